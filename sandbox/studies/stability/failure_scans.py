"""Scans of one on n beads over exponent, number and preload, at every step or tolerance: how each run fails, and
summaries.
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

ALPHA = 1 / 10  # exponent of the scan over the number of targets
TARGETS = 4  # targets of the scans over exponent and preload
STEPS = tuple(float(step) for step in np.geomspace(3e-4, 0.3, 13))  # [s]
TOLERANCES = tuple(float(10.0**-k) for k in np.linspace(8.0, 1.0, 8))
REFERENCE_TOLERANCE = 1e-10  # tolerance of the reference motion
DURATION_FACTOR = 2.0  # Duration of a run as a multiple of the reference motion, because chattering may never end.
LONGEST_REFERENCE = 100.0  # [s] longest reference motion, for chains whose last contact opens very late
SAMPLES = 101
# pymunk has the same results as euler, and thousands of runs of the slow reference take hours
SKIPPED_METHODS = ("pymunk", "scipy")
ADAPTIVE_ERROR_FACTOR = 3.0  # allowed error of an adaptive method, as a multiple of its tolerance
HARMLESS_SWITCHES = 2  # a run with more excess switches than this chatters


class Failure(StrEnum):
    """How a run fails."""

    BLOW_UP = "blow-up"
    CHATTER = "chatter"
    ERROR = "error"


@dataclass(frozen=True)
class Scan:
    """Parameter that is varied in addition to the step or tolerance.

    Attributes:
        name, label: for files, and for the axis.
        values: in ascending order.
        chain: makes the chain for a value.
    """

    name: str
    label: str
    values: tuple[float, ...]
    chain: Callable[[float], Chain]


def _preloaded_chain(ratio: float) -> Chain:
    """Return draft gears whose preload is `ratio` times the force at the largest overlap of a single bead; the
    stiffness is 1.
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
    """One run of a scan.

    Attributes:
        scan, value, method, fineness: settings of the run; the fineness is a step [s] or a tolerance.
        energy: largest relative deviation of the energy from its initial value, over the samples.
        final_energy: the same at the end.
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
        """How the run fails; None if the velocities are correct."""
        if self.spread <= self.allowed:
            return None
        if not self.final_energy <= 1.0:
            return Failure.BLOW_UP
        return Failure.CHATTER if self.switches > HARMLESS_SWITCHES else Failure.ERROR


def scanned_methods() -> list[Method]:
    """Return the methods of the scan."""
    return [method for method in METHODS if method.name not in SKIPPED_METHODS]


def finenesses(method: Method) -> tuple[float, ...]:
    """Return the steps [s] or tolerances at which a method is run."""
    return TOLERANCES if method.adaptive else STEPS


def scan_run(scan: Scan, value: float, method: Method, fineness: float) -> ScanRun:
    """Run once and compare with the reference motion."""
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
    """Run all scans with every method, in worker processes if that is faster."""
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
    """Return the results of one run of the scan of that name as numbers."""
    scan = next(scan for scan in SCANS if scan.name == name)
    run = asdict(scan_run(scan, value, find_method(method), fineness))
    return {key: float(number) for key, number in run.items() if key not in ("scan", "value", "method", "fineness")}


@lru_cache(maxsize=64)
def _reference(chain: Chain) -> tuple[Array, Trajectory]:
    """Return initial velocities and the accurate motion, until some time after its end."""
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
    """Summary of all runs of one scan with one method.

    Attributes:
        scan, method: names.
        runs: number of runs.
        failed: number of runs with a larger error than allowed.
        kinds: kinds of failure with counts, the most frequent first.
        finest: failed run with the smallest step or tolerance, or None.
        below_limit: number of failed runs with a step below `stable_step`.
        silent: number of failed runs without a warning.
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
    """Write a row for each run, with its failure last."""
    header = (*(field.name for field in fields(ScanRun)), "failure")
    write_rows(path, header, ((*astuple(run), run.failure or "") for run in runs))
