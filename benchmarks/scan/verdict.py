"""Verdict on one simulation. The error of the simulation is compared with the tolerance and with the error that the
method estimates.
"""

from __future__ import annotations

from enum import StrEnum
from time import perf_counter
from typing import Any

import numpy as np
from softcradle.physics.simulation import solve
from softcradle.physics.trajectory import Trajectory

from benchmarks.scan.families import Motion
from benchmarks.scan.truth import FINE_SPREAD, Path, Truth, off_by

GUARANTEE = 10.0  # Guaranteed error of final velocities, as a multiple of the tolerance.
SLOW = 1.0  # Computing time [s] above which a simulation counts as slow.


class RunVerdict(StrEnum):
    """Result of comparing a simulation with the reference solution."""

    WITHIN = "within"  # The error is within the guarantee.
    # The error exceeds the guarantee. The error is within the error that the method estimates, or the method warns.
    REPORTED = "reported"
    # The error exceeds the guarantee and the error that the method estimates, so it is undetected.
    UNDETECTED = "undetected"
    GAVE_UP = "gave up"
    UNKNOWN = "unknown"  # The reference solution is not precise enough to show an error.


def judge(motion: Motion, truth: Truth, method: str, tolerance: float) -> dict[str, Any]:
    """Solve `motion` with `method`. Return the verdict and the numbers from which it follows."""
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
    """Return the errors [m] of final positions and of contact times, which are expressed as distances.

    The errors are 0 if the path is not known.
    """
    path = truth.path
    if path is None or found.status.gave_up:
        return 0.0, 0.0
    shift = float(np.abs(found.position[-1] - path.at(float(found.time[-1]), truth.velocity)).max())
    late = max((off_by(event, found, motion.speed) for event in path.events), default=0.0)
    return shift, late


def _path_verdict(found: Trajectory, error: float, path: Path, allowed: float) -> RunVerdict:
    """Return the verdict on positions and contact times, whose error is `error` [m]. The guaranteed error is `allowed`
    [m].
    """
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
