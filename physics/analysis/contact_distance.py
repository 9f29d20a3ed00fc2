"""Distance of two contacts in one collision: by the force of the struck contact over time, or by the outcome.

    force     sqrt(integral (f - g)^2 dt / integral f^2 dt) over the force of the struck contact, from the first touch
              until both collisions are over
    outcome   sqrt(mean ((v_i - w_i) / V)^2 + ln(T / S)^2) over the final velocities of all beads, V the closing speed
              at the start, and the contact times T, S of the struck contact

f, v, T belong to the given contact, g, w, S to the other. All contacts of the chain are replaced.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.contact import Contact
from softcradle.physics.simulation import simulate
from softcradle.physics.trajectory import Trajectory

Array = NDArray[np.float64]
Distance = Literal["force", "outcome"]

DISTANCES: tuple[Distance, ...] = ("force", "outcome")
TOLERANCE = 1e-6  # of the collisions: far below any distance; very soft chains need thousands of steps for less
FAR = 1e3  # distance of a contact whose collision cannot be simulated
# times of samples, in contact times: dense at both ends, where forces jump, and short of the ends themselves, where the force
# has two values
GRADED = np.clip(0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 801)), 1e-9, 1.0 - 1e-9)


def _solved(chain: Chain, velocity: Array, duration: float | None, samples: int | Array) -> Trajectory:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a contact whose run fails gets the distance FAR
        return simulate(chain, velocity, duration, "accurate", None, samples, TOLERANCE)


def _with(chain: Chain, contact: Contact) -> Chain:
    return replace(chain, contact=(contact,) * chain.contacts)


def force_distance(chain: Chain, velocity: Array, struck: int) -> Callable[[Contact], float]:
    """A function of a contact: how far the collision with it is from that of `chain`, by the force of contact `struck`."""

    def curve(contact: Contact) -> tuple[Array, Array]:
        """Force of the struck contact from its first touch to its last opening, and the times since that touch."""
        candidate = _with(chain, contact)
        spans = _solved(candidate, velocity, None, 2).contact_intervals[struck]
        touched, opened = spans[0][0], spans[-1][1]
        time = touched + (opened - touched) * GRADED
        return time - touched, _solved(candidate, velocity, opened, time).force[:, struck]

    time, force = curve(chain.power_laws[0])
    whole = np.trapezoid(force**2, time)

    def apart(contact: Contact) -> float:
        other_time, other = curve(contact)
        found = math.sqrt(squared_difference(time, force, other_time, other) / whole)
        return found if math.isfinite(found) else FAR

    return apart


def squared_difference(time: Array, curve: Array, other_time: Array, other: Array) -> float:
    """Integral of (f - g)^2 of two curves over times (T,), (S,) from 0 on; each curve is 0 after its last time.

    >>> one = np.ones(2)
    >>> squared_difference(np.array([0.0, 2.0]), one, np.array([0.0, 3.0]), 2.0 * one)
    6.0
    """
    first = min(time[-1], other_time[-1])
    both = np.unique(np.concatenate((time[time <= first], other_time[other_time <= first])))
    off = np.interp(both, time, curve) - np.interp(both, other_time, other)
    total = float(np.trapezoid(off**2, both))
    for times, values in ((time, curve), (other_time, other)):
        rest = np.concatenate(([first], times[times > first]))
        total += float(np.trapezoid(np.interp(rest, times, values) ** 2, rest))
    return total


def outcome_distance(chain: Chain, velocity: Array, struck: int) -> Callable[[Contact], float]:
    """A function of a contact: how far the collision with it is from that of `chain`, by final velocities and contact time."""
    closing = float(velocity[struck] - velocity[struck + 1])

    def outcome(contact: Contact) -> tuple[Array, float]:
        found = _solved(_with(chain, contact), velocity, None, 2)
        closed = sum(opened - touched for touched, opened in found.contact_intervals[struck])
        return found.final_velocity / closing, math.log(closed)

    speeds, logarithm = outcome(chain.power_laws[0])

    def apart(contact: Contact) -> float:
        other_speeds, other_logarithm = outcome(contact)
        off = float(np.mean((other_speeds - speeds) ** 2)) + (other_logarithm - logarithm) ** 2
        found = math.sqrt(off)
        return found if math.isfinite(found) else FAR

    return apart
