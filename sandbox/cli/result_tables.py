"""The results of a run as tables on the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table
from softcradle.sandbox.console import console, print_table, table

if TYPE_CHECKING:
    from softcradle.sandbox.trajectory_summary import Summary
    from softcradle.scenes import Scene


PREFIXES = ((1e6, "M"), (1e3, "k"), (1.0, ""))  # of units, the one that suits first


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
    print_table(output, _beads(summary))
    print_table(output, _contacts(summary))
    output.print(_cost(summary))
    for sentence in summary.warnings:
        output.print(f"warning: {sentence}", style="yellow")


def _beads(summary: Summary) -> Table:
    last = "velocity when it gave up [m/s]" if summary.gave_up else "final velocity [m/s]"
    grid = table("bead", "mass [kg]", "velocity at start [m/s]", last, numbers=True)
    for i, bead in enumerate(summary.beads):
        mass = "wall" if bead.mass is None else f"{bead.mass:g}"
        grid.add_row(str(i), mass, _speed(bead.start_velocity), _speed(bead.final_velocity))
    return grid


def _contacts(summary: Summary) -> Table:
    pulls = any(contact.largest_pull for contact in summary.contacts)
    size, prefix = _prefix(max((max(item.largest_force, item.largest_pull) for item in summary.contacts), default=0.0))
    titles = "contact", "closed\n[s]", "opened\n[s]", "times", "largest\noverlap [m]", f"largest\nforce [{prefix}N]"
    grid = table(*titles, *[f"largest\npull [{prefix}N]"] * pulls, numbers=True)
    for i, contact in enumerate(summary.contacts):
        grid.add_row(
            f"{i}-{i + 1}",
            _time(contact.closed),
            _time(contact.opened),
            str(contact.times),
            f"{contact.largest_overlap:.4g}",
            f"{contact.largest_force / size:.6g}",
            *[f"{contact.largest_pull / size:.6g}"] * pulls,
        )
    return grid


def _speed(velocity: float) -> str:
    """Eight decimals; of a speed that these would not fit or show, eight digits."""
    fits = velocity == 0.0 or 1e-4 <= abs(velocity) < 1e6
    return f"{velocity:.8f}" if fits else f"{velocity:.8g}"


def _time(time: float | None) -> str:
    if time is None:
        return "never"
    return f"{time:.6f}" if time == 0.0 or 1e-3 <= time < 1e6 else f"{time:.6g}"


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
        size, prefix = _prefix(max(summary.absorbed_by_contacts, summary.absorbed_by_bed))
        taken = (summary.absorbed_by_contacts / size, summary.absorbed_by_bed / size)
        grid.add_row("absorbed", f"{taken[0]:.6g} {prefix}J by contacts, {taken[1]:.6g} {prefix}J by the bed")
    momentum = "not defined" if summary.momentum_error is None else f"{summary.momentum_error:.1e} at most"
    grid.add_row("momentum error", momentum)
    grid.add_row("cost", f"{summary.steps} steps, {summary.evaluations} evaluations, {summary.milliseconds:.3g} ms")
    return grid


def _prefix(largest: float) -> tuple[float, str]:
    """(size, prefix) of the unit that suits numbers up to `largest`, of which 1000 are 1 k."""
    return next((size, name) for size, name in PREFIXES if size == 1.0 or largest >= size)


def _error(relative: float | None) -> str:
    return "not defined" if relative is None else f"{relative:.1e}"
