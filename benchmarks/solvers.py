"""The methods of `simulate` as the work-precision table sees them: a case and a fineness in, velocities and a time out."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from benchmarks.cases import MARGIN, Case
from physics import simulate

Array = NDArray[np.float64]

ADAPTIVE = ("accurate", "radau", "dop853")
FIXED = ("conserving", "verlet")


@dataclass(frozen=True)
class Solver:
    """One way to solve a case, at one series of settings.

    Attributes:
        name: whose it is: settings of the same name compete, the best is shown.
        setting: what sets this series apart from others of the same name.
        finenesses: tolerances or numbers of steps, coarse to fine.
        run: from a fineness to the final velocities (n+1,), or None where it gave up, and its time [s].
        ours: True for the methods of `simulate`.
    """

    name: str
    setting: str
    finenesses: Sequence[float]
    run: Callable[[float], tuple[Array | None, float]]
    ours: bool = False


def tolerances(least: float = 1e-12) -> list[float]:
    """Half decades from 1e-2 down to `least`."""
    return [float(10.0 ** (-0.5 * k)) for k in range(4, round(-2.0 * np.log10(least)) + 1)]


def step_counts(most: float) -> list[int]:
    """Numbers of steps from 30 up to `most`, by factors of 2."""
    return [30 * 2**k for k in range(1 + int(np.log2(most / 30)))]


def ours(case: Case) -> list[Solver]:
    """The adaptive methods over tolerances, the fixed-step ones over steps; their time is that of the kernel."""
    found = [Solver(name, "", tolerances(), partial(_adaptive, case, name), True) for name in ADAPTIVE]
    return found + [Solver(name, "", step_counts(4e6), partial(_fixed, case, name), True) for name in FIXED]


def _adaptive(case: Case, method: str, tolerance: float) -> tuple[Array, float]:
    return _solved(case, method, case.duration, tolerance=tolerance)


def _fixed(case: Case, method: str, steps: float) -> tuple[Array, float]:
    duration = case.end * MARGIN if case.duration is None else case.duration  # as the peers: chatter may never end
    return _solved(case, method, duration, step=duration / steps)


def _solved(case: Case, method: str, duration: float | None, **fineness: float) -> tuple[Array, float]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # the error shows what the warning says
        found = simulate(case.chain, case.velocity, duration, method=method, samples=2, **fineness)  # type: ignore[arg-type]
    return found.final_velocity, found.seconds
