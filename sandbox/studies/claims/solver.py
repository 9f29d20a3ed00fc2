"""The methods behind the claims: the one that measures, a second one for error bars, and the independent reference."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from softcradle.physics import Chain, Trajectory
from softcradle.physics.analysis.mode_coupling import ModeCoupling, mode_coupling
from softcradle.physics.simulation import solve
from softcradle.physics.status import WarningCode

Samples = int | tuple[float, ...]  # number of samples, or their times [s]

INCOMPLETE = (WarningCode.GAVE_UP, WarningCode.UNCONVERGED, WarningCode.LOG_FULL)  # such a run says nothing
KEPT_ENDS = 4096  # motions of which only the end is known: a few numbers each
KEPT_MOTIONS = 64  # motions with samples: up to some megabytes each


class NotSolvedError(Exception):
    """A run gave up: what should have been measured of it is not determined."""


@dataclass(frozen=True)
class Solver:
    """A method with its fineness: a step for fixed steps, a tolerance for adaptive methods."""

    method: str
    step: float | None = None
    tolerance: float = 1e-9

    def motion(
        self, chain: Chain, velocity: tuple[float, ...], duration: float | None = None, samples: Samples = 2
    ) -> Trajectory:
        """The motion by the full equations, Eq. (3); NotSolvedError where the method gave up."""
        return (_end if samples == 2 else _sampled)(self, chain, velocity, duration, samples)

    def model(
        self, chain: Chain, velocity: tuple[float, ...], duration: float | None = None, samples: Samples = 2
    ) -> ModeCoupling:
        """The motion by the mode-coupling model, Eqs. (8), (A3)."""
        return _model(self, chain, velocity, duration, samples)


MEASURING = Solver("accurate")
SECOND = Solver("conserving", 1e-4)  # its energy is exact; its error, of the order of what is shown, is the error bar
FINER_SECOND = Solver("conserving", 1e-5)  # for differences of times and for small spreads
FINEST_SECOND = Solver("conserving", 1e-6)  # for oscillations whose period is some 1e-4
REFERENCE = Solver("scipy")

# Least swing that counts as one, in units of the striker's speed or of f0: a hundredth of what Fig. 2c shows.
SWING = 1e-5


def _motion(
    solver: Solver, chain: Chain, velocity: tuple[float, ...], duration: float | None, samples: Samples
) -> Trajectory:
    found = solve(chain, velocity, duration, solver.method, solver.step, _argument(samples), solver.tolerance)
    for warning in found.warnings:
        if warning.code in INCOMPLETE:
            raise NotSolvedError(f"{solver.method}: {warning.code.value}")
    if found.status.gave_up:
        raise NotSolvedError(f"{solver.method}: {found.status.name.lower()}")
    return found


_end = lru_cache(maxsize=KEPT_ENDS)(_motion)
_sampled = lru_cache(maxsize=KEPT_MOTIONS)(_motion)


@lru_cache(maxsize=KEPT_MOTIONS)
def _model(
    solver: Solver, chain: Chain, velocity: tuple[float, ...], duration: float | None, samples: Samples
) -> ModeCoupling:
    with warnings.catch_warnings():  # the error bar of the case tells how far a motion is determined
        warnings.simplefilter("ignore", RuntimeWarning)
        return mode_coupling(
            chain, velocity, duration, solver.method, solver.step, _argument(samples), solver.tolerance
        )


def _argument(samples: Samples) -> int | np.ndarray:
    return samples if isinstance(samples, int) else np.array(samples)
