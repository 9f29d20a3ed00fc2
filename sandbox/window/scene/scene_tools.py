"""The tools of the page: table of values, sharing, comparison, stopwatch and ruler, and the menu that lists them."""

from __future__ import annotations

from collections.abc import Callable

import pygame
from softcradle.sandbox.languages import _, error_words
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.menu import Menu
from softcradle.sandbox.window.plots.plot_board import PlotBoard
from softcradle.sandbox.window.plots.plot_kinds import FORCES, VELOCITIES
from softcradle.sandbox.window.scene.data_tool import DataTool
from softcradle.sandbox.window.scene.scene_editor import SceneEditor
from softcradle.sandbox.window.scene.scene_view import SceneView
from softcradle.sandbox.window.scene.sharing import Sharing, beside_itself, beside_other_balls
from softcradle.sandbox.window.scene.stopwatch import Ruler, Stopwatch
from softcradle.sandbox.window.scene.values_board import ValuesBoard
from softcradle.sandbox.window.window_page import Host
from softcradle.scenes import Scene

# actions in the menu
MENU = (
    *(
        "lesson",
        "tell",
        "arrows",
        "values",
        "copy_values",
        "copy_scene",
        "share_page",
        "compare",
        "compare_balls",
        "stopwatch",
        "ruler",
        "data",
        "signals",
    ),
    *("sweep", "fit", "pause_at_end", "sound", "logarithmic", "inspector"),
    *("open", "larger", "smaller", "fullscreen", "theme", "language"),
)


# those that are buttons in the lab, and entries of the menu at the first level
BUTTONS_OF_LAB = (VELOCITIES, FORCES, "overlaps", "save_scene", "film", "screenshot")


class SceneTools:
    """Tools of one page; `open_scene` shows another scene in its place."""

    def __init__(
        self,
        host: Host,
        session: Session,
        editor: SceneEditor,
        view: SceneView,
        board: PlotBoard,
        open_scene: Callable[[Scene], None],
    ) -> None:
        self.host, self.session, self.view, self.board, self.open_scene = host, session, view, board, open_scene
        self.values = ValuesBoard(host, session, editor, self.values_area)
        self.stopwatch = Stopwatch(host, session)
        self.ruler = Ruler(host, session, view)
        self.data = DataTool(host, session, board)
        sharing = Sharing(host, session)
        self.actions: dict[str, Callable[[], None]] = {
            "values": self.toggle_values,
            "edit_values": self.edit_values,
            "copy_values": sharing.copy_values,
            "copy_scene": sharing.copy_scene,
            "tell": sharing.tell,
            "compare": self.compare,
            "compare_balls": self.compare_balls,
            "stopwatch": self.stopwatch.press,
            "ruler": self.ruler.toggle,
            **self.data.actions,
        }

    def show_menu(self, button: pygame.Rect) -> None:
        """Show the menu below its button."""
        self.host.put_over(Menu(self.host, button.bottomright, (*BUTTONS_OF_LAB, *MENU) if self.host.explore else MENU))

    def toggle_values(self) -> None:
        """Show the table of values in place of the plots, or the plots."""
        self.view.plots_covered = not self.view.plots_covered
        self.view.redraw()
        if not self.view.places.plots:
            self.board.hidden, self.board.shown = False, self.board.shown or self.board.available()[:1]
            self.host.rebuild()
        self.values.update()

    def edit_values(self) -> None:
        """Type into a cell of the table, if it is shown."""
        if self.covers_plots:
            self.values.cells.begin_at_selection()
        else:
            self.host.messages.show(_("the table of values is not shown: T shows it"))

    def compare(self) -> None:
        """Open the scene beside a copy of itself."""
        self._open_beside(lambda: beside_itself(self.session.to_scene()))

    def compare_balls(self) -> None:
        """Open the scene beside the same blow among steel balls, or soft beads, and play both."""
        if self._open_beside(lambda: beside_other_balls(self.session)):
            self.host.act("play_pause")

    def _open_beside(self, make: Callable[[], Scene]) -> bool:
        """Open what `make` gives; whether there is something."""
        try:
            scene = make()
        except ValueError as error:
            self.host.messages.show(_("this cannot be compared: {error}", error=error_words(error)), warning=True)
            return False
        self.open_scene(scene)
        return True

    def handle(self, event: pygame.Event) -> bool:
        """Take an event on the table or the ruler."""
        return self.values.handle(event) or self.ruler.handle(event)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the table in place of the plots."""
        area = self.values_area()
        if area is not None:
            self.values.paint(surface, area)

    @property
    def covers_plots(self) -> bool:
        """Whether the table lies on the plots."""
        return self.view.plots_covered and bool(self.view.places.plots)

    def values_area(self) -> pygame.Rect | None:
        """The place of the table; None while it is not shown."""
        return self.view.plots_area() if self.covers_plots else None

    def build(self) -> None:
        """Find places in a page that is built anew."""
        self.values.arrange()
        self.values.cells.build()

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw ruler and stopwatch."""
        rect, unit = self.view.places.lanes[0], self.host.unit
        self.ruler.paint(surface)
        self.stopwatch.paint(surface, (rect.left + 120 * unit, rect.bottom - 14 * unit))
