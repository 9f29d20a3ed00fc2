"""The report: one HTML page with player, charts and tables inside it, nothing loaded from anywhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from html import escape

from softcradle.physics.analysis.collision_measures import CollisionMeasures, ContactMeasures
from softcradle.sandbox.page.motion_charts import chart_row, force_chart, velocity_chart
from softcradle.sandbox.page.page_document import document, footer, heading, note, table
from softcradle.sandbox.page.page_tables import member_notes
from softcradle.sandbox.page.played_motion import Member, PlayedMotion
from softcradle.sandbox.page.player_section import player_section
from softcradle.sandbox.studies.compare.comparison_plots import TimeAxis, contact_bars, overlays
from softcradle.sandbox.studies.compare.comparison_results import SideResult
from softcradle.sandbox.studies.compare.comparison_tables import (
    MeasureRow,
    collision_rows,
    contact_rows,
    contact_titles,
    velocity_rows,
)
from softcradle.scenes import Scene


def html_page(title: str, scene: Scene, results: Sequence[SideResult], notes: Sequence[str] = ()) -> str:
    """The whole page as text; `scene` has a lane for each of `results`, `notes` are sentences that stand below the numbers."""
    names = [result.side.name for result in results]
    member = Member("", tuple(result.trajectory for result in results), tuple(names))
    played = PlayedMotion(scene, (member,))
    lanes, axis = range(len(results)), TimeAxis(played)
    parts = [
        heading(title, scene.source),
        player_section(played),
        member_notes(member),
        "<h2>In numbers</h2>",
        _measures(["", *names], collision_rows(results) + velocity_rows(results), "The collision"),
        *(note(text) for text in notes),
        "<h2>On top of each other</h2>", overlays(results, axis),
        "<h2>Velocities</h2>", chart_row([velocity_chart(played, lane) for lane in lanes]),
        "<h2>Forces</h2>", chart_row([force_chart(played, lane) for lane in lanes]),
        "<h2>Open, touching, loaded</h2>", contact_bars(results, axis),
        "<h2>Contact by contact</h2>",
        *(_measures(["contact", *(t for t, _ in contact_titles())], contact_rows(r), r.side.name) for r in results),
        "<h2>What the numbers mean</h2>", _meanings(),
        footer([]),
    ]  # fmt: skip
    return document(title, parts)


def _measures(titles: Sequence[str], rows: Sequence[MeasureRow], caption: str) -> str:
    return table(titles, [(row.title, *row.values) for row in rows], caption, [row.meaning for row in rows])


def _meanings() -> str:
    meanings: dict[str, str] = {}
    for kind in (CollisionMeasures, ContactMeasures):
        for field in fields(kind):
            if "title" in field.metadata:
                meanings.setdefault(field.metadata["title"], field.metadata["meaning"])
    items = "".join(f"<dt>{escape(title)}</dt><dd>{escape(meaning)}</dd>" for title, meaning in meanings.items())
    return f"<dl>{items}</dl>"
