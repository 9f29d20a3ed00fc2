"""Scans of collisions that show how each method fails.

One bead hits n beads. Exponent, n and preload are varied, at every step or tolerance. The results are summarised for
each method.
"""

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, astuple, dataclass, fields
from enum import StrEnum
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import METHODS, Chain, Contact, Trajectory, one_on, power_law, stable_step
from softcradle.physics.advice.stability_limits import TRUSTED_ERROR
from softcradle.physics.methods import Method, find_method
from softcradle.physics.simulation import solve
from softcradle.sandbox.studies.data_table import write_rows
from softcradle.sandbox.sweeps import listed
from softcradle.sandbox.sweeps.run_sweep import Progress, map_points

Array = NDArray[np.float64]

ALPHA = 1 / 10  # Exponent in the scan over the number of targets.
TARGETS = 4  # Number of targets in the scans over exponent and preload.
STEPS = tuple(float(step) for step in np.geomspace(3e-4, 0.3, 13))  # Time steps of the scans [s].
TOLERANCES = tuple(float(10.0**-k) for k in np.linspace(8.0, 1.0, 8))
REFERENCE_TOLERANCE = 1e-10  # Tolerance of the reference motion.
# Duration of a simulation, divided by the duration of the reference motion. The duration is limited because chattering
# may never end.
DURATION_FACTOR = 2.0
LONGEST_REFERENCE = 100.0  # Longest reference motion [s]. In some chains the last contact opens very late.
SAMPLES = 101
# Methods that are not scanned. pymunk has the same results as euler. The reference scipy is slow, and thousands of
# simulations would take hours.
SKIPPED_METHODS = ("pymunk", "scipy")
ADAPTIVE_ERROR_FACTOR = 3.0  # Allowed error of an adaptive method as a multiple of its tolerance.
HARMLESS_SWITCHES = 2  # A simulation with more excess openings and closings than this counts as chattering.


class Failure(StrEnum):
    """Kind of failure of a simulation."""

    BLOW_UP = "blow-up"
    CHATTER = "chatter"
    ERROR = "error"


@dataclass(frozen=True)
class Scan:
    """Parameter that is varied in addition to the step or tolerance.

    Attributes:
        name, label: name for files, and label of the axis.
        values: values of the parameter in ascending order.
        chain: function that makes the chain for a value.
    """

    name: str
    label: str
    values: tuple[float, ...]
    chain: Callable[[float], Chain]


def _preloaded_chain(ratio: float) -> Chain:
    """Return a chain with draft gears of unit stiffness.

    The preload is `ratio` times the force at the largest overlap of a single bead.
    """
    return one_on(TARGETS, Contact(ratio, 1.0, 1.0))


SCANS: tuple[Scan, ...] = (
    Scan(
        "alpha", "exponent alpha, one on 4", tuple(float(a) for a in np.geomspace(0.01, 2.0, 12)),
        lambda alpha: one_on(TARGETS, power_law(1.0, alpha)),
    ),
    Scan("n", "targets n, alpha = 1/10", (1.0, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 14.0, 20.0),
         lambda n: one_on(int(n), power_law(1.0, ALPHA))),
    Scan("preload", "preload / (stiffness x 1 m), one on 4", (0.0, *(float(f) for f in np.geomspace(0.01, 10.0, 10))),
         _preloaded_chain),
)  # fmt: skip


@dataclass(frozen=True)
class ScanRun:
    """One simulation of a scan.

    Attributes:
        scan, value, method, fineness: settings; the fineness is a step [s] or a tolerance.
        energy: largest relative deviation of the energy from its initial value, over the samples.
        final_energy: relative deviation of the energy at the end.
        spread: root mean square error of the target velocities, relative to the closing speed.
        switches: closings and openings of contacts in excess of the true number.
        warned: True if the trajectory contains a warning.
        limit: `stable_step` of the chain [s].
        allowed: largest `spread` that is not a failure.
    """

    scan: str
    value: float
    method: str
    fineness: float
    energy: float
    final_energy: float
    spread: float
    switches: int
    warned: bool
    limit: float
    allowed: float

    @property
    def failure(self) -> Failure | None:
        """Kind of failure; None if the velocities are correct."""
        if self.spread <= self.allowed:
            return None
        if not self.final_energy <= 1.0:
            return Failure.BLOW_UP
        return Failure.CHATTER if self.switches > HARMLESS_SWITCHES else Failure.ERROR


def scanned_methods() -> list[Method]:
    """Return the methods that are scanned."""
    return [method for method in METHODS if method.name not in SKIPPED_METHODS]


def finenesses(method: Method) -> tuple[float, ...]:
    """Return the steps [s] or tolerances with which `method` is scanned."""
    return TOLERANCES if method.adaptive else STEPS


