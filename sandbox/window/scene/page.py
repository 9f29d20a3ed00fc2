"""The page on which a scene is played. It shows beads, plots, time controls, badges and inspector of one session."""

from __future__ import annotations

from collections.abc import Callable

import pygame
from softcradle.sandbox.languages import _, scene_words
from softcradle.sandbox.session.replay import Replay
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.dialog import EntryDialog
from softcradle.sandbox.window.lessons.runner import LessonRunner
from softcradle.sandbox.window.page import Actions, Derived, Host, Page
from softcradle.sandbox.window.page_geometry import least_height
from softcradle.sandbox.window.plots.board import PlotBoard
from softcradle.sandbox.window.scene.clock import SceneClock
from softcradle.sandbox.window.scene.editor import SceneEditor
from softcradle.sandbox.window.scene.explore_panel import ExplorePanel
from softcradle.sandbox.window.scene.inspector import Inspector
from softcradle.sandbox.window.scene.lane_cards import LaneCards
from softcradle.sandbox.window.scene.outcome_card import OutcomeCard
from softcradle.sandbox.window.scene.pointer_tool import PointerTool
from softcradle.sandbox.window.scene.save_dialogs import SaveDialogs, WindowFilm, session_savings
from softcradle.sandbox.window.scene.sound import SceneSound
from softcradle.sandbox.window.scene.time_controls import SceneTimeControls, Timeline
from softcradle.sandbox.window.scene.toolbar import Toolbar
from softcradle.sandbox.window.scene.tools import SceneTools, ViewKeys
from softcradle.sandbox.window.scene.view import SceneView
from softcradle.sandbox.window.scene.why_view import WhyView
from softcradle.sandbox.window.unsaved_scene import UnsavedScene
from softcradle.scenes import Scene


def joined(*tables: Actions) -> Actions:
    """Return the union of several tables of actions. Raise ValueError if two actions have the same name."""
    found: Actions = {}
    for table in tables:
        if twice := found.keys() & table.keys():
            raise ValueError(f"two actions are called {', '.join(sorted(twice))}")
        found |= table
    return found


