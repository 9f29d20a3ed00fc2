"""Files of a comparison: a page with a player, charts and tables, or a film, or the numbers.

Each file is written completely or not at all.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.analysis.collision import ContactMeasures
from softcradle.physics.analysis.matching import Match
from softcradle.physics.analysis.measures import can_touch, energy_inside, first_touch, loaded_samples
from softcradle.physics.coupler import Coupler
from softcradle.sandbox.draw.shared_scales import axis_range
from softcradle.sandbox.files import readable_json
from softcradle.sandbox.film.formats import check
from softcradle.sandbox.film.scene_film import render_scene
from softcradle.sandbox.page.document import footer, note, table
from softcradle.sandbox.page.played_motion import PlayedMotion, result_notes
from softcradle.sandbox.page.shared_page import recorded_page
from softcradle.sandbox.page.svg_charts import ChartAxes, Curve, Range, bar_chart, chart_row, line_chart
from softcradle.sandbox.quantities import FORCE, OVERLAP, TIME
from softcradle.sandbox.studies.compare.results import (
    SideResult,
    collision_table,
    contact_table,
    end_time,
    results_as_json,
    title_of,
    velocity_table,
)
from softcradle.sandbox.studies.compare.sides import Comparison, match_as_json, match_sentence
from softcradle.sandbox.trajectory_summary import ResultTable
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Scene

Array = NDArray[np.float64]
LAW_POINTS = 400  # Number of points of the curve of a contact law.


class TimeAxis:
    """Time axis that all charts and the player of a page share, with a suitable unit."""

    def __init__(self, played: PlayedMotion) -> None:
        self.begin, self.end = played.scales.time
        self.unit, self.unit_name = played.time_unit
        self.label = f"{TIME.name} ({self.unit_name})"

    def axes(self, values: Range, label: str) -> ChartAxes:
        """Return the axes of a chart that shows `values` over time."""
        return ChartAxes((self.begin / self.unit, self.end / self.unit), values, self.label, label)

    def times(self, result: SideResult) -> Array:
        """Return the (T+2,) sample times in the unit of the axis.

        The last two entries are the end of the motion and the end of the axis; see :func:`_extended`.
        """
        time = result.trajectory.time
        extended: Array = np.concatenate((time, [time[-1], max(self.end, float(time[-1]))])) / self.unit
        return extended


def _extended(values: Array, last: Array | float) -> Array:
    """Return the (T+2, ...) array that consists of `values` (T, ...) and two copies of `last`.

    The values `last` apply from the end of the motion to the end of the axis.
    """
    extended: Array = np.concatenate((values, np.broadcast_to(last, (2, *values.shape[1:]))))
    return extended


def _forces(result: SideResult) -> Array:
    """Return the (T+2, n) contact forces. After the motion, the force of a contact that is open at its end is 0."""
    found = result.trajectory
    closed = [bool(spans) and math.isinf(spans[-1][1]) for spans in found.contact_intervals]
    return _extended(found.force, np.where(closed, found.force[-1], 0.0))


def overlays(results: Sequence[SideResult], axis: TimeAxis) -> str:
    """Return three charts that compare all sides.

    The charts show the force of the struck contact, the energy inside the target cluster, and the contact laws.
    """
    forces = [_forces(result)[:, result.measures.struck] for result in results]
    inside = [_energy_inside(result) for result in results]
    return chart_row(
        [
            _overlay("Force of the struck contact", results, forces, axis, FORCE.title),
            _overlay("Energy inside the target cluster", results, inside, axis, "share of the energy at the start"),
            _law_chart(results),
        ]
    )


def _overlay(title: str, results: Sequence[SideResult], values: Sequence[Array], axis: TimeAxis, label: str) -> str:
    curves = [
        Curve(result.side.name, axis.times(result), column, f"s{k}")
        for k, (result, column) in enumerate(zip(results, values, strict=True))
    ]
    return line_chart(title, curves, axis.axes(axis_range(values), label))


def _energy_inside(result: SideResult) -> Array:
    share = energy_inside(result.trajectory, result.measures.struck)
    return np.nan_to_num(_extended(share, share[-1]))


def _law_chart(results: Sequence[SideResult]) -> str:
    """Return a chart of the law of the struck contact, up to the largest overlap on any side.

    The chart includes the jump of the force at overlap 0. The text is empty if no side has such a law.
    """
    deepest = max(float(r.trajectory.overlap[:, r.measures.struck].max()) for r in results)
    if deepest <= 0.0:
        return ""
    overlap = np.concatenate(([0.0], np.geomspace(1e-6, 1.0, LAW_POINTS) * deepest))
    curves = []
    for k, result in enumerate(results):
        law = result.trajectory.chain.contact[result.measures.struck]
        force = np.asarray(law.force(overlap))
        released = law.released(overlap) if isinstance(law, Coupler) else (1.0 - law.loss) * force
        curves.append(Curve(result.side.name, overlap, force, f"s{k}"))
        if np.any(released < force):
            curves.append(Curve(f"{result.side.name}, unloading", overlap, np.asarray(released), f"s{k}"))
    axes = ChartAxes((0.0, deepest), axis_range([curve.y for curve in curves]), OVERLAP.title, FORCE.title)
    return line_chart("Law of the struck contact", curves, axes)


def contact_bars(results: Sequence[SideResult], axis: TimeAxis) -> str:
    """Return a chart for each side that shows when each contact is open, touching and loaded."""
    charts = []
    for result in results:
        rows = [(f"{k}-{k + 1}", _states(result, k, axis)) for k in range(result.trajectory.chain.contacts)]
        charts.append(bar_chart(f"{result.side.name}: contacts", rows, axis.axes((0.0, 1.0), ""), axis.unit_name))
    return chart_row(charts)


def _states(result: SideResult, contact: int, axis: TimeAxis) -> list[tuple[str, float, float]]:
    """Return (state, begin, end) in the unit of the axis for the states open, closed and loaded.

    The state loaded is drawn on top of touching.
    """
    trajectory, unit = result.trajectory, axis.unit
    found, opened_last = list[tuple[str, float, float]](), axis.begin
    loaded = loaded_samples(trajectory)[:, contact]
    plain = not can_touch(trajectory.chain.contact[contact])
    for begin, opened in trajectory.contact_intervals[contact]:
        end = opened if math.isfinite(opened) else axis.end
        # A contact between beads at rest does not count as touching before the collision begins.
        closed = begin if plain else max(begin, first_touch(trajectory, result.measures.struck))
        if closed < end:
            found += [("open", opened_last / unit, closed / unit)] if opened_last < closed else []
            found.append(("loaded" if plain else "touching", closed / unit, end / unit))
            opened_last = end
        if not plain:
            found += [("loaded", a / unit, b / unit) for a, b in _intervals(trajectory.time, loaded, begin, end)]
    return [*found, ("open", opened_last / unit, axis.end / unit)] if opened_last < axis.end else found


def _intervals(time: Array, loaded: NDArray[np.bool_], begin: float, end: float) -> list[tuple[float, float]]:
    """Return the intervals between `begin` and `end` in which `loaded` (T,) is True.

    Each interval is extended by one sample at both ends.
    """
    inside = loaded & (time >= begin) & (time <= end)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], inside.astype(int), [0]))))
    last = len(time) - 1
    return [
        (max(begin, float(time[max(a - 1, 0)])), min(end, float(time[min(b, last)])))
        for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
    ]


def html_page(title: str, scene: Scene, results: Sequence[SideResult], notes: Sequence[str] = ()) -> str:
    """Return the HTML page as text.

    The scene has one lane for each of `results`. The sentences `notes` appear below the numbers.
    """
    names = [result.side.name for result in results]
    played = PlayedMotion(scene, tuple(result.trajectory for result in results), tuple(names))
    axis, measures, speeds = TimeAxis(played), collision_table(results), velocity_table(results)
    contacts = [contact_table(result) for result in results]
    parts = [
        result_notes(played),
        "<h2>In numbers</h2>",
        table(measures.titles, measures.rows + speeds.rows, "The collision", measures.hints + speeds.hints),
        *(note(text) for text in notes),
        "<h2>On top of each other</h2>", overlays(results, axis),
        "<h2>Open, touching, loaded</h2>", contact_bars(results, axis),
        "<h2>Contact by contact</h2>",
        *(table(found.titles, found.rows, name) for found, name in zip(contacts, names, strict=True)),
        "<h2>What the numbers mean</h2>", _meanings([measures, speeds], contacts),
        footer(),
    ]  # fmt: skip
    return recorded_page(played, parts, title)


def _meanings(tables: Sequence[ResultTable], contacts: Sequence[ResultTable]) -> str:
    """Return a text that explains each row of `tables` and each column of `contacts`."""
    above = {title for found in contacts for title in found.titles}
    columns = [(title_of(one), one.metadata["meaning"]) for one in fields(ContactMeasures) if title_of(one) in above]
    meanings: dict[str, str] = {}
    for title, meaning in [
        *((row[0], hint) for t in tables for row, hint in zip(t.rows, t.hints, strict=True)),
        *columns,
    ]:
        meanings.setdefault(title, meaning)
    items = (f"<dt>{escape(title)}</dt><dd>{escape(text)}</dd>" for title, text in meanings.items() if text)
    return f"<dl>{''.join(items)}</dl>"


FILM_WIDTH = 1280  # Width of the film [pixels].
FILM_LEAST_HEIGHT = 720  # Smallest height of the film [pixels].
FILM_MARGIN = 96  # Height of the free space above and below all rows of the film [pixels].
FILM_ROW = 300  # Height of the row of one side in the film [pixels].
LONGEST_FILM = 20.0  # Longest duration of the film [s] if the user does not set the slow motion.
FILM_SUFFIXES = (".mp4", ".gif")
PLAYED_SUFFIXES = (".html", *FILM_SUFFIXES)
SUFFIXES = (".json", *PLAYED_SUFFIXES)


@dataclass(frozen=True)
class FilmSettings:
    """Settings of the film as given by the user.

    Attributes:
        size: width and height [pixels]; None chooses a size that suits the number of sides.
        slow: seconds of film for each second of motion. None uses the values of the scenes, limited by LONGEST_FILM.
    """

    size: tuple[int, int] | None = None
    slow: float | None = None

    def pixels(self, comparison: Comparison) -> tuple[int, int]:
        """Return width and height of the film [pixels]. Each side has a row in the film."""
        height = max(FILM_LEAST_HEIGHT, FILM_MARGIN + FILM_ROW * len(comparison.sides))
        return self.size or (FILM_WIDTH, height)


def check_outputs(paths: Sequence[Path], comparison: Comparison, settings: FilmSettings) -> None:
    """Raise UserError if the kind of a file is unknown, or if a setting is not used by any file."""
    for path in paths:
        if path.suffix not in SUFFIXES:
            raise UserError(f"cannot write {path}: the name must end in {', '.join(SUFFIXES)}")
        if path.suffix in FILM_SUFFIXES:
            check(path, settings.pixels(comparison), None)
    for option, given, suffixes in (("size", settings.size, FILM_SUFFIXES), ("slow", settings.slow, PLAYED_SUFFIXES)):
        if given is not None and not any(path.suffix in suffixes for path in paths):
            raise UserError(f"--{option} is for {', '.join(suffixes)}: give one of them with -o")


@dataclass(frozen=True)
class ComparisonReport:
    """Comparison with its results, its film settings and, if a search was requested, the nearest contact."""

    comparison: Comparison
    results: Sequence[SideResult]
    settings: FilmSettings = FilmSettings()
    match: Match | None = None

    def notes(self) -> list[str]:
        """Return the sentences that appear below the numbers."""
        return [] if self.match is None else [match_sentence(self.match)]

    def as_json(self) -> dict[str, Any]:
        """Return the whole report as JSON data: numbers, lists and texts."""
        content = results_as_json(self.comparison, self.results)
        return content if self.match is None else content | {"match": match_as_json(self.match)}

    def html(self) -> str:
        """Return the HTML page as text."""
        scene = self._scene()
        view = scene.view.model_copy(update={"slow": self._slow_motion(scene)})
        return html_page(self.comparison.title, scene.model_copy(update={"view": view}), self.results, self.notes())

    def write(self, path: Path) -> None:
        """Write the report to `path`. The suffix of `path` selects the kind of file."""
        if path.suffix == ".json":
            path.write_text(readable_json(self.as_json()) + "\n", encoding="utf-8")
        elif path.suffix == ".html":
            path.write_text(self.html(), encoding="utf-8")
        else:
            scene = self._scene()
            render_scene(scene, path, self.settings.pixels(self.comparison), slow=self._slow_motion(scene))

    def _scene(self) -> Scene:
        return self.comparison.as_scene(end_time(self.results))

    def _slow_motion(self, scene: Scene) -> float:
        """Return the number of seconds of film for each second of motion."""
        return self.settings.slow or min(scene.view.slow, LONGEST_FILM / end_time(self.results))
