"""Numbers known of pulses in long Hertz chains: speed and overlap of the solitary wave, pulses of several strikers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, Trajectory, hertz, simulate
from softcradle.sandbox.studies.paper import crest
from softcradle.sandbox.studies.verify.known_numbers import KnownNumber

LENGTH = 60  # beads behind the striker
FIRST, LAST = 20, 45  # contacts between which the pulse has its shape
DEPTH = 500  # beads of a column
WEAK = 1e-4  # [m/s] of its uppermost bead, small beside its velocity of sound
SAMPLES = 1201  # of a run: a top of the overlap, through three of them, is found to a few 1e-6
SOURCE = "long chains of unit spheres, K = 1, struck by one at 1 m/s"


def rows() -> Iterator[KnownNumber]:
    """All rows of this file."""
    yield KnownNumber("Hertz pulse: contacts a second", 0.840509, SOURCE, _speed, 1e-4)
    yield KnownNumber("Hertz pulse: largest overlap [m]", 0.742309, SOURCE, _overlap, 1e-4)
    yield KnownNumber(
        "width of the Hertz pulse in diameters", 4.967, "pi sqrt(10) / 2, Nesterenko's compacton", _width, 0.1
    )
    for m in (2, 3, 5):
        yield KnownNumber(f"pulses that {m} strikers send", float(m), "one each", partial(_pulses_as_number, m), 0.0)
    hong = "Hong, Ji and Kim, Phys. Rev. Lett. 82, 3058 (1999): weak pulses, great depths"
    yield KnownNumber("Hertz chain under its weight: peak velocity as depth to the power", -0.25, hong, _weighted, 0.02)


def _pulses_as_number(strikers: int) -> float:
    return float(_pulses(strikers))


@cache
def _struck(strikers: int) -> Trajectory:
    chain = Chain([1.0] * (LENGTH + strikers), hertz(1.0))
    velocity = [1.0] * strikers + [0.0] * LENGTH
    time = np.linspace(0.0, 1.15 * LENGTH, SAMPLES)
    return simulate(chain, velocity, float(time[-1]), samples=time, tolerance=1e-8)


def _weighted() -> float:
    """Slope of the logarithm of the peak velocity of each bead over that of its depth, in the lower half of a column.

    Unit masses under unit gravity on unit contacts: contact i carries i + 1, so its overlap is that to the power 2/3.
    """
    carried = np.arange(1.0, DEPTH + 1.0)
    chain = Chain([1.0] * DEPTH + [math.inf], hertz(1.0), gap=-(carried ** (2.0 / 3.0)), drive=[1.0] * DEPTH + [0.0])
    passed = 0.97 * float((1.0 / np.sqrt(1.5 * carried ** (1.0 / 3.0))).sum())  # before it comes back from the ground
    velocity = [WEAK] + [0.0] * DEPTH
    found = simulate(chain, velocity, passed, "verlet", 0.03, samples=round(passed / 0.1))
    peak, lower = found.velocity.max(axis=0), slice(DEPTH // 2, round(0.85 * DEPTH))
    return float(np.polyfit(np.log(carried[lower]), np.log(peak[:-1][lower]), 1)[0])


def _peak(found: Trajectory, contact: int) -> tuple[float, float]:
    """Time and overlap of the crest of a contact."""
    return crest(found.time, found.overlap[:, contact])


def _speed() -> float:
    found = _struck(1)
    return (LAST - FIRST) / (_peak(found, LAST)[0] - _peak(found, FIRST)[0])


def _overlap() -> float:
    return _peak(_struck(1), LAST)[1]


def _width() -> float:
    """That of a squared cosine's fourth power in velocity, from the second moment of the force along the chain."""
    found = _struck(1)
    k = int(np.argmax(found.overlap[:, LAST]))
    velocity: NDArray[np.float64] = np.maximum(found.velocity[k, FIRST:], 0.0)
    place = np.arange(velocity.size)
    mean = velocity @ place / velocity.sum()
    spread = float(np.sqrt(velocity @ (place - mean) ** 2 / velocity.sum()))
    return spread / _COSINE_SPREAD


_X = np.linspace(-0.5, 0.5, 20001)
_COSINE_SPREAD = float(np.sqrt((np.cos(np.pi * _X) ** 4 * _X**2).sum() / (np.cos(np.pi * _X) ** 4).sum()))  # of width 1


def _pulses(strikers: int) -> int:
    """Maxima of the force in a contact far from the strikers, of at least a twentieth of the largest."""
    force = _struck(strikers).force[:, LENGTH // 2 + strikers]
    inner = force[1:-1]
    tops = (inner > force[:-2]) & (inner >= force[2:]) & (inner > 0.05 * force.max())
    return int(tops.sum())
