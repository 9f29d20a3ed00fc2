"""Symmetries of the equations: a motion and its image must be the same, so each number here is 0."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, Contact, draft_gear, hertz, power_law, simulate
from softcradle.sandbox.studies.verify.known_number import KnownNumber

Array = NDArray[np.float64]

MASS = (1.0, 2.0, 0.5, 1.5, 1.0)
LAWS = (power_law(1.0, 0.3), hertz(5.0), draft_gear(10.0, 0.05), hertz(2.0))
START = (1.0, 0.2, 0.0, 0.0, -0.4)
TOLERANCE = 1e-9
ALLOWED = 1e-7


def rows() -> Iterator[KnownNumber]:
    """All rows of this file."""
    source = "symmetry of the equations"
    yield KnownNumber("change by a moving observer [m/s]", 0.0, source, _galilean, ALLOWED)
    yield KnownNumber("change by a mirror [m/s]", 0.0, source, _mirrored, ALLOWED)
    yield KnownNumber("change by other units", 0.0, source, _rescaled, ALLOWED)
    yield KnownNumber("start found again backwards [m/s]", 0.0, source, _reversed, ALLOWED)


def _end(chain: Chain, start: Array, duration: float | None = None) -> Array:
    return simulate(chain, start, duration, samples=2, tolerance=TOLERANCE).final_velocity


def _apart(one: Array, other: Array) -> float:
    return float(np.abs(one - other).max())


def _galilean() -> float:
    chain, start = Chain(MASS, LAWS), np.array(START)
    return _apart(_end(chain, start + 3.0) - 3.0, _end(chain, start))


def _mirrored() -> float:
    image = Chain(MASS[::-1], LAWS[::-1])
    return _apart(-_end(image, -np.array(START)[::-1])[::-1], _end(Chain(MASS, LAWS), np.array(START)))


def _rescaled() -> float:
    """Lengths, times and masses in other units: forces as M L / T**2."""
    length, time, mass = 1e-3, 1e-4, 7.0
    force = mass * length / time**2
    laws = [Contact(c.preload * force, c.stiffness * force / length**c.exponent, c.exponent) for c in LAWS]
    image = Chain(np.array(MASS) * mass, laws)
    speed = length / time
    return _apart(_end(image, np.array(START) * speed) / speed, _end(Chain(MASS, LAWS), np.array(START)))


def _reversed() -> float:
    """The collision run back from its end: the beads at the places where they were, with velocities turned about."""
    forward = simulate(Chain(MASS, hertz(5.0)), START, samples=2, tolerance=TOLERANCE)
    back = Chain(MASS, hertz(5.0), gap=-forward.overlap[-1])
    return _apart(-_end(back, -forward.final_velocity), np.array(START))
