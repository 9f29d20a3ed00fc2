"""Figure of a study. The figure shows each case with its error bar, the allowed value and the nearest counter-example."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.text import Text
from softcradle.physics.checked_input import finite_or_none
from softcradle.sandbox.console import print_table, table
from softcradle.sandbox.studies.claims.claim import Case, CaseOutcome, JudgedClaim, Verdict, case_text
from softcradle.sandbox.studies.data_table import Table
from softcradle.sandbox.studies.plot_style import BLACK, BLUE, GREY, RED, new_figure, styled, write_picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

LOG_SPAN = 30.0  # An axis is logarithmic if its largest positive number divided by its smallest is at least this ratio.
SIDE_STYLES: dict[CaseOutcome, dict[str, Any]] = {
    CaseOutcome.HOLDS: {"color": BLUE, "marker": "o"},
    CaseOutcome.FAILS: {"color": RED, "marker": "s"},
    CaseOutcome.UNDETERMINED: {"color": GREY, "marker": "x"},
}
# The labels 2 and 5 of each decade are drawn if the ratio of the largest to the smallest value is below this number.
FEW_DECADES = 100.0
MOST_TITLE = 60  # Maximum number of characters in a line of the title. The figure is as wide as a column of a journal.


def study_table(study: JudgedClaim) -> Table:
    """Return a table with one row for each case.

    The columns are the parameters, the variable, the value, its error, the allowed value and the outcome. The outcome
    is 1 if the claim holds, -1 if it fails and 0 if it is undetermined.
    """
    table: Table = {
        name: np.array([case.parameters[name] for case in study.cases]) for name in study.cases[0].parameters
    }
    columns = ("variable", "value", "error", "allowed")
    table |= {name: np.array([getattr(case, name) for case in study.cases]) for name in columns}
    sign = {CaseOutcome.HOLDS: 1.0, CaseOutcome.FAILS: -1.0, CaseOutcome.UNDETERMINED: 0.0}
    return table | {"holds": np.array([sign[case.side] for case in study.cases])}


def draw_study(study: JudgedClaim) -> Figure:
    """Draw all cases of a study in a figure that is as wide as a column of a journal."""
    figure, axes = new_figure(height=2.9)
    _set_scales(axes, study)
    for side in CaseOutcome:
        _draw_cases(axes, study.on(side), side)
    axes.axhline(study.cases[0].allowed, color=BLACK, linewidth=0.7, linestyle="--", label="allowed")
    _ring(axes, study.own_case, "the paper's own", GREY)
    if study.counter_example is not None and study.counter_example is not study.own_case:
        _ring(axes, study.counter_example, "counter-example", RED)
    axes.set(xlabel=study.variable.replace("alpha", r"$\alpha$"), ylabel="\n".join(_lines(study.quantity, 48)))
    axes.xaxis.label.set_fontsize(8.0)
    axes.yaxis.label.set_fontsize(7.5)
    axes.set_title(
        "\n".join([*_lines(study.statement, MOST_TITLE), *_lines(study.verdict_text, MOST_TITLE)]),
        fontsize=7.0,
        loc="left",
    )
    figure.legend(fontsize=6.5, ncols=3, loc="outside lower center", columnspacing=1.0, handletextpad=0.4)
    return figure


def _draw_cases(axes: Axes, cases: list[Case], side: CaseOutcome) -> None:
    drawn = [case for case in cases if math.isfinite(case.value) and math.isfinite(case.error)]
    if not drawn:
        return
    variable, value, error = np.array([(case.variable, case.value, case.error) for case in drawn]).T
    axes.errorbar(
        variable, value, error, linestyle="none", markersize=3.0, elinewidth=0.7, label=f"{side} ({len(cases)})",
        **SIDE_STYLES[side],
    )  # fmt: skip


def _ring(axes: Axes, case: Case, label: str, colour: str) -> None:
    """Draw a ring around `case` if it has a value."""
    if math.isfinite(case.value):
        axes.plot(
            [case.variable], [case.value], "o", markersize=9.0, markerfacecolor="none", color=colour, linestyle="none",
            label=label,
        )  # fmt: skip


def _set_scales(axes: Axes, study: JudgedClaim) -> None:
    variable = np.array([case.variable for case in study.cases])
    value = np.array([case.value for case in study.cases if math.isfinite(case.value)])
    if _spans_decades(variable):
        axes.set_xscale("log")
        _label_decades(axes.xaxis, variable)
    if _spans_decades(value):
        axes.set_yscale("log")
        _label_decades(axes.yaxis, value)


def _label_decades(axis: Axis, values: np.ndarray) -> None:
    """Label the powers of ten of an axis. If there are few of them, also label 2 and 5 times each."""
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    if values.max() < FEW_DECADES * values.min():
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_formatter(NullFormatter())


def _spans_decades(values: np.ndarray) -> bool:
    return bool(values.size and values.min() > 0.0 and values.max() > LOG_SPAN * values.min())


def _lines(text: str, width: int) -> list[str]:
    import textwrap

    return textwrap.wrap(text, width)


COLOURS = {Verdict.HOLDS: "green", Verdict.WITHIN: "yellow", Verdict.BEYOND: "red", Verdict.UNDETERMINED: "magenta"}


def print_studies(output: Console, studies: Sequence[JudgedClaim]) -> None:
    """Print one row for each claim, and the number of claims with each verdict."""
    grid = table("claim", "statement and place", "what we measure", "range", "verdict")
    grid.show_lines, grid.expand = True, True
    for column, share in zip(grid.columns, (2, 5, 9, 4, 3), strict=True):
        column.ratio, column.overflow = share, "fold"
    for study in studies:
        verdict = Text(study.verdict_text, COLOURS[study.verdict])
        grid.add_row(study.name, f"{study.statement} ({study.place})", study.measured_text, study.range_text, verdict)
    print_table(output, grid)
    for kind, colour in COLOURS.items():
        output.print(f"{kind}: {sum(study.verdict is kind for study in studies)}", style=colour)
    output.print(f"processor time: {sum(study.seconds for study in studies):.0f} s for {len(studies)} claims")


def print_study(output: Console, study: JudgedClaim) -> None:
    """Print the statement of one claim, its verdict, the description of the measurement, and all cases."""
    output.print(f"{study.name}: {study.statement} ({study.place})", style="bold")
    output.print(study.verdict_text, style=COLOURS[study.verdict])
    output.print(f"Measured: {study.measured_text}.")
    output.print(f"How: {study.how}. Range: {study.range_text}.")
    if math.isfinite(study.reference):
        output.print(f"The independent reference finds {study.reference:.6g} in the paper's own case.")
    own_column = study.variable not in study.cases[0].parameters
    grid = table(*study.cases[0].parameters, *[study.variable] * own_column, "value", "error", "", numbers=True)
    for case in study.cases:
        shown = [f"{number:.4g}" for number in case.parameters.values()]
        shown += [f"{case.variable:.4g}"] * own_column
        grid.add_row(*shown, f"{case.value:.5g}", f"{case.error:.1g}", case.reason or case.side)
    print_table(output, grid)


def markdown(studies: Sequence[JudgedClaim]) -> Iterator[str]:
    """Yield the lines of a Markdown table that has one row for each claim, in the order of the paper."""
    yield "| claim | what the paper states | verdict | what was found |"
    yield "|---|---|---|---|"
    for study in studies:
        cells = (f"`{study.name}`", f"{study.statement} ({study.place})", study.verdict_text, study.measured_text)
        yield f"| {' | '.join(_cell(cell) for cell in cells)} |"


def _cell(text: str) -> str:
    """Escape `text` for a table cell. Markdown would read powers, products, bars and comparisons as mark-up."""
    if text.startswith("`"):
        return text
    for sign in "\\|*_<>$[]":
        text = text.replace(sign, "\\" + sign)
    return text


def as_json(study: JudgedClaim) -> dict[str, Any]:
    """Return a study as JSON data. Missing and undefined numbers are null."""
    counter = study.counter_example
    return {
        "name": study.name, "statement": study.statement, "place": study.place, "quantity": study.quantity,
        "variable": study.variable, "how": study.how, "range": study.range_text, "remark": study.remark,
        "verdict": str(study.verdict), "verdict text": study.verdict_text, "limit": study.limit, "by the bar": study.bar_text,
        "measured": study.measured_text, "own case": _case_json(study.own_case), "reference": finite_or_none(study.reference),
        "counter-example": None if counter is None else _case_json(counter),
        "cases": [_case_json(case) for case in study.cases], "seconds": study.seconds,
    }  # fmt: skip


def _case_json(case: Case) -> dict[str, Any]:
    return {
        "parameters": dict(case.parameters), "variable": case.variable, "value": finite_or_none(case.value),
        "error": finite_or_none(case.error), "allowed": case.allowed, "side": str(case.side), "reason": case.reason,
        "text": case_text(case),
    }  # fmt: skip


def write_studies(studies: Sequence[JudgedClaim], folder: Path) -> list[Path]:
    """Write each study as .png, .pdf and .csv files, and return their paths."""
    paths: list[Path] = []
    with styled():
        for study in studies:
            stem = folder / f"claim-{study.name.replace('/', '-over-')}"
            paths += write_picture(draw_study(study), study_table(study), stem)
    return paths
