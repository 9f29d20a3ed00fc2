"""Measures of a motion that the paper speaks of: depth law, loads, and the separation of time scales."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physics.chain import Chain
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


def loads(chain: Chain, struck: int = 0) -> Array:
    """(n,) the force that each contact has to pass on, as a part of its own at overlap 1; 1 at the contact `struck`.

    If the clusters move as rigid bodies and the struck contact pushes with its force at overlap 1, a contact inside
    passes on the part of it that accelerates the masses beyond, Eq. (4). For small exponents a contact can pass on no
    more than about its force at overlap 1, so clusters are rigid-like only if all loads are below 1; how small the
    exponents must be follows from ``load**(1/exponent)``, the overlap. For n equal beads the greatest load is (n-1)/n.

    >>> from physics import one_on, power_law
    >>> loads(one_on(4, power_law(1.0, 0.1)))
    array([1.  , 0.75, 0.5 , 0.25])
    """
    mass = np.array(chain.mass)
    strength = np.array([contact.preload + contact.stiffness for contact in chain.contact])
    beyond, before = np.cumsum(mass[::-1])[::-1][1:], np.cumsum(mass)[:-1]
    right = np.arange(chain.contacts) >= struck
    share = np.where(right, beyond / beyond[struck], before / before[struck])
    found: Array = share * strength[struck] / strength
    return found


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
