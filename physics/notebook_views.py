"""Views of chains and trajectories in a notebook. The package `sandbox`, which is built on the physics, draws them."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from html import escape
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from softcradle.physics.extras import needed_for

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class InlineFilm:
    """Film in .mp4 format that a notebook plays. `data` contains its bytes, `size` its width and height in pixels."""

    data: bytes
    size: tuple[int, int]

    def __repr__(self) -> str:
        return f"InlineFilm of {self.size[0]}x{self.size[1]} pixels, {len(self.data) / 1e3:.0f} kB"

    def _repr_html_(self) -> str:
        source = f"data:video/mp4;base64,{base64.b64encode(self.data).decode()}"
        return f'<video controls loop autoplay muted width="{self.size[0]}" src="{source}"></video>'

    def save(self, path: str | PathLike[str]) -> None:
        """Write the film to the .mp4 file `path`."""
        Path(path).write_bytes(self.data)


@dataclass(frozen=True, repr=False)
class InlinePage:
    """Live page in a cell of a notebook, inside its own frame. `text` is the complete HTML of the page."""

    text: str
    height: int = 760  # height of the cell [pixels]

    def __repr__(self) -> str:
        return f"InlinePage of {len(self.text) / 1e3:.0f} kB"

    def _repr_html_(self) -> str:
        frame = f'style="width: 100%; height: {self.height}px; border: 0" sandbox="allow-scripts"'
        return f'<iframe {frame} srcdoc="{escape(self.text)}"></iframe>'

    def save(self, path: str | PathLike[str]) -> None:
        """Write the page to the .html file `path`."""
        Path(path).write_text(self.text, encoding="utf-8")

    @property
    def state(self) -> Any:
        """State of the page. Python can read it only with anywidget. Without anywidget, this property raises an
        ImportError.
        """
        with needed_for("live().state", "widget"):
            raise ModuleNotFoundError(name="anywidget")


class Shown:
    """Base class of objects that a notebook shows as a table.

    If the object moves and matplotlib is installed, the notebook also shows a picture.
    """

    def _repr_html_(self) -> str:
        return _module("views").html_of(self)


class Moving(Shown):
    """Base class of Trajectory and Scene, which can be plotted and played."""

    def plot(self) -> Figure:
        """Plot velocities and forces over time. Each lane of a scene gets its own curves. The style is that of the
        figures in the paper.

        This requires the extra [figures].
        """
        with needed_for("plot()", "figures"):
            return _module("figure_view").figure_of(self)

    def film(self, slow: float | None = None, size: tuple[int, int] = (800, 450)) -> InlineFilm:
        """Return a film that a notebook plays. This requires the extra [film].

        `slow` is the film time in seconds for one second of motion. The default is that of the scene. Without a scene,
        the film lasts six seconds.
        """
        with needed_for("film()", "film"):
            return _module("views").film_of(self, slow, size)

    def to_page(self, path: str | PathLike[str], slow: float | None = None) -> None:
        """Write an HTML page that plays the motion.

        `slow` is the playing time in seconds for one second of motion. The default is that of the scene. Without a
        scene, the page plays for six seconds.

        Raises
        ------
        UserError
            If the page cannot be written, or the motion is too long for a page.
        """
        _module("views").write_page_of(self, path, slow)


def live_of(shown: object, slow: float | None) -> Any:
    """Return a live page of a Scene for a cell of a notebook.

    The page is a LiveWidget if anywidget is installed, otherwise an InlinePage.
    """
    text = import_module("softcradle.sandbox.page").scene_text(shown, slow)[0]
    try:
        return _module("live_widget").LiveWidget(text=text)
    except ModuleNotFoundError as error:
        if error.name != "anywidget":
            raise
        return InlinePage(text)


def _module(name: str) -> Any:
    return import_module(f"softcradle.sandbox.notebook.{name}")
