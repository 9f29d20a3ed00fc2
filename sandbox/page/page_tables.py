"""The tables of a played motion: what every bead and contact did in exact numbers, and how they were computed."""

from __future__ import annotations

from softcradle.physics import Trajectory
from softcradle.sandbox.draw.number_format import number_text, scientific
from softcradle.sandbox.page.page_document import note, table
from softcradle.sandbox.page.played_motion import PlayedMotion
from softcradle.sandbox.trajectory_summary import Summary, summarise
from softcradle.scenes.contact_text import contact_text

BEAD_TITLES = ("bead", "at the start (m/s)", "at the end (m/s)", "mass (kg)")
CONTACT_TITLES = (
    "contact", "greatest force (N)", "greatest overlap (m)", "first closed (s)", "last opened (s)", "times", "law",
)  # fmt: skip


def result_tables(played: PlayedMotion) -> str:
    """Two tables for each lane."""
    parts = []
    for lane, trajectory in enumerate(played.trajectories):
        summary = summarise(played.labels[lane], trajectory)
        parts.append(table(BEAD_TITLES, _bead_rows(summary), _named(played, lane, "Velocities")))
        parts.append(table(CONTACT_TITLES, _contact_rows(summary, trajectory), _named(played, lane, "Contacts")))
    return "".join(parts)


def result_notes(played: PlayedMotion) -> str:
    """How the motion of each lane was computed, and what may be wrong with it."""
    parts = []
    for lane, trajectory in enumerate(played.trajectories):
        parts.append(note(_named(played, lane, recorded_sentence(trajectory))))
        parts += [note(_named(played, lane, str(warning)), warning=True) for warning in trajectory.warnings]
    return "".join(parts)


def _named(played: PlayedMotion, lane: int, text: str) -> str:
    """`text` behind the label of the lane, where there are several."""
    label = played.labels[lane]
    return f"{label}: {text[0].lower()}{text[1:]}" if label and len(played.labels) > 1 else text


def recorded_sentence(trajectory: Trajectory) -> str:
    """By which method a motion was recorded, and with which errors."""
    summary = summarise("", trajectory)
    fineness = f"step {scientific(summary.step)} s" if summary.step else f"tolerance {summary.tolerance:g}"
    errors = [
        f"{name} error {scientific(value) if value > 1e-17 else '0'}"
        for name, value in (("energy", summary.energy_error), ("momentum", summary.momentum_error))
        if value is not None
    ]
    if summary.velocity_error is not None:
        errors.insert(0, f"velocities at the end to {scientific(summary.velocity_error)} m/s")
    cost = [f"{summary.steps} steps"] if summary.steps else []
    return f"Recorded motion, computed by {summary.method}, {fineness}; {', '.join(errors + cost)}"


def _bead_rows(summary: Summary) -> list[list[str]]:
    return [
        [
            str(k),
            number_text(bead.start_velocity),
            number_text(bead.final_velocity),
            "wall" if bead.mass is None else f"{bead.mass:g}",
        ]
        for k, bead in enumerate(summary.beads)
    ]


def _contact_rows(summary: Summary, trajectory: Trajectory) -> list[list[str]]:
    return [
        [
            f"{k}-{k + 1}",
            number_text(contact.largest_force),
            scientific(contact.largest_overlap, 3) if contact.largest_overlap > 0.0 else "0",
            "-" if contact.closed is None else f"{contact.closed:.6g}",
            "-" if contact.opened is None else f"{contact.opened:.6g}",
            str(contact.times),
            contact_text(trajectory.chain.contact[k]),
        ]
        for k, contact in enumerate(summary.contacts)
    ]
