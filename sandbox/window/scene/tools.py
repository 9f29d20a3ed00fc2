"""The tools of the page: table of values, sharing, comparison, measured data, what is shown and how."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pygame
from softcradle.sandbox.languages import N_, _, error_words, label_words, pgettext
from softcradle.sandbox.session.contact_conversion import has_soft_contacts, steel_ball
from softcradle.sandbox.session.export import shared_text
from softcradle.sandbox.session.inputs import SetContact, SetKind, SetMethod
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.summary_text import summary_text
from softcradle.sandbox.session.values_table import values_csv
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.plots.board import PlotBoard
from softcradle.sandbox.window.plots.kinds import PLOT_KINDS
from softcradle.sandbox.window.scene.data_tool import DataTool
from softcradle.sandbox.window.scene.editor import SceneEditor
from softcradle.sandbox.window.scene.lane_cards import LaneCards
from softcradle.sandbox.window.scene.pointer_tool import Ruler, Stopwatch
from softcradle.sandbox.window.scene.values_board import ValuesBoard
from softcradle.sandbox.window.scene.view import SceneView
from softcradle.scenes import Scene

STEEL = N_("steel balls")
OTHER, COMPARED = ", the other", ", compared"  # as in sandbox/languages/translation.py


class Sharing:
    """What goes from a session to the clipboard."""

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session

    def copy_values(self) -> None:
        """Put all values at the frame shown on the clipboard as CSV."""
        self._copy(lambda: values_csv(self.session), _("the values are on the clipboard, as CSV"))

    def tell(self) -> None:
        """Show what has happened in words; it can be copied, to be read aloud."""
        text = summary_text(self.session)
        self.host.choose(
            _("What happened"),
            text,
            {_("Close"): lambda: None, _("Copy"): lambda: self._copy(lambda: text, _("copied"))},
        )

    def copy_scene(self) -> None:
        """Put the scene with all edits on the clipboard as text."""
        done = _("the scene is on the clipboard, as text: paste it into a message, or into a window with Ctrl+V")
        self._copy(lambda: shared_text(self.session.to_scene()), done)

    def _copy(self, text: Callable[[], str], done: str) -> None:
        try:
            pygame.scrap.put_text(text())
        except (ValueError, pygame.error) as error:
            self.host.messages.show(_("nothing was copied: {error}", error=error), warning=True)
        else:
            self.host.messages.show(done)


def beside_other_balls(session: Session) -> Scene:
    """The first lane of a session beside the same blow among steel balls, or among soft beads where they are of steel.

    ValueError where contacts are couplers or laws of one's own, or no scene file can say it.
    """
    scene = beside_itself(session.to_scene())
    chain, speed = session.lanes[0].chain, session.lanes[0].setup.speed
    steel, other = has_soft_contacts(chain), Session(scene)
    if steel:
        for i in range(chain.contacts):
            law = steel_ball(chain, i, speed, scene.view.length)
            other.apply(SetContact(1, i, law))
    else:
        other.apply(SetKind(1, None, "power"))
    found = other.to_scene()
    first, second = found.lanes
    second = second.model_copy(update={"label": STEEL if steel else second.label})
    above, below = (label_words(lane.label) for lane in (first, second))
    text = _("The same blow twice: above {above}, below {below}.", above=above or _("the row as it was"), below=below)
    return found.model_copy(update={"lanes": (first, second), "text": text})


def beside_itself(scene: Scene) -> Scene:
    """The first lane of a scene beside a copy of it, to be edited and compared."""
    lane = scene.lanes[0].model_dump()
    lanes = [lane, {**lane, "label": f"{lane['label']}{OTHER}".removeprefix(", ")}]
    title = scene.title.removesuffix(COMPARED) + COMPARED  # once, though it is compared again
    return Scene.model_validate({**scene.model_dump(), "title": title, "lanes": lanes})


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
        if not self.board.single:
            self.host.settings.plots = self.board.chosen
            self.host.settings.save()
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


class SceneTools:
    """Tools of one page; `open_scene` shows another scene in its place.

    Attributes:
        before: the scene of one row that is compared here, or None.
    """

    def __init__(
        self,
        host: Host,
        session: Session,
        editor: SceneEditor,
        view: SceneView,
        board: PlotBoard,
        open_scene: Callable[[Scene, Scene | None], None],
        before: Scene | None = None,
    ) -> None:
        self.before = before
        self.host, self.session, self.view, self.board, self.open_scene = host, session, view, board, open_scene
        self.values = ValuesBoard(host, session, editor, self.values_area)
        self.stopwatch = Stopwatch(host, session)
        self.ruler = Ruler(host, session, view)
        self.data = DataTool(host, session, view)
        sharing = Sharing(host, session)
        self.actions: dict[str, Callable[[], None]] = {
            "values": self.toggle_values,
            "copy_values": sharing.copy_values,
            "copy_scene": sharing.copy_scene,
            "tell": sharing.tell,
            "compare": self.compare,
            "compare_balls": self.compare_balls,
            "alone": self.alone,
            "stopwatch": self.stopwatch.press,
            "ruler": self.ruler.toggle,
            **self.data.actions,
        }

    def toggle_values(self) -> None:
        """Show the table of values in place of the plots, or the plots."""
        self.view.card.hide()
        self.view.plots_covered = not self.view.plots_covered
        self.view.redraw()
        if not self.view.places.plots:
            self.board.show((self.board.present or self.board.shown or self.board.available())[0])
            self.host.rebuild()
        self.values.update()

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
        one = self.session.scene if len(self.session.lanes) == 1 else self.before
        self.open_scene(scene, one)
        return True

    def alone(self) -> None:
        """Go back to the first row, with the edits that were made here and the words that it had before."""
        if len(self.session.lanes) == 1:
            self.host.messages.show(_("there is one row"))
            return
        try:
            scene = self.session.to_scene()
        except ValueError as error:
            self.host.messages.show(str(error), warning=True)
            return
        words = self.before or scene.model_copy(update={"title": scene.title.removesuffix(COMPARED)})
        kept = {name: getattr(words, name) for name in ("title", "text", "question", "source")}
        self.open_scene(
            Scene.model_validate({**scene.model_dump(), **kept, "lanes": scene.model_dump()["lanes"][:1]}), None
        )

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

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw ruler and stopwatch."""
        rect, unit = self.view.places.lanes[0], self.host.unit
        self.ruler.paint(surface)
        self.stopwatch.paint(surface, (rect.left + 120 * unit, rect.bottom - 14 * unit))
