"""What a comparison writes: the report, a film, or the numbers; each file whole or not at all."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from sandbox.atomic import output_file
from sandbox.codecs import check
from sandbox.compare.choice import Comparison
from sandbox.compare.page import Embedded, page
from sandbox.compare.results import Result, as_json, ends
from sandbox.errors import UserError
from sandbox.render import RenderReport, render_scene
from scenes import Scene

WIDTH, LEAST_HEIGHT, ROW = 1280, 720, 300  # pixels of the film, and of each of its rows where there are many
LONGEST = 20.0  # seconds of film, where nobody wishes how slow
FILMS = (".mp4", ".gif", ".webp", ".avif")


@dataclass(frozen=True)
class Wishes:
    """Pixels of the film, and seconds of film for one of motion; None leaves it to us."""

    size: tuple[int, int] | None = None
    slow: float | None = None

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


def write(path: Path, comparison: Comparison, results: Sequence[Result], wishes: Wishes) -> None:
    """Write the kind of file that the name of `path` asks for."""
    if path.suffix == ".json":
        path.write_text(json.dumps(as_json(comparison, results), indent=2, allow_nan=False) + "\n", encoding="utf-8")
    elif path.suffix == ".html":
        path.write_text(report(comparison, results, wishes), encoding="utf-8")
    else:
        _film(path, comparison, results, wishes)


def report(comparison: Comparison, results: Sequence[Result], wishes: Wishes | None = None) -> str:
    """The page as text."""
    wishes = wishes or Wishes()
    with tempfile.TemporaryDirectory(prefix="softcradle-") as folder:
        film, still = Path(folder) / "film.mp4", Path(folder) / "still.png"
        made = _film(film, comparison, results, wishes)
        _film(still, comparison, results, wishes)
        slow = wishes.pace(comparison.film(ends(results)), ends(results))
        return page(comparison, results, Embedded(film, still, wishes.pixels(comparison), made.clock, slow))


def _film(path: Path, comparison: Comparison, results: Sequence[Result], wishes: Wishes) -> RenderReport:
    end = ends(results)
    scene = comparison.film(end)
    return render_scene(scene, path, wishes.pixels(comparison), slow=wishes.pace(scene, end))
