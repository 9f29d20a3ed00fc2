"""Report of a benchmark: a table to print, and its numbers for the JSON file."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from rich.console import Console
from rich.table import Table


@dataclass(frozen=True)
class Report:
    """Table with notes. The object contains the same numbers as plain data.

    Attributes:
        title: description of the measured quantity.
        columns, rows: the table as text; goals are in brackets after the values.
        notes: sentences below the table.
        data: the numbers of the table for JSON.
    """

    title: str
    columns: list[str] = field(default_factory=list)
    rows: list[list[str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    data: Any = None

    def show(self, console: Console) -> None:
        """Print the table, or only the title of a report without columns."""
        if not self.columns:
            console.print(self.title, highlight=False)
            return
        table = Table(title=self.title, title_justify="left")
        for k, column in enumerate(self.columns):
            table.add_column(column, justify="left" if k == 0 else "right")
        for row in self.rows:
            table.add_row(*row)
        console.print(table)
        for note in self.notes:
            console.print(note, markup=False, highlight=False)
        console.print()

    def markdown(self) -> str:
        """Return the table and its notes as Markdown."""
        rows = [self.columns, ["---"] + ["---:"] * (len(self.columns) - 1), *self.rows]
        lines = [f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |" for row in rows]
        notes = [f"* {note}" for note in self.notes]
        return "\n".join([f"**{self.title}**", "", *lines, "", *notes]) + "\n"


def at_most(value: float | None, aim: float | None) -> str:
    """Return a measured value as text with its goal in brackets. A value that is larger than the goal is marked.

    Without a value, return a dash.
    """
    if value is None:
        return "-" if aim is None else f"- ({aim:g}) missed"
    shown = f"{value:.3g}" if value < 1000 else f"{value:.0f}"
    if aim is None:
        return shown
    return f"{shown} ({aim:g})" + ("" if value <= aim else " missed")


def at_least(shown: str, value: float, aim: float) -> str:
    """Return the text `shown` of a value with its goal in brackets. A value that is smaller than the goal is marked."""
    return f"{shown} (at least {aim:g})" + ("" if value >= aim else " missed")
