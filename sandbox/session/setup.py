"""Setups: the immutable half of a session. An edit replaces one; the history keeps the one of each frame."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from physics.chain import Chain
from physics.contact import Contact
from physics.methods import find_method
from physics.state import State
from physics.time_scale import contact_scales, speed_scale
from scenes import Lane, Scene

FRAME_RATE = 120  # model frames in a second at the wall; drawn at 60 Hz every picture is two of them
STEPS_A_CONTACT = 64  # of the chosen method: see `choose_method`


@dataclass(frozen=True)
class LaneSetup:
    """How one lane moves.

    Attributes:
        label: of the scene's lane.
        chain: the Chain.
        method: a name from METHODS.
        step: longest step [s]; 0 for adaptive methods.
        automatic: True: method and step follow :func:`choose_method` through every edit.
        tolerance: of adaptive methods.
        locked: per contact the law it had before its piston was locked, else None.
        speed: closing speed [m/s] that this scene is about; scales of steps, of the hand and of errors follow it.
        start: the State to which a restart goes back; never changed in place.
    """

    label: str
    chain: Chain
    method: str
    step: float
    automatic: bool
    tolerance: float
    locked: tuple[Contact | None, ...]
    speed: float
    start: State = field(compare=False, repr=False)

    def with_start(self, start: State) -> LaneSetup:
        """The same lane with another start."""
        return replace(self, start=start)

    def with_speed(self, velocity: NDArray[np.float64]) -> LaneSetup:
        """The same lane, about the speeds `velocity` (n+1,) [m/s]; an automatic step follows."""
        changed = replace(self, speed=speed_scale(self.chain, velocity))
        return changed.chosen() if self.automatic else changed

    def with_chain(self, chain: Chain, locked: tuple[Contact | None, ...] | None = None) -> LaneSetup:
        """The same lane with another chain; an automatic step follows."""
        changed = replace(self, chain=chain, locked=self.locked if locked is None else locked)
        return changed.chosen() if self.automatic else changed

    def chosen(self) -> LaneSetup:
        """The same lane by the method that :func:`choose_method` takes."""
        method, step = choose_method(self.chain, self.speed)
        return replace(self, method=method, step=step, automatic=True)

    def step_for(self, frame_time: float) -> float | None:
        """Step [s] for a frame of `frame_time` [s]: whole steps to a frame, none longer than `step`; None: adaptive."""
        if find_method(self.method).adaptive:
            return None
        return frame_time / max(1, math.ceil(frame_time / self.step - 1e-9))


@dataclass(frozen=True)
class Setup:
    """All lanes and the slow motion they are shown in: `slow` wall seconds for one of the model."""

    lanes: tuple[LaneSetup, ...]
    slow: float = 1.0

    @property
    def frame_time(self) -> float:
        """Model time of one frame [s]."""
        return 1.0 / (FRAME_RATE * self.slow)


def choose_method(chain: Chain, speed: float) -> tuple[str, float]:
    """The cheapest method that holds the scene's error, and its step [s].

    It is `conserving`, whose energy and momentum are exact at any step, with 64 steps to the shortest contact between
    beads that close at `speed` [m/s]: final velocities of every scene of the catalogue are then right within 6e-4 of
    it, half a pixel of a plot, for 0.3 microseconds a contact and step.
    """
    return "conserving", contact_time(chain, speed) / STEPS_A_CONTACT


def contact_time(chain: Chain, speed: float) -> float:
    """Shortest contact [s] of the chain at the closing speed `speed` [m/s]."""
    return float(contact_scales(chain, np.array([0.0, speed]))[1].min())


def setup_of(scene: Scene) -> Setup:
    """The setup with which a scene opens."""
    return Setup(tuple(lane_setup(scene, lane) for lane in scene.lanes), scene.view.slow)


def lane_setup(scene: Scene, lane: Lane) -> LaneSetup:
    """How `lane` moves in `scene`: by the scene's method and step where it names them."""
    chain = lane.chain()
    speed = speed_scale(chain, lane.velocity)
    method, step = choose_method(chain, speed)
    setup = LaneSetup(
        label=lane.label,
        chain=chain,
        method=method,
        step=step,
        automatic=True,
        tolerance=1e-8 if scene.tolerance is None else scene.tolerance,
        locked=(None,) * chain.contacts,
        speed=speed,
        start=State.at_start(chain, lane.velocity),
    )
    if scene.method is None and scene.step is None:
        return setup
    return with_method(setup, scene.method or method, scene.step)


def with_method(setup: LaneSetup, name: str, step: float | None = None) -> LaneSetup:
    """The lane by method `name`, with a step that suits it where none is given. ValueError for an unknown name."""
    if name == "auto":
        return setup.chosen()
    method = find_method(name)
    if method.adaptive:
        step = 0.0
    elif step is None:
        fine = contact_time(setup.chain, setup.speed)
        step = fine / (STEPS_A_CONTACT if name == "conserving" else 1000)
    return replace(setup, method=name, step=step, automatic=False)
