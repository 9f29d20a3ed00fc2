"""`softcradle chart`: measure the computing time and the error of every method on this machine. Plot the time over the
error, together with other integrators for comparison.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from types import ModuleType
from typing import TYPE_CHECKING

from softcradle.sandbox.cli.arguments import LISTED, WrittenFiles, add_open, figure_path, opened_outputs, refuse_options
from softcradle.sandbox.console import ProgressShown, console, print_rows
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.user_error import UserError

if TYPE_CHECKING:
    from softcradle.sandbox.studies.precision.cases import CaseDefinition
    from softcradle.sandbox.studies.precision.table import MeasuredCase

QUANTITIES = ("velocities", "forces", "overlaps")


def add_arguments(parser: argparse.ArgumentParser) -> None:
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
    parser.add_argument(
        "--ours", action="store_true", help="leave out other people's integrators, which a checkout has"
    )
    parser.add_argument("--list", action="store_true", help="list the cases instead")
    add_open(parser)


def main(args: argparse.Namespace) -> int:
    """Measure the cases, draw the chart and print one table for each case."""
    from softcradle.sandbox.studies.plot_style import save_figure, styled
    from softcradle.sandbox.studies.precision.chart import draw_chart
    from softcradle.sandbox.studies.precision.measurement import machine_stamp
    from softcradle.sandbox.studies.precision.table import write_csv

    definitions = _definitions(args.scenes)
    if args.list:
        refuse_options(args, LISTED, "csv", "ours", "open")
        print_rows(("case", "what collides"), [(one.name, one.label) for one in definitions])
        return 0
    path, peers = figure_path(args.output, "chart"), None if args.ours else _peers()
    paths = [path, *[path.with_suffix(".csv")] * args.csv]
    written = WrittenFiles(paths)
    with opened_outputs(paths) as (picture, *numbers), styled():
        measured = []
        with ProgressShown("cases", len(definitions)) as progress:
            for k, definition in enumerate(definitions):
                tell = partial(progress.tell, done=k, count=len(definitions))
                measured.append(_measured(definition, args.error, peers, tell))
        stamp = machine_stamp(peers.peer_distributions() if peers else ())
        save_figure(draw_chart(measured, stamp), picture, 110.0)
        for table in numbers:
            write_csv(measured, table)
    for found in measured:
        _print(found)
    written.report(paths, show=args.open)
    return 0


def _definitions(wanted: Sequence[str]) -> list[CaseDefinition]:
    """Return the cases with the names `wanted`. If no name is given, return all cases. Names that are not cases are
    read as scenes.
    """
    from softcradle.sandbox.studies.precision.cases import CASE_DEFINITIONS, definitions_of

    known = {definition.name: definition for definition in CASE_DEFINITIONS}
    if not wanted:
        return list(CASE_DEFINITIONS)
    return [
        found for name in wanted for found in ([known[name]] if name in known else definitions_of(load_scene(name)))
    ]


def _measured(
    definition: CaseDefinition, quantity: str, peers: ModuleType | None, report: Callable[[str], None]
) -> MeasuredCase:
    from softcradle.sandbox.studies.precision.measurement import measure_case, our_solvers
    from softcradle.sandbox.studies.precision.table import MeasuredCase

    report(f"{definition.label}: the truth")
    try:
        case = definition.solve()
    except ValueError as error:
        raise UserError(f"{definition.label}: {error}") from None
    if quantity == "overlaps" and not case.yielding.any():
        raise UserError(f"{definition.label}: no contact yields, so that --error overlaps has nothing to compare")
    solvers = [*our_solvers(case), *(peers.peer_solvers(case) if peers else [])]
    series = measure_case(case, solvers, quantity, announce=lambda name: report(f"{definition.label}: {name}"))
    return MeasuredCase(case, series, quantity)


def _peers() -> ModuleType | None:
    """Return the module with the integrators of other projects. Return None if it is missing, because an installed
    wheel does not contain it.
    """
    try:
        from softcradle.sandbox.studies.precision import peers
    except ImportError:
        return None
    return peers


def _print(found: MeasuredCase) -> None:
    from softcradle.sandbox.studies.precision.cases import ERROR_LEVELS
    from softcradle.sandbox.studies.precision.table import auto_sentence, curve_rows, ratio_sentence, setting_text

    output, measured = console(), curve_rows(found)
    output.print(f"{found.case.label}; truth: {found.case.source}", style="bold")
    rows = []
    for row in measured:
        cells = ["-" if best is None else f"{1e3 * best.seconds:.3g}" for best in row.fastest]
        rows.append((row.name, *cells, "; ".join(setting_text(best) for best in row.fastest)))
    print_rows(
        (f"ms to an error of {found.quantity} of", *(f"{error:g}" for error in ERROR_LEVELS), "by"), rows, output=output
    )
    output.print(ratio_sentence(measured))
    output.print(auto_sentence(measured))
    if cut := [row.name for row in measured if row.out_of_time]:
        output.print(f"ended where a further run would have taken too long: {', '.join(cut)}")
    output.print()
