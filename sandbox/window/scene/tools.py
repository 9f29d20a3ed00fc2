"""The tools of the page: table of values, clipboard, comparison with a second lane, measured data, and keys for the
view.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pygame
from softcradle.physics.messages import Message
from softcradle.sandbox.languages import (
    N_,
    _,
    error_words,
    localized,
    ngettext,
    pgettext,
    scene_words,
)
from softcradle.sandbox.measured_table import MeasuredTable, read_table
from softcradle.sandbox.session.contact_conversion import has_soft_contacts, steel_ball
from softcradle.sandbox.session.export import shared_text, words_for
from softcradle.sandbox.session.inputs import SetContact, SetKind, SetMethod
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.summary_text import summary_text
from softcradle.sandbox.session.values_table import values_csv
from softcradle.sandbox.story.numbers import scientific
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.plots.board import PlotBoard
from softcradle.sandbox.window.plots.curves import Plot
from softcradle.sandbox.window.plots.data_overlay import (
    MEASURED_KINDS,
    PICTURES,
    TABLES,
    NumbersOverlay,
    PictureOverlay,
    edges_of,
    load_picture,
)
from softcradle.sandbox.window.plots.kinds import KEY, KYMOGRAPH, OWN, PLOT_KINDS, pair_of
from softcradle.sandbox.window.scene.editor import SceneEditor
from softcradle.sandbox.window.scene.lane_cards import LaneCards
from softcradle.sandbox.window.scene.pointer_tool import Ruler, Stopwatch
from softcradle.sandbox.window.scene.save_dialogs import shown_path
from softcradle.sandbox.window.scene.values_board import ValuesBoard
from softcradle.sandbox.window.scene.view import NO_ROOM, SceneView
from softcradle.scenes import Scene


class DataTool:
    """Measured data that is drawn over the plots of a page. It also sets the two signals of the x-y plot."""

    def __init__(self, host: Host, session: Session, view: SceneView) -> None:
        self.host, self.session, self.view, self.board = host, session, view, view.board
        self.actions = {"data": self.ask, "signals": self.ask_signals}

    def ask(self) -> None:
        """Ask for the path of a file to draw over the plots. If the plots already show measured data, remove it
        instead.
        """
        if any(self.board.overlays.values()):
            self.board.overlays.clear()
            self.host.messages.show(_("measured data removed"))
            return
        note = _(
            "a table ({endings}: a line of names, then a time and a column for each curve) or a picture of a kymograph",
            endings=", ".join(TABLES),
        )
        self.host.ask(_("Measured data over a plot"), note, "", self._take_typed)

    def _take_typed(self, text: str) -> None:
        if not self.take_file(text, (-1, -1)):
            endings = ", ".join((*TABLES, *PICTURES))
            wrong = _("{path}: needs the ending {endings}", path=text, endings=endings)
            self.host.messages.show(wrong, warning=True)

    def take_file(self, text: str, point: tuple[int, int]) -> bool:
        """Draw a file over the plot at `point`, or over the default plot. Return True if the file is a table or a
        picture.
        """
        path = Path(os.path.expanduser(text))
        ending = path.suffix.lower()
        if ending not in (*TABLES, *PICTURES):
            return False
        try:
            if ending in TABLES:
                self._lay_numbers(path, point)
            else:
                self._ask_edges(path)
        except (UserError, ValueError) as error:  # For example, the path contains a NUL character.
            self.host.messages.show(str(error), warning=True)
        return True

    def _plot(self, kind: str, point: tuple[int, int] = (-1, -1)) -> tuple[tuple[str, int], Plot]:
        """Return the key and the plot of a kind. This is the plot at `point` or another one, which is shown if
        necessary.
        """
        under = self.board.plot_at(point)
        if under is not None and self.board.keys[self.board.plots.index(under)][0] == kind:
            return self.board.keys[self.board.plots.index(under)], under
        self.view.show_plot(kind)
        if not self.board.plots:
            raise UserError(_(NO_ROOM))
        where = next(k for k, key in enumerate(self.board.keys) if key[0] == kind)
        return self.board.keys[where], self.board.plots[where]

    def _lay_numbers(self, path: Path, point: tuple[int, int]) -> None:
        data = read_table(path)
        key, plot = self._plot(self._measured_kind(path, data, point), point)
        curves = len(plot.content.colours)
        laid = NumbersOverlay.of(data, MEASURED_KINDS[key[0]])
        if laid.values.shape[1] > curves:
            raise UserError(_too_many(path, laid.values.shape[1], curves))
        self.board.overlays[key] = [laid]
        text = ngettext(
            "{n} time from {path} over {plot}",
            "{n} times from {path} over {plot}",
            len(data.time),
            path=shown_path(path),
            plot=plot.content.title,
        )
        differences = laid.differences(plot)
        if differences.size:
            difference = scientific(float(np.sqrt(np.mean(differences**2))), 1)
            text += _("; they differ by {difference} (root mean square)", difference=difference)
        if not all(column.unit for column in data.along_row(MEASURED_KINDS[key[0]])):
            text += _("; columns without a unit are taken to be in SI units")
        self.host.messages.show(text)

    def _measured_kind(self, path: Path, data: MeasuredTable, point: tuple[int, int]) -> str:
        """Return the kind of plot for a table of measured data.

        This is the kind of the plot at `point`, if it fits the data. Otherwise it is the first kind that shows a
        measured quantity.
        """
        kinds = [kind for kind, quantity in MEASURED_KINDS.items() if data.along_row(quantity)]
        if not kinds:
            columns = ", ".join(repr(column.name) for column in data.columns)
            wrong = _(
                "{path}: {columns}: no velocity, position or force along the row; name one such as v1 (m/s)",
                path=path,
                columns=columns,
            )
            raise UserError(wrong)
        under = self.board.plot_at(point)
        pointed = "" if under is None else self.board.keys[self.board.plots.index(under)][0]
        return pointed if pointed in kinds else kinds[0]

    def _ask_edges(self, path: Path) -> None:
        picture = load_picture(path)
        key, plot = self._plot(KYMOGRAPH)
        begin, end = max(0.0, plot.span.time(0)), plot.span.time(plot.area.width)
        proposed = localized(f"{begin:.4g} {end:.4g} {plot.axis.high:.4g} {plot.axis.low:.4g}")
        note = _("values at its edges: time at the left and right [s], position at the top and bottom [m]")
        self.host.ask(_("A picture over the kymograph"), note, proposed, partial(self._lay_picture, picture, key))

    def _lay_picture(self, picture: pygame.Surface, key: tuple[str, int], text: str) -> None:
        try:
            self.board.overlays[key] = [PictureOverlay(picture, edges_of(text))]
        except ValueError as error:
            self.host.messages.show(str(error), warning=True)

    def ask_signals(self) -> None:
        """Ask for the two signals of the x-y plot."""
        vertical, horizontal = self.board.pair
        text = _("{vertical} against {horizontal}", vertical=vertical, horizontal=horizontal)
        self.host.ask(_("Plot one signal against another"), _(KEY), text, self._take_signals)

    def _take_signals(self, text: str) -> None:
        try:
            self.board.pair = pair_of(text, self.session.lanes[0].chain.contacts + 1)
        except ValueError as error:
            self.host.messages.show(str(error), warning=True)
            return
        self.view.show_plot(OWN)


def _too_many(path: Path, columns: int, curves: int) -> str:
    """Return a sentence about a table that has more columns than the plot has curves."""
    return ngettext(
        "{path}: has {columns} columns of this quantity, and the plot has {n} curve",
        "{path}: has {columns} columns of this quantity, and the plot has {n} curves",
        curves,
        path=path,
        columns=columns,
    )


STEEL = N_("steel balls")


def beside_other_balls(session: Session) -> Scene:
    """Return a scene that compares the first lane of a session with other balls in the same collision.

    The second lane has steel balls, or soft beads if the first lane already has steel balls. Raise ValueError if the
    contacts are couplers or user-defined, or if the state cannot be written as a scene file.
    """
    scene = beside_itself(session.to_scene())
    # Use a new session, because the present one may have edits that are later than the current frame.
    other = Session(scene)
    chain, speed = other.lanes[0].chain, other.lanes[0].setup.speed
    steel = has_soft_contacts(chain)
    if steel:
        for i in range(chain.contacts):
            law = steel_ball(chain, i, speed, scene.view.length)
            other.apply(SetContact(1, i, law))
    else:
        other.apply(SetKind(1, None, "power"))
    found = other.to_scene()
    first, second = found.lanes
    second = second.model_copy(update={"label": STEEL if steel else second.label})
    above, below = (scene_words(lane.label) for lane in (first, second))
    said = [_("The same blow twice: above {above}, below {below}.", above=above or _("the row as it was"), below=below)]
    if steel:
        said.append(_("Real steel is much harder: these balls are soft enough to show how they touch."))
    text = " ".join([*said, *([scene_words(scene.text)] if scene.text else [])])
    return found.model_copy(update={"lanes": (first, second), "text": text})


def worth_comparing(session: Session) -> bool:
    """Return True if a comparison with steel balls shows the effect of a scene best.

    Such a scene has a single lane of soft beads, without drives, brakes, bed or walls.
    """
    chain = session.lanes[0].chain
    free = not (chain.piecewise or chain.driven or chain.brakes or chain.on_bed or chain.walls)
    soft = chain.contacts > 1 and has_soft_contacts(chain)
    return len(session.lanes) == 1 and free and soft and session.scene.duration is None


def beside_itself(scene: Scene) -> Scene:
    """Return a scene with the first lane of `scene` and a copy of this lane. The copy can be edited and compared.

    The text of the scene applies to both lanes.
    """
    lane = scene.lanes[0].model_dump()
    words, label = words_for(scene, scene.lanes[:1]), lane["label"]
    other = Message("other", "{label}, the other", label=label) if label else Message("other_row", "the other")
    lanes = [lane, {**lane, "label": other}]
    return Scene.model_validate({**scene.model_dump(), **words, "lanes": lanes})


class ViewKeys:
    """Actions with keys that change the view. One of them changes the method of the session."""

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
        """Switch all lanes to the next method."""
        self.editor.apply(SetMethod(None, self.cards.next_method()))

    def toggle_plot(self, name: str) -> None:
        """Show or hide one kind of plot."""
        if name not in self.board.available():
            self.host.messages.hint(
                _("the plot “{name}” needs two lanes with equal numbers of beads", name=pgettext("button", name))
            )
            return
        self.board.toggle(name)
        if not self.board.single:
            self.host.settings.keep(plots=self.board.chosen)
        self.host.follow()
        self.view.say_if_plots_have_no_room()

    def toggle_plots(self) -> None:
        """Show or hide all plots."""
        self.board.hidden = not self.board.hidden
        self.host.follow()
        self.view.say_if_plots_have_no_room()

    def toggle_logarithmic(self) -> None:
        """Switch the axis for overlaps between logarithmic and linear."""
        self.board.logarithmic = not self.board.logarithmic

    def toggle_panel(self) -> None:
        """Show or hide the panel on the right."""
        self.view.panel_shown = not self.view.panel_shown


class SceneTools:
    """Tools of one page. `open_scene` replaces the page by another scene and performs an action on the new page.

    Attributes:
        before: the scene with a single lane from which this comparison was made, or None.
    """

    def __init__(
        self,
        host: Host,
        session: Session,
        editor: SceneEditor,
        view: SceneView,
        board: PlotBoard,
        open_scene: Callable[[Scene, Scene | None, str | None], None],
        before: Scene | None = None,
    ) -> None:
        self.before = before
        self.host, self.session, self.view, self.board, self.open_scene = host, session, view, board, open_scene
        self.values = ValuesBoard(host, session, editor, self.values_area)
        self.stopwatch = Stopwatch(host, session, board.span.clock)
        self.ruler = Ruler(host, session, view)
        self.data = DataTool(host, session, view)
        self.actions: dict[str, Callable[[], None]] = {
            "values": self.toggle_values,
            "copy_values": self.copy_values,
            "copy_scene": self.copy_scene,
            "tell": self.tell,
            "compare": self.compare,
            "compare_balls": self.compare_balls,
            "alone": self.alone,
            "stopwatch": self.stopwatch.press,
            "ruler": self.ruler.toggle,
            **self.data.actions,
        }

    def toggle_values(self) -> None:
        """Switch between the plots and the table of values."""
        self.view.why.hide()
        self.view.plots_covered = not self.view.plots_covered
        self.host.follow()
        if not self.view.places.plots:
            self.board.show((self.board.present or self.board.shown or self.board.available())[0])
            self.host.follow()
        self.view.say_if_plots_have_no_room()

    def copy_values(self) -> None:
        """Copy all values of the current frame to the clipboard as CSV."""
        self._copy(lambda: values_csv(self.session), _("the values are on the clipboard, as CSV"))

    def tell(self) -> None:
        """Describe the motion in words. The text can be copied, for example to be read aloud by another program."""
        text = summary_text(self.session)
        self.host.choose(
            _("What happened"),
            text,
            {_("Close"): lambda: None, _("Copy"): lambda: self._copy(lambda: text, _("copied"))},
        )

    def copy_scene(self) -> None:
        """Copy the scene with all edits to the clipboard as text."""
        done = _("the scene is on the clipboard, as text: paste it into a message, or into a window with Ctrl+V")
        self._copy(lambda: shared_text(self.session.to_scene()), done)

    def _copy(self, text: Callable[[], str], done: str) -> None:
        try:
            pygame.scrap.put_text(text())
        except (ValueError, pygame.error) as error:
            self.host.messages.show(_("nothing was copied: {error}", error=error), warning=True)
        else:
            self.host.messages.show(done)

    def compare(self) -> None:
        """Open a scene that compares the present scene with a copy of itself."""
        self._open_beside(lambda: beside_itself(self.session.to_scene()))

    def compare_balls(self) -> None:
        """Open a scene that compares the present scene with other balls in the same collision, and play both.

        The other balls are steel balls, or soft beads if the present scene has steel balls.
        """
        self._keep_choice(beside=True)
        self._open_beside(lambda: beside_other_balls(self.session), "play_pause")

    def _keep_choice(self, beside: bool) -> None:
        """Store the choice of the user: if `beside`, Explore opens the next scenes next to steel balls."""
        if self.host.explore:
            self.host.settings.keep(beside=beside)

    def _open_beside(self, make: Callable[[], Scene], then: str | None = None) -> None:
        """Open the scene that `make` returns and perform the action `then`. If the scene cannot be made, show a
        message.
        """
        try:
            scene = make()
        except ValueError as error:
            self.host.messages.show(_("this cannot be compared: {error}", error=error_words(error)), warning=True)
            return
        one = self.session.scene if len(self.session.lanes) == 1 else self.before
        self.open_scene(scene, one, then)

    def alone(self) -> None:
        """Return to a scene with the first lane only. It keeps the edits of this lane."""
        if len(self.session.lanes) == 1:
            self.host.messages.hint(_("there is one row"))
            return
        try:
            scene = self.session.to_scene()
        except ValueError as error:
            self.host.messages.show(str(error), warning=True)
            return
        self._keep_choice(beside=False)
        words = words_for(self.before or self.session.scene, scene.lanes[:1])
        changed = {**words, "lanes": scene.model_dump()["lanes"][:1]}
        self.open_scene(Scene.model_validate({**scene.model_dump(), **changed}), None, None)

    def handle(self, event: pygame.Event) -> bool:
        """Handle events of the table of values and of the ruler."""
        return self.values.handle(event) or self.ruler.handle(event)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the table of values instead of the plots."""
        area = self.values_area()
        if area is not None:
            self.values.paint(surface, area)

    @property
    def covers_plots(self) -> bool:
        """True while the table of values covers the plots."""
        return self.view.plots_covered and bool(self.view.places.plots)

    def values_area(self) -> pygame.Rect | None:
        """Return the rectangle of the table of values, or None while it is hidden."""
        return self.view.plots_area() if self.covers_plots else None

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw the ruler and the stopwatch."""
        rect, unit = self.view.places.lanes[0], self.host.unit
        self.ruler.paint(surface)
        self.stopwatch.paint(surface, (rect.left + 120 * unit, rect.bottom - 14 * unit))
