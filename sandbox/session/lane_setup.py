"""Setups of lanes. A setup is the immutable part of a lane, and an edit replaces it. The history stores the setup of
each frame.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.advice.auto_method import LIVE_ERROR as ERROR
from softcradle.physics.advice.auto_method import conserving_step
from softcradle.physics.chain import Chain
from softcradle.physics.contact import Contact
from softcradle.physics.messages import InputError
from softcradle.physics.methods import find_method, refusal_of, refusal_of_fineness
from softcradle.physics.scales import speed_scale, step_at
from softcradle.physics.state import State
from softcradle.sandbox.languages import _
from softcradle.sandbox.scene_runs import KEEPING, SHOWN
from softcradle.sandbox.story.live_rules import CONSERVING_COST, FRAME_COST, FRAME_RATE
from softcradle.scenes import Lane, Scene

# Cost of a step per contact in microseconds, by method.
STEP_COST = {"euler": 0.015, "verlet": 0.015, "yoshida4": 0.045, "conserving": CONSERVING_COST, "pymunk": 2.0}
# Largest cost of a frame in microseconds if the user has entered the step. With a larger cost, a dragged bead would lag
# behind the pointer.
TYPED_STEP_FRAME_COST = 30_000.0


def suitable_step(method: str, chain: Chain, speed: float) -> float:
    """Return a step [s] for `method`, or 0 if the method is adaptive. The final velocities then have an error of about
    ERROR.

    For the default method `conserving`, the step follows the same rule as the method "auto". With this step, the error
    stays below ERROR in every scene of the catalogue. The cost is 0.3 microseconds per contact and step.
    """
    if find_method(method).adaptive:
        return 0.0
    if method == KEEPING:
        return conserving_step(chain, speed, ERROR)
    return step_at(chain, speed)


def steps_in(frame_time: float, method: str, step: float, contacts: int, given: bool, hangs: bool = False) -> int:
    """Return the number of steps in a frame of `frame_time` [s]. A step is at most `step` [s] long if the cost allows
    it.

    The cost is counted in steps and not measured. The same inputs therefore give bitwise the same results on a slow
    computer. If the chain `hangs` on strings, its frames may cost more. Beads on strings touch only for a small part of
    a frame, and the time between collisions takes a single step.
    """
    most = (TYPED_STEP_FRAME_COST if given or hangs else FRAME_COST) / (STEP_COST.get(method, 1.0) * contacts)
    return max(1, min(math.ceil(frame_time / step - 1e-9), int(most)))


TOLERANCE = 1e-8  # Default tolerance of adaptive methods.
DURATION = 10.0  # Duration in seconds of a scene that, after an edit, no longer ends by itself.


@dataclass(frozen=True)
class LaneSetup:
    """Settings that determine the motion of one lane.

    Attributes:
        label: label of the lane in the scene.
        chain: the Chain.
        method: a name from METHODS.
        step: longest step [s]; 0 for adaptive methods.
        automatic: True if the method is the default, not a choice of the user.
        step_given: True if the user has entered the step. If False, the step is chosen again after every edit.
        tolerance: tolerance of adaptive methods.
        locked: for each contact, its law before its piston was locked, or None.
        origin: for each contact, the law from which every conversion of this contact starts, or None.
        speed: closing speed [m/s] of the scene. It scales steps, the pointer spring and errors.
        start: the State to which a restart returns; never changed in place.
        length: length of a bead [m], the limit for the depth of a converted contact.
        duration: duration of the scene [s], during which a drive accelerates beads.
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
        """Largest possible speed [m/s] at which two beads close. The closing speed, the drive and compressed contacts
        contribute.
        """
        return speed_scale(self.chain, [0.0, self.speed], self.duration)

    def with_speed(self, velocity: NDArray[np.float64]) -> LaneSetup:
        """Return the same lane with the closing speed of `velocity` (n+1,) [m/s]. A step chosen by the program is
        chosen again.
        """
        return replace(self, speed=speed_scale(self.chain, velocity, self.duration)).with_choice()

    def with_chain(
        self,
        chain: Chain,
        locked: tuple[Contact | None, ...] | None = None,
        origin: tuple[Contact | None, ...] | None = None,
    ) -> LaneSetup:
        """Return the same lane with another chain. A step chosen by the program is chosen again.

        Raise ValueError if the method does not support the chain.
        """
        _check_carried(chain, self.method)
        locked, origin = self.locked if locked is None else locked, self.origin if origin is None else origin
        return replace(self, chain=chain, locked=locked, origin=origin).with_choice()

    def origin_of(self, contact: int) -> Contact | None:
        """Return the law from which a contact was converted, or None if the contact was not converted."""
        return self.origin[contact] if self.origin else None

    def with_choice(self) -> LaneSetup:
        """Return the same lane with new choices of method and step. Choices of the user are kept."""
        if self.automatic:
            return replace(self, method=SHOWN, step=suitable_step(SHOWN, self.chain, self.scale))
        return self if self.step_given else replace(self, step=suitable_step(self.method, self.chain, self.scale))

    def with_method(self, name: str) -> LaneSetup:
        """Return the same lane with the method `name`. With 'auto', the program chooses a method. The step is chosen
        again.

        Raise ValueError if the name is unknown.
        """
        method = self.method if name == "auto" else find_method(name).name
        _check_carried(self.chain, SHOWN if name == "auto" else method)
        return replace(self, method=method, automatic=name == "auto", step_given=False).with_choice()

    def with_step(self, step: float | None) -> LaneSetup:
        """Return the same lane with steps of at most `step` [s]. If `step` is None, the program chooses the step.

        Raise ValueError if the method is adaptive.
        """
        if step is None:
            return replace(self, step_given=False).with_choice()
        if find_method(self.method).adaptive:
            raise InputError(refusal_of_fineness(self.method, step, None))
        return replace(self, step=step, step_given=True, automatic=False)

    @property
    def finer(self) -> str:
        """Return a sentence that explains how to make the method of the lane more accurate."""
        return _("use a smaller step or slower motion") if self.step_given else _("use slower motion")

    @property
    def remedy(self) -> str:
        """Return advice for a lane whose method is inaccurate.

        The advice is to use the method that conserves energy and momentum. If the lane already uses it, the advice is
        the one from `finer`.
        """
        return self.finer if self.method == KEEPING else _("use {method} or a smaller step", method=KEEPING)

    def step_for(self, frame_time: float) -> float | None:
        """Return the step [s] in a frame of `frame_time` [s], or None for an adaptive method. See `steps_in`."""
        if self.step == 0.0:
            return None
        hangs = self.chain.swing > 0.0
        return frame_time / steps_in(frame_time, self.method, self.step, self.chain.contacts, self.step_given, hangs)


