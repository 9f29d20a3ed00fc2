"""The cases of the figures and claims: one method for all, each solved once."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics import Chain, Trajectory, one_on, power_law, simulate
from softcradle.physics.analysis.mode_coupling import ModeCoupling, mode_coupling

Array = NDArray[np.float64]
Table = dict[str, Array]  # column name: values; what a figure draws and what its csv file holds

METHOD = "accurate"
FIXED_STEP = "conserving"  # where a step is given: a motion that goes on and on, whose energy must not leak
TOLERANCE = 1e-8
SAMPLES = 1001

N, ALPHA, SOFTER = 4, 1.0 / 10.0, 1.0 / 14.0  # the paper's case: one on four, Figs. 1b, 1c, 2; and that of Fig. 1d


def soft(n: int, alpha: float) -> Chain:
    """The homogeneous chain: one on `n`, unit masses and strengths, one exponent."""
    return one_on(n, power_law(1.0, alpha))


def start(chain: Chain, strikers: int = 1) -> tuple[float, ...]:
    """Unit velocity for the strikers, rest for all others."""
    return (1.0,) * strikers + (0.0,) * (chain.contacts + 1 - strikers)


@lru_cache(maxsize=512)
def solved(
    chain: Chain,
    velocity: tuple[float, ...],
    duration: float | None = None,
    samples: int | tuple[float, ...] = SAMPLES,
    tolerance: float = TOLERANCE,
    step: float | None = None,
) -> Trajectory:
    """The full motion, Eq. (3); with a `step` by the conserving method.

    Where the last beads rattle, final velocities are known to four or five digits at any tolerance: as many as are shown.
    """
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "the motion is so sensitive", RuntimeWarning)
        return simulate(chain, velocity, duration, _method(step), step, _times(samples), tolerance)


@lru_cache(maxsize=512)
def coupled(
    chain: Chain,
    velocity: tuple[float, ...],
    duration: float | None = None,
    samples: int | tuple[float, ...] = SAMPLES,
    tolerance: float = TOLERANCE,
    step: float | None = None,
) -> ModeCoupling:
    """The mode-coupling model, Eqs. (7), (A2), (A3)."""
    return mode_coupling(chain, velocity, duration, _method(step), step, _times(samples), tolerance)


def _method(step: float | None) -> str:
    return METHOD if step is None else FIXED_STEP


def _times(samples: int | tuple[float, ...]) -> int | Array:
    return samples if isinstance(samples, int) else np.array(samples)


def contact_time(chain: Chain, velocity: tuple[float, ...], contact: int = 0) -> float:
    """Time [s] at which `contact` opens for the first time."""
    return solved(chain, velocity, samples=2).contact_intervals[contact][0][1]


def moments(*parts: Sequence[float] | Array) -> tuple[float, ...]:
    """Sample times, sorted and without doubles."""
    return tuple(np.unique(np.concatenate([np.asarray(part, dtype=np.float64) for part in parts])).tolist())


def long_table(columns: Sequence[str], rows: Sequence[Sequence[ArrayLike]]) -> Table:
    """A table from blocks: each of `rows` is one block, a value or an array a column, broadcast together."""
    blocks = [
        np.column_stack(np.broadcast_arrays(*[np.atleast_1d(np.asarray(value, dtype=np.float64)) for value in row]))
        for row in rows
    ]
    stacked = np.concatenate(blocks)
    return {name: stacked[:, k] for k, name in enumerate(columns)}


def pick(table: Table, **values: float) -> Table:
    """The rows of `table` in which the named columns have these values."""
    rows = np.ones(len(next(iter(table.values()))), dtype=bool)
    for name, value in values.items():
        rows &= np.isclose(table[name], value, rtol=1e-12, atol=0.0)
    return {name: column[rows] for name, column in table.items()}
