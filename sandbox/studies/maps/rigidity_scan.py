"""Rigidity of one on n: over (alpha, n) for the power law, over (speed, n) for the draft gear. Unit masses."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from softcradle.physics import Chain, Trajectory, draft_gear, ensemble, one_on, power_law
from softcradle.physics.analysis.closed_forms import critical_speed
from softcradle.physics.analysis.measures import rigidity
from softcradle.sandbox.studies.figures.solved_cases import Array, Table

LEAST_ALPHA, MOST_ALPHA = 1.0 / 100.0, 1.0
LEAST_SPEED, MOST_SPEED = 0.5, 20.0  # of the critical speed
SMALLEST = 2  # targets: one alone is always rigid
GEAR = draft_gear(1.0, 1.0)  # its units are those of the map: nothing but the speed is left to choose
TOLERANCE = 1e-5  # a map is read to a percent; finer runs follow the soft chains through rattles of no consequence

Progress = Callable[[int], None]


@dataclass(frozen=True)
class Map:
    """What is mapped.

    Attributes:
        name: of its files.
        title: above its panels.
        across: name of the abscissa.
        values: (X,) abscissae.
        sizes: (Y,) numbers n of targets.
        make: chain and velocity of the striker at (abscissa, n).
    """

    name: str
    title: str
    across: str
    values: Array
    sizes: Sequence[int]
    make: Callable[[float, int], tuple[Chain, float]]


def maps(columns: int, rows: int) -> tuple[Map, Map]:
    """The two maps at `columns` abscissae and the `rows` cluster sizes from 2 on."""
    sizes = range(SMALLEST, SMALLEST + rows)
    alphas = np.geomspace(LEAST_ALPHA, MOST_ALPHA, columns)
    speeds = np.geomspace(LEAST_SPEED, MOST_SPEED, columns)
    return (
        Map("power-law", "power-law beads", "alpha", alphas, sizes, _soft),
        Map("draft-gear", "draft gears", "speed / critical speed", speeds, sizes, _gear),
    )


def _soft(alpha: float, n: int) -> tuple[Chain, float]:
    return one_on(n, power_law(1.0, alpha)), 1.0


def _gear(speed: float, n: int) -> tuple[Chain, float]:
    chain = one_on(n, GEAR)
    return chain, speed * critical_speed(GEAR, chain.mass, strikers=1)


def compute(wanted: Map, progress: Progress | None = None) -> Table:
    """A row a point: abscissa, n, rigidity when the striker leaves and at the end, and whether the run had to warn."""
    points = [(value, n) for n in wanted.sizes for value in wanted.values.tolist()]
    chains, speeds = zip(*(wanted.make(*point) for point in points), strict=True)
    starts = [[speed, *[0.0] * chain.contacts] for chain, speed in zip(chains, speeds, strict=True)]
    ends = ensemble(chains, starts, tolerance=TOLERANCE, progress=progress)
    leaving = [found.contact_intervals[0][0][1] for found in ends]
    moments = ensemble(chains, starts, duration=leaving, tolerance=TOLERANCE, progress=progress)
    return {
        wanted.across: np.array([value for value, _ in points]),
        "n": np.array([n for _, n in points]),
        "rigidity at detachment": _rigidities(moments),
        "rigidity at the end": _rigidities(ends),
        "warned": np.array([bool(one.warnings or other.warnings) for one, other in zip(moments, ends, strict=True)]),
    }


def _rigidities(found: Sequence[Trajectory]) -> Array:
    return np.array([float(rigidity(one.final_velocity[1:])) for one in found])
