"""The report: one HTML page with film, charts and tables inside it, nothing loaded from anywhere."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass, fields
from html import escape
from pathlib import Path

from softcradle.physics.analysis.collision import CollisionMeasures, ContactMeasures
from softcradle.physics.version import version
from softcradle.sandbox.draw.number_format import factor
from softcradle.sandbox.resources import resource
from softcradle.sandbox.studies.compare import comparison_plots as plots
from softcradle.sandbox.studies.compare.comparison_results import Result
from softcradle.sandbox.studies.compare.comparison_tables import (
    Row,
    collision_rows,
    contact_rows,
    contact_titles,
    velocity_rows,
)
from softcradle.sandbox.studies.compare.sides import Comparison


@dataclass(frozen=True)
class Embedded:
    """The film and its strongest moment as files, and how film and motion go together.

    Attributes:
        film, still: paths of the .mp4 and the .png.
        size: pixels.
        clock: time in the motion [s] when the film begins.
        slow: seconds of film for one of motion.
    """

    film: Path
    still: Path
    size: tuple[int, int]
    clock: float
    slow: float


def page(comparison: Comparison, results: Sequence[Result], embedded: Embedded, notes: Sequence[str] = ()) -> str:
    """The whole page as text; `notes` are sentences that stand below the numbers."""
    clock = plots.Clock(results)
    sources = dict.fromkeys(side.scene.source for side in comparison.sides if side.scene.source)
    parts = [
        f"<h1>{escape(comparison.title)}</h1>",
        f'<p class="source">{escape(" · ".join(sources))}</p>',
        _film(embedded, clock),
        "<h2>In numbers</h2>",
        _table([""] + [r.side.name for r in results], collision_rows(results) + velocity_rows(results)),
        "".join(f'<p class="note">{escape(note)}</p>' for note in notes),
        _warnings(results),
        "<h2>On top of each other</h2>", plots.overlays(results, clock),
        "<h2>Velocities</h2>", plots.velocity_charts(results, clock),
        "<h2>Forces</h2>", plots.force_charts(results, clock),
        "<h2>Open, touching, loaded</h2>", plots.contact_bars(results, clock),
        "<h2>Contact by contact</h2>",
        *(_table(["contact"] + [t for t, _ in contact_titles()], contact_rows(r), r.side.name) for r in results),
        "<h2>What the numbers mean</h2>", _meanings(),
        _footer(results),
    ]  # fmt: skip
    return _document(comparison.title, "\n".join(part for part in parts if part))


def _document(title: str, body: str) -> str:
    style, script = (resource(f"report/compare.{kind}").read_text(encoding="utf-8") for kind in ("css", "js"))
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<title>{escape(title)}</title>\n<link rel="icon" href="data:,">\n<style>\n{style}</style>\n</head>\n<body>\n'
        f"{body}\n<script>\n{script}</script>\n</body>\n</html>\n"
    )


def _film(embedded: Embedded, clock: plots.Clock) -> str:
    film, still = (base64.b64encode(path.read_bytes()).decode() for path in (embedded.film, embedded.still))
    width, height = embedded.size
    data = f'data-clock="{embedded.clock:.9g}" data-slow="{embedded.slow:.9g}" data-unit="{clock.unit:.9g}"'
    pace = (
        f"1/{embedded.slow:.4g} of the real pace"
        if embedded.slow > 1.0
        else f"{factor(1.0 / embedded.slow)} the real pace"
    )
    return (
        f'<video controls loop muted playsinline width="{width}" height="{height}" {data} '
        f'poster="data:image/png;base64,{still}" src="data:video/mp4;base64,{film}"></video>'
        f'<img class="still" alt="the moment of the greatest force" src="data:image/png;base64,{still}">'
        f'<p class="hint">All on one clock, {pace}. While it runs a line goes through the charts; a click in a chart '
        "takes the film there.</p>"
    )


def _table(titles: Sequence[str], rows: Sequence[Row], caption: str = "") -> str:
    head = "".join(f'<th scope="col">{escape(title)}</th>' for title in titles)
    lines = []
    for row in rows:
        hint = f' title="{escape(row.meaning)}"' if row.meaning else ""
        cells = "".join(f"<td>{escape(value)}</td>" for value in row.values)
        lines.append(f'<tr><th scope="row"{hint}>{escape(row.title)}</th>{cells}</tr>')
    named = f"<caption>{escape(caption)}</caption>" if caption else ""
    body = "".join(lines)
    return f'<div class="scroll"><table>{named}<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def _warnings(results: Sequence[Result]) -> str:
    told = [(r.side.name, warning.sentence) for r in results for warning in r.trajectory.warnings]
    return "".join(f'<p class="note warning">{escape(name)}: {escape(sentence)}</p>' for name, sentence in told)


def _meanings() -> str:
    told: dict[str, str] = {}
    for kind in (CollisionMeasures, ContactMeasures):
        for field in fields(kind):
            if "title" in field.metadata:
                told.setdefault(field.metadata["title"], field.metadata["meaning"])
    items = "".join(f"<dt>{escape(title)}</dt><dd>{escape(meaning)}</dd>" for title, meaning in told.items())
    return f"<dl>{items}</dl>"


def _footer(results: Sequence[Result]) -> str:
    methods = dict.fromkeys(_method(result) for result in results)
    return f"<footer>softcradle {escape(version())}; computed by {escape(', '.join(methods))}</footer>"


def _method(result: Result) -> str:
    made = result.trajectory
    return f"{made.method}, " + (f"step {made.step:.3g} s" if made.step else f"tolerance {made.tolerance:g}")
