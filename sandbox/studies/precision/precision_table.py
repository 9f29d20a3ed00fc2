"""The measurements as rows: for people the least time to each error, for files every point."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from softcradle.physics.methods import AUTO
from softcradle.sandbox.studies.precision.chart_cases import REACHES, Case
from softcradle.sandbox.studies.precision.work_precision import Point, Series, by_name, fastest

COLUMNS = ("case", "method", "ours", "setting", "tolerance or steps", "error", "seconds", "evaluations")


@dataclass(frozen=True)
class Measured:
    """A case with all its series; the quantity whose error they hold."""

    case: Case
    series: list[Series]
    quantity: str = "velocities"


@dataclass(frozen=True)
class Row:
    """One curve: its fastest point for each error of REACHES, None where there is none, and why it goes no further."""

    name: str
    ours: bool
    best: list[Point | None]
    ended: str


def rows(found: Measured) -> list[Row]:
    """A row a name."""
    return [
        Row(name, some[0].solver.ours, [fastest(some, reach) for reach in REACHES], _ended(some))
        for name, some in by_name(found.series).items()
    ]


def _ended(series: Sequence[Series]) -> str:
    """Why the most exact of them has no finer point."""
    return min(series, key=lambda one: min((point.error for point in one.points), default=math.inf)).ended


def least(found: Sequence[Row], ours: bool, k: int) -> Row | None:
    """The row of the fastest way to the k-th error of REACHES among the methods of `simulate`, or among the peers."""
    reaching = [row for row in found if row.ours == ours and row.best[k] is not None]
    return min(reaching, key=lambda row: row.best[k].seconds, default=None)  # type: ignore[union-attr]


def ratio(found: Sequence[Row], k: int) -> float | None:
    """Time of the fastest peer over that of our fastest method; inf where no peer arrives, None where none of ours does."""
    mine, peer = least(found, True, k), least(found, False, k)
    if mine is None:
        return None
    return math.inf if peer is None else peer.best[k].seconds / mine.best[k].seconds  # type: ignore[union-attr]


def ratio_sentence(found: Sequence[Row]) -> str:
    """Who is fastest to each error, and the ratios of the times."""
    parts = []
    for k, reach in enumerate(REACHES):
        mine, peer, value = least(found, True, k), least(found, False, k), ratio(found, k)
        if value is None or mine is None:
            parts.append(f"{reach:g}: none of ours")
        elif peer is None:
            parts.append(f"{reach:g}: {mine.name}, no peer")
        else:
            parts.append(f"{reach:g}: {peer.name} / {mine.name} = {value:.2g}")
    return "fastest peer over our fastest, at " + "; ".join(parts)


def auto_sentence(found: Sequence[Row]) -> str:
    """How many times as long as the fastest of our methods `auto` takes to each error; "" where it was not measured."""
    auto = next((row for row in found if row.name == AUTO), None)
    if auto is None:
        return ""
    others = [row for row in found if row.name != AUTO]
    parts = []
    for k, reach in enumerate(REACHES):
        mine, best = auto.best[k], least(others, True, k)
        known = mine is not None and best is not None and best.best[k] is not None
        parts.append(f"{reach:g}: " + (f"{mine.seconds / best.best[k].seconds:.2g}" if known else "-"))  # type: ignore[union-attr]
    return f"auto over the fastest of our methods, at {'; '.join(parts)}"


def how(best: Point | None) -> str:
    """The setting of a point."""
    if best is None:
        return "-"
    fineness = f"{best.fineness:.0f} steps" if best.solver.steps else f"{best.fineness:.0e}"
    return f"{best.solver.setting} {fineness}".strip()


def write_csv(measured: Sequence[Measured], path: Path) -> None:
    """Every point of every series; no number where a run gave up or nobody counts."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow((*COLUMNS[:5], f"error of {measured[0].quantity}", *COLUMNS[6:]))
        for found in measured:
            for one in found.series:
                for point in one.points:
                    writer.writerow(
                        (found.case.name, one.solver.name, int(one.solver.ours), one.solver.setting, point.fineness,
                         _number(point.error), point.seconds, _number(point.evaluations))
                    )  # fmt: skip


def _number(value: float) -> float | str:
    return value if math.isfinite(value) else ""
