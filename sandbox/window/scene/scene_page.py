"""The page on which a scene is played: beads, plots, time controls, badges and inspector around one session."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pygame
from softcradle.sandbox.draw.palette import MUTED, WARNING
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.session.lane_setup import Setup
from softcradle.sandbox.session.replay import Replay
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.plots.plot_board import PlotBoard
from softcradle.sandbox.window.scene.impact_clicks import ImpactClicks
from softcradle.sandbox.window.scene.inspector import Inspector
from softcradle.sandbox.window.scene.lane_cards import LaneCards
from softcradle.sandbox.window.scene.pick import Pick
from softcradle.sandbox.window.scene.pointer_tool import PointerTool
from softcradle.sandbox.window.scene.save_dialogs import SaveDialogs
from softcradle.sandbox.window.scene.scene_editor import PREPARING, SceneEditor
from softcradle.sandbox.window.scene.scene_view import SceneView
from softcradle.sandbox.window.scene.time_controls import TimeControls
from softcradle.sandbox.window.scene.timeline import Timeline
from softcradle.sandbox.window.scene.toolbar import build_toolbar
from softcradle.sandbox.window.scene.view_keys import ViewKeys
from softcradle.sandbox.window.scene.window_film import WindowFilm
from softcradle.sandbox.window.window_page import Host


class ScenePage:
    """One session on screen. `leave` goes back to the gallery; `replay` runs the session where it is a recorded one."""

    def __init__(self, host: Host, session: Session, leave: Callable[[], None], replay: Replay | None = None) -> None:
        self.host, self.session, self.leave, self.replay = host, session, leave, replay
        self._setup = session.setup
        self.editor = SceneEditor(host, session)
        self.board = PlotBoard(session)
        self.cards = LaneCards(host, session)
        self.inspector = Inspector(host, session, self.editor)
        self.view = SceneView(host, session, self.editor, self.board, self.inspector)
        self.timeline = Timeline(session)
        self.time_controls = TimeControls(host, session, self.board)
        self.pointer = PointerTool(host, session, self.editor, self.view, self.time_controls)
        self.dialogs = SaveDialogs(host, session)
        self.film = WindowFilm(host, session)
        self.clicks = ImpactClicks(host, session)
        self.actions: dict[str, Callable[[], None]] = {
            **self._time_actions(),
            **ViewKeys(host, self.editor, self.board, self.view, self.cards).actions,
            **self.editor.actions,
            **self.dialogs.actions,
            "film": self.film.toggle,
            "sound": self.clicks.toggle,
            "undo": lambda: host.show(ScenePage(host, Session(session.scene), leave)),
            "help": host.toggle_help,
            "leave": self.escape,
        }

    def _time_actions(self) -> dict[str, Callable[[], None]]:
        session = self.session
        return {
            "play_pause": self.play_pause,
            "forward": partial(self.step, 1),
            "back": partial(self.step, -1),
            "slower": partial(self.time_controls.step_slow, 1),
            "faster": partial(self.time_controls.step_slow, -1),
            "restart": self.restart,
            "first": lambda: session.scrub_frame(session.history.first),
            "last": lambda: session.scrub_frame(session.history.last),
            "previous_event": partial(self.timeline.scrub_to_event, -1),
            "next_event": partial(self.timeline.scrub_to_event, 1),
        }

    @property
    def typing(self) -> bool:
        """Whether a number is being typed."""
        return self.inspector.typing

    def play_pause(self) -> None:
        """Play or pause."""
        if self.session.playing:
            self.session.pause()
        elif self.editor.preparing:
            self.host.messages.show(PREPARING)
        else:
            self.time_controls.apply_slow()
            self.session.play()

    def step(self, by: int) -> None:
        """Go `by` frames on."""
        if not self.editor.preparing:
            self.session.step_frames(by)

    def restart(self) -> None:
        """Back to the start with all edits; plays on if it was playing."""
        playing = self.session.playing
        self.session.restart()
        self.view.reset_camera()
        if playing:
            self.session.play()

    def escape(self) -> None:
        """Deselect; with nothing selected, back to the gallery."""
        if self.editor.selection is not None:
            self.editor.selection = None
        else:
            self.leave()

    def build(self) -> None:
        """Make all widgets for the host's size and unit."""
        unit = self.host.unit
        self.view.arrange()
        places, margin = self.view.places, round(12 * unit)
        panel = places.panel.inflate(-2 * margin, -2 * round(7 * unit)) if self.view.panel_shown else places.panel
        self.view.title_room = build_toolbar(self.host, places.toolbar, self.actions, self.leave)
        left, top, width = places.footer.left, places.footer.top, places.footer.width
        line = pygame.Rect(left + 2 * margin, top + round(12 * unit), width - 4 * margin, round(22 * unit))
        self.timeline.build(line, unit)
        below = pygame.Rect(left + margin, top + round(42 * unit), width - 2 * margin, round(46 * unit))
        self.time_controls.build(below, self.actions)
        self.inspector.build(self.cards.build(panel))
        self.view.rebuild()

    def handle(self, event: pygame.Event) -> bool:
        """Take events of the widgets first, then those of the mouse."""
        chosen = self.cards.handle(event)
        if chosen is not None:
            self.editor.apply(chosen)
            return True
        if self.time_controls.handle(event) or self.inspector.handle(event):
            return True
        return self.timeline.handle(event) or self.pointer.handle(event)

    def update(self, seconds: float) -> None:
        """Let time pass."""
        self._notice_kernels()
        self.pointer.update()
        if not self.editor.preparing:
            self._tick(seconds)
        if self.session.setup is not self._setup:
            self._notice_edit(self._setup, self.session.setup)
        self.view.update(seconds)
        self.board.update()
        self.timeline.update()
        self.cards.update(seconds)
        self.inspector.update(seconds)
        self.clicks.update()

    def _tick(self, seconds: float) -> None:
        if self.replay is None or self.replay.done:
            self.session.tick(seconds)
        elif not self.session.scrubbed:
            self.replay.tick(seconds)
            if self.replay.done:
                self.host.messages.show(self.replay.sentence, warning=self.replay.diverged is not None)

    def _notice_kernels(self) -> None:
        """Go on where the kernels have been loaded."""
        if not self.editor.preparing:
            return
        self.editor.check_kernels()
        if not self.editor.preparing:
            if self.host.warmup.problem:
                self.host.messages.show(self.host.warmup.problem, warning=True)
            self.view.look_ahead()
            self.view.rebuild()

    def _notice_edit(self, before: Setup, now: Setup) -> None:
        """Follow another setup: after an edit, or at a frame from before one."""
        self._setup = now
        if before.slow != now.slow:
            self.board.follow_slow_motion()
            self.view.redraw()
        self.editor.check_kernels()  # an edit may have brought friction or loss, which take kernels of their own
        old, new = ([(lane.chain, lane.locked) for lane in setup.lanes] for setup in (before, now))
        if old != new:
            self._reselect()
            self.view.rebuild()

    def _reselect(self) -> None:
        """Let the selection exist, and its widgets be of the right kind."""
        pick = self.editor.selection
        if pick is None:
            return
        count = self.session.lanes[pick.lane].chain.contacts + (1 if pick.kind == "bead" else 0)
        if pick.index >= count:
            self.editor.selection = Pick(pick.lane, pick.kind, count - 1)
        elif not self.inspector.busy:
            self.inspector.remake()

    def paint(self, surface: pygame.Surface) -> None:
        """Draw all but the widgets."""
        self.view.paint(surface)
        self.timeline.paint(surface)
        self.cards.paint(surface)

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw what lies above the widgets."""
        unit, places, point = self.host.unit, self.view.places, pygame.mouse.get_pos()
        self.time_controls.paint_over(surface)
        self.pointer.paint(surface)
        right = places.panel.left - (20 if self.view.panel_shown else 60) * unit
        self.film.paint(surface, right, places.toolbar.bottom)
        self.board.paint_reading(surface, point)
        self.timeline.paint_reading(surface, point)
        if self.editor.preparing or self.replay is not None:
            text = PREPARING if self.replay is None else self.replay.sentence
            bad = self.replay is not None and self.replay.diverged is not None
            place = (places.lanes[0].centerx, places.lanes[0].top + 30 * unit)
            write(surface, text, place, 15 * unit, WARNING if bad else MUTED, bold=bad, align=(0.5, 0.5))

    def after_frame(self, surface: pygame.Surface, seconds: float) -> None:
        """Record the finished picture, if a film is being made."""
        self.film.record(surface, seconds)

    def close(self) -> None:
        """Close the film and the sound."""
        self.film.end()
        self.clicks.close()
