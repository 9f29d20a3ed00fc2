"""Live lane: the setup, the state and the ledger of one lane. It advances frame by frame, and edits change it."""

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
LARGEST = 1e15  # Largest number in m, m/s and N. Energies of larger numbers would overflow.
LIVE_STEPS = 5_000  # Largest number of steps of an adaptive method in one frame. They take about 20 ms.
# Largest number of steps of the reference method in one frame. They take about 0.2 s, because the method is plain
# Python.
REFERENCE_STEPS = 700
WARNING_FRAMES = 60  # Number of frames for which a warning of the method stays: half a second.


class BlownUpError(Exception):
    """Raised if a method yields numbers beyond its limit. The message is a sentence."""


@dataclass
class LiveLane:
    """Present state of one lane.

    Attributes:
        setup: the immutable part of the lane.
        state: positions, velocities and forces, which change with time.
        ledger: (13,) energy, momentum and estimated error, see :mod:`softcradle.sandbox.session.ledger`.
        warning: recent problem of the method, in a sentence; empty if there is none.
        warning_age: number of frames since the last problem.
    """

    setup: LaneSetup
    state: State
    ledger: Array
    warning: str = ""
    warning_age: int = 0

    def __post_init__(self) -> None:
        """Set the error estimate of the state from the ledger. A frame of the history stores it only in the ledger."""
        estimate = float(self.ledger[VELOCITY_ERROR])
        self.state.velocity_error = math.nan if estimate < 0.0 else estimate

    @classmethod
    def at_start(cls, setup: LaneSetup) -> LiveLane:
        """Return the lane at its start."""
        state = setup.start.copy()
        return cls(setup, state, new_ledger(setup.chain, state))

    @property
    def chain(self) -> Chain:
        """The chain of the lane."""
        return self.setup.chain

    @property
    def position(self) -> Array:
        """(n+1,) positions of the beads [m], without their lengths."""
        return self.state.position(self.chain)

    @property
    def velocity(self) -> Array:
        """(n+1,) velocities of the beads [m/s]."""
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
        """Return the state as a Motion with a single sample, for drawing."""
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
        """Return the lane after an edit. Raise ValueError if the edit is invalid.

        If the session is `at_start`, the edit also changes the start of the lane.
        """
        setup, state = item.edited(self.setup, self.state.copy())
        ledger = self.ledger.copy()
        measure(setup.chain, state, ledger)
        book_edit(self.ledger, ledger, self._by_drive(state) if setup.chain is self.chain else 0.0)
        if setup.method != self.setup.method:  # The error of the previous method does not count for the new method.
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
        """Advance the lane by one frame of the `whole` session. A spring pulls `bead` (-1: none) to `pointer` [m].

        Raise BlownUpError if a number is not finite or exceeds LARGEST. The state is then unusable.
        """
        chain, state, setup, duration = self.chain, self.state, self.setup, whole.frame_time
        before, closed, switches = self.position, state.closed, state.switches
        # Sum the absorbed energy for this frame only. Differences of longer sums would depend on the start of the sum.
        state.taken[:] = 0.0
        state.push = self._push(bead, pointer, HAND_FREQUENCY * whole.slow) if bead >= 0 else None
        # After this number of steps, `conserving` finishes the frame, so that no method freezes the window.
        most = REFERENCE_STEPS if find_method(setup.method).family is Family.REFERENCE else LIVE_STEPS
        move(chain, state, duration, setup.method, setup.step_for(duration), setup.tolerance, most)
        # Skip warnings about an error estimate above the guarantee. Such errors are far too small to be visible, and
        # the verdict judges their size.
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
        """Store a new warning of the method. Without a new warning, remove an old one after WARNING_FRAMES."""
        if warning:
            self.warning, self.warning_age = warning, 0
            return
        self.warning_age += 1
        if self.warning_age >= WARNING_FRAMES:
            self.warning = ""

    def _push(self, bead: int, pointer: float, frequency: float) -> Array:
        """Return the force (n+1,) [N] of the pointer spring on each bead. It is 0 for a wall.

        The spring has the angular `frequency` [1/s].
        """
        push, mass = np.zeros(self.chain.contacts + 1), self.chain.mass[bead]
        if math.isfinite(mass):
            offset, velocity = pointer - float(self.position[bead]), float(self.velocity[bead])
            reach = 2.0 * HAND_SPEED * self.setup.speed / frequency
            stretch = min(max(offset, -reach), reach)
            push[bead] = mass * (frequency * frequency * stretch - 2.0 * frequency * velocity)
        return push

    def _external(self, before: Array, duration: float) -> External:
        """Return the input from drive, pointer spring and forces over time during a frame. `before` are the positions
        at its start.
        """
        beads = np.isfinite(self.chain.mass)
        moved = (self.position - before)[beads]

        def of(force: Array | None) -> Array:
            """Return the work and the impulse (2,) of a force that is constant during the frame."""
            return np.zeros(2) if force is None else np.array([force[beads] @ moved, duration * force[beads].sum()])

        work, impulse = of(self.chain.drive_force).tolist()
        given = self.state.given + of(self.state.push)
        return External(work, impulse, given, self.velocity, self.state.absorbed.copy())

    def _by_drive(self, state: State) -> float:
        """Return the work [J] of the drive on the way to another `state` of the same chain."""
        if self.chain.drive_force is None:
            return 0.0
        moved = np.where(np.isfinite(self.chain.mass), state.position(self.chain) - self.position, 0.0)
        return float(self.chain.drive_force @ moved)
