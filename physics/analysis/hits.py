"""Table of the hits of a motion: begin, end, impulse, closing speed, largest force and dissipated energy of each contact.

The values do not come from the stored samples. The motion is computed again with samples at the located contact times, and once
more at the largest overlaps, so every value is as accurate as the run itself.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.contact import Contact
from softcradle.physics.coupler import Coupler
from softcradle.physics.simulation import solve
from softcradle.physics.status import Status
from softcradle.physics.trajectory import Trajectory

Array = NDArray[np.float64]

# Columns of the table, with their units.
COLUMNS = {
    "contact": "index of the contact",
    "begin": "time at which the contact closes [s]",
    "end": "time at which it opens, or inf if it stays closed [s]",
    "impulse": "momentum passed from the left bead to the right one [N s]",
    "closing_speed": "overlap rate at the begin [m/s]",
    "largest_force": "largest force, negative for a pull [N]",
    "energy_lost": "energy dissipated by the contact [J]",
}
TYPE = np.dtype([(name, np.int64 if name == "contact" else np.float64) for name in COLUMNS])

# Samples between two switches of any contact. The force curve of such a part has few turning points.
INSIDE = 12

# Most repetitions of a motion that locate the largest overlaps. Secant steps converge in three or four.
REFINEMENTS = 6

# A largest overlap is located if its rate is below this fraction of the largest rate. Its error is then the square of that.
LOCATED = 1e-5

# Tolerance argument for fixed-step methods, which ignore it.
TOLERANCE = 1e-8

# Largest difference of final velocities between the stored and the repeated run, as a fraction of the largest speed.
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
        Structured array with the columns contact, begin [s], end [s], impulse [N s], closing_speed [m/s], largest_force [N] and
        energy_lost [J]. Without a wall on one side, and without a bed, the impulse follows from the momentum of that side.
        Otherwise it is the integral of the force over the samples. `pandas.DataFrame(table)` makes a data frame of it.

    Raises
    ------
    ValueError
        If the samples do not begin at t = 0, if the run gave up, or if the motion was not computed by :func:`simulate` alone, so
        that it cannot be repeated (a motion played by hand).
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
        peaks = [_peak_time(full, contact, begin, min(end, last)) for begin, contact, end in spans]
        grid = np.union1d(grid, [time for time in peaks if time is not None])
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
        # a sample at the peak of a contact with loss may have the smaller force of unloading already
        row["largest_force"] = max((*force, float(trajectory.chain.contact[contact].force(float(deepest)))), key=abs)
        row["energy_lost"] = _energy_lost(trajectory.chain, contact, overlap)
    return table


def _between(knots: Array) -> list[Array]:
    """Return sample times between neighbouring `knots`, denser at both ends, where forces of soft contacts jump."""
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


def _peak_time(run: Trajectory, contact: int, begin: float, end: float) -> float | None:
    """Return a better time of the largest |overlap| in a contact, between the samples around it; None if it is located."""
    first, last = np.searchsorted(run.time, [begin, end])
    time, rate = run.time[first : last + 1], run.rate[first : last + 1, contact]
    k = int(np.argmax(np.abs(run.overlap[first : last + 1, contact])))
    if abs(rate[k]) <= LOCATED * np.abs(rate).max():
        return None
    for other, beyond in ((k - 1, k + 1), (k + 1, k - 1)):
        if min(other, beyond) >= 0 and max(other, beyond) < time.size and rate[k] * rate[other] < 0.0:
            # The slope of the rate jumps at the peak of a contact with loss. So extrapolate the rate from one side of it only.
            slope = (rate[beyond] - rate[k]) / (time[beyond] - time[k])
            share = float(np.clip(-rate[k] / (slope * (time[other] - time[k])), 0.001, 0.999))
            return float(time[k] + (time[other] - time[k]) * share)
    return None


def _impulse(run: Trajectory, contact: int, part: slice) -> float:
    """Return the momentum [N s] that `contact` passed to its right bead during the samples `part`."""
    chain, mass = run.chain, np.asarray(run.chain.mass)
    time = run.time[part]
    for side, sign in ((slice(contact + 1, None), 1.0), (slice(None, contact + 1), -1.0)):
        if np.isfinite(mass[side]).all() and not chain.on_bed:
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
    """Return the dissipated energy [J]: the loss of the gear that acts, times each decrease of the stored energy."""
    law = chain.contact[contact]
    losses = (law.push.loss, law.pull.loss if law.pull else 0.0) if isinstance(law, Coupler) else (_loss(law), 0.0)
    if not any(losses):
        return 0.0
    rows = np.zeros((overlap.size, chain.contacts))
    rows[:, contact] = overlap
    stored = chain.stored_energy(rows)[:, contact]
    released = np.maximum(stored[:-1] - stored[1:], 0.0)
    pushed = overlap[:-1] > 0.0
    return math.fsum(np.where(pushed, losses[0], losses[1]) * released)


def _loss(law: object) -> float:
    return law.loss if isinstance(law, Contact) else 0.0
