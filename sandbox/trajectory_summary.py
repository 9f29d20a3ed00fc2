"""Summary of a trajectory as numbers. Tables and JSON files contain it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from softcradle.physics.checked_input import finite_or_none
from softcradle.sandbox.languages import _
from softcradle.sandbox.story.numbers import fixed, plain, signed

if TYPE_CHECKING:
    from softcradle.physics import Trajectory


PREFIXES = ((1e6, "M"), (1e3, "k"), (1.0, ""))  # Metric prefixes with their sizes, from the largest to the smallest.


@dataclass(frozen=True)
class BeadSummary:
    """Results of one bead.

    Attributes:
        mass: mass [kg]; None for a wall.
        start_velocity: velocity at the start [m/s]; None if the first sample is after the start.
        final_velocity: velocity at the end [m/s]; None if the velocity is infinite or NaN.
        velocity_error: estimated error of the final velocity [m/s]; None if the method does not estimate it (fixed
            steps).
    """

    mass: float | None
    start_velocity: float | None
    final_velocity: float | None
    velocity_error: float | None


@dataclass(frozen=True)
class ContactSummary:
    """Results of one contact.

    Attributes:
        closed, opened: times of the first closing and the last opening [s]; None if the event did not happen.
        times: number of closings.
        still_closed: True if the contact is closed at the end.
        largest_overlap, largest_force: largest sampled overlap [m] and force [N]. None if the numbers of the motion
            became infinite or NaN. None also if the contact closed and opened between two samples.
        largest_pull: largest pulling force of a coupler [N]; 0 for other contacts. None in the same cases as
            `largest_force`.
    """

    closed: float | None
    opened: float | None
    times: int
    still_closed: bool
    largest_overlap: float | None
    largest_force: float | None
    largest_pull: float | None = 0.0


@dataclass(frozen=True)
class Summary:
    """Results of one lane.

    Attributes:
        label: label of the lane.
        beads, contacts: results from left to right.
        end: time of the last sample [s].
        velocity_error: largest estimated error of a velocity [m/s]; None if the method does not estimate errors.
        energy_error: largest change of the energy balance (:attr:`Trajectory.ledger`), relative to the energy at the
            start. In a driven motion (drive, forces, moving walls, pointer or edits), it is relative to the largest
            energy. None if this energy is 0 or the balance is not known.
        energy_error_at_end: the energy error at the end. Errors of explicit methods are largest during the collision.
        momentum_error: largest unexplained change of the momentum, relative to the sum of abs(m v) at the start. In a
            driven motion, it is relative to the largest such sum. None if the sum is 0, or if a wall or the bed
            exchanges momentum.
        absorbed_by_contacts, absorbed_by_bed: energy [J] that contacts with loss and bed friction absorbed until the
            end. None if the numbers of the motion became infinite or NaN.
        method: name of the method.
        step: time step [s]; 0 if the method chooses its steps.
        tolerance: tolerance; 0 if the time step is fixed.
        steps, evaluations, milliseconds: number of time steps, number of force evaluations, and computing time.
        warnings: sentences about possible errors of the results.
        status: reason for the end of the simulation, a name of :class:`softcradle.physics.Status` in lower case.
        choice: method that "auto" chose, with the reason; "" if the user has chosen the method.
        gave_up: True if the simulation stopped before its end. The final velocities are then the velocities at the time
            at which it stopped.
    """

    label: str
    beads: tuple[BeadSummary, ...]
    contacts: tuple[ContactSummary, ...]
    end: float
    velocity_error: float | None
    energy_error: float | None
    energy_error_at_end: float | None
    momentum_error: float | None
    absorbed_by_contacts: float | None
    absorbed_by_bed: float | None
    method: str
    step: float
    tolerance: float
    steps: int
    evaluations: int
    milliseconds: float
    warnings: tuple[str, ...]
    status: str
    choice: str = ""
    gave_up: bool = False


@dataclass(frozen=True)
class ResultTable:
    """Table of results. A table consists of titles with units, rows of texts, and hints about the rows. Terminal, page
    and notebook display it in different ways.
    """

    titles: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    hints: tuple[str, ...] = ()


def bead_table(summary: Summary) -> ResultTable:
    """Return a table with one row for each bead."""
    last = _("velocity when it gave up [m/s]") if summary.gave_up else _("final velocity [m/s]")
    rows = (
        (
            str(i),
            mass_text(bead.mass),
            _speed(bead.start_velocity),
            _speed(bead.final_velocity),
        )
        for i, bead in enumerate(summary.beads)
    )
    return ResultTable((_("bead"), _("mass [kg]"), _("velocity at start [m/s]"), last), tuple(rows))


def mass_text(mass: float | None) -> str:
    """Return the text of a mass [kg] in a table. None and infinity mean a wall."""
    return _("wall") if mass is None or mass == math.inf else plain(mass, 6)


def contact_table(summary: Summary) -> ResultTable:
    """Return a table with one row for each contact."""
    pulls = any(contact.largest_pull for contact in summary.contacts)
    size, prefix = unit_prefix(
        max((size or 0.0 for item in summary.contacts for size in (item.largest_force, item.largest_pull)), default=0.0)
    )
    titles = _("contact"), _("closed [s]"), _("opened [s]"), _("times"), _("largest overlap [m]")
    forces = _("largest force [{unit}]", unit=f"{prefix}N"), *[_("largest pull [{unit}]", unit=f"{prefix}N")] * pulls
    rows = (
        (
            f"{i}-{i + 1}",
            _time(contact.closed),
            _("still closed") if contact.still_closed else _time(contact.opened),
            str(contact.times),
            "-" if contact.largest_overlap is None else signed(f"{contact.largest_overlap:.4g}"),
            in_unit(contact.largest_force, size),
            *[in_unit(contact.largest_pull, size)] * pulls,
        )
        for i, contact in enumerate(summary.contacts)
    )
    return ResultTable((*titles, *forces), tuple(rows))


def unit_prefix(largest: float) -> tuple[float, str]:
    """Return (size, prefix) of the metric prefix for numbers up to `largest`. For example, it is (1000, "k") from 1000
    on.
    """
    return next((size, name) for size, name in PREFIXES if size == 1.0 or largest >= size)


def in_unit(value: float | None, size: float) -> str:
    """Return `value` with six digits, in a unit of this `size`. Return a dash if the value is not known."""
    return "-" if value is None else signed(f"{value / size:.6g}")


def _speed(velocity: float | None) -> str:
    """Return a velocity with eight decimals. Very small and very large velocities have eight significant digits."""
    if velocity is None:
        return "-"
    fits = velocity == 0.0 or 1e-4 <= abs(velocity) < 1e6
    return fixed(velocity, 8) if fits else signed(f"{velocity:.8g}")


def _time(time: float | None) -> str:
    if time is None:
        return _("never")
    return signed(f"{time:.6f}" if time == 0.0 or 1e-3 <= time < 1e6 else f"{time:.6g}")


# Values that are not finite become None. `trajectory.warnings` contains the cause.
@np.errstate(over="ignore", invalid="ignore")
def summarise(label: str, trajectory: Trajectory) -> Summary:
    """Return the summary of the `trajectory` of a lane. The peak values of the summary are the largest samples, so the
    samples must be fine.
    """
    energy = trajectory.ledger
    change = np.abs(energy - energy[0])
    whole = energy + trajectory.driven + trajectory.by_walls
    scale = whole.max() if _is_driven(trajectory) else energy[0]
    return Summary(
        label=label,
        beads=_beads(trajectory),
        contacts=_contacts(trajectory),
        end=float(trajectory.time[-1]),
        velocity_error=finite_or_none(trajectory.velocity_error.max()),
        energy_error=_ratio(change.max(), scale),
        energy_error_at_end=_ratio(change[-1], scale),
        momentum_error=_momentum_error(trajectory),
        absorbed_by_contacts=finite_or_none(trajectory.absorbed_by_contacts[-1]),
        absorbed_by_bed=finite_or_none(trajectory.absorbed_by_bed[-1]),
        method=trajectory.method,
        step=trajectory.step,
        tolerance=trajectory.tolerance,
        steps=trajectory.steps,
        evaluations=trajectory.evaluations,
        milliseconds=1e3 * trajectory.seconds,
        warnings=tuple(map(str, trajectory.warnings)),
        status=trajectory.status.name.lower().replace("_", " "),
        choice=trajectory.choice,
        gave_up=trajectory.status.gave_up,
    )


def _beads(trajectory: Trajectory) -> tuple[BeadSummary, ...]:
    masses = [finite_or_none(mass) for mass in trajectory.chain.mass]
    final, known = map(finite_or_none, trajectory.final_velocity), trajectory.time[0] == 0.0
    start = trajectory.velocity[0].tolist() if known else [None] * len(masses)
    errors = map(finite_or_none, trajectory.velocity_error)
    return tuple(BeadSummary(*numbers) for numbers in zip(masses, start, final, errors, strict=True))


def _contacts(trajectory: Trajectory) -> tuple[ContactSummary, ...]:
    largest = [np.maximum(rows, 0.0).max(axis=0) for rows in (trajectory.overlap, trajectory.force, -trajectory.force)]
    return tuple(map(_contact, trajectory.contact_intervals, *largest))


def _contact(intervals: Sequence[tuple[float, float]], overlap: float, force: float, pull: float) -> ContactSummary:
    unseen = bool(intervals) and overlap == force == pull == 0.0
    return ContactSummary(
        closed=intervals[0][0] if intervals else None,
        opened=max((opened for _, opened in intervals if math.isfinite(opened)), default=None),
        times=len(intervals),
        still_closed=bool(intervals) and math.isinf(intervals[-1][1]),
        largest_overlap=None if unseen else finite_or_none(overlap),
        largest_force=None if unseen else finite_or_none(force),
        largest_pull=None if unseen else finite_or_none(pull),
    )


def _momentum_error(trajectory: Trajectory) -> float | None:
    if trajectory.chain.walls or trajectory.chain.takes_momentum:
        return None
    undriven = trajectory.momentum - trajectory.impulse
    rows = slice(None) if _is_driven(trajectory) else slice(0, 1)
    scale = np.abs(np.array(trajectory.chain.mass) * trajectory.velocity[rows]).sum(axis=1).max()
    return _ratio(np.abs(undriven - undriven[0]).max(), scale)


def _is_driven(trajectory: Trajectory) -> bool:
    """Return True if the chain receives energy from outside. The sources are a drive, forces over time, moving walls,
    the pointer, and edits of a session.
    """
    return trajectory.chain.driven or bool(trajectory.given.any() or trajectory.by_walls.any())


def _ratio(part: float, scale: float) -> float | None:
    return finite_or_none(part / scale) if scale else None
