"""The results of a run as tables on the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table
from softcradle.sandbox.console import console, print_table, table
from softcradle.sandbox.trajectory_summary import ResultTable, bead_table, contact_table, unit_prefix

if TYPE_CHECKING:
    from softcradle.sandbox.trajectory_summary import Summary
    from softcradle.scenes import Scene


def print_report(scene: Scene, summaries: Sequence[Summary]) -> None:
    """Print title and source, and the tables of each lane."""
    output = console()
    output.print(scene.title, style="bold")
    if scene.source:
        output.print(scene.source, style="dim")
    for summary in summaries:
        _print_lane(output, summary)


def _print_lane(output: Console, summary: Summary) -> None:
    output.print()
    if summary.label:
        output.print(summary.label, style="bold cyan")
    _print(output, bead_table(summary), 0)
    _print(output, contact_table(summary), 1)
    output.print(_cost(summary))
    for sentence in summary.warnings:
        output.print(f"warning: {sentence}", style="yellow")


def _print(output: Console, found: ResultTable, breaks: int) -> None:
    """Print rows of results, with so many line breaks in their titles."""
    grid = table(*(title.replace(" ", "\n", breaks) for title in found.titles), numbers=True)
    for row in found.rows:
        grid.add_row(*row)
    print_table(output, grid)


def _cost(summary: Summary) -> Table:
    grid = Table.grid(padding=(0, 2))
    resolution = f"step {summary.step:.4g} s" if summary.step else f"tolerance {summary.tolerance:g}"
    grid.add_row("method", f"{summary.method}, {resolution}")
    if summary.choice:
        grid.add_row("chosen", summary.choice)
    if summary.velocity_error is not None:
        grid.add_row("velocity error", f"{summary.velocity_error:.1e} m/s at most, as estimated along the run")
    grid.add_row(
        "energy error", f"{_error(summary.energy_error)} at most, {_error(summary.energy_error_at_end)} at the end"
    )
    if summary.absorbed_by_contacts or summary.absorbed_by_bed:
        size, prefix = unit_prefix(max(summary.absorbed_by_contacts, summary.absorbed_by_bed))
        taken = (summary.absorbed_by_contacts / size, summary.absorbed_by_bed / size)
        grid.add_row("absorbed", f"{taken[0]:.6g} {prefix}J by contacts, {taken[1]:.6g} {prefix}J by the bed")
    momentum = "not defined" if summary.momentum_error is None else f"{summary.momentum_error:.1e} at most"
    grid.add_row("momentum error", momentum)
    grid.add_row("cost", f"{summary.steps} steps, {summary.evaluations} evaluations, {summary.milliseconds:.3g} ms")
    return grid


def _error(relative: float | None) -> str:
    return "not defined" if relative is None else f"{relative:.1e}"