def scan_run(scan: Scan, value: float, method: Method, fineness: float) -> ScanRun:
    """Simulate one setting of a scan, and compare the result with the reference motion."""
    chain = scan.chain(value)
    velocity, reference = _reference(chain)
    chosen: dict[str, Any] = {"tolerance": fineness} if method.adaptive else {"step": fineness}
    found = solve(chain, velocity, float(reference.time[-1]), method.name, samples=SAMPLES, **chosen)
    energy = found.kinetic_energy + found.contact_energy
    change = np.abs(energy / energy[0] - 1.0)
    error = np.sqrt(np.mean((found.final_velocity - reference.final_velocity)[1:] ** 2))
    return ScanRun(
        scan=scan.name,
        value=value,
        method=method.name,
        fineness=fineness,
        energy=_nan_as_inf(change.max()),
        final_energy=_nan_as_inf(change[-1]),
        spread=_nan_as_inf(error),
        switches=max(_switches(found) - _switches(reference), 0),
        warned=bool(found.warnings),
        limit=stable_step(chain, velocity, TRUSTED_ERROR),
        allowed=max(TRUSTED_ERROR, ADAPTIVE_ERROR_FACTOR * fineness) if method.adaptive else TRUSTED_ERROR,
    )


def swept_runs(scans: Sequence[Scan], progress: Progress | None = None, workers: int | None = None) -> list[ScanRun]:
    """Simulate all settings of the scans with every method. Worker processes are used if they save time."""
    order = [method.name for method in scanned_methods()]
    found = []
    for scan in scans:
        rows = [
            (value, method.name, fineness)
            for value in scan.values
            for method in scanned_methods()
            for fineness in finenesses(method)
        ]
        points = listed(dict(zip(("value", "method", "fineness"), zip(*rows, strict=True), strict=True)))
        runs = map_points(partial(scan_numbers, scan.name), points, None, progress, workers)
        for (value, method, fineness), row in zip(rows, runs, strict=True):
            numbers = {name: number.item() for name, number in row.items()}
            switches, warned = int(numbers.pop("switches")), bool(numbers.pop("warned"))
            found.append(ScanRun(scan.name, value, method, fineness, switches=switches, warned=warned, **numbers))
    names = [scan.name for scan in scans]
    return sorted(found, key=lambda run: (names.index(run.scan), order.index(run.method)))


def scan_numbers(name: str, value: float, method: str, fineness: float) -> dict[str, float]:
    """Return the numbers of one simulation in the scan called `name`."""
    scan = next(scan for scan in SCANS if scan.name == name)
    run = asdict(scan_run(scan, value, find_method(method), fineness))
    return {key: float(number) for key, number in run.items() if key not in ("scan", "value", "method", "fineness")}


@lru_cache(maxsize=64)
def _reference(chain: Chain) -> tuple[Array, Trajectory]:
    """Return the initial velocities and the accurate motion until some time after its end."""
    velocity = np.eye(1, chain.contacts + 1)[0]
    end = float(solve(chain, velocity, tolerance=1e-6, samples=SAMPLES).time[-1])
    duration = DURATION_FACTOR * min(end, LONGEST_REFERENCE)
    return velocity, solve(chain, velocity, duration, samples=SAMPLES, tolerance=REFERENCE_TOLERANCE)


def _switches(trajectory: Trajectory) -> int:
    """Return how often contacts have closed or opened."""
    ends = [opened for intervals in trajectory.contact_intervals for _, opened in intervals]
    return 2 * len(ends) - sum(math.isinf(opened) for opened in ends)


def _nan_as_inf(value: float) -> float:
    return float(value) if np.isfinite(value) else math.inf


@dataclass(frozen=True)
class FailureSummary:
    """Summary of all simulations of one scan with one method.

    Attributes:
        scan, method: names of the scan and the method.
        runs: number of simulations.
        failed: number of simulations with a larger error than allowed.
        kinds: kinds of failure with counts, the most frequent first.
        finest: failed simulation with the smallest step or tolerance, or None.
        below_limit: number of failed simulations with a step below `stable_step`.
        silent: number of failed simulations without a warning.
    """

    scan: str
    method: str
    runs: int
    failed: int
    kinds: tuple[tuple[Failure, int], ...]
    finest: ScanRun | None
    below_limit: int
    silent: int


def summarise_failures(runs: Sequence[ScanRun]) -> list[FailureSummary]:
    """Return one summary for each scan and method, in order of appearance."""
    groups: dict[tuple[str, str], list[ScanRun]] = {}
    for run in runs:
        groups.setdefault((run.scan, run.method), []).append(run)
    return [_summary(scan, method, group) for (scan, method), group in groups.items()]


def _summary(scan: str, method: str, runs: Sequence[ScanRun]) -> FailureSummary:
    failed = [run for run in runs if run.failure]
    return FailureSummary(
        scan=scan,
        method=method,
        runs=len(runs),
        failed=len(failed),
        kinds=tuple(Counter(run.failure for run in failed if run.failure).most_common()),
        finest=min(failed, key=lambda run: run.fineness, default=None),
        below_limit=sum(run.fineness < run.limit for run in failed),
        silent=sum(not run.warned for run in failed),
    )


def write_csv(runs: Sequence[ScanRun], path: Path) -> None:
    """Write one row for each simulation to a .csv file. The last column is the failure."""
    header = (*(field.name for field in fields(ScanRun)), "failure")
    write_rows(path, header, ((*astuple(run), run.failure or "") for run in runs))