def _check_carried(chain: Chain, method: str) -> None:
    """Raise ValueError if the chain has friction, loss or couplers and the method does not support them."""
    if reason := refusal_of(method, chain):
        raise InputError(reason)


@dataclass(frozen=True)
class Setup:
    """Setups of all lanes, and the slow motion. One second of model time is shown in `slow` seconds of wall time."""

    lanes: tuple[LaneSetup, ...]
    slow: float = 1.0

    @property
    def frame_time(self) -> float:
        """Model time of one frame [s]."""
        return 1.0 / (FRAME_RATE * self.slow)

    @property
    def chains(self) -> list[tuple[Chain, tuple[object, ...]]]:
        """Return the chain and the locked pistons of each lane, so that two setups can be compared."""
        return [(lane.chain, lane.locked) for lane in self.lanes]

    @property
    def starts(self) -> list[tuple[list[float], ...]]:
        """Return the start of each lane as lists, so that two setups can be compared."""
        return [(s.overlap.tolist(), s.rate.tolist(), s.anchor.tolist()) for s in (lane.start for lane in self.lanes)]


def setup_of(scene: Scene) -> Setup:
    """Return the initial setup of a scene."""
    return Setup(tuple(lane_setup(scene, lane) for lane in scene.lanes), scene.view.slow)


def lane_setup(scene: Scene, lane: Lane) -> LaneSetup:
    """Return the setup of `lane` in `scene`. Method and step of the scene are used if it defines them."""
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
