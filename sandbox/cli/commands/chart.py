"""`softcradle chart`: the cost of every method against its error on this machine, beside other people's integrators."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from softcradle.sandbox.console import console, table
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.user_error import UserError

if TYPE_CHECKING:
    from softcradle.sandbox.studies.precision.chart_cases import Recipe
    from softcradle.sandbox.studies.precision.precision_table import Measured

SUFFIXES = (".png", ".pdf", ".svg")
QUANTITIES = ("velocities", "forces", "overlaps")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "scenes", metavar="SCENE", nargs="*",
        help="a case of --list, a scene, or a scene file (default: all cases; each takes up to half a minute)",
    )  # fmt: skip
    parser.add_argument(
        "-o", "--output", metavar="PICTURE", default="out/chart.png", help="picture to write (default: out/chart.png)"
    )
    parser.add_argument("--csv", action="store_true", help="write every point measured beside it, as .csv")
    parser.add_argument(
        "--error", choices=QUANTITIES, default="velocities",
        help="error of the final velocities (default), of the forces, or of the overlaps as in App. B",
    )  # fmt: skip
    parser.add_argument("--ours", action="store_true", help="leave out other people's integrators")
    parser.add_argument("--list", action="store_true", help="list the cases instead")


def main(args: argparse.Namespace) -> int:
    """Measure the cases, draw the chart and print the table of each case."""
    from softcradle.sandbox.studies.precision.chart_cases import RECIPES

    if args.list:
        listed = table("case", "what collides")
        for recipe in RECIPES:
            listed.add_row(recipe.name, recipe.label)
        console().print(listed)
        return 0
    if Path(args.output).suffix not in SUFFIXES:
        raise UserError(f"cannot write {args.output}: chart writes {', '.join(SUFFIXES)}")
    recipes = _recipes(args.scenes)
    from softcradle.sandbox.output_files import output_file

    paths = [Path(args.output), *([Path(args.output).with_suffix(".csv")] if args.csv else [])]
    with ExitStack() as stack:
        # The files are opened before the runs, so that an unwritable place is refused at once.
        files = [stack.enter_context(output_file(path)) for path in paths]
        measured = _measure(recipes, args.error, not args.ours)
        _write(measured, *files)
    for found in measured:
        _print(found)
    for path in paths:
        print(f"written: {path}")
    return 0


def _recipes(wanted: Sequence[str]) -> list[Recipe]:
    """The recipes of those names; without names, all."""
    from softcradle.sandbox.studies.precision.chart_cases import RECIPES, recipes_of

    known = {recipe.name: recipe for recipe in RECIPES}
    if not wanted:
        return list(RECIPES)
    return [found for name in wanted for found in ([known[name]] if name in known else recipes_of(load_scene(name)))]


def _measure(recipes: Sequence[Recipe], quantity: str, peers: bool) -> list[Measured]:
    from rich.console import Console
    from rich.progress import Progress

    found = []
    with Progress(console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("cases", total=len(recipes))
        for recipe in recipes:
            found.append(_measured(recipe, quantity, peers, lambda text: progress.update(task, description=text)))
            progress.advance(task)
    return found


def _measured(recipe: Recipe, quantity: str, with_peers: bool, report: Callable[[str], None]) -> Measured:
    from softcradle.sandbox.studies.precision.peers import peers
    from softcradle.sandbox.studies.precision.precision_table import Measured
    from softcradle.sandbox.studies.precision.solvers import ours
    from softcradle.sandbox.studies.precision.work_precision import measure

    report(f"{recipe.label}: the truth")
    try:
        case = recipe.cook()
    except ValueError as error:
        raise UserError(f"{recipe.label}: {error}") from None
    solvers = [*ours(case), *(peers(case) if with_peers else [])]
    return Measured(
        case, measure(case, solvers, quantity, told=lambda name: report(f"{recipe.label}: {name}")), quantity
    )


def _write(measured: Sequence[Measured], picture: Path, numbers: Path | None = None) -> None:
    from softcradle.sandbox.studies.plot_style import styled
    from softcradle.sandbox.studies.precision.precision_chart import draw
    from softcradle.sandbox.studies.precision.precision_table import write_csv

    with styled():
        draw(measured).savefig(picture, dpi=110)
    if numbers is not None:
        write_csv(measured, numbers)


def _print(found: Measured) -> None:
    from softcradle.sandbox.studies.precision.chart_cases import REACHES
    from softcradle.sandbox.studies.precision.precision_table import auto_sentence, how, ratio_sentence, rows

    grid = table(f"ms to an error of {found.quantity} of", *(f"{reach:g}" for reach in REACHES), "by")
    measured = rows(found)
    for row in measured:
        cells = ["-" if best is None else f"{1e3 * best.seconds:.3g}" for best in row.best]
        grid.add_row(row.name, *cells, "; ".join(how(best) for best in row.best))
    output = console()
    output.print(f"{found.case.label}; truth: {found.case.origin}", style="bold")
    output.print(grid)
    output.print(ratio_sentence(measured))
    output.print(auto_sentence(measured))
    if cut := [row.name for row in measured if row.ended.startswith("a ")]:
        output.print(f"ended where a further run would have taken too long: {', '.join(cut)}")
    output.print()
