"""Measures of a collision: rigidity of the struck cluster, restitution, energy left inside, and what each contact did.

The beads before the struck contact are the strikers, those behind it the target cluster. *Detachment* is the last
opening of the struck contact: "the detachment of the hitting particle", after which "the finite overlaps ... cause the
velocity divergence among the cluster particles". Walls belong to a side, but not to its cluster.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.analysis.cluster_scaling import chain_spread_variable, penetration_depth
from softcradle.physics.analysis.collision_measures import CollisionMeasures, ContactMeasures
from softcradle.physics.analysis.critical_speed import speed_ratio
from softcradle.physics.analysis.measures import (
    cluster_beads,
    dwell,
    energy_inside,
    impulses,
    interpolated,
    restitution,
    rigidity,
)
from softcradle.physics.analysis.ringing import ringing
from softcradle.physics.chain import Chain, accelerated_mass
from softcradle.physics.methods import find_method
from softcradle.physics.simulation import simulate
from softcradle.physics.trajectory import Trajectory

Array = NDArray[np.float64]


def struck_contact(velocity: ArrayLike) -> int:
    """The contact across which neighbours approach each other fastest at the start, from `velocity` (n+1,) [m/s].

    Raises:
        ValueError: none approach each other.

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
    """`simulate` with the samples that :func:`measured` needs: even ones, more while contacts are closed, and switches.

    `method` None is "accurate" where that carries the chain, else "conserving". `run` is `simulate`, or `solve` in threads,
    for which Python's warnings are not.
    """
    if method is None:
        method = "conserving" if chain.dissipative and not find_method("accurate").dissipative else "accurate"
    first = run(chain, velocity, duration, method, step, 2, tolerance)
    end = float(first.time[-1]) if duration is None else duration
    switches = np.array([t for spans in first.contact_intervals for span in spans for t in span])
    switches = switches[switches <= end]
    closed = np.linspace(switches.min(), switches.max(), samples) if switches.size else switches
    times = np.unique(np.concatenate((np.linspace(0.0, end, samples), closed, switches)))
    return run(chain, velocity, duration, method, step, times, tolerance)


def measured(trajectory: Trajectory) -> CollisionMeasures:
    """The measures of a collision; values at detachment are interpolated between samples (see :func:`collide`).

    Raises
    ------
    ValueError
        No two neighbours approach each other at the start.
    """
    struck = struck_contact(trajectory.velocity[0])
    intervals = trajectory.contact_intervals[struck]
    opened = intervals[-1][1] if intervals and math.isfinite(intervals[-1][1]) else None
    targets = slice(struck + 1, None)
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
        else _rigidity(trajectory.chain, targets, interpolated(trajectory, trajectory.velocity, opened)),
        rigidity=_rigidity(trajectory.chain, targets, trajectory.final_velocity),
        restitution=None if opened is None else restitution(trajectory, struck, intervals[0][0], opened),
        energy_inside_at_detachment=None if opened is None else _finite(interpolated(trajectory, inside, opened)),
        energy_inside=_finite(inside[-1]),
        momentum_deficit=deficits[0],
        energy_deficit=deficits[1],
        absorbed_by_contacts=_finite(trajectory.absorbed_by_contacts[-1] / whole),
        absorbed_by_bed=_finite(trajectory.absorbed_by_bed[-1] / whole),
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
            accelerated_mass=_finite(accelerated[k]),
            peak_acceleration=float(peak[k] / accelerated[k]) if math.isfinite(accelerated[k]) else None,
            momentum=float(passed[k]),
            open=float(times[k, 0]),
            touching=float(times[k, 1]),
            loaded=float(times[k, 2]),
            transmitted=_finite(passed[k] / incident[k]) if incident[k] > 0.0 else None,
            turns=heard[k].turns,
            ringing_period=heard[k].period,
            ringing_amplitude=heard[k].amplitude,
            ringing_decay=heard[k].decay,
        )
        for k in range(trajectory.chain.contacts)
    ]


def _deficits(trajectory: Trajectory, touched: float, opened: float) -> tuple[float | None, float | None]:
    """Shares of momentum and of kinetic energy at `touched` that are missing at `opened` [s]."""
    found = []
    for values in (trajectory.momentum, trajectory.kinetic_energy):
        before, after = (float(interpolated(trajectory, values, time)) for time in (touched, opened))
        found.append(1.0 - after / before if before else None)
    return found[0], found[1]


def _rigidity(chain: Chain, side: slice, velocity: Array) -> float | None:
    beads = cluster_beads(chain, side)
    return _finite(rigidity(velocity[beads])) if beads.size else None


def _finite(value: Array | float) -> float | None:
    return float(value) if math.isfinite(value) else None
