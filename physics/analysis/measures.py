"""Measures of a motion that the paper defines: depth law, loads, separation of time scales, rigidity, energy in a
cluster.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.analysis.closed_forms import common_law, meets_freely
from softcradle.physics.chain import Chain, Joint, mass_shares
from softcradle.physics.segments import PiecewiseContact
from softcradle.physics.trajectory import Trajectory

Array = NDArray[np.float64]

# Fraction of the largest overlap. If a contact with preload has a smaller overlap, it counts as touching, not as
# loaded.
LEAST_OVERLAP = 1e-9


def depth_law(n: int, alpha: float) -> Array:
    """Return the (n-1,) overlaps inside a homogeneous cluster of `n` beads, divided by the first overlap, Eq. (7).

    >>> depth_law(4, 1 / 10).round(4)
    array([1.    , 0.0173, 0.    ])
    """
    depth = np.arange(1, n)
    return ((n - depth) / (n - 1)) ** (1.0 / alpha)


def depth_bound(n: int, alpha: float) -> Array:
    """Return the paper's upper bound (n-1,) of :func:`depth_law`: ``exp(-(i-1)/(n alpha))``.

    >>> bool((depth_law(7, 0.05) <= depth_bound(7, 0.05)).all())
    True
    """
    return np.exp(-(np.arange(1, n) - 1) / (n * alpha))


def loads(chain: Chain, struck: int = 0) -> Array:
    """Return the (n,) force that each contact must transmit, divided by its force at overlap 1.

    Both clusters are assumed to move as rigid bodies, and the struck contact to push with its force at overlap 1. A
    contact inside a cluster then transmits the force that accelerates the masses beyond it, Eq. (5). The load of
    contact `struck` is 1. With small exponents, a contact transmits at most about its force at overlap 1. So clusters
    are rigid-like only if all loads are below 1. The overlap ``load**(1/exponent)`` shows how small the exponents must
    be. For n equal beads the largest inner load is (n-1)/n.

    >>> from softcradle import one_on, power_law
    >>> loads(one_on(4, power_law(1.0, 0.1)))
    array([1.  , 0.75, 0.5 , 0.25])
    """
    preload, stiffness, _ = chain.power_law_rows.T
    strength = preload + stiffness
    return mass_shares(chain.mass, struck) * strength[struck] / strength


def response_times(trajectory: Trajectory) -> Array:
    """Return the (n,) response times [s] at the largest overlaps: ``1 / sqrt(L_ii df/dd)``, L_ii = 1/m + 1/m'.

    These times generalise tau_(i,i+1), defined before Eq. (10), to unequal masses. The time is 0 for a contact that is
    never loaded, and infinite for a step force.
    """
    _, stiffness, exponent = trajectory.chain.power_law_rows.T
    deepest = np.maximum(trajectory.overlap.max(axis=0), 0.0)
    with np.errstate(divide="ignore"):
        slope = exponent * stiffness * deepest ** (exponent - 1.0)
        times = 1.0 / np.sqrt(trajectory.chain.inverse_reduced_mass * slope)
    return np.where(deepest > 0.0, times, 0.0)


def time_scale_separation(trajectory: Trajectory, struck: int = 0) -> Array:
    """Return the (n,) validity measure (tau_i / tau_dur)**2 of Eq. (10). The mode-coupling model requires values far
    below 1.

    tau_i is a response time. tau_dur is the time for which contact `struck` first stays closed.

    Raises
    ------
    ValueError
        If contact `struck` does not close and open again.
    """
    intervals = trajectory.contact_intervals[struck]
    if not intervals or not np.isfinite(intervals[0][1]):
        raise ValueError(f"contact {struck} does not close and open again: the collision has no duration")
    closed, opened = intervals[0]
    return (response_times(trajectory) / (opened - closed)) ** 2


def rigidity(velocity: ArrayLike) -> Array:
    """Return the velocity spread (...) of a cluster with velocities (..., n) [m/s].

    The spread is the largest minus the smallest velocity, divided by the mean. The spread is 0 for a rigid body, and
    infinite or NaN if the mean is 0. The paper states that it "vanishes in the limit alpha -> +0", Figs. 1(c), (d). The
    spread is the ordinate of Fig. 3 in the letter that the paper cites.

    >>> float(rigidity([0.5, 0.4, 0.3]).round(3))
    0.5
    """
    speeds = np.asarray(velocity, dtype=np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.ptp(speeds, axis=-1) / np.abs(speeds.mean(axis=-1))


def interpolated(trajectory: Trajectory, values: Array, time: float) -> Array:
    """Return `values` (T, ...) of a trajectory at `time` [s], by linear interpolation between its samples."""
    right = min(max(int(np.searchsorted(trajectory.time, time)), 1), len(trajectory.time) - 1)
    before, after = trajectory.time[right - 1], trajectory.time[right]
    share = 0.0 if after == before else min(max((time - before) / (after - before), 0.0), 1.0)
    return (1.0 - share) * values[right - 1] + share * values[right]


def restitution(trajectory: Trajectory, struck: int, touch: float, detachment: float) -> float | None:
    """Return the ratio of the speed of separation at time `detachment` [s] to the speed of approach at time `touch`
    [s].

    The result is None if the two sides do not approach each other. The speeds are those of the centres of mass. After
    the detachment, only bed friction and walls change them.
    """
    chain, sides = trajectory.chain, (slice(None, struck + 1), slice(struck + 1, None))
    rows = (interpolated(trajectory, trajectory.velocity, time) for time in (touch, detachment))
    before, after = ([_side_velocity(chain, side, row) for side in sides] for row in rows)
    approach = before[0] - before[1]
    return (after[1] - after[0]) / approach if approach > 0.0 else None


def energy_inside(trajectory: Trajectory, struck: int) -> Array:
    """Return the (T,) energy inside the target cluster as a fraction of the initial energy; NaN if the initial energy
    is 0.
    """
    chain = trajectory.chain
    beads = target_beads(chain, struck)
    mass, velocity = np.array(chain.mass)[beads], trajectory.velocity[:, beads]
    own = velocity - (velocity @ mass / mass.sum())[:, None] if beads.size else velocity
    stored = chain.stored_energy(trajectory.overlap, force=trajectory.force)[:, struck + 1 :].sum(axis=1)
    total = trajectory.kinetic_energy[0] + trajectory.contact_energy[0]
    return (0.5 * own**2 @ mass + stored) / (total or math.nan)


def impulses(trajectory: Trajectory, struck: int) -> Array:
    """Return the (n,) momentum [N s] that each contact transmitted to the right between the first and the last sample.

    The momentum follows from the momentum balance of one side of the contact. The balance is not known between two
    walls, with bed friction and on strings. In these cases, the force is integrated over the samples. The integral
    starts at the first touch of contact `struck`, because forces between beads at rest on the bed are not determined.
    """
    chain, time = trajectory.chain, trajectory.time
    if chain.takes_momentum:
        return _integrated_force(trajectory, struck)
    mass = np.array(chain.mass)
    drive = np.zeros(len(mass)) if chain.drive_force is None else chain.drive_force * (time[-1] - time[0])
    for item in chain.forces:
        drive[list(item.beads)] += np.diff(item.impulse(time[[0, -1]]))
    with np.errstate(invalid="ignore"):
        gained = mass * (trajectory.velocity[-1] - trajectory.velocity[0]) - drive  # The momentum is NaN for walls.
    right, left = np.cumsum(gained[::-1])[::-1][1:], -np.cumsum(gained)[:-1]
    known: Array = np.where(np.isfinite(right), right, left)
    if np.isfinite(known).all():
        return known
    return np.where(np.isfinite(known), known, _integrated_force(trajectory, struck))


def _integrated_force(trajectory: Trajectory, struck: int) -> Array:
    """Return the (n,) integrals of the contact forces [N s] over the samples, starting at the first touch of contact
    `struck`.

    If a contact is open at one of two neighbouring samples, its force may jump between them. Such an interval is not
    integrated with the mean force.
    """
    time, force = trajectory.time, trajectory.force
    middle, mean = 0.5 * (time[1:] + time[:-1]), 0.5 * (force[1:] + force[:-1])
    for k, spans in enumerate(trajectory.contact_intervals):
        if not isinstance(
            trajectory.chain.contact[k], PiecewiseContact
        ):  # A coupler may push before its closing is logged.
            switches = np.array(spans).ravel()
            mean[:, k] = np.where(np.isin(time[1:], switches[1::2]), force[:-1, k], mean[:, k])
            mean[np.searchsorted(switches, middle) % 2 == 0, k] = 0.0
    late = middle > first_touch(trajectory, struck)
    return np.diff(time)[late] @ mean[late]


def first_touch(trajectory: Trajectory, struck: int) -> float:
    """Return the time [s] at which contact `struck` first closes, or the end of the run."""
    spans = trajectory.contact_intervals[struck]
    return spans[0][0] if spans else float(trajectory.time[-1])


def loaded_samples(trajectory: Trajectory) -> NDArray[np.bool_]:
    """Return a boolean array (T, n): True if a contact is compressed, or if a gear of a coupler is."""
    way = trajectory.overlap.copy()
    for i, contact in trajectory.chain.piecewise:
        pulled = np.where(trajectory.force[:, i] < 0.0, contact.pulls_below - way[:, i], 0.0)
        way[:, i] = np.maximum(way[:, i], pulled)
    return way > LEAST_OVERLAP * max(float(way.max()), 0.0)


def can_touch(joint: Joint) -> bool:
    """Return True if a contact can transmit a force without moving, because it has a preload for pushing or for
    pulling.
    """
    return joint.preload > 0.0 or (
        isinstance(joint, PiecewiseContact) and any(one.preload for one in joint.pulling[:1])
    )


def dwell(trajectory: Trajectory, struck: int) -> Array:
    """Return the (n, 3) times [s] for which each contact was open, touching and loaded.

    The times are counted from the first touch of contact `struck` to the end. A coupler that pulls counts as closed.
    Closings and openings are exact. The change between touching and loaded is only known to within a sample.
    """
    time, end = trajectory.time, float(trajectory.time[-1])
    begin, loaded_at, rows = first_touch(trajectory, struck), loaded_samples(trajectory), []
    for k, spans in enumerate(trajectory.contact_intervals):
        closed = sum(max(min(last, end) - max(first, begin), 0.0) for first, last in spans)
        loaded = closed
        if can_touch(trajectory.chain.contact[k]):
            pressed = loaded_at[:, k] & (time >= begin)
            loaded = min(closed, float(np.diff(time)[pressed[1:] | pressed[:-1]].sum()))
        rows.append((end - begin - closed, closed - loaded, loaded))
    return np.array(rows)


def spread_variable(n: int, alpha: float) -> float:
    """Return ``(n+1) exp(-1/(2 n alpha))``. Two collisions of one bead on `n` beads have the same velocity spread if
    this value is equal.

    The first inner contact has the overlap ``psi ~ exp(-1/(n alpha))`` at a force near 1. After the detachment, its
    stored energy drives its beads apart at a speed of about ``sqrt(psi)``. The velocity of a rigid cluster is 2/(n+1).

    >>> round(spread_variable(4, 0.1), 3)
    1.433
    """
    return (n + 1) * math.exp(-1.0 / (2.0 * n * alpha))


def chain_spread_variable(chain: Chain, struck: int) -> float | None:
    """Return the `spread_variable` of a chain that consists of one striker and equal targets without preload or loss.

    The result is None for other chains.
    """
    law, n = common_law(chain), chain.contacts
    if law is None or law.preload or law.loss or n < 2 or struck != 0 or len(set(chain.mass)) > 1:
        return None
    return spread_variable(n, law.exponent) if meets_freely(chain, struck) else None


def penetration_depth(trajectory: Trajectory, struck: int = 0) -> float:
    """Return the number of contacts over which the overlap decreases by a factor e.

    The time is that of the largest overlap of the first inner contact. The value comes from a straight line through the
    logarithms of the overlaps behind contact `struck`. The paper's bound on Eq. (7) is n alpha. The value is 0 if no
    second inner contact is compressed, or if the overlaps do not decrease inwards.
    """
    inner = trajectory.overlap[:, struck + 1 :]
    if inner.shape[1] < 2:
        return 0.0
    row = inner[int(np.argmax(inner[:, 0]))]
    count = int(np.argmax(row <= 0.0)) if (row <= 0.0).any() else row.size
    if count < 2:
        return 0.0
    slope = float(np.polyfit(np.arange(count), np.log(row[:count]), 1)[0])
    return -1.0 / slope if slope < 0.0 else 0.0


def target_beads(chain: Chain, struck: int) -> NDArray[np.int_]:
    """Return the indices of the beads behind contact `struck`, without walls."""
    return struck + 1 + np.flatnonzero(np.isfinite(chain.mass[struck + 1 :]))


def _side_velocity(chain: Chain, side: slice, velocity: Array) -> float:
    """Return the velocity [m/s] of the centre of mass of one side of a contact. If the side contains a wall, return its
    velocity.
    """
    mass, speeds = np.array(chain.mass)[side], velocity[side]
    walls = np.isinf(mass)
    return float(speeds[walls][0] if walls.any() else speeds @ mass / mass.sum())
