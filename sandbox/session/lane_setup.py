"""Setups of lanes: the immutable part of a session. An edit replaces a setup; the history holds the one of each frame."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.advice.auto_method import LIVE_ERROR as ERROR
from softcradle.physics.advice.auto_method import conserving_step
from softcradle.physics.chain import Chain
from softcradle.physics.contact import Contact
from softcradle.physics.methods import find_method, refusal_of
from softcradle.physics.scales import speed_scale, step_at
from softcradle.physics.state import State
from softcradle.sandbox.languages import _
from softcradle.sandbox.scene_runs import KEEPING, SHOWN
from softcradle.scenes import Lane, Scene

STEP_COST = {"euler": 0.015, "verlet": 0.015, "yoshida4": 0.045, "conserving": 0.3, "pymunk": 2.0}  # us a contact
FRAME_COST = 1500.0  # us, the most with a chosen step: a picture takes two frames, and the time to draw it
TYPED_STEP_FRAME_COST = 30_000.0  # us, the most with a typed step: beyond it a dragged bead lags behind the pointer


def suitable_step(method: str, chain: Chain, speed: float) -> float:
    """Step [s] with which `method` holds about ERROR in the final velocities; 0 for adaptive methods.

    That of `conserving`, which is chosen where nobody has, follows the rule of method "auto" for this error. It holds it in
    every scene of the catalogue, for 0.3 microseconds a contact and step.
    """
    if find_method(method).adaptive:
        return 0.0
    if method == KEEPING:
        return conserving_step(chain, speed, ERROR)
    return step_at(chain, speed)


def steps_in(frame_time: float, method: str, step: float, contacts: int, given: bool) -> int:
    """Number of steps in a frame of `frame_time` [s]: none longer than `step` [s], as far as the frame's cost allows.

    The cost is counted in steps, not measured: the same inputs give the same digits on a slow computer.
    """
    most = (TYPED_STEP_FRAME_COST if given else FRAME_COST) / (STEP_COST.get(method, 1.0) * contacts)
    return max(1, min(math.ceil(frame_time / step - 1e-9), int(most)))


FRAME_RATE = 120  # model frames in a second of wall time: at 60 pictures a second each picture takes two
TOLERANCE = 1e-8  # of adaptive methods where the scene has none
DURATION = 10.0  # s, of a scene that no longer ends by itself after an edit


@dataclass(frozen=True)
class LaneSetup:
    """How one lane moves.

    Attributes:
        label: of the scene's lane.
        chain: the Chain.
        method: a name from METHODS.
        step: longest step [s]; 0 for adaptive methods.
        automatic: True: the method is that of all that is shown, as nobody has chosen one.
        step_given: True: a person has typed the step; False: it is chosen, again after every edit.
        tolerance: of adaptive methods.
        locked: per contact the law it had before its piston was locked, else None.
        origin: per contact the law that it was converted from, which every further conversion starts from, else None.
        speed: closing speed [m/s] of this scene; it scales steps, the pointer spring and errors.
        start: the State to which a restart goes back; never changed in place.
        length: of a bead [m], beyond which no converted contact may be pressed.
        duration: of the scene [s], within which a drive gives speed.
    """

    label: str
    chain: Chain
    method: str
    step: float
    automatic: bool
    step_given: bool
    tolerance: float
    locked: tuple[Contact | None, ...]
    speed: float
    start: State = field(compare=False, repr=False)
    origin: tuple[Contact | None, ...] = ()
    length: float = math.inf
    duration: float = DURATION

    @property
    def scale(self) -> float:
        """Speed [m/s] of the fastest closing there can be: at the closing speed, or by the drive and what is pressed."""
        return speed_scale(self.chain, [0.0, self.speed], self.duration)

    def with_speed(self, velocity: NDArray[np.float64]) -> LaneSetup:
        """The same lane at the closing speed of `velocity` (n+1,) [m/s]; a chosen step is chosen again."""
        return replace(self, speed=speed_scale(self.chain, velocity, self.duration)).with_choice()

    def with_chain(
        self,
        chain: Chain,
        locked: tuple[Contact | None, ...] | None = None,
        origin: tuple[Contact | None, ...] | None = None,
    ) -> LaneSetup:
        """The same lane with another chain; a chosen step is chosen again. ValueError where the method refuses the chain."""
        _check_carried(chain, self.method)
        locked, origin = self.locked if locked is None else locked, self.origin if origin is None else origin
        return replace(self, chain=chain, locked=locked, origin=origin).with_choice()

    def origin_of(self, contact: int) -> Contact | None:
        """The law that a contact was converted from; None where it has not been converted."""
        return self.origin[contact] if self.origin else None

    def with_choice(self) -> LaneSetup:
        """The same lane; method and step are chosen again where nobody has given them."""
        if self.automatic:
            return replace(self, method=SHOWN, step=suitable_step(SHOWN, self.chain, self.scale))
        return self if self.step_given else replace(self, step=suitable_step(self.method, self.chain, self.scale))

    def with_method(self, name: str) -> LaneSetup:
        """The same lane by method `name` ('auto': chosen) with a chosen step. ValueError for an unknown name."""
        method = self.method if name == "auto" else find_method(name).name
        _check_carried(self.chain, SHOWN if name == "auto" else method)
        return replace(self, method=method, automatic=name == "auto", step_given=False).with_choice()

    def with_step(self, step: float | None) -> LaneSetup:
        """The same method with steps of at most `step` [s]; None: chosen. ValueError for an adaptive method."""
        if step is None:
            return replace(self, step_given=False).with_choice()
        if find_method(self.method).adaptive:
            raise ValueError(f"method {self.method} chooses its own steps")
        return replace(self, step=step, step_given=True, automatic=False)

    @property
    def finer(self) -> str:
        """How the method of the lane is made more exact, in words."""
        return _("take a smaller step or more slow motion") if self.step_given else _("take more slow motion")

    @property
    def remedy(self) -> str:
        """What helps where the method is off: the one that keeps energy and momentum, unless it is the one that failed."""
        return self.finer if self.method == KEEPING else _("take {method} or a smaller step", method=KEEPING)

    def step_for(self, frame_time: float) -> float | None:
        """Step [s] in a frame of `frame_time` [s], see `steps_in`; None for an adaptive method."""
        if self.step == 0.0:
            return None
        return frame_time / steps_in(frame_time, self.method, self.step, self.chain.contacts, self.step_given)


def _check_carried(chain: Chain, method: str) -> None:
    """Refuse a chain with friction, loss or couplers where the method takes none."""
    if reason := refusal_of(method, chain):
        raise ValueError(reason)


@dataclass(frozen=True)
class Setup:
    """All lanes, and the slow motion: `slow` seconds of wall time show one second of the model."""

    lanes: tuple[LaneSetup, ...]
    slow: float = 1.0

    @property
    def frame_time(self) -> float:
        """Model time of one frame [s]."""
        return 1.0 / (FRAME_RATE * self.slow)

    @property
    def chains(self) -> list[tuple[Chain, tuple[object, ...]]]:
        """Chain and locked pistons of each lane, to be compared."""
        return [(lane.chain, lane.locked) for lane in self.lanes]

    @property
    def starts(self) -> list[tuple[list[float], ...]]:
        """How each lane begins, to be compared."""
        return [(s.overlap.tolist(), s.rate.tolist(), s.anchor.tolist()) for s in (lane.start for lane in self.lanes)]


def setup_of(scene: Scene) -> Setup:
    """The setup with which a scene opens."""
    return Setup(tuple(lane_setup(scene, lane) for lane in scene.lanes), scene.view.slow)


def lane_setup(scene: Scene, lane: Lane) -> LaneSetup:
    """How `lane` moves in `scene`: by the scene's method and step where it names them."""
    chain, duration = lane.chain(), scene.duration or DURATION
    speed = speed_scale(chain, lane.velocity, duration)
    setup = LaneSetup(
        label=lane.label,
        chain=chain,
        method=SHOWN,
        step=suitable_step(SHOWN, chain, speed),
        automatic=scene.method is None,
        step_given=False,
        tolerance=TOLERANCE if scene.tolerance is None else scene.tolerance,
        locked=(None,) * chain.contacts,
        speed=speed,
        start=State.at_start(chain, lane.velocity),
        length=scene.view.length,
        duration=duration,
    )
    if scene.method is not None:
        setup = setup.with_method(scene.method)
    return setup if scene.step is None else setup.with_step(scene.step)
