"""Views of a notebook: physics asks for them, the sandbox, which lies above, draws them."""

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
    """An .mp4 film that a notebook plays. `data` are its bytes, `size` its pixels."""

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
    """A page in which beads live, in a cell of a notebook: a frame of its own, `text` is all that is in it."""

    text: str
    height: int = 760  # pixels of the cell

    def __repr__(self) -> str:
        return f"InlinePage of {len(self.text) / 1e3:.0f} kB"

    def _repr_html_(self) -> str:
        frame = f'style="width: 100%; height: {self.height}px; border: 0" sandbox="allow-scripts"'
        return f'<iframe {frame} srcdoc="{escape(self.text)}"></iframe>'

    def save(self, path: str | PathLike[str]) -> None:
        """Write the page to the .html file `path`."""
        Path(path).write_text(self.text, encoding="utf-8")


def figure_of(shown: object) -> Figure:
    """The figure of a Trajectory or a Scene."""
    with needed_for("plot()", "figures"):
        return _module("figure_view").figure_of(shown)


def film_of(shown: object, slow: float | None, size: tuple[int, int]) -> InlineFilm:
    """The film of a Trajectory or a Scene."""
    with needed_for("film()", "film"):
        return _module("views").film_of(shown, slow, size)


def write_page(shown: object, path: str | PathLike[str], slow: float | None) -> None:
    """Write the page of a Trajectory or a Scene."""
    _module("views").write_page_of(shown, path, slow)


def live_of(shown: object, slow: float | None) -> InlinePage:
    """The page of a Scene, which a notebook shows in a cell."""
    text: str = _module("views").page_text(shown, slow)
    return InlinePage(text)


def html_of(shown: object) -> str:
    """The table of a Trajectory, a Scene or a Chain, with a picture where matplotlib is installed."""
    return _module("views").html_of(shown)


def _module(name: str) -> Any:
    return import_module(f"softcradle.sandbox.notebook.{name}")
