"""The page on which a scene is played: beads, plots, time controls, badges and inspector around one session."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pygame
from softcradle.sandbox.draw.palette import MUTED, WARNING
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.session.inputs import Input, SetMethod
from softcradle.sandbox.session.replay import Replay
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.page_geometry import Geometry, geometry
from softcradle.sandbox.window.plots.plot_board import Board
from softcradle.sandbox.window.scene.inspector import Inspector
from softcradle.sandbox.window.scene.lane_cards import AUTO, Cards
from softcradle.sandbox.window.scene.lane_view import Pick
from softcradle.sandbox.window.scene.pointer_tool import Hands
from softcradle.sandbox.window.scene.save_dialogs import Keeping
from softcradle.sandbox.window.scene.scene_view import Scenery
from softcradle.sandbox.window.scene.time_controls import Transport
from softcradle.sandbox.window.scene.timeline import Timeline
from softcradle.sandbox.window.scene.toolbar import build_toolbar
from softcradle.sandbox.window.scene.view_keys import ViewKeys
from softcradle.sandbox.window.window_page import Host

USUAL_PLOTS = ("velocities", "forces", "overlaps")
PREPARING = "preparing the physics: some seconds, once"


class Play:
    """One session on screen. `leave` goes back to the gallery; `replay` runs the session where it is a recorded one."""

    def __init__(self, host: Host, session: Session, leave: Callable[[], None], replay: Replay | None = None) -> None:
        self.host, self.session, self.leave, self.replay = host, session, leave, replay
        self.side, self.title_room = True, 0.0
        self.pick: Pick | None = None
        self.waiting = not host.warmer.can_move(session.lanes)
        self._setup = session.setup
        self.board = Board(session, [*USUAL_PLOTS, "difference"] if len(session.lanes) == 2 else USUAL_PLOTS)
        self.scenery = Scenery(self)
        self.hands, self.keeping = Hands(self), Keeping(self)
        self.timeline = Timeline(session)
        self.actions: dict[str, Callable[[], None]] = {
            **self._time_actions(),
            **ViewKeys(self).actions,
            **self.hands.actions,
            **self.keeping.actions,
            "undo": lambda: host.show(Play(host, Session(session.scene), leave)),  # as it was opened
            "help": host.toggle_help,
            "leave": self.escape,
        }
        self.transport = Transport(host, session, self.board, self.actions)
        self.inspector = Inspector(host, session, self.apply, self.actions)
        self.cards = Cards(host, session)

    def _time_actions(self) -> dict[str, Callable[[], None]]:
        session = self.session
        return {
            "play_pause": self.play_pause,
            "forward": partial(self.step, 1),
            "back": partial(self.step, -1),
            "slower": lambda: self.transport.step_slow(1),
            "faster": lambda: self.transport.step_slow(-1),
            "restart": self.restart,
            "first": lambda: session.scrub_frame(session.history.first),
            "last": lambda: session.scrub_frame(session.history.last),
            "previous_mark": partial(self.timeline.to_mark, -1),
            "next_mark": partial(self.timeline.to_mark, 1),
        }

    # ---- what is done to the session

    @property
    def typing(self) -> bool:
        """Whether a number is being typed."""
        return self.inspector.typing

    def play_pause(self) -> None:
        """Play or pause."""
        if self.session.playing:
            self.session.pause()
        elif self.waiting:
            self.host.messages.say(PREPARING)
        else:
            self.transport.settle()
            self.session.play()

    def step(self, by: int) -> None:
        """`by` frames on."""
        if not self.waiting:
            self.session.step_frames(by)

    def restart(self) -> None:
        """Back to the start, edits kept, playing on if it was."""
        playing = self.session.playing
        self.session.restart()
        self.scenery.reset_camera()
        if playing:
            self.session.play()

    def escape(self) -> None:
        """Deselect; with nothing selected, back to the gallery."""
        if self.pick is not None:
            self.select(None)
        else:
            self.leave()

    def select(self, pick: Pick | None) -> None:
        """Select a bead or contact, or nothing."""
        self.pick = pick
        self.inspector.select(pick)
        self.scenery.redraw()

    def apply(self, item: Input) -> bool:
        """Hand an input to the session; what it refuses is said on screen."""
        if self.waiting:
            self.host.messages.say(PREPARING)
            return False
        warmer = self.host.warmer
        if isinstance(item, SetMethod) and item.method != AUTO and not warmer.can_move(self.session.lanes, item.method):
            self.host.messages.say(f"method {item.method} is still being prepared: try again in some seconds")
            self.host.rebuild()  # the menu goes back to the method there is
            return False
        try:
            self.session.apply(item)
        except ValueError as error:
            self.host.messages.say(str(error), trouble=True)
            return False
        return True

    # ---- building

    def build(self) -> None:
        """Make all widgets for the host's size and unit."""
        rows = [len(row) for row in self.board.rows()]
        unit = self.host.unit
        self.places: Geometry = geometry(self.host.size, unit, len(self.session.lanes), rows, self.side)
        margin = round(12 * unit)
        side = self.places.side.inflate(-2 * margin, -2 * round(7 * unit)) if self.side else self.places.side
        self.title_room = build_toolbar(self.host, self.places.top, self.actions, self.leave)
        foot = self.places.foot
        line = pygame.Rect(
            foot.left + 2 * margin, foot.top + round(12 * unit), foot.width - 4 * margin, round(22 * unit)
        )
        self.timeline.build(line, unit)
        below = pygame.Rect(foot.left + margin, foot.top + round(42 * unit), foot.width - 2 * margin, round(46 * unit))
        self.transport.build(below)
        self.inspector.build(self.cards.build(side))
        self.scenery.rebuild()

    # ---- every frame

    def handle(self, event: pygame.Event) -> bool:
        """Widgets' own events first, then the mouse."""
        chosen = self.cards.handle(event)
        if chosen is not None:
            self.apply(chosen)
            return True
        if self.transport.handle(event) or self.inspector.handle(event):
            return True
        return self.timeline.handle(event) or self.hands.handle(event)

    def update(self, seconds: float) -> None:
        """Let time pass."""
        self._await()
        self.hands.hold()
        if not self.waiting:
            self._tick(seconds)
        self._notice_edits()
        self.scenery.update(seconds)
        self.board.update()
        self.timeline.update()
        self.cards.update(seconds)
        self.inspector.update(seconds)
        self.keeping.update(seconds)

    def _tick(self, seconds: float) -> None:
        if self.replay is None or self.replay.done:
            self.session.tick(seconds)
        elif not self.session.scrubbed:
            self.replay.tick(seconds)
            if self.replay.done:
                self.host.messages.say(self.replay.sentence, trouble=self.replay.diverged is not None)

    def _await(self) -> None:
        """The physics may have become ready."""
        if self.waiting and self.host.warmer.can_move(self.session.lanes):
            self.waiting = False
            if self.host.warmer.problem:
                self.host.messages.say(self.host.warmer.problem, trouble=True)
            self.scenery.look_ahead()
            self.scenery.rebuild()

    def _notice_edits(self) -> None:
        """The setup is another one: after an edit, or at a scrubbed moment before one."""
        if self.session.setup is self._setup:
            return
        before, self._setup = self._setup, self.session.setup
        if before.slow != self._setup.slow:
            self.board.respan()
            self.scenery.redraw()
        old, new = ([(lane.chain, lane.locked) for lane in setup.lanes] for setup in (before, self._setup))
        self.waiting = not self.host.warmer.can_move(self.session.lanes)  # something may rub now that did not
        if old != new:
            self._reselect()
            self.scenery.rebuild()

    def _reselect(self) -> None:
        """Keep something selected that is still there, and its widgets in step."""
        pick = self.pick
        if pick is None:
            return
        count = self.session.lanes[pick.lane].chain.contacts + (1 if pick.kind == "bead" else 0)
        if pick.index >= count:
            self.select(Pick(pick.lane, pick.kind, count - 1))
        elif not self.inspector.busy:
            self.inspector.remake()

    def paint(self, surface: pygame.Surface) -> None:
        """Draw all but the widgets."""
        self.scenery.paint(surface)
        self.timeline.paint(surface)
        self.cards.paint(surface)

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw what lies above the widgets."""
        self.transport.paint_over(surface)
        self.hands.paint(surface)
        self.keeping.paint(surface)
        point = pygame.mouse.get_pos()
        self.board.paint_reading(surface, point)
        self.timeline.paint_reading(surface, point)
        stage, unit = self.places.stages[0], self.host.unit
        if self.waiting or self.replay is not None:
            text = PREPARING if self.replay is None else self.replay.sentence
            bad = self.replay is not None and self.replay.diverged is not None
            place = (stage.centerx, stage.top + 30 * unit)
            write(surface, text, place, 15 * unit, WARNING if bad else MUTED, bold=bad, align=(0.5, 0.5))

    def shown(self, surface: pygame.Surface, seconds: float) -> None:
        """The finished picture may belong to a film."""
        self.keeping.record(surface, seconds)

    def close(self) -> None:
        """The page is being left."""
        self.keeping.close()
