"""The verdict on one run: its error compared with the tolerance and with the error that the run estimates."""

from __future__ import annotations

from enum import StrEnum
from time import perf_counter
from typing import Any

import numpy as np
from softcradle.physics.simulation import solve
from softcradle.physics.trajectory import Trajectory

from benchmarks.scan.families import Motion
from benchmarks.scan.truth import FINE_SPREAD, Path, Truth, off_by

GUARANTEE = 10.0  # Guaranteed error of final velocities, in tolerances.
SLOW = 1.0  # Time [s] above which a run counts as slow.


class RunVerdict(StrEnum):
    """The result of comparing a run with the reference solution."""

    WITHIN = "within"  # The error is within the guarantee.
    REPORTED = "reported"  # The error is larger, but within the error that the run estimates, or the run warns.
    UNDETECTED = "undetected"  # The error is larger than the run estimates, so it is undetected.
    GAVE_UP = "gave up"
    UNKNOWN = "unknown"  # The reference solution is less precise than the error that would have to be shown.


def judge(motion: Motion, truth: Truth, method: str, tolerance: float) -> dict[str, Any]:
    """Solve `motion` with `method`. Return the verdict and the numbers behind it."""
    began = perf_counter()
    found = solve(motion.chain, motion.velocity, motion.duration, method, samples=2, tolerance=tolerance)
    seconds = perf_counter() - began
    apart = np.abs(found.final_velocity - truth.velocity)
    verdict = _verdict(found, apart, truth, GUARANTEE * tolerance * motion.speed)
    shift, late = _path_errors(motion, truth, found)
    if truth.path is not None and verdict in (RunVerdict.WITHIN, RunVerdict.REPORTED):
        allowed = GUARANTEE * tolerance * motion.speed * truth.path.end
        verdict = max(verdict, _path_verdict(found, max(shift, late), truth.path, allowed), key=list(RunVerdict).index)
    return {
        "verdict": verdict.value,
        "error": float(apart.max()),
        "doubt": float(truth.doubt.max()),
        "estimate": float(found.velocity_error.max()),
        "shift": shift,
        "late": late,
        "position_error": float(found.position_error[-1]),
        "path": truth.path is not None,
        "warnings": [warning.code.value for warning in found.warnings],
        "seconds": seconds,
        "slow": seconds > SLOW,
        "steps": found.steps,
        "truth": truth.source,
    }


def _path_errors(motion: Motion, truth: Truth, found: Trajectory) -> tuple[float, float]:
    """Return the errors [m] of final positions, and of contact times as distances; 0 if the path is not known."""
    path = truth.path
    if path is None or found.status.gave_up:
        return 0.0, 0.0
    shift = float(np.abs(found.position[-1] - path.at(float(found.time[-1]), truth.velocity)).max())
    late = max((off_by(event, found, motion.speed) for event in path.events), default=0.0)
    return shift, late


def _path_verdict(found: Trajectory, error: float, path: Path, allowed: float) -> RunVerdict:
    """Return the verdict on positions and contact times, which are off by `error` [m]; `allowed` [m] is guaranteed."""
    if error <= allowed + min(path.doubt, allowed):
        return RunVerdict.WITHIN
    bound = float(np.fmax(found.position_error[-1], allowed))
    if found.warnings or error <= bound + min(path.doubt, bound):
        return RunVerdict.REPORTED
    return RunVerdict.UNDETECTED if error > bound + path.doubt else RunVerdict.UNKNOWN


def _verdict(found: Trajectory, apart: np.ndarray, truth: Truth, allowed: float) -> RunVerdict:
    if found.status.gave_up:
        return RunVerdict.GAVE_UP
    if (apart <= allowed + np.minimum(truth.doubt, allowed)).all():
        return RunVerdict.WITHIN
    bound = np.fmax(found.velocity_error, allowed)  # The estimate is NaN for methods that do not estimate their error.
    if found.warnings or (apart <= bound + np.minimum(truth.doubt, bound)).all():
        return RunVerdict.REPORTED
    known = truth.source == FINE_SPREAD or (apart > bound + truth.doubt).any()
    return RunVerdict.UNDETECTED if known else RunVerdict.UNKNOWN
