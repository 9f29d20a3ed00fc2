"""The files of a comparison: the report, a film, or the numbers; each is written whole or not at all."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from softcradle.physics.analysis.matching import Match
from softcradle.sandbox.film.film_kinds import check
from softcradle.sandbox.film.scene_film import RenderReport, render_scene
from softcradle.sandbox.output_files import output_file
from softcradle.sandbox.studies.compare.comparison_report import html_page
from softcradle.sandbox.studies.compare.comparison_results import SideResult, end_time, results_as_json
from softcradle.sandbox.studies.compare.matched_side import match_as_json, match_sentence
from softcradle.sandbox.studies.compare.sides import Comparison
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Scene

FILM_WIDTH = 1280  # [pixels]
FILM_LEAST_HEIGHT = 720  # [pixels]
FILM_MARGIN = 96  # [pixels] above and below all rows
FILM_ROW = 300  # [pixels] height of one side
LONGEST_FILM = 20.0  # [s] where no slow motion is given
FILM_SUFFIXES = (".mp4", ".gif", ".webp", ".avif")
SUFFIXES = (".html", ".json", *FILM_SUFFIXES)


@dataclass(frozen=True)
class FilmSettings:
    """Settings of the film as a user gives them.

    Attributes:
        size: [pixels]; None fits the number of sides.
        slow: seconds of film for one of motion; None takes the scenes' own, shortened to LONGEST_FILM.
        method, step: of the simulation; None takes the scenes' own.
    """

    size: tuple[int, int] | None = None
    slow: float | None = None
    method: str | None = None
    step: float | None = None

    def pixels(self, comparison: Comparison) -> tuple[int, int]:
        """Size of the film: a row a side."""
        height = max(FILM_LEAST_HEIGHT, FILM_MARGIN + FILM_ROW * len(comparison.sides))
        return self.size or (FILM_WIDTH, height)

    def slow_motion(self, scene: Scene, end: float) -> float:
        """Seconds of film for one of motion, which lasts until `end` [s]."""
        return self.slow or min(scene.view.slow, LONGEST_FILM / end)


def check_outputs(paths: Sequence[Path], comparison: Comparison, settings: FilmSettings) -> None:
    """Raise a UserError for an unknown kind of file, an impossible size, or a file that is given twice."""
    for path in paths:
        if path.suffix not in SUFFIXES:
            raise UserError(f"cannot write {path}: the name must end in {', '.join(SUFFIXES)}")
        if path.suffix != ".json":
            check(path if path.suffix in FILM_SUFFIXES else "film.mp4", settings.pixels(comparison), None)
    if len({os.path.abspath(path) for path in paths}) < len(paths):
        raise UserError("the same file is given twice with -o")


def open_outputs(stack: ExitStack, paths: Sequence[Path]) -> list[Path]:
    """Temporary files that become `paths` when `stack` is left without an error."""
    return [stack.enter_context(output_file(path)) for path in paths]


@dataclass(frozen=True)
class ComparisonReport:
    """A comparison with its results, the settings of its film, and the nearest contact if one was searched."""

    comparison: Comparison
    results: Sequence[SideResult]
    settings: FilmSettings = FilmSettings()
    match: Match | None = None

    def notes(self) -> list[str]:
        """Sentences that stand below the numbers."""
        return [] if self.match is None else [match_sentence(self.match)]

    def as_json(self) -> dict[str, Any]:
        """Everything as plain numbers, lists and texts."""
        content = results_as_json(self.comparison, self.results)
        return content if self.match is None else content | {"match": match_as_json(self.match)}

    def html(self) -> str:
        """The page as text."""
        scene = self._scene()
        view = scene.view.model_copy(update={"slow": self._slow_motion(scene)})
        return html_page(self.comparison.title, scene.model_copy(update={"view": view}), self.results, self.notes())

    def write_film(self, path: Path) -> RenderReport:
        """Write the film, or for a picture's name the frame of the greatest force."""
        scene, settings = self._scene(), self.settings
        size, slow = settings.pixels(self.comparison), self._slow_motion(scene)
        return render_scene(scene, path, size, slow=slow, method=settings.method, step=settings.step)

    def write(self, path: Path) -> None:
        """Write the kind of file that the name of `path` tells."""
        if path.suffix == ".json":
            path.write_text(json.dumps(self.as_json(), indent=2, allow_nan=False) + "\n", encoding="utf-8")
        elif path.suffix == ".html":
            path.write_text(self.html(), encoding="utf-8")
        else:
            self.write_film(path)

    def _scene(self) -> Scene:
        return self.comparison.as_scene(end_time(self.results))

    def _slow_motion(self, scene: Scene) -> float:
        return self.settings.slow_motion(scene, end_time(self.results))
