"""What the keys of the view do: which plots are shown and how, the camera, the panel."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from softcradle.sandbox.session.inputs import SetMethod
from softcradle.sandbox.window.plots.plot_kinds import KINDS

if TYPE_CHECKING:
    from softcradle.sandbox.window.scene.scene_page import Play


class ViewKeys:
    """Actions that change what is seen, and nothing of the model but the method."""

    def __init__(self, page: Play) -> None:
        self.page = page
        self.actions: dict[str, Callable[[], None]] = {
            **{kind: partial(self.toggle_plot, kind) for kind in KINDS},
            "logarithmic": self.toggle_axis,
            "plots": self.toggle_plots,
            "fit": self.toggle_follow,
            "zoom_in": partial(self.zoom, 1),
            "zoom_out": partial(self.zoom, -1),
            "method": self.next_method,
            "inspector": self.toggle_side,
        }

    def next_method(self) -> None:
        """The next method, in all lanes."""
        if self.page.apply(SetMethod(None, self.page.cards.next_method())):
            self.page.host.rebuild()

    def toggle_plot(self, kind: str) -> None:
        """Show or hide one kind of plot."""
        if kind == "difference" and len(self.page.session.lanes) != 2:
            self.page.host.messages.say("the difference needs two lanes")
            return
        self.page.board.toggle(kind)
        self.page.host.rebuild()

    def toggle_plots(self) -> None:
        """Show or hide all plots."""
        self.page.board.hidden = not self.page.board.hidden
        self.page.host.rebuild()

    def toggle_axis(self) -> None:
        """Overlaps on a logarithmic axis or a plain one."""
        self.page.board.logarithmic = not self.page.board.logarithmic
        self.page.scenery.rebuild()

    def toggle_follow(self) -> None:
        """Let the camera follow the beads, or stand where it is."""
        camera = self.page.scenery.camera
        camera.following = not camera.following
        self.page.host.messages.say("the camera follows the beads" if camera.following else "the camera stands still")

    def toggle_side(self) -> None:
        """Hide or show the panel on the right."""
        self.page.side = not self.page.side
        self.page.host.rebuild()

    def zoom(self, steps: int) -> None:
        """Nearer or farther."""
        self.page.scenery.camera.zoom(steps)
        self.page.scenery.rebuild()
