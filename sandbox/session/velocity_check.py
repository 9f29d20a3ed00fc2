"""Check of velocities. An accurate run in the background measures the error of the live run.

The accurate run begins at the frame in which the user last changed the motion.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from softcradle.physics.methods import refusal_of
from softcradle.physics.simulation import move
from softcradle.physics.state import State
from softcradle.sandbox.motion import Array
from softcradle.sandbox.scene_runs import TOLD
from softcradle.sandbox.session import inputs
from softcradle.sandbox.session.history_slices import slice_at
from softcradle.sandbox.session.lane_setup import LaneSetup
from softcradle.sandbox.session.recording import hash_of
from softcradle.sandbox.session.session import Session

METHOD = TOLD
TOLERANCE = 1e-9  # Tolerance of the accurate run.
# Largest number of steps of the accurate run between two checks. They take some tenths of a second. If more steps are
# needed, the error is unknown.
MOST_STEPS = 20_000
LEAST_FRAMES = 30  # Smallest number of frames between two checks: a quarter of a second.
# Inputs that do not change the motion.
UNTOUCHING = inputs.SetSlow, inputs.SetMethod, inputs.SetStep, inputs.Resume


@dataclass(frozen=True)
class CheckedFrame:
    """Result of a check at one frame. `velocity` (n+1,) are the live velocities, and `state` is the state of the
    accurate run.

    `error` is the largest error of a bead velocity relative to the closing speed, or None if it is unknown.
    """

    frame: int
    error: float | None
    velocity: Array
    state: State


class VelocityCheck:
    """Check of one lane. Its jobs may run on another thread, one job at a time.

    Attributes:
        base: key of the state from which the present checks start.
    """

    def __init__(self, session: Session, lane: int) -> None:
        self.session, self.lane = session, lane
        self.base: tuple[object, ...] = ()
        self._found: list[CheckedFrame] = []
        self._busy = False

    def error(self) -> float | None:
        """Return the error at the visible frame from the last check, or None if it is not known."""
        if self.base != self._present_base():
            return None
        self._drop_stale()
        return next((one.error for one in reversed(self._found) if one.frame <= self.session.frame), None)

    def job(self) -> Callable[[], CheckedFrame] | None:
        """Return a function that performs the next check, or None if no check is due. Its result must be passed to
        :meth:`take`.
        """
        session = self.session
        base = self._present_base()
        if self._busy or session.held.lane >= 0.0 or not base or session.frame != session.history.last:
            return None
        if refusal_of(METHOD, session.lanes[self.lane].chain):
            return None
        if base != self.base:
            self.base, self._found = base, []
        self._drop_stale()
        begin = self._touched()
        last = self._found[-1] if self._found else None
        if session.frame - (last.frame if last else begin) < LEAST_FRAMES:
            return None
        state = last.state if last else session.history.snapshot(begin).states[self.lane]
        now = slice_at(session.history, self.lane, session.frame)
        setup, frame, time, velocity = now.setup, session.frame, float(now.time[0]), now.velocity[0].copy()
        self._busy = True
        return lambda: checked(setup, state.copy(), frame, time, velocity)

    def take(self, base: tuple[object, ...], result: object) -> None:
        """Store the `result` of a job that was started for `base`."""
        self._busy = False
        if base == self.base and isinstance(result, CheckedFrame):
            self._found.append(result)

    def _drop_stale(self) -> None:
        """Drop results of a branch of the history that no longer exists. For example, another method starts a new
        branch.
        """
        history, last = self.session.history, self.session.history.last
        while self._found and not (
            history.first <= self._found[-1].frame <= last
            and np.array_equal(
                slice_at(history, self.lane, self._found[-1].frame).velocity[0], self._found[-1].velocity
            )
        ):
            self._found.pop()

    def _touched(self) -> int:
        """Return the frame at which the user last changed the motion."""
        frames = (
            frame
            for frame, item in reversed(self.session.recording.inputs)
            if frame <= self.session.frame and not isinstance(item, UNTOUCHING)
        )
        return next(frames, self.session.recording.frame)

    def _present_base(self) -> tuple[object, ...]:
        begin = self._touched()
        if begin < self.session.history.first:
            return ()
        snapshot = self.session.history.snapshot(begin)
        return begin, hash_of(snapshot), self.session.lanes[self.lane].chain


def checked(setup: LaneSetup, state: State, frame: int, time: float, velocity: Array) -> CheckedFrame:
    """Advance `state` accurately to `time` [s] and compare its velocities with the live velocities (n+1,) at that time.

    The error is the difference plus the error estimate of the accurate run.
    """
    move(setup.chain, state, time - state.time, METHOD, None, TOLERANCE, MOST_STEPS)
    error = (float(np.abs(state.velocity(setup.chain) - velocity).max()) + state.velocity_error) / setup.speed
    return CheckedFrame(frame, error if math.isfinite(error) else None, velocity, state)
