"""Ringing of a contact: the oscillation of its overlap or force about a slowly changing value. The results are turning
points, period, amplitude and decay.

Inside a struck cluster, a contact follows the force that it must transmit, Eq. (5). This curve of the overlap is called
the quasi-static branch. The contact oscillates about this branch at the local frequency ``sqrt((1/m + 1/m') df/dd)``.
The inverse of this frequency is the response time defined before Eq. (10).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.trajectory import Trajectory

Array = NDArray[np.float64]

LEAST_SWING = 1e-9  # Smallest change of a curve between two turning points, as a fraction of the range of the curve.
FEWEST_TURNS = 4  # Smallest number of turning points of a curve with an oscillation. One rise and one fall have fewer.


@dataclass(frozen=True)
class Ringing:
    """Oscillation on top of a curve that rises and falls once.

    Attributes:
        turns: number of turning points of the curve. Without oscillation it is 1.
        period: mean time between every other turning point [s]; None with fewer than 4 turning points.
        amplitude: half of the largest distance between a turning point and the mean of its neighbours, in units of
            the curve.
        decay: rate at which the logarithm of this distance decreases [1/s]. The rate is negative if the oscillation
            grows.
    """

    turns: int
    period: float | None = None
    amplitude: float | None = None
    decay: float | None = None


def turning_points(curve: ArrayLike, swing: float | None = None) -> NDArray[np.int_]:
    """Return the indices of the turning points of `curve` (T,). Between two turning points, the curve changes by at
    least `swing`.

    The default of `swing` is LEAST_SWING times the range of the curve. Pass another value if the curve may be constant,
    because its range is then only round-off.

    >>> turning_points([0.0, 1.0, 0.5, 2.0, 0.0]).tolist()
    [1, 2, 3]
    >>> turning_points([0.0, 1.0, 0.5, 2.0, 0.0], swing=0.7).tolist()
    [3]
    """
    values = np.asarray(curve, dtype=np.float64)
    least = LEAST_SWING * float(np.ptp(values)) if swing is None else swing
    found = []
    extreme, direction = 0, 0
    for i in range(1, values.size):
        change = values[i] - values[extreme]
        if direction * change > 0.0 or (direction == 0 and abs(change) > least):
            extreme, direction = i, int(np.sign(change))
        elif direction * change < -least:
            found.append(extreme)
            extreme, direction = i, -direction
    return np.array(found, dtype=np.int_)


def ringing(time: ArrayLike, curve: ArrayLike) -> Ringing:
    """Analyse the oscillation of `curve` (T,), sampled at `time` (T,) [s]. The oscillation needs several samples per
    period.

    >>> t = np.linspace(0.0, 1.0, 2001)
    >>> found = ringing(t, np.sin(np.pi * t) + 0.1 * np.sin(2.0 * np.pi * t / 0.05))
    >>> round(found.period, 3), round(found.amplitude, 2)
    (0.05, 0.1)
    """
    times, values = np.asarray(time, dtype=np.float64), np.asarray(curve, dtype=np.float64)
    at = turning_points(values)
    if at.size < FEWEST_TURNS:
        return Ringing(int(at.size))
    height = values[at]
    swing = np.abs(height[:-2] - 2.0 * height[1:-1] + height[2:]) / 4.0
    period = float(np.mean(times[at[2:]] - times[at[:-2]]))
    decay = -float(np.polyfit(times[at[1:-1]], np.log(swing), 1)[0]) if swing.size > 2 and (swing > 0.0).all() else None
    return Ringing(int(at.size), period, float(swing.max()), decay)


def returns(trajectory: Trajectory, contact: int) -> tuple[Array, Array]:
    """Return the times [s] of the minima of the overlap of `contact`, and the overlaps [m] at these times.

    Between two samples, the overlap is interpolated by a parabola from its rates. The samples must therefore be dense
    compared with the period.
    """
    rate, overlap, time = trajectory.rate[:, contact], trajectory.overlap[:, contact], trajectory.time
    rows = np.flatnonzero((rate[1:-1] < 0.0) & (rate[2:] >= 0.0)) + 1
    part = -rate[rows] / (rate[rows + 1] - rate[rows])
    span = part * (time[rows + 1] - time[rows])
    return time[rows] + span, overlap[rows] + 0.5 * rate[rows] * span
