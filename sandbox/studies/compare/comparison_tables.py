"""The measures as rows of text: one list for the terminal and for the page."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from rich.console import Console
from rich.table import Table
from softcradle.physics.analysis.collision_measures import CollisionMeasures, ContactMeasures
from softcradle.sandbox.console import print_table, table
from softcradle.sandbox.draw.number_format import number_text, subscript
from softcradle.sandbox.studies.compare.comparison_results import SideResult

SHORTEST_TIME = 1e-6  # of the whole time: shorter times in a state are errors of the switch times, and shown as 0


@dataclass(frozen=True)
class MeasureRow:
    """A row of a table: its title with the unit, what it means, and its values as texts."""

    title: str
    meaning: str
    values: tuple[str, ...]


def collision_rows(results: Sequence[SideResult]) -> list[MeasureRow]:
    """A row a measure of the whole collision."""
    rows = []
    for field in fields(CollisionMeasures):
        if "title" not in field.metadata or field.name == "final_velocity":
            continue
        if field.metadata["dissipative"] and not any(result.trajectory.chain.dissipative for result in results):
            continue
        values = tuple(number_text(getattr(result.measures, field.name)) for result in results)
        rows.append(MeasureRow(_title(field.metadata), field.metadata["meaning"], values))
    return rows


def velocity_rows(results: Sequence[SideResult]) -> list[MeasureRow]:
    """A row a bead: its final velocity; a last one for how well these are known, where a method tells."""
    most = max(len(result.measures.final_velocity) for result in results)
    rows = []
    for bead in range(most):
        final = [result.measures.final_velocity for result in results]
        values = tuple(number_text(velocity[bead]) if bead < len(velocity) else "" for velocity in final)
        rows.append(MeasureRow(f"v{subscript(bead)} at the end (m/s)", "", values))
    errors = [float(result.trajectory.velocity_error.max()) for result in results]
    if not all(map(math.isnan, errors)):
        meaning = "largest error of these velocities, as the method estimates it along the run"
        rows.append(MeasureRow("known to (m/s)", meaning, tuple("" if math.isnan(e) else f"{e:.1e}" for e in errors)))
    return rows


def contact_rows(result: SideResult) -> list[MeasureRow]:
    """A row a contact of one side."""
    rows, shortest = [], SHORTEST_TIME * float(result.trajectory.time[-1])
    for k, contact in enumerate(result.measures.contacts):
        numbers = {field.name: getattr(contact, field.name) for field in fields(ContactMeasures)}
        numbers |= {name: 0.0 for name in ("open", "touching", "loaded") if numbers[name] < shortest}
        values = tuple(number_text(value) for value in numbers.values())
        struck = " (struck)" if k == result.measures.struck else ""
        rows.append(MeasureRow(f"{k}-{k + 1}{struck}", "", values))
    return rows


def contact_titles() -> list[tuple[str, str]]:
    """Title and meaning of each column of :func:`contact_rows`."""
    return [(_title(field.metadata), field.metadata["meaning"]) for field in fields(ContactMeasures)]


def _title(metadata: Mapping[str, Any]) -> str:
    title, unit = metadata["title"], metadata["unit"]
    return f"{title} ({unit})" if unit else str(title)


def print_tables(output: Console, title: str, results: Sequence[SideResult]) -> None:
    """The comparison on the terminal."""
    output.print(title, style="bold")
    made = table("", *(result.side.name.replace("(", "\n(") for result in results), numbers=True)
    for row in velocity_rows(results) + collision_rows(results):
        made.add_row(row.title, *row.values)
    print_table(output, made)
    for result in results:
        output.print(result.side.name, style="bold cyan")
        print_table(output, _contact_table(result))
        for warning in result.trajectory.warnings:
            output.print(f"warning: {warning}", style="yellow")


def _contact_table(result: SideResult) -> Table:
    """A column a contact, or a row where there are many: the narrower of the two."""
    rows, titles = contact_rows(result), [title for title, _ in contact_titles()]
    if len(rows) < len(titles):
        made = table("contact", *(row.title.replace(" ", "\n") for row in rows), numbers=True)
        for k, title in enumerate(titles):
            made.add_row(title, *(row.values[k] for row in rows))
        return made
    made = table("contact", *(title.replace(" (", "\n(") for title in titles), numbers=True)
    for row in rows:
        made.add_row(row.title, *row.values)
    return made
