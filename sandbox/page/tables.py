"""The tables of a played motion: what every bead and contact did in exact numbers, and how they were computed."""

from __future__ import annotations

from softcradle.physics import Trajectory
from softcradle.sandbox.draw.number_format import scientific
from softcradle.sandbox.page.document import note, table
from softcradle.sandbox.page.played_motion import PlayedMotion
from softcradle.sandbox.trajectory_summary import bead_table, contact_table, summarise
from softcradle.scenes.contact_text import contact_text


def result_tables(played: PlayedMotion) -> str:
    """Two tables for each lane."""
    parts = []
    for lane, trajectory in enumerate(played.trajectories):
        summary = summarise(played.labels[lane], trajectory)
        beads, contacts = bead_table(summary), contact_table(summary)
        laws = map(contact_text, trajectory.chain.contact)
        rows = [(*row, law) for row, law in zip(contacts.rows, laws, strict=True)]
        parts.append(table(beads.titles, beads.rows, _named(played, lane, "Velocities")))
        parts.append(table((*contacts.titles, "law"), rows, _named(played, lane, "Contacts")))
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
