"""Results of a comparison: the motion of each side, its measures, and tables for the terminal and the page."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import Field, asdict, dataclass, fields
from itertools import groupby
from typing import Any

import numpy as np
from rich.console import Console
from softcradle.physics import Trajectory
from softcradle.physics.analysis.collision import CollisionMeasures, ContactMeasures, collide, measured
from softcradle.physics.checked_input import finite_or_none
from softcradle.physics.trajectory_file import versions
from softcradle.sandbox.console import print_rows
from softcradle.sandbox.story.numbers import number_text, subscript
from softcradle.sandbox.studies.compare.sides import Comparison, Side
from softcradle.sandbox.trajectory_summary import ResultTable, summarise
from softcradle.sandbox.user_error import UserError
from softcradle.scenes.contact_text import contact_text


@dataclass(frozen=True)
class SideResult:
    """Computed motion and measures of one side of a comparison."""

    side: Side
    trajectory: Trajectory
    measures: CollisionMeasures

    @property
    def contact(self) -> str:
        """Contacts of the side as one line of text. Equal neighbouring contacts are listed once."""
        found = [text for text, _ in groupby(map(contact_text, self.trajectory.chain.contact))]
        return ", ".join(found) if len(found) <= 4 else f"{found[0]}, ... {found[-1]}"


def solve_sides(comparison: Comparison) -> list[SideResult]:
    """Simulate every side of the comparison and compute its measures.

    Raises:
        UserError: if a side does not accept the method or step.
    """
    return [_solve_side(side) for side in comparison.sides]


def _solve_side(side: Side) -> SideResult:
    with warnings.catch_warnings():
        # The warnings are suppressed because the report shows the same warnings from `trajectory.warnings`.
        warnings.simplefilter("ignore", RuntimeWarning)
        try:
            trajectory = collide(side.lane.chain(), side.lane.velocity, **side.scene.settings())
        except ValueError as error:
            raise UserError(f"{side.name}: {error}") from None
    if not np.isfinite(trajectory.position).all():
        raise UserError(f"{side.name}: the motion by {trajectory.method} did not stay finite: choose a smaller step")
    return SideResult(side, trajectory, measured(trajectory))


def end_time(results: Sequence[SideResult]) -> float:
    """Return the time [s] at which the longest motion ends."""
    return max(float(result.trajectory.time[-1]) for result in results)


def results_as_json(comparison: Comparison, results: Sequence[SideResult]) -> dict[str, Any]:
    """Return the results of all sides as JSON data: numbers, lists and texts."""
    return {"title": comparison.title, "sides": [_side_as_json(result) for result in results], "versions": versions()}


def _side_as_json(result: SideResult) -> dict[str, Any]:
    summary, trajectory = summarise(result.side.name, result.trajectory), result.trajectory
    return {
        "name": result.side.name,
        "contact": result.contact,
        "masses": [finite_or_none(mass) for mass in trajectory.chain.mass],
        "start_velocity": list(result.side.lane.velocity),
        "measures": asdict(result.measures),
        "method": trajectory.method,
        "status": summary.status,
        "velocity_error": [bead.velocity_error for bead in summary.beads],
        "energy_error": summary.energy_error,
        "momentum_error": summary.momentum_error,
        "warnings": [str(warning) for warning in trajectory.warnings],
    }


# Shortest duration of a contact state, as a fraction of the whole time. A shorter duration is within the error of the
# event times, and is shown as 0.
SHORTEST_TIME = 1e-6


def _table(results: Sequence[SideResult], rows: Sequence[tuple[str, str, Sequence[str]]]) -> ResultTable:
    """Return a table with a column for each side. Each of `rows` consists of a title, its meaning and the values."""
    titles = ("", *(result.side.name for result in results))
    return ResultTable(titles, tuple((title, *values) for title, _, values in rows), tuple(hint for _, hint, _ in rows))


def collision_table(results: Sequence[SideResult]) -> ResultTable:
    """Return a table with a row for each measure that describes the whole collision."""
    rows = []
    for field in fields(CollisionMeasures):
        if "title" not in field.metadata or field.name == "final_velocity":
            continue
        if field.metadata["dissipative"] and not any(result.trajectory.chain.dissipative for result in results):
            continue
        values = [getattr(result.measures, field.name) for result in results]
        if any(value is not None for value in values):
            rows.append((title_of(field), field.metadata["meaning"], list(map(number_text, values))))
    return _table(results, rows)


def velocity_table(results: Sequence[SideResult]) -> ResultTable:
    """Return a table of the final velocity of each bead. The table includes error estimates if a method reports them."""
    final = [result.measures.final_velocity for result in results]
    rows = []
    for bead in range(max(map(len, final))):
        values = [number_text(velocity[bead]) if bead < len(velocity) else "" for velocity in final]
        rows.append((f"v{subscript(bead)} at the end (m/s)", "", values))
    errors = [float(result.trajectory.velocity_error.max()) for result in results]
    if not all(map(math.isnan, errors)):
        meaning = "largest error of these velocities, as the method estimates it along the run"
        rows.append(("known to (m/s)", meaning, ["" if math.isnan(error) else f"{error:.1e}" for error in errors]))
    return _table(results, rows)


def contact_table(result: SideResult) -> ResultTable:
    """Return a table with a row for each contact of one side. Empty columns are left out."""
    rows, shortest, contacts = [], SHORTEST_TIME * float(result.trajectory.time[-1]), result.measures.contacts
    found = [
        field for field in fields(ContactMeasures) if any(getattr(one, field.name) is not None for one in contacts)
    ]
    for k, contact in enumerate(contacts):
        numbers = {field.name: getattr(contact, field.name) for field in found}
        numbers |= {name: 0.0 for name in ("open", "touching", "loaded") if numbers[name] < shortest}
        struck = " (struck)" if k == result.measures.struck else ""
        rows.append((f"{k}-{k + 1}{struck}", *map(number_text, numbers.values())))
    return ResultTable(("contact", *map(title_of, found)), tuple(rows))


def title_of(field: Field[Any]) -> str:
    """Return the name of a measure with its unit."""
    title, unit = field.metadata["title"], field.metadata["unit"]
    return f"{title} ({unit})" if unit else str(title)


def print_tables(output: Console, title: str, results: Sequence[SideResult]) -> None:
    """Print the comparison on the terminal.

    Contacts are the columns of their table if there are fewer contacts than measures.
    """
    output.print(title, style="bold")
    speeds, measures = velocity_table(results), collision_table(results)
    print_rows([name.replace("(", "\n(") for name in speeds.titles], speeds.rows + measures.rows, True, output)
    for result in results:
        output.print(result.side.name, style="bold cyan")
        found = contact_table(result)
        if len(found.rows) < len(found.titles) - 1:
            (_, *names), *rows = zip(found.titles, *found.rows, strict=True)
            print_rows(["contact", *(name.replace(" ", "\n") for name in names)], rows, True, output)
        else:
            print_rows([name.replace(" (", "\n(") for name in found.titles], found.rows, True, output)
        for warning in result.trajectory.warnings:
            output.print(f"warning: {warning}", style="yellow")
