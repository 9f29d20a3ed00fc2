"""Keys of the view: which plots are shown and how, the camera, the panel, the method."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from softcradle.sandbox.languages import _, pgettext
from softcradle.sandbox.session.inputs import SetMethod
from softcradle.sandbox.window.plots.plot_board import PlotBoard
from softcradle.sandbox.window.plots.plot_kinds import PLOT_KINDS
from softcradle.sandbox.window.scene.lane_cards import LaneCards
from softcradle.sandbox.window.scene.scene_editor import SceneEditor
from softcradle.sandbox.window.scene.scene_view import SceneView
from softcradle.sandbox.window.window_page import Host


class ViewKeys:
    """Actions that change what is shown, and of the model only the method."""

    def __init__(self, host: Host, editor: SceneEditor, board: PlotBoard, view: SceneView, cards: LaneCards) -> None:
        self.host, self.editor, self.board, self.view, self.cards = host, editor, board, view, cards
        self.actions: dict[str, Callable[[], None]] = {
            **{name: partial(self.toggle_plot, name) for name in PLOT_KINDS},
            "logarithmic": self.toggle_logarithmic,
            "plots": self.toggle_plots,
            "fit": view.fit,
            "arrows": view.next_arrows,
            "zoom_in": partial(view.zoom, 1),
            "zoom_out": partial(view.zoom, -1),
            "method": self.next_method,
            "inspector": self.toggle_panel,
        }

    def next_method(self) -> None:
        """Take the next method, in all lanes."""
        self.editor.apply(SetMethod(None, self.cards.next_method()))

    def toggle_plot(self, name: str) -> None:
        """Show or hide one kind of plot."""
        if name not in self.board.available():
            self.host.messages.show(_("the {name} needs two lanes", name=pgettext("button", name)))
            return
        self.board.toggle(name)
        self.host.rebuild()

    def toggle_plots(self) -> None:
        """Show or hide all plots."""
        self.board.hidden = not self.board.hidden
        self.host.rebuild()

    def toggle_logarithmic(self) -> None:
        """Give overlaps a logarithmic axis or a linear one."""
        self.board.logarithmic = not self.board.logarithmic
        self.view.rebuild()

    def toggle_panel(self) -> None:
        """Show or hide the panel on the right."""
        self.view.panel_shown = not self.view.panel_shown
        self.host.rebuild()
