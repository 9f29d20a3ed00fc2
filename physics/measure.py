"""Measures of a motion that the paper speaks of: the depth law of overlaps and the separation of time scales."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physics.trajectory import Trajectory

Array = NDArray[np.float64]


def depth_law(n: int, alpha: float) -> Array:
    """(n-1,) overlaps inside a homogeneous cluster of `n` beads as parts of the first, Eq. (6), i = 1 ... n-1.

    >>> depth_law(4, 1 / 10).round(4)
    array([1.    , 0.0173, 0.    ])
    """
    depth = np.arange(1, n)
    law: Array = ((n - depth) / (n - 1)) ** (1.0 / alpha)
    return law


def depth_bound(n: int, alpha: float) -> Array:
    """(n-1,) the paper's bound ``exp(-(i-1)/(n alpha))`` on :func:`depth_law`.

    >>> bool((depth_law(7, 0.05) <= depth_bound(7, 0.05)).all())
    True
    """
    bound: Array = np.exp(-(np.arange(1, n) - 1) / (n * alpha))
    return bound


def response_times(trajectory: Trajectory) -> Array:
    """(n,) response time of each contact [s] where it is pressed most: ``1 / sqrt(L_ii df/dd)``, L_ii = 1/m + 1/m'.

    The paper's tau_(i,i+1) before Eq. (10), with masses. 0 for a contact that never loads, inf for a step force.
    """
    law, inverse_mass = trajectory.chain.parameters
    _, stiffness, exponent = law.T
    deepest = np.maximum(trajectory.overlap.max(axis=0), 0.0)
    with np.errstate(divide="ignore"):
        slope = exponent * stiffness * deepest ** (exponent - 1.0)
        times: Array = 1.0 / np.sqrt((inverse_mass[:-1] + inverse_mass[1:]) * slope)
    return times


def time_scale_separation(trajectory: Trajectory, struck: int = 0) -> Array:
    """(n,) the validity measure of Eq. (10), (tau_i / tau_dur)**2: mode coupling needs it far below 1.

    tau_dur is the time for which the contact `struck` is first closed.

    Raises:
        ValueError: that contact does not close and open again.
    """
    intervals = trajectory.contact_intervals[struck]
    if not intervals or not np.isfinite(intervals[0][1]):
        raise ValueError(f"contact {struck} does not close and open again: the collision has no duration")
    closed, opened = intervals[0]
    separation: Array = (response_times(trajectory) / (opened - closed)) ** 2
    return separation
