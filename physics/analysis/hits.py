"""Table of the hits of a motion: begin, end, impulse, closing speed, largest force and dissipated energy of each
contact.

The values do not come from the stored samples. The motion is computed again with samples at the contact times. Then the
motion is computed once more with samples at the turning points of the overlaps. Every value is therefore as accurate as
the run itself.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.contact import Contact
from softcradle.physics.coupler import Coupler
from softcradle.physics.hit_table import TYPE
from softcradle.physics.simulation import solve
from softcradle.physics.status import Status
from softcradle.physics.trajectory import Trajectory

Array = NDArray[np.float64]

# Number of samples between two consecutive switches of any contacts. In such an interval, the force curve has few
# turning points.
INSIDE = 12

# Largest number of repeated runs that locate the turning points of overlaps. The secant method converges in three or
# four.
REFINEMENTS = 6

# Largest overlap rate at a located turning point, as a fraction of the largest rate. The relative error of the overlap
# is the square of this fraction.
LOCATED = 1e-5

# Value of the tolerance argument for fixed-step methods, which ignore it.
TOLERANCE = 1e-8

# Largest difference of final velocities between the stored run and the repeated run, as a fraction of the largest
# speed.
SAME_RUN = 1e-5


def hits(trajectory: Trajectory) -> NDArray[np.void]:
    """Return the table of all hits of `trajectory`, sorted by their begin.

    Parameters
    ----------
    trajectory : Trajectory
        Result of :func:`simulate` whose samples begin at t = 0.

    Returns
    -------
    ndarray
        Structured array with the columns contact, begin [s], end [s], impulse [N s], closing_speed [m/s], largest_force
            [N] and
        energy_lost [J]. Without a wall on one side, and without a bed, the impulse follows from the momentum of that
            side.
        Otherwise it is the integral of the force over the samples. `pandas.DataFrame(table)` makes a data frame of it.

    Raises
    ------
    ValueError
        If the samples do not begin at t = 0, if the run gave up, or if the motion cannot be repeated. Only a motion
        that was completely computed by :func:`simulate` can be repeated, not a motion that was played by hand.
    """
    if trajectory.time.size == 0 or trajectory.time[0] != 0.0:
        raise ValueError("hits need the start of the motion: let the samples begin at t = 0")
    if trajectory.status.gave_up:
        raise ValueError("the run gave up before its end: its hits are not known")
    last = float(trajectory.time[-1])
    spans = [
        (begin, contact, end)
        for contact, intervals in enumerate(trajectory.contact_intervals)
        for begin, end in intervals
        if begin <= last
    ]
    table = np.zeros(len(spans), TYPE)
    if not spans:
        return table
    switches = np.array([time for begin, _, end in spans for time in (begin, end)])
    knots = np.unique(np.clip(switches, 0.0, last))
    grid = np.unique(np.concatenate([knots, *_between(knots)]))
    full = _repeated(trajectory, grid)
    for _ in range(REFINEMENTS):
        turns = [_turning_times(full, contact, begin, min(end, last)) for begin, contact, end in spans]
        grid = np.union1d(grid, [time for times in turns for time in times])
        if grid.size == full.time.size:
            break
        full = _repeated(trajectory, grid)
    for row, (begin, contact, end) in zip(table, sorted(spans), strict=True):
        first, final = np.searchsorted(full.time, [begin, min(end, last)])
        part = slice(first, min(final, full.time.size - 1) + 1)
        overlap, force = full.overlap[part, contact], full.force[part, contact]
        deepest = overlap[np.argmax(np.abs(overlap))]
        row["contact"], row["begin"], row["end"] = contact, begin, end
        row["impulse"] = _impulse(full, contact, part)
        row["closing_speed"] = full.rate[first, contact]
        # A sample at the peak of a contact with loss may already contain the smaller force of unloading.
        row["largest_force"] = max((*force, float(trajectory.chain.contact[contact].force(float(deepest)))), key=abs)
        row["energy_lost"] = _energy_lost(trajectory.chain, contact, overlap)
    return table


def _between(knots: Array) -> list[Array]:
    """Return sample times between neighbouring `knots`. The times are denser near both ends of an interval, because
    forces of soft contacts jump at the ends.
    """
    share = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, INSIDE) / INSIDE)
    return [begin + (end - begin) * share for begin, end in pairwise(knots)]


def _repeated(trajectory: Trajectory, times: Array) -> Trajectory:
    """Solve the same motion with samples at `times`."""
    duration = None if trajectory.status is Status.SEPARATED else float(trajectory.time[-1])
    step, tolerance = trajectory.step or None, trajectory.tolerance or TOLERANCE
    run = solve(trajectory.chain, trajectory.velocity[0], duration, trajectory.method, step, times, tolerance)
    speed = np.abs(trajectory.velocity).max(initial=0.0, where=np.isfinite(trajectory.velocity))
    known = np.nan_to_num(trajectory.velocity_error).max(initial=0.0)
    if not np.abs(run.final_velocity - trajectory.final_velocity).max() <= max(SAME_RUN * speed, 10.0 * known):
        raise ValueError("this motion cannot be computed again from its start: it was played or edited by hand")
    return run


def _turning_times(run: Trajectory, contact: int, begin: float, end: float) -> list[float]:
    """Return improved times for turning points of the overlap that are not located yet, within one hit.

    A contact without loss needs only the time of the largest absolute overlap. With loss, every turning point separates
    loading from unloading.
    """
    first, last = np.searchsorted(run.time, [begin, end])
    time, rate = run.time[first : last + 1], run.rate[first : last + 1, contact]
    turns = np.flatnonzero(rate[:-1] * rate[1:] < 0.0)
    if not any(_losses(run.chain.contact[contact])):
        peak = int(np.argmax(np.abs(run.overlap[first : last + 1, contact])))
        turns = turns[(turns == peak) | (turns + 1 == peak)]
    found = []
    for k in turns.tolist():
        near, far = (k, k + 1) if abs(rate[k]) <= abs(rate[k + 1]) else (k + 1, k)
        if abs(rate[near]) <= LOCATED * np.abs(rate).max():
            continue
        # The slope of the rate jumps at the turning point of a contact with loss. Therefore extrapolate from one side
        # only.
        beyond = 2 * near - far
        if not (0 <= beyond < time.size and rate[beyond] * rate[near] > 0.0 and rate[beyond] != rate[near]):
            beyond = far
        slope = (rate[beyond] - rate[near]) / (time[beyond] - time[near])
        share = float(np.clip(-rate[near] / (slope * (time[far] - time[near])), 0.001, 0.999))
        found.append(float(time[near] + (time[far] - time[near]) * share))
    return found


def _impulse(run: Trajectory, contact: int, part: slice) -> float:
    """Return the momentum [N s] that `contact` transmitted to the bead on its right during the samples `part`."""
    chain, mass = run.chain, np.asarray(run.chain.mass)
    time = run.time[part]
    for side, sign in ((slice(contact + 1, None), 1.0), (slice(None, contact + 1), -1.0)):
        if np.isfinite(mass[side]).all() and not chain.takes_momentum:
            gained = mass[side] @ (run.velocity[part][-1, side] - run.velocity[part][0, side])
            return sign * float(gained - _external(chain, side, float(time[0]), float(time[-1])))
    return float(np.trapezoid(run.force[part, contact], time))


def _external(chain: Chain, side: slice, begin: float, end: float) -> float:
    """Return the impulse [N s] of the drive and of forces over time on the beads of `side`."""
    total = 0.0 if chain.drive_force is None else float(chain.drive_force[side].sum()) * (end - begin)
    beads = set(range(*side.indices(chain.contacts + 1)))
    for force in chain.forces:
        total += len(beads & set(force.beads)) * float(force.impulse(end) - force.impulse(begin))
    return total


def _energy_lost(chain: Chain, contact: int, overlap: Array) -> float:
    """Return the dissipated energy [J] of a contact.

    Each decrease of the stored energy is multiplied by the loss of the gear that acts at this time.
    """
    losses = _losses(chain.contact[contact])
    if not any(losses):
        return 0.0
    rows = np.zeros((overlap.size, chain.contacts))
    rows[:, contact] = overlap
    stored = chain.stored_energy(rows)[:, contact]
    released = np.maximum(stored[:-1] - stored[1:], 0.0)
    pushed = overlap[:-1] > 0.0
    return math.fsum(np.where(pushed, losses[0], losses[1]) * released)


def _losses(law: object) -> tuple[float, float]:
    """Return two losses of a contact: for pushing and for pulling."""
    if isinstance(law, Coupler):
        return law.push.loss, law.pull.loss if law.pull else 0.0
    return (law.loss if isinstance(law, Contact) else 0.0), 0.0
