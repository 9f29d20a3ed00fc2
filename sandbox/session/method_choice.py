"""Choice of method and step: what a lane is moved by when nobody has said otherwise, and how long a frame may take."""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics.chain import Chain
from softcradle.physics.methods import find_method
from softcradle.physics.scales import STEPS_A_CONTACT, contact_scales

ERROR = 1e-3  # of the closing speed: what a scene's final velocities may be off at the window, a pixel of a plot
CONSERVING_STEPS = 64  # to the shortest contact: see `choose_method`
COST = {"euler": 0.015, "verlet": 0.015, "yoshida4": 0.045, "conserving": 0.3, "pymunk": 2.0}  # us a contact and step
FRAME_COST = 1500.0  # us: two frames a picture, and the rest of a 60th of a second for drawing
MOST_COST = 30_000.0  # us: of a frame with a step that a person has typed; beyond it the hand is no longer felt


def choose_method(chain: Chain, speed: float) -> tuple[str, float]:
    """The cheapest method that holds the scene's error, and its step [s].

    It is `conserving`, whose energy and momentum are exact at any step, with 64 steps to the shortest contact between
    beads that close at `speed` [m/s]: final velocities of every scene of the catalogue are then right within ERROR of
    it, for 0.3 microseconds a contact and step. It is not `simulate`'s "auto", which measures the machine: the same hands at
    the window must give the same digits on every computer.
    """
    return "conserving", suitable_step("conserving", chain, speed)


def suitable_step(method: str, chain: Chain, speed: float) -> float:
    """Step [s] with which `method` holds about that error too; 0 where it chooses its own."""
    if find_method(method).adaptive:
        return 0.0
    return contact_time(chain, speed) / (CONSERVING_STEPS if method == "conserving" else STEPS_A_CONTACT)


def contact_time(chain: Chain, speed: float) -> float:
    """Shortest contact [s] of the chain at the closing speed `speed` [m/s]."""
    return float(contact_scales(chain, np.array([0.0, speed]))[1].min())


def steps_in(frame_time: float, method: str, step: float, contacts: int, given: bool) -> int:
    """Steps in a frame of `frame_time` [s], none longer than `step` [s] as long as a frame has room for them.

    The room is in steps, not in time by the clock: the same inputs give the same digits on a slow computer.
    """
    room = (MOST_COST if given else FRAME_COST) / (COST.get(method, 1.0) * contacts)
    return max(1, min(math.ceil(frame_time / step - 1e-9), int(room)))
