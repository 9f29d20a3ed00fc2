"""The experiment at all launch speeds that the text allows, as a sweep: a point is a speed, with and without pistons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple

from softcradle.sandbox.studies.bed_experiment import SPEEDS, STRIKERS, Deficits, Fit, fit_friction
from softcradle.sandbox.studies.data_table import Array
from softcradle.sandbox.studies.piston_experiment import WINDOWS, FittedDeficits, Measured, deficits_at
from softcradle.sandbox.sweeps import grid
from softcradle.sandbox.sweeps.run_sweep import Progress, map_points


def compute_experiment(
    speeds: Sequence[float] = SPEEDS, progress: Progress | None = None, workers: int | None = None
) -> tuple[list[Fit], list[FittedDeficits]]:
    """Fits of the friction of the bed alone, and the deficits with pistons, of both experiments at these speeds [m/s]."""
    found = map_points(speed_numbers, grid({"speed": list(speeds)}), None, progress, workers)
    fits, pistons = list[Fit](), list[FittedDeficits]()
    for speed, numbers in zip(speeds, found, strict=True):
        fits += [_fit(name, speed, row) for name, row in zip(STRIKERS, numbers["fits"], strict=True)]
        cases = [(name, window) for name in STRIKERS for window in (0.0, *WINDOWS)]
        pistons += [_piston(*case, speed, row) for case, row in zip(cases, numbers["pistons"], strict=True)]
    return fits, pistons


def speed_numbers(speed: float) -> dict[str, list[list[float]]]:
    """The numbers of one launch speed, a row an experiment and with pistons a row each of its windows, too."""
    fits = [[fit.friction, *astuple(fit.deficits)] for fit in fit_friction(speed)]
    return {"fits": fits, "pistons": [[*found.momentum, *found.energy] for found in deficits_at(speed)]}


def _fit(experiment: str, speed: float, row: Array) -> Fit:
    friction, *deficits = row.tolist()
    return Fit(experiment, speed, friction, Deficits(*deficits))


def _piston(experiment: str, window: float, speed: float, row: Array) -> FittedDeficits:
    momentum, momentum_error, energy, energy_error = row.tolist()
    return FittedDeficits(experiment, speed, window, Measured(momentum, momentum_error), Measured(energy, energy_error))
