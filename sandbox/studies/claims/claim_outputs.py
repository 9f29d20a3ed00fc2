"""What is printed and written of studies: a table, the cases of one of them, JSON, and a picture with its numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.text import Text
from softcradle.sandbox.console import print_table, table
from softcradle.sandbox.studies.claims.claim import Case, Study, Verdict, case_text

COLOURS = {Verdict.HOLDS: "green", Verdict.WITHIN: "yellow", Verdict.BEYOND: "red", Verdict.UNDETERMINED: "magenta"}


def print_studies(output: Console, studies: Sequence[Study]) -> None:
    """A row a claim, and how often each verdict was reached."""
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


def print_study(output: Console, study: Study) -> None:
    """One claim: statement, verdict, how it was measured, and all cases."""
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


def markdown(studies: Sequence[Study]) -> Iterator[str]:
    """Lines of a table in Markdown: a row a claim, in the order of the paper."""
    yield "| claim | what the paper states | verdict | what was found |"
    yield "|---|---|---|---|"
    for study in studies:
        cells = (f"`{study.name}`", f"{study.statement} ({study.place})", study.verdict_text, study.measured_text)
        yield f"| {' | '.join(_cell(cell) for cell in cells)} |"


def _cell(text: str) -> str:
    """Text that is no mark-up: powers, products, bars and comparisons stay as they are."""
    if text.startswith("`"):
        return text
    for sign in "\\|*_<>$[]":
        text = text.replace(sign, "\\" + sign)
    return text


def as_json(study: Study) -> dict[str, Any]:
    """A study as JSON: numbers that do not exist are null."""
    counter = study.counter_example
    return {
        "name": study.name, "statement": study.statement, "place": study.place, "quantity": study.quantity,
        "variable": study.variable, "how": study.how, "range": study.range_text, "remark": study.remark,
        "verdict": str(study.verdict), "verdict text": study.verdict_text, "limit": study.limit, "by the bar": study.bar_text,
        "measured": study.measured_text, "own case": _case_json(study.own_case), "reference": _finite(study.reference),
        "counter-example": None if counter is None else _case_json(counter),
        "cases": [_case_json(case) for case in study.cases], "seconds": study.seconds,
    }  # fmt: skip


def _case_json(case: Case) -> dict[str, Any]:
    return {
        "parameters": dict(case.parameters), "variable": case.variable, "value": _finite(case.value),
        "error": _finite(case.error), "allowed": case.allowed, "side": str(case.side), "reason": case.reason,
        "text": case_text(case),
    }  # fmt: skip


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def write_studies(studies: Sequence[Study], folder: Path) -> list[Path]:
    """The picture of each study as .png, .pdf and .csv; the paths."""
    from softcradle.sandbox.studies.claims.study_figure import draw_study, study_table
    from softcradle.sandbox.studies.picture_files import write_picture
    from softcradle.sandbox.studies.plot_style import styled

    paths: list[Path] = []
    with styled():
        for study in studies:
            stem = folder / f"claim-{study.name.replace('/', '-over-')}"
            paths += write_picture(draw_study(study), study_table(study), stem)
    return paths
