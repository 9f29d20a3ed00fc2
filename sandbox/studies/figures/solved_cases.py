"""The motions behind the figures and claims: one method for all, each computed once."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, Trajectory, one_on, power_law
from softcradle.physics.analysis.mode_coupling import ModeCoupling, mode_coupling
from softcradle.physics.simulation import solve

Array = NDArray[np.float64]
Samples = int | tuple[float, ...]  # number of samples, or their times [s]

METHOD = "accurate"
FIXED_STEP_METHOD = "conserving"  # where a step is given: in a motion without an end the energy must not drift
TOLERANCE = 1e-8
SAMPLES = 1001

# The paper's cases.
N = 4  # targets in Figs. 1 and 2
ALPHA = 1.0 / 10.0  # exponent in Figs. 1b, 1c and 2
SOFTER_ALPHA = 1.0 / 14.0  # exponent in Fig. 1d


def soft_chain(n: int, alpha: float) -> Chain:
    """The homogeneous chain: one on `n`, unit masses and strengths, one exponent."""
    return one_on(n, power_law(1.0, alpha))


def start_velocity(chain: Chain, strikers: int = 1) -> tuple[float, ...]:
    """Unit velocity for the strikers, rest for all others."""
    return (1.0,) * strikers + (0.0,) * (chain.contacts + 1 - strikers)


@lru_cache(maxsize=512)
def full_motion(
    chain: Chain,
    velocity: tuple[float, ...],
    duration: float | None = None,
    samples: Samples = SAMPLES,
    tolerance: float = TOLERANCE,
    step: float | None = None,
) -> Trajectory:
    """The motion by the full equations, Eq. (3); with a `step` by the conserving method. What may be wrong is a warning."""
    found = solve(chain, velocity, duration, _method(step), step, _sample_argument(samples), tolerance)
    for warning in found.warnings:
        warnings.warn(str(warning), RuntimeWarning, stacklevel=2)
    return found


@lru_cache(maxsize=512)
def model_motion(
    chain: Chain,
    velocity: tuple[float, ...],
    duration: float | None = None,
    samples: Samples = SAMPLES,
    tolerance: float = TOLERANCE,
    step: float | None = None,
) -> ModeCoupling:
    """The motion by the mode-coupling model, Eqs. (8), (A3)."""
    return mode_coupling(chain, velocity, duration, _method(step), step, _sample_argument(samples), tolerance)


def _method(step: float | None) -> str:
    return METHOD if step is None else FIXED_STEP_METHOD


def _sample_argument(samples: Samples) -> int | Array:
    return samples if isinstance(samples, int) else np.array(samples)


def full_one_on(
    n: int, alpha: float, duration: float | None = None, samples: Samples = SAMPLES, tolerance: float = TOLERANCE
) -> Trajectory:
    """The motion of one on `n`, homogeneous, by the full equations."""
    chain = soft_chain(n, alpha)
    return full_motion(chain, start_velocity(chain), duration, samples, tolerance)


def model_one_on(
    n: int, alpha: float, duration: float | None = None, samples: Samples = SAMPLES, tolerance: float = TOLERANCE
) -> ModeCoupling:
    """The motion of one on `n`, homogeneous, by the mode-coupling model."""
    chain = soft_chain(n, alpha)
    return model_motion(chain, start_velocity(chain), duration, samples, tolerance)


def opening_time(n: int, alpha: float, contact: int = 0) -> float:
    """Time [s] at which `contact` of one on `n` opens for the first time."""
    return full_one_on(n, alpha, samples=2).contact_intervals[contact][0][1]


def merged_times(*parts: Sequence[float] | Array) -> tuple[float, ...]:
    """Sample times of all `parts`, sorted, each once."""
    return tuple(np.unique(np.concatenate([np.asarray(part, dtype=np.float64) for part in parts])).tolist())
