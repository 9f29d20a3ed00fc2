"""What a trajectory came to, as plain numbers: for the table of `run` and for its JSON."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from softcradle.physics import Trajectory


@dataclass(frozen=True)
class BeadSummary:
    """One bead: mass [kg] (None: a wall), velocities [m/s] at the start and at the end."""

    mass: float | None
    start_velocity: float
    final_velocity: float


@dataclass(frozen=True)
class ContactSummary:
    """One contact: first closed and last opened [s] (None: never), how often, largest overlap [m] and force [N]."""

    closed: float | None
    opened: float | None
    times: int
    largest_overlap: float
    largest_force: float


@dataclass(frozen=True)
class Summary:
    """A lane's results.

    Attributes:
        label: of the lane.
        beads, contacts: from left to right.
        end: time at which it ends [s].
        energy_error: largest distance of the energy from that at the start and the work of a drive, relative to it, in
            a driven chain to the largest energy; None where that is 0.
        energy_error_at_end: the same at the end, when explicit methods have most of it back.
        momentum_error: largest distance of the momentum from that at the start and the impulse of a drive, relative to
            the sum of abs(m v) at the start, in a driven chain to the largest such sum;
            None where that is 0 or a wall or bed takes momentum.
        absorbed_by_contacts, absorbed_by_bed: energy [J] that contacts with loss and bed friction took until the end;
            both belong to the energy above, so that its error is that of the ledger.
        method, step, tolerance: how; step in s (0 where the method chooses), tolerance 0 for fixed steps.
        steps, evaluations, milliseconds: cost.
        warnings: sentences.
        choice: what method "auto" chose and why; "" where the method was given.
    """

    label: str
    beads: tuple[BeadSummary, ...]
    contacts: tuple[ContactSummary, ...]
    end: float
    energy_error: float | None
    energy_error_at_end: float | None
    momentum_error: float | None
    absorbed_by_contacts: float
    absorbed_by_bed: float
    method: str
    step: float
    tolerance: float
    steps: int
    evaluations: int
    milliseconds: float
    warnings: tuple[str, ...]
    choice: str = ""


def summarise(label: str, trajectory: Trajectory) -> Summary:
    """The Summary of a lane's `trajectory`, from its samples: sample finely where peaks matter."""
    energy = trajectory.ledger
    off = np.abs(energy - energy[0])
    whole = (energy + trajectory.driven).max() if trajectory.chain.drive else energy[0]
    return Summary(
        label=label,
        beads=_beads(trajectory),
        contacts=_contacts(trajectory),
        end=float(trajectory.time[-1]),
        energy_error=_ratio(off.max(), whole),
        energy_error_at_end=_ratio(off[-1], whole),
        momentum_error=_momentum_error(trajectory),
        absorbed_by_contacts=float(trajectory.absorbed_by_contacts[-1]),
        absorbed_by_bed=float(trajectory.absorbed_by_bed[-1]),
        method=trajectory.method,
        step=trajectory.step,
        tolerance=trajectory.tolerance,
        steps=trajectory.steps,
        evaluations=trajectory.evaluations,
        milliseconds=1e3 * trajectory.seconds,
        warnings=trajectory.warnings,
        choice=trajectory.choice,
    )


def _beads(trajectory: Trajectory) -> tuple[BeadSummary, ...]:
    masses = [mass if math.isfinite(mass) else None for mass in trajectory.chain.mass]
    start, final = trajectory.velocity[0].tolist(), trajectory.final_velocity.tolist()
    return tuple(BeadSummary(*numbers) for numbers in zip(masses, start, final, strict=True))


def _contacts(trajectory: Trajectory) -> tuple[ContactSummary, ...]:
    overlaps = np.maximum(trajectory.overlap, 0.0).max(axis=0).tolist()
    forces = trajectory.force.max(axis=0).tolist()
    return tuple(
        ContactSummary(
            closed=intervals[0][0] if intervals else None,
            opened=intervals[-1][1] if intervals and math.isfinite(intervals[-1][1]) else None,
            times=len(intervals),
            largest_overlap=overlap,
            largest_force=force,
        )
        for intervals, overlap, force in zip(trajectory.contact_intervals, overlaps, forces, strict=True)
    )


def _momentum_error(trajectory: Trajectory) -> float | None:
    if trajectory.chain.walls or trajectory.chain.friction:
        return None
    kept = trajectory.momentum - trajectory.impulse
    rows = slice(None) if trajectory.chain.drive else slice(0, 1)
    whole = np.abs(np.array(trajectory.chain.mass) * trajectory.velocity[rows]).sum(axis=1).max()
    return _ratio(np.abs(kept - kept[0]).max(), whole)


def _ratio(part: float, whole: float) -> float | None:
    return float(part / whole) if whole else None
