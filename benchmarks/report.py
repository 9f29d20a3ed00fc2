"""What every part of the benchmarks hands back: one table to print, and its numbers for the JSON file."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from rich.console import Console
from rich.table import Table


@dataclass(frozen=True)
class Report:
    """A table with its notes, and the same as plain data.

    Attributes:
        title: what was measured.
        columns, rows: the table as text; aims stand in brackets beside the values they belong to.
        notes: sentences below the table.
        data: the numbers behind it, as JSON takes them.
    """

    title: str
    columns: list[str]
    rows: list[list[str]]
    notes: list[str] = field(default_factory=list)
    data: Any = None

    def show(self, console: Console) -> None:
        """Print it; a report without columns is its title alone."""
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


def against(value: float | None, aim: float | None) -> str:
    """A measured value with its aim in brackets, marked where it is missed; a dash where there is none."""
    if value is None:
        return "-" if aim is None else f"- ({aim:g}) missed"
    shown = f"{value:.3g}" if value < 1000 else f"{value:.0f}"
    if aim is None:
        return shown
    return f"{shown} ({aim:g})" + ("" if value <= aim else " missed")
