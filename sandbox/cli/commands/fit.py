"""`softcradle fit`: fit the free values of a scene to measured data. The command also searches for values that reach a
goal.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from softcradle.sandbox.cli.arguments import (
    FIGURE_SUFFIXES,
    WrittenFiles,
    add_open,
    add_scene,
    check_open,
    figure_path,
    opened_outputs,
    positive_number,
    refuse_options,
    whole_number,
)
from softcradle.sandbox.console import ProgressShown, console, print_json, print_rows
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.user_error import UserError

if TYPE_CHECKING:
    from softcradle.sandbox.studies.fitting.design_scene import SceneDesign
    from softcradle.sandbox.studies.fitting.fit_scene import SceneFit
    from softcradle.scenes import Scene

MOST_STARTS = 10_000
SCENE, NUMBERS, PAGE = ".toml", ".json", ".html"
DATA_ONLY = ("columns", "quantity", "window", "begin", "end", "starts")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_scene(parser)
    parser.add_argument(
        "data", metavar="DATA", nargs="*",
        help="table of measurements (see the documentation of fit for the formats); each of several tables is fitted by itself",
    )  # fmt: skip
    parser.add_argument(
        "--free", action="append", default=[], metavar="PATH",
        help="free value, such as lanes.0.contact.loss, lanes.0.mass[1] or lanes.0.contact[:].stiffness=10..500; start frees "
        "the time of the data at which the scene begins, offset the origin of positions; may be given several times",
    )  # fmt: skip
    parser.add_argument(
        "--goal", action="append", default=[], metavar="GOAL",
        help="in place of data: 'least peak force', 'most momentum of bead 3' or 'momentum deficit = 0.075'; any measure of "
        "softcradle sweep --measures",
    )  # fmt: skip
    parser.add_argument(
        "-o", "--output", action="append", default=[], metavar="OUT",
        help="scene with the fitted values .toml, figure .png .pdf .svg, numbers .json, or with --goal a page .html; may be "
        "given several times",
    )  # fmt: skip
    parser.add_argument(
        "--lane", type=whole_number(0, 10_000), default=0, metavar="N", help="lane of the data (default 0)"
    )
    parser.add_argument(
        "--column", action="append", default=[], dest="columns", metavar="NAME=PLACE",
        help="meaning of a column, such as 'marker 7 X=position 0'; then only stated columns are used",
    )  # fmt: skip
    parser.add_argument(
        "--quantity", action="append", default=[], metavar="NAME",
        help="position, velocity or force: use only these (default: forces, and positions or else velocities)",
    )  # fmt: skip
    parser.add_argument(
        "--from", type=float, dest="begin", metavar="SECONDS", help="first time of the data that is used"
    )
    parser.add_argument("--to", type=float, dest="end", metavar="SECONDS", help="last time of the data that is used")
    parser.add_argument(
        "--window", type=positive_number, metavar="SECONDS", help="use only data within this time of the first hit"
    )
    parser.add_argument(
        "--starts", type=whole_number(1, MOST_STARTS), metavar="N",
        help="local searches from different starts (default: one, and more if its residuals are not random)",
    )  # fmt: skip
    parser.add_argument(
        "--seed", type=whole_number(0, 10**9), default=0, metavar="N", help="seed of the starts (default 0)"
    )
    parser.add_argument("--json", action="store_true", help="print the numbers as JSON instead of tables")
    add_open(parser)


def main(args: argparse.Namespace) -> int:
    """Fit the values or search for them, write the outputs and print the tables."""
    check_open(args.open, args.output)
    if not args.free:
        raise UserError("no free value is given: name one, such as --free lanes.0.contact.loss")
    if bool(args.data) == bool(args.goal):
        raise UserError("fit needs a table of measurements or a --goal, and not both")
    scene = load_scene(args.scene)
    if args.goal:
        refuse_options(
            args, "{option} is for data, not for a --goal", *(one for one in DATA_ONLY if getattr(args, one))
        )
        return _design(args, scene)
    return _fit(args, scene)


def _fit(args: argparse.Namespace, scene: Scene) -> int:
    from softcradle.sandbox.studies.fitting.fit_scene import fit

    wanted = [_checked_output(name, (SCENE, NUMBERS, *FIGURE_SUFFIXES)) for name in args.output]
    outputs = [path for one in wanted for path in _paths(one, len(args.data))]
    written = WrittenFiles(outputs)
    columns = dict(_column(text) for text in args.columns)
    begin, end = args.begin, args.end
    between = None
    if begin is not None or end is not None:
        between = (-float("inf") if begin is None else begin, float("inf") if end is None else end)
    found: list[SceneFit] = []
    with opened_outputs(outputs) as temporary:
        with ProgressShown("starts") as progress:
            for data in args.data:
                where = f"{Path(data).name}: starts" if len(args.data) > 1 else "starts"
                found.append(
                    fit(
                        scene, data, args.free, lane=args.lane, quantities=args.quantity, columns=columns, between=between,
                        window=args.window, starts=args.starts, seed=args.seed,
                        progress=lambda _what, done, count, where=where: progress.tell(where, done, count),  # type: ignore[misc]
                    )
                )  # fmt: skip
        contents = [fit_numbers(one) for one in found]
        for path, place in zip(outputs, temporary, strict=True):
            number = outputs.index(path) % len(args.data)
            _write(place, found[number], contents[number])
    if args.json:
        print_json(contents[0] if len(contents) == 1 else contents)
    else:
        for one in found:
            print_fit(one)
        if len(found) > 1:
            print_scatter(found)
    written.report(outputs, show=args.open, silent=args.json)
    return 0


def _checked_output(name: str, suffixes: Sequence[str]) -> Path:
    """Return the path of an output file. Raise UserError if its format is not supported. Raise ImportError if
    matplotlib is not installed.
    """
    path = Path(name)
    if path.suffix not in suffixes:
        raise UserError(f"cannot write {name}: fit writes {', '.join(suffixes)}")
    return figure_path(name, "fit") if path.suffix in FIGURE_SUFFIXES else path


def _paths(path: Path, count: int) -> list[Path]:
    """Return one output path for each table of data."""
    return [path] if count == 1 else [path.with_name(f"{path.stem}-{k + 1}{path.suffix}") for k in range(count)]


def _column(text: str) -> tuple[str, str]:
    name, equals, place = text.rpartition("=")
    if not equals or not name:
        raise UserError(f"--column must be NAME=PLACE, such as 'marker 7 X=position 0', not {text!r}")
    return name, place


def _write(path: Path, found: SceneFit | SceneDesign, content: dict[str, Any]) -> None:
    """Write the scene, the numbers, the figure of a fit or the page of a design, as the suffix of `path` says."""
    from softcradle.sandbox.files import readable_json

    if path.suffix == SCENE:
        path.write_text(found.scene.to_toml(), encoding="utf-8")
    elif path.suffix == NUMBERS:
        path.write_text(readable_json(content) + "\n", encoding="utf-8")
    elif path.suffix == PAGE:
        from softcradle.sandbox.page import scene_text

        path.write_text(scene_text(found.scene)[0], encoding="utf-8")
    else:
        from softcradle.sandbox.studies.fitting.fit_scene import SceneFit
        from softcradle.sandbox.studies.plot_style import save_figure

        assert isinstance(found, SceneFit)
        save_figure(found.plot(), path)


def fit_numbers(found: SceneFit) -> dict[str, Any]:
    """Return the results of a fit as a dictionary for JSON."""
    from softcradle.physics.checked_input import finite_or_none
    from softcradle.physics.trajectory_file import versions

    return {
        "title": found.scene.title,
        "data": found.table.name,
        "values": {
            name: {"value": value, "error": finite_or_none(error), "determined": bool(known)}
            for name, value, error, known in zip(
                found.names, found.values.tolist(), found.errors.tolist(), found.determined, strict=True
            )
        },
        "correlation": [[finite_or_none(one) for one in row] for row in found.correlation.tolist()],
        "restitution": {name: {"value": e, "error": finite_or_none(de)} for name, (e, de) in found.restitution.items()},
        "noise": dict(found.noise),
        "singular values": found.singular_values.tolist(),
        "statements": list(found.statements),
        "starts": found.starts,
        "runs": found.runs,
        "versions": versions(),
    }


def print_fit(found: SceneFit) -> None:
    """Print the fitted values, their correlations and the sentences about the fit."""
    from softcradle.sandbox.studies.fitting.fit_scene import shown_value
    from softcradle.sandbox.studies.fitting.observations import UNIT_OF

    output = console()
    output.print(f"{found.scene.title}: fit to {found.table.name}", style="bold")
    rows = []
    for k, one in enumerate(found.free):
        value, error = float(found.values[k]), float(found.errors[k])
        text = shown_value(value, error) if found.determined[k] else f"{value:.4g}"
        rows.append((one.name, text, f"{one.value:.6g}", "" if found.determined[k] else "not determined"))
    for name, (value, error) in found.restitution.items():
        rows.append((f"restitution of {name}", shown_value(value, error), "", ""))
    print_rows(("free value", "fitted", "start", "remark"), rows, True, output)
    strongest = _strongest(found)
    if strongest:
        output.print(strongest)
    noise = ", ".join(f"{quantity} {size:.3g} {UNIT_OF[quantity]}" for quantity, size in found.noise.items())
    output.print(f"noise: {noise}; {found.time.size} times, {found.starts} starts, {found.runs} runs")
    for sentence in found.statements:
        output.print(sentence, style="yellow")


def _strongest(found: SceneFit) -> str:
    """Return a line about the two fitted values with the strongest correlation, or an empty text if all are
    independent.
    """
    import numpy as np

    size = np.abs(np.nan_to_num(np.triu(found.correlation, 1)))
    if not size.any():
        return ""
    i, j = np.unravel_index(int(np.argmax(size)), size.shape)
    return f"strongest correlation: {found.correlation[i, j]:.3f}, of {found.names[i]} and {found.names[j]}"


def print_scatter(found: Sequence[SceneFit]) -> None:
    """Print the mean and the scatter of each fitted value. Mean and scatter follow from the fits of several tables of
    data.
    """
    import numpy as np

    rows = []
    names = [name for name in found[0].names if all(name in one.names for one in found)]
    for name in names:
        values = np.array([one.values[one.names.index(name)] for one in found])
        rows.append(
            (name, f"{values.mean():.5g}", f"{values.std(ddof=1):.2g}", f"{values.min():.5g}", f"{values.max():.5g}")
        )
    for name in found[0].restitution:
        values = np.array([one.restitution[name][0] for one in found])
        text = f"restitution of {name}"
        rows.append(
            (text, f"{values.mean():.5g}", f"{values.std(ddof=1):.2g}", f"{values.min():.5g}", f"{values.max():.5g}")
        )
    output = console()
    output.print(f"{len(found)} tables of data", style="bold")
    print_rows(("free value", "mean", "scatter", "least", "most"), rows, True, output)


def _design(args: argparse.Namespace, scene: Scene) -> int:
    from softcradle.sandbox.studies.fitting.design_scene import design

    wanted = [_checked_output(name, (SCENE, NUMBERS, PAGE)) for name in args.output]
    written = WrittenFiles(wanted)
    with opened_outputs(wanted) as temporary:
        with ProgressShown("generations") as progress:
            found = design(scene, args.goal, args.free, seed=args.seed, progress=progress.tell)
        content = found.numbers()
        for place in temporary:
            _write(place, found, content)
    if args.json:
        print_json(content)
    else:
        _print_design(found)
    written.report(wanted, show=args.open, silent=args.json)
    return 0


def _print_design(found: SceneDesign) -> None:
    output = console()
    output.print(f"{found.scene.title}: {', '.join(goal.text for goal in found.goals)}", style="bold")
    rows = []
    for one, value, error in zip(found.free, found.values.tolist(), found.errors.tolist(), strict=True):
        from softcradle.sandbox.studies.fitting.fit_scene import shown_value

        rows.append((one.name, shown_value(value, error), f"{one.low:.6g}..{one.high:.6g}"))
    print_rows(("free value", "found", "bounds"), rows, True, output)
    for sentence in found.statements:
        output.print(sentence)
