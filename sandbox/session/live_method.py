"""Choice of method and step: what moves a lane when nobody has chosen, and how many steps a frame may take."""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics.advice.auto_method import LIVE_ERROR as ERROR
from softcradle.physics.advice.auto_method import conserving_step
from softcradle.physics.chain import Chain
from softcradle.physics.default_step import STEPS_A_CONTACT
from softcradle.physics.methods import find_method
from softcradle.physics.scales import contact_scales

STEP_COST = {"euler": 0.015, "verlet": 0.015, "yoshida4": 0.045, "conserving": 0.3, "pymunk": 2.0}  # us a contact
FRAME_COST = 1500.0  # us, the most with a chosen step: a picture takes two frames, and the time to draw it
TYPED_STEP_FRAME_COST = 30_000.0  # us, the most with a typed step: beyond it a dragged bead lags behind the pointer


def choose_method(chain: Chain, speed: float) -> tuple[str, float]:
    """The cheapest method whose final velocities are right within ERROR, and its step [s].

    It is `conserving`, whose energy and momentum are exact at any step, with the step that the rule of method "auto" has for
    this error. That holds ERROR in every scene of the catalogue, for 0.3 microseconds a contact and step.
    """
    return "conserving", suitable_step("conserving", chain, speed)


def suitable_step(method: str, chain: Chain, speed: float) -> float:
    """Step [s] with which `method` holds about that error too; 0 for adaptive methods."""
    if find_method(method).adaptive:
        return 0.0
    if method == "conserving":
        return conserving_step(chain, [0.0, speed], ERROR)
    return contact_time(chain, speed) / STEPS_A_CONTACT


def contact_time(chain: Chain, speed: float) -> float:
    """Shortest contact [s] of the chain at the closing speed `speed` [m/s]."""
    return float(contact_scales(chain, np.array([0.0, speed]))[1].min())


def steps_in(frame_time: float, method: str, step: float, contacts: int, given: bool) -> int:
    """Number of steps in a frame of `frame_time` [s]: none longer than `step` [s], as far as the frame's cost allows.

    The cost is counted in steps, not measured: the same inputs give the same digits on a slow computer.
    """
    most = (TYPED_STEP_FRAME_COST if given else FRAME_COST) / (STEP_COST.get(method, 1.0) * contacts)
    return max(1, min(math.ceil(frame_time / step - 1e-9), int(most)))
