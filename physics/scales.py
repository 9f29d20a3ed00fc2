"""Scales of a chain from energy estimates: speeds, and the depth and duration of each contact."""

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

NO_APPROACH = 1e-13  # Approach speed, relative to the fastest bead, below which beads do not count as closing
# Lower limit of the tolerance scale, as a fraction of the largest velocity difference.
LEAST_SCALE = 1e-10
# Smallest possible velocity error, as a fraction of the largest velocity difference (present or caused by forces):
# round-off of a sum
SPEED_ROUND_OFF = 16.0 * float(np.finfo(np.float64).eps)
# Range of overlaps [m] that can be computed. Powers of overlaps far beyond it overflow or underflow.
LEAST_DEPTH, MOST_DEPTH = 1e-60, 1e25
# Number of default steps in the shortest contact time, and least number in the time in which bed friction stops a bead
DEFAULT_STEPS_A_CONTACT, DEFAULT_STEPS_A_STOP = 1000, 100


def _approach(values: Sequence[float]) -> float:
    """Return the largest ``values[j] - values[k]`` over beads j to the left of k; 0 if none is positive."""
    found, ahead = 0.0, -math.inf
    for value in values:
        ahead = max(ahead, value)
        found = max(found, ahead - value)
    return found


def speed_scale(chain: Chain, velocity: ArrayLike, duration: float | None = None) -> float:
    """Return the `greatest_speed`, or 1 if it is 0, so that scales stay finite."""
    return greatest_speed(chain, velocity, duration) or 1.0


def greatest_speed(chain: Chain, velocity: ArrayLike, duration: float | None = None) -> float:
    """Return the largest of the closing speed and the speeds that compressed contacts and the drive can give in
    `duration` [m/s].
    """
    speeds = np.asarray(velocity, dtype=np.float64).tolist()
    found = max(speeds) - min(speeds)
    # A drive gives a speed within the duration, but no more than it gives in the long run.
    if chain.driven:
        given = _given_speed(chain)
        found = max(found, given if duration is None else min(given, found + duration * _pull(chain)))
    return max(found, _sprung_speed(chain))


@per_chain
def _given_speed(chain: Chain) -> float:
    """Return the largest speed [m/s] that the drive can give, starting from the initial state."""
    return max(_driven_speed(chain, chain.drives), _fall_speed(chain, chain.drives, start_of(chain)[0]))


@per_chain
def _sprung_speed(chain: Chain) -> float:
    """Return the largest speed [m/s] that contacts compressed at the start can give."""
    return _released_speed(chain, start_of(chain)[0])


@per_chain
def _pull(chain: Chain) -> float:
    """Return the largest difference of the accelerations [m/s²] that the drive gives to beads, over all times."""
    return float(np.ptp(chain.drives * chain.inverse_mass, axis=1).max())


def closing_scale(
    chain: Chain,
    velocity: Array,
    overlap: Array,
    external: Array | None,
    duration: float | None,
    tolerance: float = math.inf,
) -> float:
    """Return the speed [m/s] that the tolerance of a motion is relative to: the largest closing speed that is possible.

    It is the largest of these speeds: the speed at which beads approach (or separate, if couplers pull), the speed that
    compressed contacts can give, and the speed that `external` forces (n+1,) [N] can give by pressing on contacts and
    over the gaps. In a motion without any of these it is the speed of the moving beads. The scale is so large that
    `tolerance` times the scale is at least the round-off of the velocities.
    """
    speeds = velocity.tolist()
    high, low, approach = max(speeds), min(speeds), _approach(speeds)
    # Rates below round-off are not a closing.
    if approach <= NO_APPROACH * max(high, -low):
        approach = 0.0
    if chain.pulls:  # separating beads come back
        approach = high - low
    if chain.swing:  # and so do beads on strings
        approach = swinging_speed(chain, velocity, overlap)
    found, apart = max(approach, _released_speed(chain, overlap)), high - low
    # Forces over time can give at most their largest acceleration times the time.
    if chain.forces:
        until = chain.knots[-1] if duration is None else duration
        found = max(found, min(_given_speed(chain), approach + until * _pull(chain)))
        apart += until * _pull(chain)
    # Steady forces, by pressing on contacts, by acceleration over gaps, or both within the duration.
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
    # All beads move together: any scale will do.
    if not found and high == low:
        return 1.0
    return max(found, LEAST_SCALE * apart, SPEED_ROUND_OFF / tolerance * apart)


