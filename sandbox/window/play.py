"""The page on which a scene is played: beads, plots, time controls, badges and inspector around one session."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pygame
from pygame_gui.elements import UIButton

from sandbox.draw.palette import FAINT, INK, MUTED, PAPER, WARNING
from sandbox.draw.scales import Scales, scales_of
from sandbox.draw.text import shortened, write
from sandbox.session.inputs import Input, SetMethod
from sandbox.session.replay import Replay
from sandbox.session.session import Session
from sandbox.window.board import Board
from sandbox.window.camera import Camera
from sandbox.window.cards import Cards
from sandbox.window.geometry import Geometry, geometry
from sandbox.window.hands import Hands
from sandbox.window.inspector import Inspector
from sandbox.window.keeping import Keeping
from sandbox.window.keys import hint
from sandbox.window.live_scales import LiveScales, estimated, moment
from sandbox.window.page import Host
from sandbox.window.plot_kinds import KINDS
from sandbox.window.stage_view import Pick, ShownScene, StageView
from sandbox.window.thumbnails import motion
from sandbox.window.timeline import Timeline
from sandbox.window.transport import Transport

USUAL_PLOTS = ("velocities", "forces", "overlaps")
TOOLS = (
    ("save_scene", "Save scene", 92.0),
    ("save_session", "Save session", 102.0),
    ("export", "Export", 64.0),
    ("screenshot", "Screenshot", 86.0),
    ("film", "Film", 52.0),
    ("help", "Help", 52.0),
)


class Play:
    """One session on screen. `leave` goes back to the gallery."""

    def __init__(self, host: Host, session: Session, leave: Callable[[], None], replay: Replay | None = None) -> None:
        self.host, self.session, self.leave, self.replay = host, session, leave, replay
        self.scene = session.scene
        self.side = True
        self.pick: Pick | None = None
        self.board = Board(session, [*USUAL_PLOTS, "difference"] if len(session.lanes) == 2 else USUAL_PLOTS)
        self.scales = LiveScales(self._first_scales(), session.lanes)
        self.camera = Camera.of(self.scales.scales)
        self.hands, self.keeping = Hands(self), Keeping(self)
        self.actions: dict[str, Callable[[], None]] = self._actions()
        self.timeline = Timeline(session)
        self.transport = Transport(host, session, self.board, self.actions)
        self.inspector = Inspector(host, session, self.apply, self.actions)
        self.cards = Cards(host, session)
        self.views: list[StageView] = []
        self.ground: pygame.Surface | None = None
        self.waiting = not host.warmer.ready.is_set()
        self.tracks = [moment(lane) for lane in session.lanes]
        self._setup = session.setup

    def _first_scales(self) -> Scales:
        """From a run ahead where the physics can run without a wait: the scales of the film."""
        if not self.host.warmer.ready.is_set():
            return estimated(self.scene, self.session)
        try:
            return scales_of(self.scene, motion(self.scene))
        except (ValueError, RuntimeError, ArithmeticError):
            return estimated(self.scene, self.session)

    def _actions(self) -> dict[str, Callable[[], None]]:
        session, time = self.session, {
            "play_pause": self.play_pause,
            "forward": partial(self.step, 1),
            "back": partial(self.step, -1),
            "slower": lambda: self.transport.step_slow(1),
            "faster": lambda: self.transport.step_slow(-1),
            "restart": self.restart,
            "first": lambda: session.scrub_frame(session.history.first),
            "last": lambda: session.scrub_frame(session.history.last),
            "previous_mark": lambda: self.timeline.to_mark(-1),
            "next_mark": lambda: self.timeline.to_mark(1),
        }  # fmt: skip
        view = {
            "logarithmic": self.toggle_axis,
            "plots": self.toggle_plots,
            "fit": self.toggle_follow,
            "zoom_in": lambda: self.zoom(1),
            "zoom_out": lambda: self.zoom(-1),
            "method": lambda: self.apply(SetMethod(None, self.cards.next_method())) and self.host.rebuild(),
            "inspector": self.toggle_side,
            "undo": self.reopen,
            "leave": self.escape,
        }
        plots = {kind: partial(self.toggle_plot, kind) for kind in KINDS}
        help_alone = {"help": self.host.toggle_help}
        return {**time, **view, **plots, **help_alone, **self.hands.actions, **self.keeping.actions}

    # ---- what the keys do

    def play_pause(self) -> None:
        """Play or pause."""
        if self.session.playing:
            self.session.pause()
        elif self.waiting:
            self.host.messages.say("the physics is still being prepared: a few seconds, once")
        else:
            self.transport.settle()
            self.session.play()

    @property
    def typing(self) -> bool:
        """Whether a number is being typed."""
        return self.inspector.typing

    def step(self, by: int) -> None:
        """`by` frames on."""
        if not self.waiting:
            self.session.step_frames(by)

    def restart(self) -> None:
        """Back to the start, edits kept, playing on if it was."""
        playing = self.session.playing
        self.session.restart()
        self.camera = Camera.of(self.scales.scales)
        self.rebuild_views()
        if playing:
            self.session.play()

    def toggle_plot(self, kind: str) -> None:
        """Show or hide one kind of plot."""
        if kind == "difference" and len(self.session.lanes) != 2:
            self.host.messages.say("the difference needs two lanes")
            return
        self.board.toggle(kind)
        self.host.rebuild()

    def toggle_plots(self) -> None:
        """Show or hide all plots."""
        self.board.hidden = not self.board.hidden
        self.host.rebuild()

    def toggle_axis(self) -> None:
        """Overlaps on a logarithmic axis or a plain one."""
        self.board.logarithmic = not self.board.logarithmic
        self.rebuild_views()

    def toggle_follow(self) -> None:
        """Let the camera follow the beads, or stand where it is."""
        self.camera.following = not self.camera.following
        self.host.messages.say("the camera follows the beads" if self.camera.following else "the camera stands still")

    def toggle_side(self) -> None:
        """Hide or show the panel on the right."""
        self.side = not self.side
        self.host.rebuild()

    def zoom(self, steps: int) -> None:
        """Nearer or farther."""
        self.camera.zoom(steps)
        self.rebuild_views()

    def reopen(self) -> None:
        """Forget all edits: the scene as it was opened."""
        self.host.show(Play(self.host, Session(self.scene), self.leave))

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
        self.redraw()

    def apply(self, item: Input) -> bool:
        """Hand an input to the session; what it refuses is said on screen."""
        if self.waiting:
            self.host.messages.say("the physics is still being prepared: a few seconds, once")
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
        self._build_top()
        foot = self.places.foot
        self.timeline.build(
            pygame.Rect(foot.left + 2 * margin, foot.top + round(12 * unit), foot.width - 4 * margin, round(22 * unit)),
            unit,
        )
        below = pygame.Rect(foot.left + margin, foot.top + round(42 * unit), foot.width - 2 * margin, round(46 * unit))
        self.transport.build(below)
        self.inspector.build(self.cards.build(side))
        self.rebuild_views()

    def _build_top(self) -> None:
        unit, manager, top = self.host.unit, self.host.manager, self.places.top
        high = round(30 * unit)
        y = top.centery - high // 2
        place = pygame.Rect(round(12 * unit), y, round(84 * unit), high)
        UIButton(place, "← Scenes", manager, tool_tip_text="back to the gallery", command=self.leave)
        x = top.right - round(12 * unit)
        for name, text, wide in reversed(TOOLS):
            x -= round((wide + 5) * unit)
            place = pygame.Rect(x, y, round(wide * unit), high)
            UIButton(place, text, manager, tool_tip_text=hint(name), command=self.actions[name])
        self.title_room = x - round(120 * unit)

    def rebuild_views(self) -> None:
        """Make beads and plots anew: scales, camera, lanes or their number have changed."""
        lanes, unit, places = self.session.lanes, self.host.unit, self.places
        self.scales.reset_lanes(lanes)
        scales = self.camera.window(self.scales.scales)
        shown = ShownScene.of(lanes, self.scene.view)
        self.views = [
            StageView(k, (rect, places.loupes, places.shares), unit, lane, shown, scales)
            for k, (rect, lane) in enumerate(zip(places.stages, lanes, strict=True))
        ]
        self.board.build(places.plots, unit, scales)
        self.redraw()

    def redraw(self) -> None:
        """What stands still must be drawn again."""
        self.ground = None

    # ---- every frame

    def handle(self, event: pygame.Event) -> bool:
        """Widgets' own events first, then the mouse."""
        chosen = self.cards.handle(event)
        if chosen is not None:
            return self.apply(chosen) or True
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
        self.camera.follow(self.session.lanes, self.scene.view.length, seconds)
        self.tracks = [moment(lane) for lane in self.session.lanes]
        if self.scales.fit(self.tracks):
            self.rebuild_views()
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
        """The physics has become ready: scales from a run ahead."""
        if self.waiting and self.host.warmer.ready.is_set():
            self.waiting = False
            if self.host.warmer.problem:
                self.host.messages.say(self.host.warmer.problem, trouble=True)
            self.scales = LiveScales(self._first_scales(), self.session.lanes)
            self.camera = Camera.of(self.scales.scales)
            self.rebuild_views()

    def _notice_edits(self) -> None:
        """The setup is another one: after an edit, or at a scrubbed moment before one."""
        if self.session.setup is self._setup:
            return
        before, self._setup = self._setup, self.session.setup
        chains = [lane.chain for lane in self._setup.lanes]
        if before.slow != self._setup.slow:
            self.board.respan()
            self.redraw()
        if [lane.chain for lane in before.lanes] != chains:
            self._changed_chains()
        elif [lane.locked for lane in before.lanes] != [lane.locked for lane in self._setup.lanes]:
            self.rebuild_views()

    def _changed_chains(self) -> None:
        pick = self.pick
        if pick is not None:
            count = self.session.lanes[pick.lane].chain.contacts + (1 if pick.kind == "bead" else 0)
            if pick.index >= count:
                self.select(Pick(pick.lane, pick.kind, count - 1))
            elif not self.inspector.busy:
                self.inspector.remake()
        self.rebuild_views()

    def paint(self, surface: pygame.Surface) -> None:
        """Draw all but the widgets."""
        if self.ground is None:
            self.ground = self._drawn_ground(surface.get_size())
        surface.blit(self.ground, (0, 0))
        for view, track in zip(self.views, self.tracks, strict=True):
            view.paint(surface, track, self.camera.centre)
        if self.pick is not None:
            self.views[self.pick.lane].paint_pick(surface, self.pick)
        self.board.paint(surface)
        self.timeline.paint(surface)
        self.cards.paint(surface)

    def _drawn_ground(self, size: tuple[int, int]) -> pygame.Surface:
        ground, unit, places = pygame.Surface(size, 0, 32), self.host.unit, self.places
        ground.fill(PAPER)
        for view in self.views:
            view.backdrop(ground)
        self.board.backdrop(ground)
        self.inspector.backdrop(ground)
        for y in (places.top.bottom - 1, places.foot.top):
            ground.fill(FAINT, (0, y, size[0], 1))
        if self.side:
            ground.fill(FAINT, (places.side.left, places.side.top, 1, places.side.height))
        title = shortened(self.scene.title, 19 * unit, self.title_room, bold=True)
        write(ground, title, (110 * unit, places.top.centery), 19 * unit, INK, bold=True, align=(0, 0.5))
        return ground

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw what lies above the widgets."""
        self.transport.paint_over(surface)
        self.hands.paint(surface)
        self.keeping.paint(surface)
        point = pygame.mouse.get_pos()
        self.board.paint_reading(surface, point)
        self.timeline.paint_reading(surface, point)
        if self.waiting or self.replay is not None:
            place = (self.places.stages[0].centerx, self.places.stages[0].top + 60 * self.host.unit)
            text = "preparing the physics: a few seconds, once" if self.replay is None else self.replay.sentence
            tint = WARNING if self.replay is not None and self.replay.diverged is not None else MUTED
            write(surface, text, place, 15 * self.host.unit, tint, bold=tint is WARNING, align=(0.5, 0.5))

    def shown(self, surface: pygame.Surface, seconds: float) -> None:
        """The finished picture may belong to a film."""
        self.keeping.record(surface, seconds)

    def close(self) -> None:
        """The page is being left."""
        self.keeping.close()
