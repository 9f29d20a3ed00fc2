"""Estimates of the scales of a chain from energy: speeds, and the depth and duration of each contact."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.chain import Chain, per_chain
from softcradle.physics.checked_input import SMALLEST
from softcradle.physics.contact import Contact
from softcradle.physics.messages import InputError
from softcradle.physics.numerics.plain_kernels import powers
from softcradle.physics.state import State, displacement, hanging_energy, rest_of, start_of

Array = NDArray[np.float64]

NO_APPROACH = 1e-13  # Approach speed, relative to the fastest bead, below which two beads do not count as approaching
# Lower limit of the tolerance scale, as a fraction of the largest velocity difference.
LEAST_SCALE = 1e-10
# Smallest velocity error, as a fraction of the largest velocity difference. This error is the round-off of a sum of
# velocities. The velocity difference may be present at the start or be produced by forces.
SPEED_ROUND_OFF = 16.0 * float(np.finfo(np.float64).eps)
# Smallest and largest overlap [m] that can be computed. Powers of overlaps far outside this range overflow or
# underflow.
LEAST_DEPTH, MOST_DEPTH = 1e-60, 1e25
# Number of default steps in the shortest contact time, and smallest number of default steps in the time in which bed
# friction stops a bead
DEFAULT_STEPS_A_CONTACT, DEFAULT_STEPS_A_STOP = 1000, 100


def _approach(values: Sequence[float]) -> float:
    """Return the largest ``values[j] - values[k]`` for a bead j to the left of a bead k. Return 0 if none is positive."""
    found, ahead = 0.0, -math.inf
    for value in values:
        ahead = max(ahead, value)
        found = max(found, ahead - value)
    return found


def speed_scale(chain: Chain, velocity: ArrayLike, duration: float | None = None) -> float:
    """Return the `greatest_speed` [m/s], or 1 if it is 0. A scale must not be 0."""
    return greatest_speed(chain, velocity, duration) or 1.0


def greatest_speed(chain: Chain, velocity: ArrayLike, duration: float | None = None) -> float:
    """Return the largest speed [m/s] at which beads can approach each other within `duration` [s].

    The result includes the closing speed at the start, and the speeds that compressed contacts and the drive can
    produce.
    """
    speeds = np.asarray(velocity, dtype=np.float64).tolist()
    found = max(speeds) - min(speeds)
    # A drive can produce a limited speed within the duration, which is never more than its limit for long times.
    if chain.driven:
        given = _given_speed(chain)
        found = max(found, given if duration is None else min(given, found + duration * _pull(chain)))
    return max(found, _sprung_speed(chain))


@per_chain
def _given_speed(chain: Chain) -> float:
    """Return the largest speed [m/s] that the drive can produce from the initial state."""
    return max(_driven_speed(chain, chain.drives), _fall_speed(chain, chain.drives, start_of(chain)[0]))


@per_chain
def _sprung_speed(chain: Chain) -> float:
    """Return the largest speed [m/s] that contacts compressed at the start can produce."""
    return _released_speed(chain, start_of(chain)[0])


@per_chain
def _pull(chain: Chain) -> float:
    """Return the largest difference between the accelerations [m/s²] of two beads by the drive, over all times."""
    return float(np.ptp(chain.drives * chain.inverse_mass, axis=1).max())


def closing_scale(
    chain: Chain,
    velocity: Array,
    overlap: Array,
    external: Array | None,
    duration: float | None,
    tolerance: float = math.inf,
) -> float:
    """Return the speed [m/s] to which the tolerance of a motion is relative: the largest possible closing speed.

    The result is the largest of three speeds. The first is the speed at which beads approach (or separate, if couplers
    pull). The second is the speed that compressed contacts can produce. The third is the speed that `external` forces
    (n+1,) [N] can produce, by pressing on contacts and by accelerating beads over gaps. If all three are 0, it is the
    speed of the moving beads. The scale has a lower limit, so `tolerance` times the scale is at least the round-off of
    the velocities.
    """
    speeds = velocity.tolist()
    high, low, approach = max(speeds), min(speeds), _approach(speeds)
    # A rate below round-off does not count as approach.
    if approach <= NO_APPROACH * max(high, -low):
        approach = 0.0
    if chain.pulls:  # Couplers can pull separating beads back.
        approach = high - low
    if chain.swing:  # Beads on strings swing back.
        approach = swinging_speed(chain, velocity, overlap)
    found, apart = max(approach, _released_speed(chain, overlap)), high - low
    # Time-dependent forces can produce at most their largest acceleration times the duration.
    if chain.forces:
        until = chain.knots[-1] if duration is None else duration
        found = max(found, min(_given_speed(chain), approach + until * _pull(chain)))
        apart += until * _pull(chain)
    # Steady forces act by pressing on contacts, by acceleration over gaps, or by both within the duration.
    if external is not None:
        acceleration = external * chain.inverse_mass
        pushes = external[None]
        given = max(_driven_speed(chain, pushes), math.hypot(approach, _fall_speed(chain, pushes, overlap)))
        if duration is not None:
            given = min(given, approach + _approach(acceleration.tolist()) * duration)
            apart += float(np.ptp(acceleration)) * duration
        found = max(found, given)
        if not found and duration is not None:
            found = float(np.abs(acceleration).max()) * duration
    # All beads move together, so any scale is suitable.
    if not found and high == low:
        return 1.0
    return max(found, LEAST_SCALE * apart, SPEED_ROUND_OFF / tolerance * apart)


def swinging_speed(chain: Chain, velocity: Array, overlap: Array) -> float:
    """Return an upper limit [m/s] of the closing speeds of beads on strings.

    `velocity` (n+1,) and `overlap` (n,) are values at any time of the motion. The difference of two displacements
    oscillates, and its energy limits the speed.
    """
    return math.hypot(
        np.ptp(velocity), math.sqrt(chain.swing) * np.ptp(displacement(chain, overlap, rest_of(chain)[1]))
    )


def largest_error(chain: Chain, start: State, end: State) -> Array:
    """Return the largest possible error [m/s] of each velocity (n+1,) in the state `end`.

    The error follows from the momentum, and from the energy since `start`.
    """
    force, passed = start.external(chain), end.time - start.time
    push = np.zeros(len(chain.mass)) if force is None else force
    # Energy does not limit the velocities in three cases: walls with different speeds, time-dependent forces, and a
    # moving wall together with a braking bed.
    walls = np.unique(start.velocity(chain)[np.isinf(chain.mass)])
    if walls.size > 1 or chain.forces or (walls.any() and chain.on_bed):
        return np.full(push.size, np.inf)
    stored = chain.stored_energy(start.overlap, force=start.force).sum()
    if chain.swing:
        stored = stored + hanging_energy(chain, start.overlap, start.anchor[0])
    held = np.asarray(chain.takes_momentum)
    mean, room = velocity_room(np.asarray(chain.mass), held, start.velocity(chain), stored, push, passed)
    return np.abs(end.velocity(chain) - mean) + room


def is_possible(chain: Chain, start: State, error: float) -> bool:
    """Return True if every bead velocity can have the error `error` [m/s]. This quick test uses only the fastest pair
    of beads.
    """
    pairs = zip(start.rate.tolist(), chain.inverse_reduced_mass.tolist(), strict=True)
    return error <= math.sqrt(max(rate * rate / weight for rate, weight in pairs)) * _least_share(chain)


@per_chain
def _least_share(chain: Chain) -> float:
    """Return the smallest sqrt(1/m - 1/M) of all beads, as in `velocity_room`."""
    total = math.inf if chain.walls or chain.takes_momentum else sum(chain.mass)
    heaviest = max(mass for mass in chain.mass if mass < math.inf)
    return math.sqrt(max(1.0 / heaviest - 1.0 / total, 0.0))


def velocity_room(
    mass: Array, on_bed: NDArray[np.bool_], velocity: Array, stored: Array, push: Array, passed: Any
) -> tuple[Array, Array]:
    """Return limits of the bead velocities (..., n+1) after `passed` (...) [s]: the mean velocity of all beads, and the
    largest possible difference [m/s] from this mean.

    Let E be the energy of all beads relative to their mean velocity. The velocity of a bead of mass m then differs from
    the mean by at most sqrt(2 E (1/m - 1/M)). M is the total mass, which is infinite with a wall or a bed. In a time t,
    forces f, given by `push` (..., n+1) [N], add at most t sqrt(sum f²/m) to sqrt(2 E). `stored` (...) is the energy
    [J] of the contacts at the start.
    """
    walls = np.isinf(mass)
    finite, inverse = np.where(walls, 0.0, mass), 1.0 / mass
    held = walls.any(axis=-1) | on_bed
    # The mean velocity is that of the walls. Without walls, it is that of the centre of mass.
    total = np.where(held, np.inf, finite.sum(axis=-1))
    first = np.take_along_axis(velocity, walls.argmax(axis=-1)[..., None], -1)[..., 0] * walls.any(axis=-1)
    mean = np.where(held, first, (finite * velocity).sum(axis=-1) / total)[..., None]
    pull = ((inverse > 0.0) * push).sum(axis=-1) / total
    # Energy relative to the mean velocity, and the largest increase of its square root by forces.
    energy = 0.5 * (finite * (velocity - mean) ** 2).sum(axis=-1) + stored
    given = passed * np.sqrt((inverse * (push - finite * pull[..., None]) ** 2).sum(axis=-1))
    room = (np.sqrt(2.0 * energy) + given)[..., None] * np.sqrt(np.maximum(inverse - 1.0 / total[..., None], 0.0))
    return mean + (passed * pull)[..., None] * np.ones_like(mass), room


def _released_speed(chain: Chain, overlap: Array) -> float:
    """Return the largest speed [m/s] at which a contact compressed to `overlap` drives its two beads apart.

    Return 0 if no contact is compressed.
    """
    if not max(overlap.tolist()) > 0.0:
        return 0.0
    return float(np.sqrt(2.0 * chain.stored_energy(overlap, powers) * chain.inverse_reduced_mass).max())


def _fall_speed(chain: Chain, forces: Array, overlap: Array) -> float:
    """Return the largest speed [m/s] at which beads meet if they start from rest and an external force closes all gaps.

    `forces` (K, n+1) [N] contains K cases of external forces.
    """
    gaps = float(-np.minimum(overlap, 0.0).sum())
    if gaps == 0.0:
        return 0.0
    return math.sqrt(2.0 * max(map(_approach, (forces * chain.inverse_mass).tolist())) * gaps)


def _driven_speed(chain: Chain, forces: Array) -> float:
    """Return the largest speed [m/s] that a contact reaches under an external force.

    The speed is computed from the part of the force that the contact transmits. `forces` (K, n+1) [N] contains K cases
    of external forces.
    """
    preload, stiffness, exponent = chain.law_rows.T
    force = np.maximum(_passed_on(chain, forces) - preload, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = powers((1.0 + exponent) * force / stiffness, 1.0 / exponent)
    for i, law in chain.own_contacts:
        depth[i] = law.overlap(2.0 * (force[i] + law.preload))
    with np.errstate(invalid="ignore"):
        speed = np.sqrt(2.0 * force * depth * chain.inverse_reduced_mass)
    return float(np.max(speed, where=np.isfinite(speed), initial=0.0))


def _passed_on(chain: Chain, drives: Array) -> Array:
    """Return the largest force (n,) [N] of each contact if rigid beads start from rest under external forces.

    `drives` (K, n+1) [N] contains K cases of external forces. Beads that are driven into each other move on as one
    body, even across gaps: two groups of beads are joined if the left group accelerates faster.
    """
    walls, greatest = np.isinf(chain.mass), np.zeros(chain.contacts)
    for drive in drives:
        runs: list[tuple[int, float, float]] = []  # Number of beads, total drive [N] and total mass [kg] of each group
        # Join beads that are driven into each other to groups with a common acceleration.
        for push, inertia in zip(drive.tolist(), chain.mass, strict=True):
            count, whole, total = 1, push, inertia
            while runs and runs[-1][1] / runs[-1][2] > whole / total:
                more, other, beside = runs.pop()
                count, whole, total = count + more, whole + other, total + beside
            runs.append((count, whole, total))
        # The force of a contact is the sum of the forces that the beads on its left transmit.
        counts = np.array([count for count, _, _ in runs])
        acceleration = np.repeat([whole / total for _, whole, total in runs], counts)
        left = drive - chain.finite_mass * acceleration  # Force that the contacts must absorb from each bead
        if walls.any():  # A wall holds the group to which it belongs.
            left -= np.where(walls, np.repeat(np.add.reduceat(left, np.cumsum(counts) - counts), counts), 0.0)
        passed = np.cumsum(left)[:-1]
        greatest = np.maximum(greatest, np.where(passed > NO_APPROACH * np.abs(drive).sum(), passed, 0.0))
    return greatest


def contact_scales(chain: Chain, velocity: ArrayLike, duration: float | None = None) -> tuple[Array, Array]:
    """Return estimates (n,) of the largest overlap [m] and of the contact time [s], for each contact separately, as if
    two free beads collided.

    The speed is the largest speed within `duration` [s]. The overlap d follows from the energy balance ``F d + K
    d**(1+a)/(1+a) = mu v**2 / 2`` with the reduced mass mu. The overlap is approximated by the smaller of the two
    solutions in which one term on the left is left out. For user-defined laws, their energy is used. The contact time
    is the time for moving over this overlap and back at the closing speed.
    """
    return scales_at(chain, speed_scale(chain, velocity, duration))


def struck_depth(preload: Array, stiffness: Array, exponent: Array, energy: Array | float) -> Array:
    """Return the overlaps [m], any shape, at which contacts store `energy` [J].

    The result is the smaller of two solutions: one for the preload only, and one for the power law only.
    """
    with np.errstate(divide="ignore"):
        by_power = powers((1.0 + exponent) * energy / stiffness, 1.0 / (1.0 + exponent))
        return np.minimum(energy / preload, by_power)


def scales_at(chain: Chain, speed: float) -> tuple[Array, Array]:
    """Return the overlaps (n,) [m] and contact times (n,) [s] of single contacts that close at `speed` [m/s]."""
    energy = 0.5 * speed * speed / chain.inverse_reduced_mass
    preload, stiffness, exponent = chain.law_rows.T
    depth = struck_depth(preload, stiffness, exponent, energy)
    for i, law in chain.own_contacts:
        depth[i] = law.depth(float(energy[i]))
    # Time for moving over the overlap and back. With a stop, it is at most half a period of the spring of the stop.
    times = 2.0 * depth / speed
    for i, contact in chain.piecewise:
        if contact.stop_stiffness:
            times[i] = min(times[i], math.pi / math.sqrt(contact.stop_stiffness * chain.inverse_reduced_mass[i]))
    pulling = as_it_pulls(chain)
    return depth, times if pulling is None else np.minimum(times, scales_at(pulling, speed)[1])


def shortest_contact(chain: Chain, speed: float, start: ArrayLike | None = None) -> float:
    """Return the time [s] of the shortest contact of the chain at the closing speed `speed` [m/s].

    If the start velocities (n+1,) [m/s] are given, contacts that stay touching during the whole motion are ignored.
    """
    times = scales_at(chain, speed)[1]
    return float((times if start is None else times[~stays_touching(chain, start)]).min())


def stays_touching(chain: Chain, velocity: ArrayLike) -> NDArray[np.bool_]:
    """Return True for each contact (n,) that surely stays touching during the whole motion.

    The motion starts with `velocity` (n+1,) [m/s]. Without external forces, a contact with preload that touches at the
    start transmits at most the largest force of the moving contacts. Such a contact never yields if its preload is
    larger than any force that the moving contacts can reach with all the energy.
    """
    speeds, stays = np.asarray(velocity, dtype=np.float64), np.zeros(chain.contacts, dtype=np.bool_)
    walls = np.isinf(chain.mass)
    if chain.driven or chain.on_bed or chain.piecewise or chain.own_laws or np.unique(speeds[walls]).size > 1:
        return stays
    # All the energy, relative to the centre of mass or to the walls.
    mass = chain.finite_mass
    mean = float(speeds[walls][0]) if walls.any() else float(speeds @ mass / mass.sum())
    overlap, preload, stiffness, exponent = -np.array(chain.gap), *chain.law_rows.T
    energy = 0.5 * float(mass @ (speeds - mean) ** 2) + float(chain.stored_energy(overlap, powers).sum())
    if energy == 0.0:
        return stays
    greatest = preload + stiffness * powers(struck_depth(preload, stiffness, exponent, energy), exponent)
    # Remove contacts whose preload can be exceeded by the force of another contact, until nothing changes.
    stays = (overlap == 0.0) & (np.diff(speeds) == 0.0) & (preload > 0.0)
    while stays.any():
        held = stays & (preload > greatest[~stays].max(initial=0.0))
        if (held == stays).all():
            break
        stays = held
    return stays & (not stays.all())


@per_chain
def as_it_pulls(chain: Chain) -> Chain | None:
    """Return the chain with the pulling gear in place of each contact that pulls. Return None if no contact can pull."""
    if not chain.pulls:
        return None
    contacts = list(chain.contact)
    for i, contact in chain.piecewise:
        gear = (contact.pulling or contact.pushing)[0]
        contacts[i] = Contact(gear.preload, gear.stiffness, gear.exponent, gear.loss)
    return Chain(chain.mass, contacts)


def default_step(chain: Chain, velocity: ArrayLike, duration: float | None = None, touching: bool = False) -> float:
    """Return the default step [s] of a fixed-step method: a thousandth of the shortest contact time within `duration`.

    With bed friction or brakes, it is at most a hundredth of the time in which they stop a bead. `touching` is True for
    a whole motion with a method that keeps touching contacts closed. Contacts that stay touching are then ignored.
    """
    return step_at(chain, speed_scale(chain, velocity, duration), velocity if touching else None)


def step_at(chain: Chain, speed: float, start: ArrayLike | None = None) -> float:
    """Return the `default_step` [s] at the closing speed `speed` [m/s]. `start` is as in :func:`shortest_contact`."""
    shortest = shortest_contact(chain, speed, start) / DEFAULT_STEPS_A_CONTACT
    strongest = max(chain.bed.tolist(), default=0.0)
    return min(shortest, speed / strongest / DEFAULT_STEPS_A_STOP) if strongest else shortest


@per_chain
def _computable_speeds(chain: Chain) -> tuple[float, float]:
    """Return a range of speed scales [m/s] in which the depths of all contacts can surely be computed.

    For user-defined laws the range is empty, so their depths are always checked one by one. At a depth d below 1 m, a
    contact stores at most d times the larger of its preload and its stiffness. At larger depths up to MOST_DEPTH, it
    stores at least this energy.
    """
    if chain.own_laws:
        return math.inf, 0.0
    strength = list(map(max, *chain.law_rows.T[:2].tolist()))
    weight = chain.inverse_reduced_mass.tolist()
    least = math.sqrt(2.0 * max(weight) * max(strength) * LEAST_DEPTH)
    return max(SMALLEST, least), math.sqrt(2.0 * min(weight) * min(strength) * MOST_DEPTH)


def require_computable(chain: Chain, velocity: ArrayLike, duration: float | None = None) -> None:
    """Raise ValueError if a contact overlap would be so small or so large that its powers leave the range of floats."""
    speed = speed_scale(chain, velocity, duration)
    least, most = _computable_speeds(chain)
    if least < speed < most:
        return
    if not speed >= SMALLEST:
        raise InputError(
            "slow",
            "the closing speed must be 0 or at least {least:g} m/s, not {given:g}: choose other units",
            least=SMALLEST,
            given=speed,
        )
    # The speed is outside the range of the quick test. Check each contact.
    with np.errstate(over="ignore", under="ignore"):
        depth = scales_at(chain, speed)[0]
    for i, law in chain.own_contacts:
        if math.isinf(depth[i]):
            raise InputError(
                "weak_law",
                "contact {left}-{right}: the law {law!r} never stores the energy of this motion",
                left=i,
                right=i + 1,
                law=law.name,
            )
    for i in np.flatnonzero(~((depth >= LEAST_DEPTH) & (depth <= MOST_DEPTH)))[:1].tolist():
        raise InputError(
            "depth",
            "contact {left}-{right} would be pressed by about {depth:.2g} m; depths from {least:g} to {most:g} m can be "
            "computed: choose other units",
            left=i,
            right=i + 1,
            depth=depth[i],
            least=LEAST_DEPTH,
            most=MOST_DEPTH,
        )
    for law in chain.own_laws:
        deepest = max(float(depth[i]) for i, own in chain.own_contacts if own == law)
        law.require_usable(deepest)