def swinging_speed(chain: Chain, velocity: Array, overlap: Array) -> float:
    """Return an upper bound [m/s] of closing speeds on strings, from velocities (n+1,) and overlaps (n,) at any time.

    The difference of two displacements swings with its energy.
    """
    return math.hypot(
        np.ptp(velocity), math.sqrt(chain.swing) * np.ptp(displacement(chain, overlap, rest_of(chain)[1]))
    )


def largest_error(chain: Chain, start: State, end: State) -> Array:
    """Return (n+1,) the largest possible error [m/s] of the velocities of `end`, from momentum and the energy since
    `start`.
    """
    force, passed = start.external(chain), end.time - start.time
    push = np.zeros(len(chain.mass)) if force is None else force
    # Energy does not bound the velocities if walls have different speeds, if forces act over time, or if a wall moves
    # and a bed brakes.
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
    """Return whether every bead velocity can have the error `error` [m/s]. A quick test with the fastest pair of beads
    only.
    """
    pairs = zip(start.rate.tolist(), chain.inverse_reduced_mass.tolist(), strict=True)
    return error <= math.sqrt(max(rate * rate / weight for rate, weight in pairs)) * _least_share(chain)


@per_chain
def _least_share(chain: Chain) -> float:
    """Return the smallest sqrt(1/m - 1/M), as in `velocity_room`."""
    total = math.inf if chain.walls or chain.takes_momentum else sum(chain.mass)
    heaviest = max(mass for mass in chain.mass if mass < math.inf)
    return math.sqrt(max(1.0 / heaviest - 1.0 / total, 0.0))


def velocity_room(
    mass: Array, on_bed: NDArray[np.bool_], velocity: Array, stored: Array, push: Array, passed: Any
) -> tuple[Array, Array]:
    """Return (..., n+1) the mean velocity of all beads after `passed` (...) [s], and the largest possible distance
    [m/s] from it.

    Beads with the energy E relative to their mean velocity deviate from it by at most sqrt(2 E (1/m - 1/M)), where M is
    the total mass, infinite with a wall or a bed. Forces `push` (..., n+1) [N] add at most t sqrt(sum f²/m) to sqrt(2
    E). `stored` (...) is the energy [J] of the contacts at the start.
    """
    walls = np.isinf(mass)
    finite, inverse = np.where(walls, 0.0, mass), 1.0 / mass
    held = walls.any(axis=-1) | on_bed
    # The mean velocity is that of the walls if there are any, otherwise that of the centre of mass.
    total = np.where(held, np.inf, finite.sum(axis=-1))
    first = np.take_along_axis(velocity, walls.argmax(axis=-1)[..., None], -1)[..., 0] * walls.any(axis=-1)
    mean = np.where(held, first, (finite * velocity).sum(axis=-1) / total)[..., None]
    pull = ((inverse > 0.0) * push).sum(axis=-1) / total
    # Energy relative to the mean, and what forces can add to its square root.
    energy = 0.5 * (finite * (velocity - mean) ** 2).sum(axis=-1) + stored
    given = passed * np.sqrt((inverse * (push - finite * pull[..., None]) ** 2).sum(axis=-1))
    room = (np.sqrt(2.0 * energy) + given)[..., None] * np.sqrt(np.maximum(inverse - 1.0 / total[..., None], 0.0))
    return mean + (passed * pull)[..., None] * np.ones_like(mass), room


def _released_speed(chain: Chain, overlap: Array) -> float:
    """Return the largest speed [m/s] at which a contact compressed to `overlap` drives its two beads apart; 0 without
    such contacts.
    """
    if not max(overlap.tolist()) > 0.0:
        return 0.0
    return float(np.sqrt(2.0 * chain.stored_energy(overlap, powers) * chain.inverse_reduced_mass).max())


