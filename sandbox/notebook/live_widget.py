"""Live page of a scene in a cell of a notebook. The page reports its state to Python through anywidget, with the
messages that docs/sharing.md describes.
"""

from os import PathLike
from pathlib import Path
from typing import Any

import anywidget
import traitlets
from softcradle.sandbox.files import resource


class LiveWidget(anywidget.AnyWidget):
    """Live page of a scene. Python can read and change the state of the page.

    Attributes
    ----------
    state : dict
        Current state of the page: settings, time, guess, outcome and chains. The state is empty until the page is
            shown.
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
        """Change settings of the page. The settings are named as in the address of the page, for example ``set(n=9,
        a="1/20", play=True)``.
        """
        self.send({"settings": settings, "play": play})

    def save(self, path: str | PathLike[str]) -> None:
        """Write the page to the .html file `path`."""
        Path(path).write_text(self.text, encoding="utf-8")