class ScenePage(Page):
    """The page of one session.

    Arguments:
        leave: function that returns to the gallery.
        replay: the replay that drives the session, if the session was recorded.
        alone: the scene with a single lane from which this comparison was made, or None.
    """

    def __init__(
        self,
        host: Host,
        session: Session,
        leave: Callable[[], None],
        replay: Replay | None = None,
        alone: Scene | None = None,
    ) -> None:
        self.host, self.session, self.leave, self.replay = host, session, leave, replay
        self.editor = SceneEditor(host, session)
        self.board = PlotBoard(session, host.clock, host.settings.plots)
        self.cards = LaneCards(host, session)
        self.inspector = Inspector(host, session, self.editor)
        self.explore = ExplorePanel(host, session, self.editor, lambda: self.cards.health)
        self.panels = (self.inspector, self.explore)
        self.outcome, self.why = OutcomeCard(host, session), WhyView(host, session)
        self.view = SceneView(
            host, session, self.editor, self.board, self.panels, self.outcome, self.why, self._answered
        )
        self.timeline = Timeline(session)
        self.clock = SceneClock(host, session, self.editor, self.view, self.timeline, replay, self.outcome.show_outcome)
        clock = self.clock
        self.time_controls = SceneTimeControls(host, session, self.board, clock.activity, clock.note, clock.may_edit)
        clock.controls = self.time_controls
        self.pointer = PointerTool(host, session, self.editor, self.view)
        self.film = WindowFilm(host)
        self.toolbar = Toolbar(host, self.film, session.undo_stack, lambda: self.board.present)
        savings = session_savings(host.messages, session)
        self.dialogs = SaveDialogs(host, self.film, savings)
        self.sound = SceneSound(host, session, clock.activity)
        self.tools = SceneTools(host, session, self.editor, self.view, self.board, self.show_scene, alone)
        self.unsaved_scene = UnsavedScene(host, session)
        self._called_unsaved = False
        self.lessons = LessonRunner(host, session, self.clock, self.outcome, alone, self._asks_beside)
        for panel in self.panels:
            panel.questions = self.lessons
            panel.reset_view, panel.keep_ghost = self.view.reset_camera, self.board.keep_ghost
        self.explore.play_again = self.clock.play_again
        self.clock.collided = lambda: self.why.available
        self._kernels = Derived(self._moved_of, self.editor.check_kernels)
        self._edits = Derived(lambda: session.setup.chains, self.view.follower.notice)
        self._words = Derived(lambda: session.scene, self.lessons.begin)
        for one in (self._kernels, self._edits, self._words):
            one.note()
        own: Actions = {
            "lesson": self.lessons.ask,
            "words": self.ask_words,
            "why": self.explain,
            **self.toolbar.actions,
            "sound": self.sound.toggle,
            "help": host.toggle_help,
            "level": host.toggle_level,
            "leave": self.escape,
            "sweep": self.sweep,
        }
        view_keys = ViewKeys(host, self.editor, self.board, self.view, self.cards)
        parts = (self.tools, self.clock, view_keys, self.editor, self.dialogs)
        self.actions: Actions = joined(own, *(part.actions for part in parts))

    def sweep(self) -> None:
        """Compare nine values of a parameter of the visible panel."""
        (self.explore if self.host.explore else self.inspector).sweep()

    def explain(self) -> None:
        """Explain the collision of each lane at its largest force. If an explanation is open, close it.

        If the picture does not fit, show the explanation as text in a dialog.
        """
        self.outcome.hide()
        self.board.hidden = self.view.plots_covered = False
        self.why.toggle()
        if self.why.rows and not self.view.plots_area().height:
            self.host.choose(_("Why?"), self.why.words, {_("Close"): lambda: None})
            self.why.hide()

    def show_scene(self, scene: Scene, alone: Scene | None = None, then: str | None = None) -> None:
        """Replace this page by the page of `scene`, which was made from the first lane. Perform the action `then` on
        the new page.

        Unsaved edits of the first lane remain marked as unsaved. Edits that exist only in other lanes would be lost, so
        the user is asked first.
        """

        def show() -> None:
            session = Session(scene, clock=self.host.clock)
            if self.unsaved:
                session.undo_stack.lose_what_was_saved()
            page = ScenePage(self.host, session, self.leave, alone=alone)
            page.lessons.answered = self.lessons.answered  # The new page does not ask the question of the scene again.
            self.host.show(page)
            self.host.act(then)

        if self.session.undo_stack.unsaved_beside_first or (self._called_unsaved and len(self.session.lanes) > 1):
            self.host.ask_before_loss(show)
        else:
            show()

    def ask_words(self) -> None:
        """Ask for the title, the texts and the labels of the scene."""
        try:
            scene = self.session.to_scene()
        except ValueError as error:
            self.host.messages.show(str(error), warning=True)
            return
        fields = {_("title"): scene.title, _("text"): scene.text, _("question"): scene.question}
        labels = {_("lane {n}", n=k + 1): lane.label for k, lane in enumerate(scene.lanes)}

        def take(found: dict[str, str]) -> None:
            title, text, question, *names = found.values()
            named = zip(scene.lanes, names, strict=True)
            # Keep the lane if its label is unchanged, because its label can then still be translated.
            lanes = [lane if name == lane.label else lane.model_copy(update={"label": name}) for lane, name in named]
            words = {"title": title or scene.title, "text": text, "question": question, "lanes": tuple(lanes)}
            told = scene.model_copy(update=words)
            if told != scene:
                self.session.set_words(told)

        note = _(
            "These words appear in the scene file, in films and on web pages. The question is asked before the text is shown."
        )
        self.host.put_over(EntryDialog(self.host, _("Words of the scene"), note, fields | labels, take, long=_("text")))

    @property
    def title(self) -> str:  # type: ignore[override]
        """The title of the scene."""
        return self.session.scene.title

    @property
    def least_height(self) -> float:  # type: ignore[override]
        """The height that all lanes and a row of plots need together [design pixels]."""
        return least_height(len(self.session.lanes))

    @property
    def typing(self) -> bool:  # type: ignore[override]
        """True while a number is being typed."""
        return any(panel.typing for panel in self.panels)

    def cancel_typing(self) -> None:
        """Discard the number that is being typed."""
        for panel in self.panels:
            panel.cancel_typing()

    @property
    def unsaved(self) -> bool:  # type: ignore[override]
        """True if there are unsaved edits. Values that were only tried out in Explore do not count."""
        return self.session.undo_stack.unsaved_work

    def call_unsaved(self) -> None:
        """Mark the scene with all its lanes as unsaved, because no file contains it."""
        self.session.undo_stack.lose_what_was_saved()
        self._called_unsaved = True

    @property
    def moving(self) -> bool:  # type: ignore[override]
        """True if the next frame differs from the current one without user input."""
        return (
            self.clock.activity() != "paused"
            or self.editor.preparing
            or self.film.recording
            or self.pointer.grip is not None
            or self.view.follower.pending
            or not self.board.complete
        )

    def escape(self) -> None:
        """Clear the selection. Without a selection, close the explanation or hide the card. If neither is open, return
        to the gallery.
        """
        if self.editor.selection is not None:
            self.editor.selection = None
        elif self.why.rows:
            self.why.hide()
        elif self.outcome.text:
            self.outcome.hide()
        else:
            self.leave()

    def message_place(self, size: tuple[int, int], unit: float) -> pygame.Rect:
        """Return the rectangle for messages. It is next to the clock, or on the timeline."""
        return self.time_controls.beside(self.view.places.footer)

    def _answered(self) -> object:
        return self.lessons.answered, self.lessons.title, self.lessons.question, self.lessons.explanations

    def _asks_beside(self) -> bool:
        """Return True if the visible panel shows the answers to the question."""
        return self.view.panel_shown and any(panel.choices for panel in self.panels)

    def _moved_of(self) -> object:
        """Return the values that determine if the kernels can compute the lanes in real time."""
        setup = self.session.setup
        return setup.chains, [(lane.method, lane.step) for lane in setup.lanes], setup.slow

    def made_of(self) -> object:
        """Return the values on which the widgets depend: the scene, the visible parts and the choices of the user."""
        places = self.view.panel_shown, self.board.present, self.board.single
        selected = self.editor.selection is not None
        return self.session.scene, places, self.film.recording, self.editor.refused, self.cards.made_of(selected)

    def build(self) -> None:
        """Create all widgets for the size and unit of the host."""
        unit = self.host.unit
        self.view.arrange()
        places, margin = self.view.places, round(12 * unit)
        panel = places.panel.inflate(-2 * margin, -2 * round(7 * unit)) if self.view.panel_shown else places.panel
        self.toolbar.build(places.toolbar, self.actions, self.leave)
        self.timeline.place(places.footer, unit)
        row = pygame.Rect(places.footer.left + margin, places.footer.top + round(42 * unit), 1, round(46 * unit))
        row.width = places.footer.width - 2 * margin
        self.time_controls.build(row, self.actions)
        nowhere = pygame.Rect(0, 0, 0, 0)
        lab, few = (nowhere, panel) if self.host.explore else (panel, nowhere)
        self.inspector.build(self.cards.build(lab, self.editor.selection is not None))
        self.explore.build(few)
        self.view.follow()

    def handle(self, event: pygame.Event) -> bool:
        """Handle an event. Widgets come first, then the mouse on the beads."""
        if event.type == pygame.KEYDOWN:
            self.session.end_gesture()
        chosen = self.cards.handle(event)
        if chosen is not None:
            self.editor.refused += not self.editor.apply(chosen)
            return True
        if self.time_controls.handle(event) or any(panel.handle(event) for panel in self.panels):
            return True
        return self.tools.handle(event) or self.timeline.handle(event) or self.pointer.handle(event)

    def take_file(self, path: str, point: tuple[int, int]) -> bool:
        """Draw a table or a picture from a file over a plot. Return False if the file is neither."""
        return self.tools.data.take_file(path, point)

    def update(self, seconds: float) -> None:
        """Advance by `seconds` of wall time."""
        self._notice_kernels()
        self.pointer.update()
        if not self.editor.preparing:
            self.clock.tick(seconds)
        self.outcome.update()
        self.host.follow()
        self.view.update(seconds)
        self.board.update()
        self.timeline.update()
        self.cards.update(seconds)
        self.toolbar.update()
        self.time_controls.explained = self.why.available
        self.time_controls.follow_why()
        for panel in self.panels:
            panel.update(seconds)
        self.sound.update(self.view.scales.scales.force)
        self.lessons.update()
        self.unsaved_scene.update(seconds)

    def _notice_kernels(self) -> None:
        """Let the scene continue after its kernels have been loaded."""
        if not self.editor.preparing:
            return
        self.editor.check_kernels()
        if self.host.warmup.problem:
            self.host.messages.show(self.host.warmup.problem, warning=True)
        if not self.editor.preparing:
            self.view.look_ahead()
            self.view.follow()

    def follow(self) -> None:
        """Update all drawings to the present texts and lanes."""
        self._words.follow()
        self._kernels.follow()
        self._edits.follow()
        self.view.follow()
        self.outcome.follow(self.view.lanes)
        self.timeline.follow()
        self.tools.values.arrange()
        for panel in self.panels:
            panel.follow()

    def paint(self, surface: pygame.Surface) -> None:
        """Draw everything below the widgets."""
        self.view.paint(surface)
        mark = "• " if self.unsaved else ""
        title = scene_words(self.session.scene.title)
        compared = self.tools.before is not None and len(self.session.lanes) > 1
        self.toolbar.paint_title(surface, mark + (_("{title}, compared", title=title) if compared else title))
        self.tools.paint(surface)
        self.timeline.paint(surface)
        self.cards.paint(surface)
        self.explore.paint(surface)
        self.outcome.paint(surface)

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw everything above the widgets."""
        point = self.host.pointer
        self.time_controls.paint_over(surface)
        for lane in self.view.lanes if self.pointer.grip is None else ():
            lane.paint_handles(surface, point)
        self.pointer.paint(surface)
        for panel in self.panels if self.view.panel_shown else ():
            if panel.rect.width:
                panel.paint_over(surface, point)
        self.cards.paint_over(surface, point)
        if not self.tools.covers_plots and not self.why.rows:
            self.board.paint_reading(surface, point)
        self.tools.paint_over(surface)
        self.timeline.paint_reading(surface, point)

    def after_frame(self, surface: pygame.Surface, seconds: float) -> None:
        """Record the finished frame, if a film is being made."""
        self.film.record(surface, seconds)

    def let_go(self) -> None:
        """Release everything that is dragged: a slider, the timeline, the ruler, the view, or a bead."""
        self.session.end_gesture()
        self.timeline.dragged, self.tools.ruler.dragged, self.pointer.panned = False, None, None
        if self.pointer.pressed is not None:
            self.pointer.release()

    def close(self) -> None:
        """Finish the film and stop the sound."""
        if not self.unsaved:
            self.host.unsaved_file.forget()
        self.film.end()
        self.sound.close()
