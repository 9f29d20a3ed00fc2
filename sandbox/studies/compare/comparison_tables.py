"""The measures as rows of text: one list for the terminal and for the page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

from rich.console import Console
from softcradle.physics.analysis.collision import CollisionMeasures, ContactMeasures
from softcradle.sandbox.console import table
from softcradle.sandbox.draw.number_format import MINUS, scientific, subscript
from softcradle.sandbox.studies.compare.comparison_results import Result

NOTHING = 1e-12  # below it a number is round-off
NOISE = 1e-6  # of the whole time: shorter stays are the tolerance of the switches


@dataclass(frozen=True)
class Row:
    """A measure: its title with the unit, what it means, and its value for each side."""

    title: str
    meaning: str
    values: tuple[str, ...]


def number(value: float | None) -> str:
    """Five digits, as people read them; a dash for what is not defined."""
    if value is None:
        return "-"
    if abs(value) < NOTHING:
        return "0"
    if not 1e-3 <= abs(value) < 1e5:
        return scientific(value, 2)
    return f"{value:.4g}".replace("-", MINUS) if abs(value) >= 1000 else f"{value:.4f}".replace("-", MINUS)


def collision_rows(results: Sequence[Result]) -> list[Row]:
    """A row a measure of the whole collision."""
    rows = []
    for field in fields(CollisionMeasures):
        if "title" not in field.metadata or field.name == "final_velocity":
            continue
        if field.metadata["dissipative"] and not any(result.trajectory.chain.dissipative for result in results):
            continue
        values = tuple(number(getattr(result.measures, field.name)) for result in results)
        rows.append(Row(_titled(field.metadata), field.metadata["meaning"], values))
    return rows


def velocity_rows(results: Sequence[Result]) -> list[Row]:
    """A row a bead: its final velocity."""
    most = max(len(result.measures.final_velocity) for result in results)
    rows = []
    for bead in range(most):
        speeds = [result.measures.final_velocity[bead : bead + 1] for result in results]
        values = tuple(number(speed[0]) if speed else "" for speed in speeds)
        rows.append(Row(f"v{subscript(bead)} at the end (m/s)", "", values))
    return rows


def contact_rows(result: Result) -> list[Row]:
    """A row a contact of one side."""
    rows, noise = [], NOISE * float(result.trajectory.time[-1])
    for k, contact in enumerate(result.measures.contacts):
        numbers = {field.name: getattr(contact, field.name) for field in fields(ContactMeasures)}
        numbers |= {name: 0.0 for name in ("open", "touching", "loaded") if numbers[name] < noise}
        values = tuple(number(value) for value in numbers.values())
        struck = " (struck)" if k == result.measures.struck else ""
        rows.append(Row(f"{k}-{k + 1}{struck}", "", values))
    return rows


def contact_titles() -> list[tuple[str, str]]:
    """Title and meaning of each column of :func:`contact_rows`."""
    return [(_titled(field.metadata), field.metadata["meaning"]) for field in fields(ContactMeasures)]


def _titled(metadata: object) -> str:
    title, unit = metadata["title"], metadata["unit"]  # type: ignore[index]
    return f"{title} ({unit})" if unit else str(title)


def print_tables(to: Console, title: str, results: Sequence[Result]) -> None:
    """The comparison on the terminal."""
    to.print(title, style="bold")
    made = table("", *(result.side.name for result in results), numbers=True)
    for row in velocity_rows(results) + collision_rows(results):
        made.add_row(row.title, *row.values)
    to.print(made)
    for result in results:
        to.print(result.side.name, style="bold cyan")
        made = table("contact", *(title.replace(" (", "\n(") for title, _ in contact_titles()), numbers=True)
        for row in contact_rows(result):
            made.add_row(row.title, *row.values)
        to.print(made)
        for sentence in map(str, result.trajectory.warnings):
            to.print(f"warning: {sentence}", style="yellow")
