"""Page in a cell of a notebook that reports its state to Python, by anywidget and the messages of docs/sharing.md."""

from os import PathLike
from pathlib import Path
from typing import Any

import anywidget
import traitlets
from softcradle.sandbox.files import resource


class LiveWidget(anywidget.AnyWidget):
    """Live page of a scene whose state Python can read and change.

    Attributes
    ----------
    state : dict
        The state of the page, which follows it: settings, time, guess, outcome, and the rows. It is empty until the
        page is shown.
    text : str
        The complete HTML of the page.
    height : int
        Height of the cell [pixels].
    """

    _esm = resource("widget.js").read_text(encoding="utf-8")
    text = traitlets.Unicode().tag(sync=True)
    height = traitlets.Int(760).tag(sync=True)
    state = traitlets.Dict().tag(sync=True)

    def set(self, play: bool | None = None, **settings: Any) -> None:
        """Change settings of the page, named as in its address, for example ``set(n=9, a="1/20", play=True)``."""
        self.send({"settings": settings, "play": play})

    def save(self, path: str | PathLike[str]) -> None:
        """Write the page to the .html file `path`."""
        Path(path).write_text(self.text, encoding="utf-8")
