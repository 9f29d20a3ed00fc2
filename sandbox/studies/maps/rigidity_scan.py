"""Scans of the rigidity of one on n: over (alpha, n) for the power law, over (speed, n) for the draft gear. Unit masses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from softcradle.physics import Chain, Trajectory, draft_gear, one_on, power_law
from softcradle.physics.analysis.critical_speed import critical_speed
from softcradle.physics.analysis.measures import rigidity
from softcradle.physics.simulation import solve
from softcradle.physics.status import Status
from softcradle.sandbox.studies.data_table import Array, Table
from softcradle.sandbox.sweeps import grid
from softcradle.sandbox.sweeps.run_sweep import Progress, map_points

ALPHAS = (1.0 / 100.0, 1.0)  # range of exponents
SPEEDS = (0.5, 20.0)  # range of speeds of the striker, over the critical speed
FEWEST_TARGETS = 2  # one target alone is always rigid
GEAR = draft_gear(1.0, 1.0)  # stiffness and precompression are the units, so that the speed alone is left to vary
TOLERANCE = 1e-5  # a map is read to a percent; finer runs resolve every closing of chains that chatter, to no effect


@dataclass(frozen=True)
class RigidityMap:
    """The points of a map.

    Attributes:
        name: of its files, and in CHAINS of what it moves.
        title: above its panels.
        abscissa: name of what varies along the abscissa.
        values: (X,) abscissae.
        sizes: (Y,) numbers n of targets.
    """

    name: str
    title: str
    abscissa: str
    values: Array
    sizes: Sequence[int]


def rigidity_maps(columns: int, rows: int) -> tuple[RigidityMap, RigidityMap]:
    """The two maps at `columns` abscissae and the `rows` cluster sizes from 2 on."""
    sizes = range(FEWEST_TARGETS, FEWEST_TARGETS + rows)
    alphas, speeds = np.geomspace(*ALPHAS, columns), np.geomspace(*SPEEDS, columns)
    return (
        RigidityMap("power-law", "power-law beads", "alpha", alphas, sizes),
        RigidityMap("draft-gear", "draft gears", "speed / critical speed", speeds, sizes),
    )


def _power_law_chain(alpha: float, n: int) -> tuple[Chain, float]:
    return one_on(n, power_law(1.0, alpha)), 1.0


def _draft_gear_chain(speed: float, n: int) -> tuple[Chain, float]:
    chain = one_on(n, GEAR)
    return chain, speed * critical_speed(GEAR, chain.mass, strikers=1)


CHAINS = {
    "power-law": _power_law_chain,
    "draft-gear": _draft_gear_chain,
}  # and the striker's velocity, by (abscissa, n)


def compute_map(
    scanned: RigidityMap, kept: Path | None = None, progress: Progress | None = None, workers: int | None = None
) -> Table:
    """A row a point: abscissa, n, rigidity when the striker leaves and at the end (nan where unknown), status, warned.

    The status is that of the run (softcradle.physics.status.Status): from 2 on it gave up, and its end is unknown. With `kept`,
    points that a run before has computed are not computed again, see `map_points`.
    """
    points = grid({"n": list(scanned.sizes), "abscissa": scanned.values.tolist()})
    rows = map_points(partial(point_numbers, scanned.name, TOLERANCE), points, kept, progress, workers)
    found = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    at = points.columns(0, points.count)
    columns = {scanned.abscissa: at["abscissa"], "n": at["n"]}
    columns |= {name.replace("_", " "): found[name] for name in ("rigidity_at_detachment", "rigidity_at_the_end")}
    return columns | {name: found[name].astype(int) for name in ("status", "warned")}


def point_numbers(name: str, tolerance: float, abscissa: float, n: int) -> dict[str, float]:
    """One point of the map of that name."""
    chain, speed = CHAINS[name](abscissa, n)
    start = [speed, *[0.0] * n]
    end = solve(chain, start, samples=2, tolerance=tolerance)
    leaving = _detachment(end)
    detached = solve(chain, start, leaving, samples=2, tolerance=tolerance)
    return {
        "rigidity_at_detachment": _rigidity(detached, leaving),
        "rigidity_at_the_end": _rigidity(end, leaving),
        "status": float(max((end.status, detached.status), key=_severity)),
        "warned": float(bool(detached.warnings or end.warnings)),
    }


def _severity(status: Status) -> tuple[bool, int]:
    """Order of statuses in which those of runs that gave up, the reasons of hatched cells, come last."""
    return status.gave_up, status


def _detachment(found: Trajectory) -> float:
    """When the striker leaves; 0 where the run gave up before."""
    spans = found.contact_intervals[0]
    return spans[0][1] if spans and math.isfinite(spans[0][1]) else 0.0


def _rigidity(found: Trajectory, leaving: float) -> float:
    """Rigidity at the end of a run; nan where it gave up, or where the striker's leaving is unknown."""
    if found.status.gave_up or leaving == 0.0:
        return math.nan
    return float(rigidity(found.final_velocity[1:]))