def _fall_speed(chain: Chain, forces: Array, overlap: Array) -> float:
    """Return the largest speed [m/s] at which beads meet after closing all gaps, starting from rest, under one of the
    `forces` (K, n+1) [N].
    """
    gaps = float(-np.minimum(overlap, 0.0).sum())
    if gaps == 0.0:
        return 0.0
    return math.sqrt(2.0 * max(map(_approach, (forces * chain.inverse_mass).tolist())) * gaps)


def _driven_speed(chain: Chain, forces: Array) -> float:
    """Return the largest speed [m/s] that a contact reaches under the part of one of the `forces` (K, n+1) [N] that it
    passes on.
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
    """Return the largest force (n,) [N] of each contact between rigid beads, starting from rest, under one of the
    `drives` (K, n+1) [N].

    Beads that are driven into each other move on as one body across all gaps: groups of beads are joined while the left
    one accelerates faster.
    """
    walls, greatest = np.isinf(chain.mass), np.zeros(chain.contacts)
    for drive in drives:
        runs: list[tuple[int, float, float]] = []  # number of beads, total drive and mass [kg] of each group
        # Join the beads that are driven into each other to groups with a common acceleration.
        for push, inertia in zip(drive.tolist(), chain.mass, strict=True):
            count, whole, total = 1, push, inertia
            while runs and runs[-1][1] / runs[-1][2] > whole / total:
                more, other, beside = runs.pop()
                count, whole, total = count + more, whole + other, total + beside
            runs.append((count, whole, total))
        # The contact force is the sum of what the beads on its left have left over.
        counts = np.array([count for count, _, _ in runs])
        acceleration = np.repeat([whole / total for _, whole, total in runs], counts)
        left = drive - chain.finite_mass * acceleration  # force that the contacts must take from each bead
        if walls.any():  # a wall holds the group that contains it
            left -= np.where(walls, np.repeat(np.add.reduceat(left, np.cumsum(counts) - counts), counts), 0.0)
        passed = np.cumsum(left)[:-1]
        greatest = np.maximum(greatest, np.where(passed > NO_APPROACH * np.abs(drive).sum(), passed, 0.0))
    return greatest


def contact_scales(chain: Chain, velocity: ArrayLike, duration: float | None = None) -> tuple[Array, Array]:
    """Return (n,) estimates of largest overlap [m] and contact time [s] if each contact were struck alone, within
    `duration` [s].

    The energy balance ``F d + K d**(1+a)/(1+a) = mu v**2 / 2`` with the reduced mass mu is approximated by the smaller
    of its two one-term solutions; for user-defined laws their energy is used. The time is that of moving over this
    overlap and back at the closing speed.
    """
    return scales_at(chain, speed_scale(chain, velocity, duration))


def struck_depth(preload: Array, stiffness: Array, exponent: Array, energy: Array | float) -> Array:
    """Return the overlaps [m], any shape, at which contacts store `energy` [J]: the smaller of the two one-term
    solutions.
    """
    with np.errstate(divide="ignore"):
        by_power = powers((1.0 + exponent) * energy / stiffness, 1.0 / (1.0 + exponent))
        return np.minimum(energy / preload, by_power)


def scales_at(chain: Chain, speed: float) -> tuple[Array, Array]:
    """Return (n,) overlaps [m] and times [s] of contacts that are struck alone at `speed` [m/s]."""
    energy = 0.5 * speed * speed / chain.inverse_reduced_mass
    preload, stiffness, exponent = chain.law_rows.T
    depth = struck_depth(preload, stiffness, exponent, energy)
    for i, law in chain.own_contacts:
        depth[i] = law.depth(float(energy[i]))
    # Time over the overlap and back; a stop shortens it to half a period of its spring.
    times = 2.0 * depth / speed
    for i, contact in chain.piecewise:
        if contact.stop_stiffness:
            times[i] = min(times[i], math.pi / math.sqrt(contact.stop_stiffness * chain.inverse_reduced_mass[i]))
    pulling = as_it_pulls(chain)
    return depth, times if pulling is None else np.minimum(times, scales_at(pulling, speed)[1])


def shortest_contact(chain: Chain, speed: float, start: ArrayLike | None = None) -> float:
    """Return the time [s] of the shortest contact of the chain at the closing speed `speed` [m/s].

    If the start velocities (n+1,) [m/s] are given, contacts that stay touching during the whole motion do not count.
    """
    times = scales_at(chain, speed)[1]
    return float((times if start is None else times[~stays_touching(chain, start)]).min())


def stays_touching(chain: Chain, velocity: ArrayLike) -> NDArray[np.bool_]:
    """Return (n,) whether each contact surely stays touching during the motion from the start of `chain` with
    velocities (n+1,) [m/s].

    Without external forces, a contact with preload that touches at the start passes on at most the largest force of the
    moving contacts. So it never yields if its preload is larger than any force that these contacts reach with all the
    energy.
    """
    speeds, stays = np.asarray(velocity, dtype=np.float64), np.zeros(chain.contacts, dtype=np.bool_)
    walls = np.isinf(chain.mass)
    if chain.driven or chain.on_bed or chain.piecewise or chain.own_laws or np.unique(speeds[walls]).size > 1:
        return stays
    # All the energy in the frame of the centre of mass, or of the walls.
    mass = chain.finite_mass
    mean = float(speeds[walls][0]) if walls.any() else float(speeds @ mass / mass.sum())
    overlap, preload, stiffness, exponent = -np.array(chain.gap), *chain.law_rows.T
    energy = 0.5 * float(mass @ (speeds - mean) ** 2) + float(chain.stored_energy(overlap, powers).sum())
    if energy == 0.0:
        return stays
    greatest = preload + stiffness * powers(struck_depth(preload, stiffness, exponent, energy), exponent)
    # Remove contacts whose preload another contact can exceed, until nothing changes.
    stays = (overlap == 0.0) & (np.diff(speeds) == 0.0) & (preload > 0.0)
    while stays.any():
        held = stays & (preload > greatest[~stays].max(initial=0.0))
        if (held == stays).all():
            break
        stays = held
    return stays & (not stays.all())


@per_chain
def as_it_pulls(chain: Chain) -> Chain | None:
    """Return the chain with the pulling gear in place of each contact that pulls; None if no contact pulls."""
    if not chain.pulls:
        return None
    contacts = list(chain.contact)
    for i, contact in chain.piecewise:
        gear = (contact.pulling or contact.pushing)[0]
        contacts[i] = Contact(gear.preload, gear.stiffness, gear.exponent, gear.loss)
    return Chain(chain.mass, contacts)


def default_step(chain: Chain, velocity: ArrayLike, duration: float | None = None, touching: bool = False) -> float:
    """Return the default step [s] of a fixed-step method: a thousandth of the shortest contact time within `duration`.

    With bed friction or brakes it is at most a hundredth of the time in which they stop a bead. `touching` is True for
    a whole motion with a method that keeps touching contacts closed: then contacts that stay touching do not count.
    """
    return step_at(chain, speed_scale(chain, velocity, duration), velocity if touching else None)


def step_at(chain: Chain, speed: float, start: ArrayLike | None = None) -> float:
    """Return the `default_step` [s] at the closing speed `speed` [m/s]; `start` as in :func:`shortest_contact`."""
    shortest = shortest_contact(chain, speed, start) / DEFAULT_STEPS_A_CONTACT
    strongest = max(chain.bed.tolist(), default=0.0)
    return min(shortest, speed / strongest / DEFAULT_STEPS_A_STOP) if strongest else shortest


@per_chain
def _computable_speeds(chain: Chain) -> tuple[float, float]:
    """Return limits of the speed scale [m/s] between which all contact depths can surely be computed.

    With user-defined laws the range is empty, so that their depths are always checked one by one. At a depth d below 1
    m, a contact stores at most the larger of its preload and stiffness times d; at depths up to MOST_DEPTH at least
    that.
    """
    if chain.own_laws:
        return math.inf, 0.0
    strength = list(map(max, *chain.law_rows.T[:2].tolist()))
    weight = chain.inverse_reduced_mass.tolist()
    least = math.sqrt(2.0 * max(weight) * max(strength) * LEAST_DEPTH)
    return max(SMALLEST, least), math.sqrt(2.0 * min(weight) * min(strength) * MOST_DEPTH)


def require_computable(chain: Chain, velocity: ArrayLike, duration: float | None = None) -> None:
    """Raise ValueError if a contact would be pressed so little or so far that powers of the overlap leave the range of
    floats.
    """
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
    # The quick range excludes the motion: check each contact.
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
