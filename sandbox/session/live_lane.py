"""Live lane: its setup, its state and its ledger, advanced frame by frame and changed by edits."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.methods import Family, find_method
from softcradle.physics.simulation import move
from softcradle.physics.state import State
from softcradle.physics.status import WarningCode
from softcradle.sandbox.languages import _
from softcradle.sandbox.motion import Motion
from softcradle.sandbox.session.inputs import LaneInput, SetVelocity
from softcradle.sandbox.session.lane_setup import LaneSetup, Setup
from softcradle.sandbox.session.ledger import (
    BY_BED,
    BY_CONTACTS,
    SWITCHES,
    VELOCITY_ERROR,
    External,
    book_all,
    book_edit,
    book_frame,
    measure,
    new_ledger,
)
from softcradle.sandbox.story.ending import is_endless, is_over
from softcradle.sandbox.story.live_rules import HAND_FREQUENCY, HAND_SPEED

Array = NDArray[np.float64]
LARGEST = 1e15  # m, m/s, N; beyond it energies would overflow
LIVE_STEPS = 5_000  # most steps of an adaptive method in one frame, about 20 ms
REFERENCE_STEPS = 700  # most steps of the reference method, which is plain Python, in one frame, about 0.2 s
WARNING_FRAMES = 60  # frames for which a warning of the method stays: half a second


class BlownUpError(Exception):
    """A method has exceeded its limit; the message is a sentence."""


@dataclass
class LiveLane:
    """Present state of one lane.

    Attributes:
        setup: the immutable part.
        state: the moving part.
        ledger: (13,) energy, momentum and estimated error, see :mod:`softcradle.sandbox.session.ledger`.
        warning: recent problem of its method, in a sentence; empty without one.
        warning_age: frames since then.
    """

    setup: LaneSetup
    state: State
    ledger: Array
    warning: str = ""
    warning_age: int = 0

    def __post_init__(self) -> None:
        """Continue from the error in the ledger, because a frame of the history does not store it elsewhere."""
        estimate = float(self.ledger[VELOCITY_ERROR])
        self.state.velocity_error = math.nan if estimate < 0.0 else estimate

    @classmethod
    def at_start(cls, setup: LaneSetup) -> LiveLane:
        """Return the lane at its start."""
        state = setup.start.copy()
        return cls(setup, state, new_ledger(setup.chain, state))

    @property
    def chain(self) -> Chain:
        """The chain."""
        return self.setup.chain

    @property
    def position(self) -> Array:
        """(n+1,) positions [m], without bead lengths."""
        return self.state.position(self.chain)

    @property
    def velocity(self) -> Array:
        """(n+1,) bead velocities [m/s]."""
        return self.state.velocity(self.chain)

    @property
    def endless(self) -> bool:
        """True if contacts may close again and again."""
        return is_endless(self.chain, self.state)

    @property
    def over(self) -> bool:
        """True if no contact can close any more."""
        return is_over(self.chain, self.state, self.setup.speed)

    @property
    def motion(self) -> Motion:
        """Return the state as a Motion of one row, for drawing."""
        state, dissipative = self.state, self.chain.dissipative
        return Motion(
            chain=self.chain,
            time=np.array([state.time]),
            overlap=state.overlap[None],
            rate=state.rate[None],
            anchor=state.anchor[None],
            force=state.force[None],
            absorbed=self.ledger[[BY_CONTACTS, BY_BED]].sum()[None] if dissipative else np.zeros(0),
        )

    def changed(self, item: LaneInput, at_start: bool) -> LiveLane:
        """Return the lane after an edit; an edit `at_start` of the session also changes the lane's start. Raise
        ValueError if it is refused.
        """
        setup, state = item.edited(self.setup, self.state.copy())
        ledger = self.ledger.copy()
        measure(setup.chain, state, ledger)
        book_edit(self.ledger, ledger, self._by_drive(state) if setup.chain is self.chain else 0.0)
        if setup.method != self.setup.method:  # the previous method's error does not count for the new one
            book_all(ledger)
            ledger[VELOCITY_ERROR] = 0.0
        if at_start:
            start = state.copy()
        else:
            start = item.edited(self.setup, self.setup.start.copy())[1] if item.changes_start else self.setup.start
        if at_start and isinstance(item, SetVelocity):
            setup = setup.with_speed(state.velocity(setup.chain))
        return LiveLane(replace(setup, start=start), state, ledger)

    def advance(self, whole: Setup, bead: int, pointer: float) -> None:
        """Advance by one frame of the `whole` session; a spring pulls `bead` (-1: none) to `pointer` [m].

        Raise BlownUpError, with an unusable state, if a number is not finite or exceeds LARGEST.
        """
        chain, state, setup, duration = self.chain, self.state, self.setup, whole.frame_time
        before, closed, switches = self.position, state.closed, state.switches
        state.taken[:] = 0.0  # for this frame only, because differences of sums would depend on their start
        state.push = self._push(bead, pointer, HAND_FREQUENCY * whole.slow) if bead >= 0 else None
        # after these steps of a frame `conserving` finishes it, so that no method freezes the window
        most = REFERENCE_STEPS if find_method(setup.method).family is Family.REFERENCE else LIVE_STEPS
        move(chain, state, duration, setup.method, setup.step_for(duration), setup.tolerance, most)
        # An estimate above the guarantee is far below anything visible; the verdict judges its size.
        self._take_warning(" ".join(str(one) for one in state.warnings if one.code is not WarningCode.ESTIMATE))
        if not all(
            (np.abs(values) < LARGEST).all() for values in (state.overlap, state.rate, state.anchor, state.force)
        ):
            raise BlownUpError(_("{method} has blown up: {remedy}", method=setup.method, remedy=setup.remedy))
        ledger = self.ledger.copy()
        measure(chain, state, ledger)
        book_frame(chain, self.ledger, ledger, self._external(before, duration))
        seen = int(np.count_nonzero(closed != state.closed))
        ledger[VELOCITY_ERROR] = -1.0 if math.isnan(state.velocity_error) else state.velocity_error
        ledger[SWITCHES] += max(seen, state.switches - switches)
        self.ledger = ledger

    def _take_warning(self, warning: str) -> None:
        """Store a new warning of the method, and drop an old one."""
        if warning:
            self.warning, self.warning_age = warning, 0
            return
        self.warning_age += 1
        if self.warning_age >= WARNING_FRAMES:
            self.warning = ""

    def _push(self, bead: int, pointer: float, frequency: float) -> Array:
        """Return the (n+1,) force [N] on each bead from a spring of angular `frequency` [1/s] to the pointer; 0 on a
        wall.
        """
        push, mass = np.zeros(self.chain.contacts + 1), self.chain.mass[bead]
        if math.isfinite(mass):
            offset, velocity = pointer - float(self.position[bead]), float(self.velocity[bead])
            reach = 2.0 * HAND_SPEED * self.setup.speed / frequency
            stretch = min(max(offset, -reach), reach)
            push[bead] = mass * (frequency * frequency * stretch - 2.0 * frequency * velocity)
        return push

    def _external(self, before: Array, duration: float) -> External:
        """Return the input of drive, pointer spring and forces over time during a frame that began at the positions
        `before`.
        """
        beads = np.isfinite(self.chain.mass)
        moved = (self.position - before)[beads]

        def of(force: Array | None) -> Array:
            """Return (2,) work and impulse of a steady force on each bead."""
            return np.zeros(2) if force is None else np.array([force[beads] @ moved, duration * force[beads].sum()])

        work, impulse = of(self.chain.drive_force).tolist()
        given = self.state.given + of(self.state.push)
        return External(work, impulse, given, self.velocity, self.state.absorbed.copy())

    def _by_drive(self, state: State) -> float:
        """Return the work [J] of the drive between this state and another state of the same chain."""
        if self.chain.drive_force is None:
            return 0.0
        moved = np.where(np.isfinite(self.chain.mass), state.position(self.chain) - self.position, 0.0)
        return float(self.chain.drive_force @ moved)
