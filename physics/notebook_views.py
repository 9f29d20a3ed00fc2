"""Notebook views of chains and trajectories. The sandbox, a layer above the physics, draws them."""

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
    """An .mp4 film that a notebook plays. `data` contains its bytes, `size` its pixels."""

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
    """A live page in a cell of a notebook, in its own frame. `text` is its complete HTML."""

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
        """The state of the page. Python can read it only with anywidget, so this raises an ImportError."""
        with needed_for("live().state", "widget"):
            raise ModuleNotFoundError(name="anywidget")


class Shown:
    """Object that a notebook shows as a table, with a picture if something moves and matplotlib is installed."""

    def _repr_html_(self) -> str:
        return _module("views").html_of(self)


class Moving(Shown):
    """Trajectory or Scene: an object that can be plotted and played."""

    def plot(self) -> Figure:
        """Plot velocities and forces of each lane of a scene over time, in the style of the figures of the paper.
        Needs the extra [figures].
        """
        with needed_for("plot()", "figures"):
            return _module("figure_view").figure_of(self)

    def film(self, slow: float | None = None, size: tuple[int, int] = (800, 450)) -> InlineFilm:
        """Return a film that a notebook plays. Needs the extra [film].

        `slow` is the number of seconds for one second of motion; the default is that of the scene, or six seconds in
        total.
        """
        with needed_for("film()", "film"):
            return _module("views").film_of(self, slow, size)

    def to_page(self, path: str | PathLike[str], slow: float | None = None) -> None:
        """Write an HTML page that plays the motion.

        `slow` is the number of seconds for one second of motion; the default is that of the scene, or six seconds in
        total.

        Raises
        ------
        UserError
            If the page cannot be written, or the motion is too long for a page.
        """
        _module("views").write_page_of(self, path, slow)


def live_of(shown: object, slow: float | None) -> Any:
    """Return the page of a Scene for a cell of a notebook: a LiveWidget if anywidget is installed, else an InlinePage."""
    text = import_module("softcradle.sandbox.page").scene_text(shown, slow)[0]
    try:
        return _module("live_widget").LiveWidget(text=text)
    except ModuleNotFoundError as error:
        if error.name != "anywidget":
            raise
        return InlinePage(text)


def _module(name: str) -> Any:
    return import_module(f"softcradle.sandbox.notebook.{name}")
