"""The end of a motion by the reference in extended precision, with its error: two runs of different order and fineness."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.reference.extended_precision import MOST_STEPS, STAGES, ExtendedRun
from softcradle.physics.reference.one_thread import on_one_thread
from softcradle.physics.state import State


@dataclass(frozen=True)
class ReferenceEnd:
    """Where a chain ends, with what is known of the error.

    Attributes:
        velocity: (n+1,) final velocities [m/s].
        time: of the end [s].
        error: [m/s] largest difference of a velocity from that of a run with fewer stages and a tenfold tolerance, and the
            tolerance of the finer run.
        steps: of both runs.
    """

    velocity: NDArray[np.float64]
    time: float
    error: float
    steps: int


@on_one_thread
def reference_end(
    chain: Chain,
    velocity: ArrayLike,
    duration: float | None = None,
    tolerance: float = 1e-13,
    most_steps: int = MOST_STEPS,
) -> ReferenceEnd:
    """Final velocities of `chain` in extended precision, with their error.

    Raises:
        ReferenceGaveUpError: the motion takes more than `most_steps` steps.
    """
    state = State.at_start(chain, velocity)
    fine = ExtendedRun(chain, state, tolerance, most_steps=most_steps)
    fine.until(math.inf if duration is None else duration)
    coarse = ExtendedRun(chain, state, 10.0 * tolerance, STAGES - 2, most_steps)
    coarse.until(float(fine.time) if duration is None else duration)
    apart = float(np.abs(fine.point.velocity - coarse.point.velocity).max())
    error = apart + tolerance * fine.speed
    return ReferenceEnd(fine.point.velocity.astype(np.float64), float(fine.time), error, fine.steps + coarse.steps)
