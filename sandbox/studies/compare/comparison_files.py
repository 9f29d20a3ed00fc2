"""What a comparison writes: the report, a film, or the numbers; each file whole or not at all."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from softcradle.physics.analysis.matching import Match
from softcradle.sandbox.film.codecs import check
from softcradle.sandbox.film.scene_film import RenderReport, render_scene
from softcradle.sandbox.output_files import output_file
from softcradle.sandbox.studies.compare.comparison_results import Result, as_json, ends
from softcradle.sandbox.studies.compare.html_report import Embedded, page
from softcradle.sandbox.studies.compare.matched_side import match_json, sentence
from softcradle.sandbox.studies.compare.sides import Comparison
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Scene

WIDTH, LEAST_HEIGHT, ROW = 1280, 720, 300  # pixels of the film, and of each of its rows where there are many
LONGEST = 20.0  # seconds of film, where nobody wishes how slow
FILMS = (".mp4", ".gif", ".webp", ".avif")


@dataclass(frozen=True)
class Wishes:
    """Pixels of the film, seconds of film for one of motion, and its method and step; None leaves it to us."""

    size: tuple[int, int] | None = None
    slow: float | None = None
    method: str | None = None
    step: float | None = None

    def pixels(self, comparison: Comparison) -> tuple[int, int]:
        """Size of the film: a row a side."""
        return self.size or (WIDTH, max(LEAST_HEIGHT, 96 + ROW * len(comparison.sides)))

    def pace(self, scene: Scene, end: float) -> float:
        """Seconds of film for one of motion: the scenes' own, unless that would take too long."""
        return self.slow or min(scene.view.slow, LONGEST / end)


def checked_outputs(paths: Sequence[Path], comparison: Comparison, wishes: Wishes) -> None:
    """A UserError for a kind of file or a size that cannot be, and for a file that is there twice."""
    for path in paths:
        if path.suffix not in (".html", ".json", *FILMS):
            known = ", ".join((".html", ".json", *FILMS))
            raise UserError(f"cannot write {path}: the name must end in {known}")
        if path.suffix in (".html", *FILMS):
            check(path if path.suffix in FILMS else "film.mp4", wishes.pixels(comparison), None)
    if len({os.path.abspath(path) for path in paths}) < len(paths):
        raise UserError("the same file is given twice with -o")


def opened(stack: ExitStack, paths: Sequence[Path]) -> list[Path]:
    """Temporary files that take the places of `paths` when all is done."""
    return [stack.enter_context(output_file(path)) for path in paths]


@dataclass(frozen=True)
class Report:
    """A comparison with its results, how its film is wished, and a match if one was asked for."""

    comparison: Comparison
    results: Sequence[Result]
    wishes: Wishes = Wishes()
    match: Match | None = None

    def notes(self) -> list[str]:
        """Sentences that stand below the numbers."""
        return [] if self.match is None else [sentence(self.match)]

    def plain(self) -> dict[str, Any]:
        """Everything as plain numbers, lists and texts."""
        told = as_json(self.comparison, self.results)
        return told if self.match is None else told | {"match": match_json(self.match)}

    def page(self) -> str:
        """The page as text."""
        with tempfile.TemporaryDirectory(prefix="softcradle-") as folder:
            film, still = Path(folder) / "film.mp4", Path(folder) / "still.png"
            made = self.film(film)
            self.film(still)
            size, slow = self.wishes.pixels(self.comparison), self._pace(self._scene())
            return page(self.comparison, self.results, Embedded(film, still, size, made.clock, slow), self.notes())

    def film(self, path: Path) -> RenderReport:
        """Write the film, or a picture of its strongest moment."""
        scene = self._scene()
        wishes = self.wishes
        size, slow = wishes.pixels(self.comparison), self._pace(scene)
        return render_scene(scene, path, size, slow=slow, method=wishes.method, step=wishes.step)

    def _scene(self) -> Scene:
        return self.comparison.film(ends(self.results))

    def _pace(self, scene: Scene) -> float:
        return self.wishes.pace(scene, ends(self.results))


def write(path: Path, report: Report) -> None:
    """Write the kind of file that the name of `path` asks for."""
    if path.suffix == ".json":
        path.write_text(json.dumps(report.plain(), indent=2, allow_nan=False) + "\n", encoding="utf-8")
    elif path.suffix == ".html":
        path.write_text(report.page(), encoding="utf-8")
    else:
        report.film(path)
