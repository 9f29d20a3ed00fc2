"""The verdict on one run: its error against the truth, the tolerance, and what the run itself states."""

from __future__ import annotations

from enum import StrEnum
from time import perf_counter
from typing import Any

import numpy as np
from softcradle.physics.simulation import solve
from softcradle.physics.trajectory import Trajectory

from benchmarks.scan.families import Motion
from benchmarks.scan.truth import FINE_SPREAD, Truth

PROMISE = 10.0  # tolerances: an error below this is within
SLOW = 1.0  # [s]


class RunVerdict(StrEnum):
    """How one run stands to the truth."""

    WITHIN = "within"  # the error is within the tolerance
    STATED = "stated"  # it is not, but within what the run states of its own error, or the run warns
    SILENT = "silent"  # it is beyond what the run states
    GAVE_UP = "gave up"
    UNKNOWN = "unknown"  # the truth is known less well than the error that it would have to show


def judge(motion: Motion, truth: Truth, method: str, tolerance: float) -> dict[str, Any]:
    """Solve `motion` by `method`; the verdict with the numbers behind it."""
    began = perf_counter()
    found = solve(motion.chain, motion.velocity, motion.duration, method, samples=2, tolerance=tolerance)
    seconds = perf_counter() - began
    apart = np.abs(found.final_velocity - truth.velocity)
    return {
        "verdict": _verdict(found, apart, truth, PROMISE * tolerance * motion.speed).value,
        "error": float(apart.max()),
        "doubt": float(truth.doubt.max()),
        "stated": float(found.velocity_error.max()),
        "warnings": [warning.code.value for warning in found.warnings],
        "seconds": seconds,
        "slow": seconds > SLOW,
        "steps": found.steps,
        "truth": truth.source,
    }


def _verdict(found: Trajectory, apart: np.ndarray, truth: Truth, allowed: float) -> RunVerdict:
    if found.status.gave_up:
        return RunVerdict.GAVE_UP
    if (apart <= allowed + np.minimum(truth.doubt, allowed)).all():
        return RunVerdict.WITHIN
    bound = np.fmax(found.velocity_error, allowed)  # NaN where a method states none
    if found.warnings or (apart <= bound + np.minimum(truth.doubt, bound)).all():
        return RunVerdict.STATED
    known = truth.source == FINE_SPREAD or (apart > bound + truth.doubt).any()
    return RunVerdict.SILENT if known else RunVerdict.UNKNOWN
