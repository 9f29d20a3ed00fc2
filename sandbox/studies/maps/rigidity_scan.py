"""Scans of the rigidity of one on n: over (alpha, n) for the power law, over (speed, n) for the draft gear. Unit masses."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from softcradle.physics import Chain, Trajectory, draft_gear, ensemble, one_on, power_law
from softcradle.physics.analysis.critical_speed import critical_speed
from softcradle.physics.analysis.measures import rigidity
from softcradle.sandbox.studies.data_table import Array, Table

ALPHAS = (1.0 / 100.0, 1.0)  # range of exponents
SPEEDS = (0.5, 20.0)  # range of speeds of the striker, over the critical speed
FEWEST_TARGETS = 2  # one target alone is always rigid
GEAR = draft_gear(1.0, 1.0)  # stiffness and precompression are the units, so that the speed alone is left to vary
TOLERANCE = 1e-5  # a map is read to a percent; finer runs resolve every closing of chains that chatter, to no effect

Point = tuple[float, int]  # abscissa and number of targets


@dataclass(frozen=True)
class RigidityMap:
    """The points of a map.

    Attributes:
        name: of its files.
        title: above its panels.
        abscissa: name of what varies along the abscissa.
        values: (X,) abscissae.
        sizes: (Y,) numbers n of targets.
        make: gives the chain and the velocity of the striker at (abscissa, n).
    """

    name: str
    title: str
    abscissa: str
    values: Array
    sizes: Sequence[int]
    make: Callable[[float, int], tuple[Chain, float]]


def rigidity_maps(columns: int, rows: int) -> tuple[RigidityMap, RigidityMap]:
    """The two maps at `columns` abscissae and the `rows` cluster sizes from 2 on."""
    sizes = range(FEWEST_TARGETS, FEWEST_TARGETS + rows)
    alphas, speeds = np.geomspace(*ALPHAS, columns), np.geomspace(*SPEEDS, columns)
    return (
        RigidityMap("power-law", "power-law beads", "alpha", alphas, sizes, _power_law_chain),
        RigidityMap("draft-gear", "draft gears", "speed / critical speed", speeds, sizes, _draft_gear_chain),
    )


def _power_law_chain(alpha: float, n: int) -> tuple[Chain, float]:
    return one_on(n, power_law(1.0, alpha)), 1.0


def _draft_gear_chain(speed: float, n: int) -> tuple[Chain, float]:
    chain = one_on(n, GEAR)
    return chain, speed * critical_speed(GEAR, chain.mass, strikers=1)


def point_rows(scanned: RigidityMap, points: Sequence[Point]) -> Table:
    """A row a point: abscissa, n, rigidity when the striker leaves and at the end (nan where unknown), status, warned.

    The status is that of the run (softcradle.physics.status.Status): from 2 on it gave up, and its end is unknown.
    """
    chains, speeds = zip(*(scanned.make(*point) for point in points), strict=True)
    starts = [[speed, *[0.0] * chain.contacts] for chain, speed in zip(chains, speeds, strict=True)]
    ends = ensemble(chains, starts, tolerance=TOLERANCE)
    detachment = [_detachment(found) for found in ends]
    detached = ensemble(chains, starts, duration=detachment, tolerance=TOLERANCE)
    status = [max(one.status, other.status) for one, other in zip(detached, ends, strict=True)]
    return {
        scanned.abscissa: np.array([value for value, _ in points]),
        "n": np.array([float(n) for _, n in points]),
        "rigidity at detachment": _rigidities(detached, detachment),
        "rigidity at the end": _rigidities(ends, detachment),
        "status": np.array(status, dtype=np.float64),
        "warned": np.array([float(bool(a.warnings or b.warnings)) for a, b in zip(detached, ends, strict=True)]),
    }


def _detachment(found: Trajectory) -> float:
    """When the striker leaves; 0 where the run gave up before."""
    spans = found.contact_intervals[0]
    return spans[0][1] if spans and math.isfinite(spans[0][1]) else 0.0


def _rigidities(trajectories: Sequence[Trajectory], detachment: Sequence[float]) -> Array:
    """Rigidity at the end of each run; nan where it gave up, or where the striker's leaving is unknown."""
    known = [not found.status.gave_up and left > 0.0 for found, left in zip(trajectories, detachment, strict=True)]
    found = [
        float(rigidity(one.final_velocity[1:])) if ok else math.nan for one, ok in zip(trajectories, known, strict=True)
    ]
    return np.array(found)


def points_of(scanned: RigidityMap) -> list[Point]:
    """All points of a map, row by row."""
    return [(value, n) for n in scanned.sizes for value in scanned.values.tolist()]
