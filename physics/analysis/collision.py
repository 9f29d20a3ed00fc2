"""Measures of a collision: rigidity of the struck cluster, restitution, energy left inside, and a table of the
contacts.

The measures are fields of dataclasses. The metadata of each field contains its title, unit and meaning.

The struck contact lies between the strikers on its left and the target cluster on its right. *Detachment* is the last
opening of the struck contact. The paper writes "the detachment of the hitting particle", after which "the finite
overlaps ... cause the velocity divergence among the cluster particles". A wall belongs to one side of the struck
contact, but not to the cluster on this side.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.analysis.closed_forms import speed_ratio
from softcradle.physics.analysis.measures import (
    chain_spread_variable,
    dwell,
    energy_inside,
    impulses,
    interpolated,
    penetration_depth,
    restitution,
    rigidity,
    target_beads,
)
from softcradle.physics.analysis.ringing import ringing
from softcradle.physics.chain import Chain, accelerated_mass
from softcradle.physics.checked_input import finite_or_none
from softcradle.physics.methods import refusal_of
from softcradle.physics.simulation import simulate
from softcradle.physics.trajectory import Trajectory

Array = NDArray[np.float64]

# Smallest number of samples in each contact. With 31 samples, the largest force is accurate to 0.1 %.
WITHIN_CONTACT = 31


def _measure(title: str, unit: str, meaning: str, dissipative: bool = False) -> Any:
    """Return a dataclass field for one measure, with its title, unit and meaning.

    A `dissipative` measure is only meaningful in a motion with dissipation.
    """
    return field(metadata={"title": title, "unit": unit, "meaning": meaning, "dissipative": dissipative})


@dataclass(frozen=True)
class ContactMeasures:
    """Measures of one contact. ``fields`` returns the title, unit and meaning of each number as metadata.

    The accelerated mass is None if it includes a wall. The force per mass is then None as well.
    """

    peak_force: float = _measure("peak force", "N", "greatest force")
    accelerated_mass: float | None = _measure(
        "mass accelerated", "kg", "of the beads beyond it, seen from the struck contact, Eq. (5)"
    )
    peak_acceleration: float | None = _measure(
        "force per mass",
        "m/s²",
        "peak force over the mass accelerated: the common A of Eq. (5), one number for all contacts of a rigid cluster",
    )
    momentum: float = _measure("momentum passed", "N s", 'integral of the force over time; "the flow rate of momentum"')
    open: float = _measure(
        "open", "s", "for how long apart, from the first touch of the struck contact to the end of the run"
    )
    touching: float = _measure(
        "touching", "s", "for how long at overlap 0 with a force between 0 and the preload, Eq. (C1)"
    )
    loaded: float = _measure("loaded", "s", "for how long at overlaps > 0")
    transmitted: float | None = _measure(
        "transmitted", "", "momentum passed over that of the beads before it at the start; the rest is reflected"
    )
    turns: int = _measure("turns", "", "turning points of the force while it acts: 1 where nothing rings")
    ringing_period: float | None = _measure(
        "ringing period", "s", "mean time between every other turning point, from four of them on"
    )
    ringing_amplitude: float | None = _measure(
        "ringing amplitude", "N", "largest distance of a turning point from the mean of its neighbours, halved"
    )
    ringing_decay: float | None = _measure(
        "ringing decay", "1/s", "rate at which the logarithm of that distance falls; negative where it grows"
    )


@dataclass(frozen=True)
class CollisionMeasures:
    """Measures of one collision. ``fields`` returns the title, unit and meaning of each number as metadata.

    A number is None if it is not defined. Reasons are a division by a mean of 0, a collision without detachment, and a
    side that consists only of a wall.

    Attributes:
        struck: index of the contact between strikers and targets.
        final_velocity: final velocity of every bead.
        contacts: measures of each contact, from left to right.
    """

    struck: int
    final_velocity: tuple[float, ...] = _measure("final velocities", "m/s", "of the beads, from left to right")
    rigidity_at_detachment: float | None = _measure(
        "rigidity at detachment",
        "",
        "velocity spread of the target cluster (largest less smallest) over its mean at detachment; 0 for a rigid body",
    )
    rigidity: float | None = _measure(
        "rigidity at the end",
        "",
        'the same when all is over: "the finite overlaps ... cause the velocity divergence among the cluster particles"',
    )
    restitution: float | None = _measure(
        "restitution of the striker",
        "",
        "speed at which the centres of mass of strikers and targets part at detachment over that at which they met: 1 for "
        "two rigid bodies; in an elastic collision 1 less its square is the share of the energy of approach left inside",
    )
    energy_inside_at_detachment: float | None = _measure(
        "energy inside at detachment",
        "",
        "share of the energy at the start that is inside the target cluster: what its contacts store and the motion of "
        'its beads about their centre of mass; "only in the limit alpha -> +0 ... the target cluster does not accumulate '
        'the compressive energies during the collision"',
    )
    energy_inside: float | None = _measure("energy inside at the end", "", "the same when all is over")
    momentum_deficit: float | None = _measure(
        "deficit of momentum",
        "",
        '"the relative deficits in the momentum and energy upon collision": share of the momentum at the first touch of '
        "the struck contact that is missing at detachment",
        dissipative=True,
    )
    energy_deficit: float | None = _measure("deficit of energy", "", "the same of the kinetic energy", dissipative=True)
    absorbed_by_contacts: float | None = _measure(
        "absorbed by contacts",
        "",
        "share of the energy at the start that contacts with loss have taken",
        dissipative=True,
    )
    absorbed_by_bed: float | None = _measure(
        "absorbed by the bed", "", "the same by friction on the bed", dissipative=True
    )
    detachment: float | None = _measure("detachment", "s", "time of the last opening of the struck contact")
    contact_time: float | None = _measure(
        "contact time", "s", "for how long the struck contact was closed; the paper's tau_dur"
    )
    peak_force: float = _measure("peak force", "N", "greatest force of the struck contact")
    peak_acceleration: float | None = _measure(
        "peak force per mass", "m/s²", "the same over the mass that it accelerates, the target cluster"
    )
    momentum: float = _measure("momentum passed", "N s", "by the struck contact")
    speed_ratio: float | None = _measure(
        "speed over critical", "", "of draft gears, V/v_c: up to 1 both clusters stay exactly rigid"
    )
    speed_margin: float | None = _measure(
        "margin", "", "1 less that: how far below the critical speed, negative above it"
    )
    spread_variable: float | None = _measure(
        "spread variable",
        "",
        "of one bead on n alike, (n+1) exp(-1/(2 n alpha)): where it is equal, so is the rigidity at the end",
    )
    penetration_depth: float | None = _measure(
        "penetration depth",
        "",
        "contacts over which the overlap falls by a factor e inside the target cluster: n alpha at most for beads alike that "
        "just touch",
    )
    contacts: tuple[ContactMeasures, ...] = ()


def struck_contact(velocity: ArrayLike) -> int:
    """Return the index of the contact whose beads approach each other fastest at the start.

    `velocity` (n+1,) [m/s] contains the start velocities.

    Raises:
        ValueError: if no neighbours approach each other.

    >>> struck_contact([1.0, 1.0, 0.0, 0.0])
    1
    """
    closing = -np.diff(np.asarray(velocity, dtype=np.float64))
    if not (closing > 0.0).any():
        raise ValueError("no two neighbours approach each other at the start: there is no collision to measure")
    return int(np.argmax(closing))


def collide(
    chain: Chain,
    velocity: ArrayLike,
    duration: float | None = None,
    method: str | None = None,
    step: float | None = None,
    tolerance: float = 1e-9,
    samples: int = 2001,
    run: Callable[..., Trajectory] = simulate,
) -> Trajectory:
    """Run `simulate` with the samples that :func:`measured` needs.

    The sample times are evenly spaced times, the times of all contact switches, and additional times in short contacts.
    If `method` is None, the method is "accurate" if it supports the chain, otherwise "conserving". Python's warnings
    are not thread-safe: pass `solve` as `run` in threads.
    """
    if method is None:
        method = "conserving" if refusal_of("accurate", chain) else "accurate"
    first = run(chain, velocity, duration, method, step, 2, tolerance)
    end = float(first.time[-1]) if duration is None else duration
    spans = np.array([span for of_contact in first.contact_intervals for span in of_contact]).reshape(-1, 2)
    switches = spans[spans <= end]
    closed = np.linspace(switches.min(), switches.max(), samples) if switches.size else switches
    times = np.concatenate((np.linspace(0.0, end, samples), closed, switches, _inside_short(spans, end, samples)))
    times = np.unique(times)
    return run(chain, velocity, duration, method, step, times, tolerance)


def _inside_short(spans: Array, end: float, samples: int) -> Array:
    """Return sample times inside those contact intervals `spans` (K, 2) [s] that evenly spaced samples would miss.

    The evenly spaced samples reach up to the time `end`. The function returns about `samples` times in total.
    """
    last = np.minimum(spans[:, 1], end)
    length = last - spans[:, 0]
    short = (length > 0.0) & (length < WITHIN_CONTACT * end / samples)
    if not short.any():
        return np.zeros(0)
    count = min(max(samples // int(short.sum()), 1), WITHIN_CONTACT)
    return np.linspace(spans[short, 0], last[short], count + 2)[1:-1].ravel()


def measured(trajectory: Trajectory) -> CollisionMeasures:
    """Return the measures of a collision. Values at the detachment are interpolated between samples (see
    :func:`collide`).

    Raises
    ------
    ValueError
        If no two neighbours approach each other at the start.
    """
    struck = struck_contact(trajectory.velocity[0])
    intervals = trajectory.contact_intervals[struck]
    opened = intervals[-1][1] if intervals and math.isfinite(intervals[-1][1]) else None
    targets = target_beads(trajectory.chain, struck)
    inside = energy_inside(trajectory, struck)
    deficits = _deficits(trajectory, intervals[0][0], opened) if opened is not None else (None, None)
    whole = float(trajectory.kinetic_energy[0] + trajectory.contact_energy[0]) or math.nan
    contacts = tuple(_contact_measures(trajectory, struck))
    own = contacts[struck]
    speed = -float(np.diff(trajectory.velocity[0])[struck])
    ratio = speed_ratio(trajectory.chain, struck, speed)
    return CollisionMeasures(
        struck=struck,
        final_velocity=tuple(trajectory.final_velocity.tolist()),
        detachment=opened,
        contact_time=None if opened is None else sum(end - start for start, end in intervals),
        rigidity_at_detachment=None
        if opened is None
        else _rigidity(interpolated(trajectory, trajectory.velocity, opened)[targets]),
        rigidity=_rigidity(trajectory.final_velocity[targets]),
        restitution=None if opened is None else restitution(trajectory, struck, intervals[0][0], opened),
        energy_inside_at_detachment=None
        if opened is None
        else finite_or_none(interpolated(trajectory, inside, opened)),
        energy_inside=finite_or_none(inside[-1]),
        momentum_deficit=deficits[0],
        energy_deficit=deficits[1],
        absorbed_by_contacts=finite_or_none(trajectory.absorbed_by_contacts[-1] / whole),
        absorbed_by_bed=finite_or_none(trajectory.absorbed_by_bed[-1] / whole),
        peak_force=own.peak_force,
        peak_acceleration=own.peak_acceleration,
        momentum=own.momentum,
        speed_ratio=ratio,
        speed_margin=None if ratio is None else 1.0 - ratio,
        spread_variable=chain_spread_variable(trajectory.chain, struck),
        penetration_depth=penetration_depth(trajectory, struck) or None,
        contacts=contacts,
    )


def _contact_measures(trajectory: Trajectory, struck: int) -> list[ContactMeasures]:
    accelerated = accelerated_mass(trajectory.chain.mass, struck)
    peak, passed, times = trajectory.force.max(axis=0), impulses(trajectory, struck), dwell(trajectory, struck)
    heard = [ringing(trajectory.time, force) for force in trajectory.force.T]
    mass = np.array(trajectory.chain.mass)
    incident = np.cumsum(np.where(np.isfinite(mass), mass, math.nan) * trajectory.velocity[0])[:-1]
    return [
        ContactMeasures(
            peak_force=float(peak[k]),
            accelerated_mass=finite_or_none(accelerated[k]),
            peak_acceleration=float(peak[k] / accelerated[k]) if math.isfinite(accelerated[k]) else None,
            momentum=float(passed[k]),
            open=float(times[k, 0]),
            touching=float(times[k, 1]),
            loaded=float(times[k, 2]),
            transmitted=finite_or_none(passed[k] / incident[k]) if incident[k] > 0.0 else None,
            turns=heard[k].turns,
            ringing_period=heard[k].period,
            ringing_amplitude=heard[k].amplitude,
            ringing_decay=heard[k].decay,
        )
        for k in range(trajectory.chain.contacts)
    ]


def _deficits(trajectory: Trajectory, touched: float, opened: float) -> tuple[float | None, float | None]:
    """Return the relative losses of momentum and of kinetic energy between the times `touched` and `opened` [s]."""
    found = []
    for values in (trajectory.momentum, trajectory.kinetic_energy):
        before, after = (float(interpolated(trajectory, values, time)) for time in (touched, opened))
        found.append(1.0 - after / before if before else None)
    return found[0], found[1]


def _rigidity(velocity: Array) -> float | None:
    return finite_or_none(rigidity(velocity)) if velocity.size else None
