"""The view of a scene. It draws beads and plots with the present scales and camera, and a backdrop that does not
change.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import pygame
from softcradle.sandbox.draw.lane_drawing import ARROWS
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.shared_scales import Scales, scales_of
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.scene_runs import SHOWN as AHEAD
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.session.session import Session, beginning
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.page import Derived, Host
from softcradle.sandbox.window.page_geometry import Geometry, fitting, geometry, plots_width
from softcradle.sandbox.window.plots.board import PlotBoard
from softcradle.sandbox.window.plots.kinds import VELOCITIES
from softcradle.sandbox.window.plots.scales import (
    MOST_AT_ONCE,
    EditFollower,
    LiveScales,
    estimated_scales,
    motions_ahead,
)
from softcradle.sandbox.window.scene.editor import Pick, SceneEditor
from softcradle.sandbox.window.scene.inspector import Inspector
from softcradle.sandbox.window.scene.lane_view import LaneView, SessionLanes
from softcradle.sandbox.window.scene.outcome_card import OutcomeCard
from softcradle.sandbox.window.scene.why_view import WhyView

ZOOM = 1.25  # Zoom factor of one step.
MARGIN = 0.04  # Margin on each side of the outermost beads when all beads are shown, as a fraction of the width.
# Width of the view after automatic widening, relative to the necessary width. The extra width keeps moving beads
# visible for some time.
SPARE = 1.4
# Distance by which the longest velocity arrow extends beyond its bead, in lengths of a bead.
ARROW = 0.36
# Additional margin of the initial view, as a fraction of the length of a bead. The window of the scales has no space
# for arrows.
OPENING_ROOM = 0.12
# Largest margin on each side of the initial view of an edited scene, as a fraction of the initial length of the lane.
# Scenes of the catalogue need up to 0.63. A bead that bounces off a wall moves on for tens of seconds, and a view of
# its whole path would show the lane as a dot.
MOST_ROOM = 0.7
NO_ROOM = N_("plots do not fit: make the window larger or the scale smaller")
NARROWEST, WIDEST = 1e-4, 1e9  # Smallest and largest visible width, in lengths of a bead.


@dataclass
class Camera:
    """The visible part of the line of beads, given by its centre [m] and width [m]. An `automatic` camera keeps all
    beads visible.
    """

    centre: float
    width: float
    automatic: bool = True

    @classmethod
    def of(cls, window: tuple[float, float]) -> Camera:
        """Return the camera that shows a window [m]."""
        low, high = window
        return cls(0.5 * (low + high), high - low)

    def zoom(self, steps: float, length: float) -> None:
        """Zoom in by `steps`, or out if negative. The limits are relative to the `length` [m] of a bead."""
        self.width = min(max(self.width * ZOOM**-steps, NARROWEST * length), WIDEST * length)
        self.automatic = False

    def pan(self, distance: float) -> None:
        """Move by `distance` [m] to the right."""
        self.centre += distance
        self.automatic = False

    def fit(self, lanes: Sequence[LiveLane], length: float, spare: float = 1.0) -> None:
        """Show all beads in a window that is `spare` times as wide as necessary. The beads are `length` [m] long."""
        low, high = extent(lanes, length)
        self.centre, self.width = 0.5 * (low + high), (1.0 + 2.0 * MARGIN) * spare * (high - low)
        self.automatic = True

    def keep_in_sight(self, lanes: Sequence[LiveLane], length: float, visible: float) -> bool:
        """Widen an automatic camera if a bead has left the visible part of the line, which is `visible` metres wide.

        Return True if the camera has changed.
        """
        if not self.automatic:
            return False
        low, high = extent(lanes, length)
        if low >= self.centre - 0.5 * visible and high <= self.centre + 0.5 * visible:
            return False
        self.fit(lanes, length, SPARE)
        return True

    def window(self, scales: Scales) -> Scales:
        """Return the scales with the window of this camera."""
        return replace(scales, window=(self.centre - 0.5 * self.width, self.centre + 0.5 * self.width))


def extent(lanes: Sequence[LiveLane], length: float) -> tuple[float, float]:
    """Return the left and right end of all beads, including their longest arrows [m]."""
    positions = [lane.position for lane in lanes]
    low = min(float(p.min()) for p in positions)
    high = max(float(p.max()) + length * len(p) for p in positions)
    return low - ARROW * length, high + ARROW * length


class SceneView:
    """The visible content of a session, except the widgets.

    Attributes:
        scales: scales of beads and plots.
        follower: computes new scales after edits.
        camera: visible part of the line.
        lanes: the beads, a LaneView for each lane.
        motions: present state of the lanes, one sample each.
        places: rectangles of the page.
        panel_shown: True if the panel on the right is visible.
        plots_covered: True if something else covers the plots, so that they are not drawn.
        rows: plots of each visible row. There are `row_count` rows in total, and `first_row` is the first visible one.
    """

    def __init__(
        self,
        host: Host,
        session: Session,
        editor: SceneEditor,
        board: PlotBoard,
        panels: Sequence[Inspector],
        card: OutcomeCard,
        why: WhyView,
        answered: Callable[[], object],
    ) -> None:
        self.host, self.session, self.editor, self.board = host, session, editor, board
        self.panels, self.card, self.why, self.answered = panels, card, why, answered
        self.lanes: list[LaneView] = []
        self.panel_shown, self.plots_covered = True, False
        self.first_row = self.row_count = 0
        self.arrows = next(iter(ARROWS))
        self.places: Geometry = self._geometry()
        self._frame = -1  # Frame of the collision that is marked.
        self._backdrop = pygame.Surface((1, 1))
        self.scales = LiveScales(session)
        self.follower = EditFollower(host, session, self.scales)
        self.look_ahead()
        self._grown = Derived(lambda: session.history.cuts, self.scales.follow_history)
        self._framed = Derived(lambda: (self.scales.ahead, session.history.cuts), self._frame_again)
        self._framed.note()
        self._undone, self._went, self._seen = (
            0,
            False,
            self.scales.ahead,
        )  # Number of undone steps, and the scales, when the camera was last reset.
        self.drawn = Derived(self._drawn_of, self._draw)
        self.backdrop = Derived(self._backdrop_of, self._draw_backdrop)

    def look_ahead(self) -> None:
        """Set scales and camera from a run ahead of time, as for a film.

        A long run is done in the background. Estimated scales are used until it ends.
        """
        seen = self._scales_ahead()
        self.scales.take(seen or estimated_scales(self.session.scene, self.session))
        if seen is None:
            self.follower.notice()
        self.reset_camera()
        self.motions = [lane.motion for lane in self.session.lanes]

    def _scales_ahead(self) -> Scales | None:
        """Return the scales of a run ahead of time, or None if the run takes long or fails. The scene can be played in
        any case.
        """
        scene = self.session.scene
        if not self._sees_ahead:
            return None
        try:
            return scales_of(scene, motions_ahead(scene, MOST_AT_ONCE))
        except (UserError, ValueError, RuntimeError, ArithmeticError):
            return None

    @property
    def _sees_ahead(self) -> bool:
        """True if a run ahead of time takes only milliseconds. Its machine code is then in memory."""
        methods = {AHEAD, *(lane.setup.method for lane in self.session.lanes)}
        return all(self.host.warmup.is_warm(method) for method in methods)

    def _geometry(self) -> Geometry:
        self.board.single = (self.board.single or VELOCITIES) if self.host.explore else ""
        size, unit = self.host.size, self.host.unit
        room = plots_width(size, unit, self.panel_shown)
        rows, lanes, explore = self.board.rows(room), len(self.session.lanes), self.host.explore
        most = fitting(size, unit, lanes, explore)
        self.row_count = len(rows)
        self.first_row = min(max(self.first_row, 0), max(0, len(rows) - most))
        self.rows = rows[self.first_row : self.first_row + most]
        return geometry(size, unit, lanes, [len(row) for row in self.rows], self.panel_shown, explore)

    def plots_area(self) -> pygame.Rect:
        """Return the rectangle that contains all plots."""
        places = [rect for row in self.places.plots for rect in row]
        return places[0].unionall(places) if places else pygame.Rect(0, 0, 0, 0)

    def next_arrows(self) -> None:
        """Let the arrows show the next quantity in ARROWS."""
        names = list(ARROWS)
        self.arrows = names[(names.index(self.arrows) + 1) % len(names)]

    def show_plot(self, kind: str) -> None:
        """Show a kind of plot. Scroll to its row if necessary."""
        self.why.hide()
        self.board.show(kind)
        self.host.follow()
        self.say_if_plots_have_no_room()
        if self.rows and all(name != kind for name, _lane in self.board.keys):
            rows = self.board.rows(plots_width(self.host.size, self.host.unit, self.panel_shown))
            self.first_row = next(k for k, row in enumerate(rows) if kind in dict(row))
            self.follow()

    def say_if_plots_have_no_room(self) -> None:
        """Show a message if the requested plots do not fit."""
        if self.row_count and not self.rows:
            self.host.messages.hint(_(NO_ROOM))

    def scroll_plots(self, point: tuple[int, int], by: int) -> bool:
        """Scroll the plots down by `by` rows if `point` is on the plots and some plots do not fit.

        Return True if the plots were scrolled.
        """
        if len(self.rows) == self.row_count or not self.rows or not self.plots_area().collidepoint(point):
            return False
        self.first_row += by
        return True

    def _paint_scroll_bar(self, surface: pygame.Surface) -> None:
        """Draw a scroll bar next to the plots if some plots do not fit."""
        if len(self.rows) == self.row_count or not self.rows:
            return
        first, last = self.places.plots[0][0], self.places.plots[-1][-1]
        track = pygame.Rect(last.right + 2, first.top, max(4, round(5 * self.host.unit)), last.bottom - first.top)
        pygame.draw.rect(surface, tones.grid, track, border_radius=3)
        pitch = track.height / self.row_count
        bar = track.move(0, round(self.first_row * pitch))
        bar.height = round(len(self.rows) * pitch)
        pygame.draw.rect(surface, tones.muted, bar, border_radius=3)

    def arrange(self) -> None:
        """Place all parts of the page. The layout depends on the size and unit of the host and on the visible plots."""
        self.places = self._geometry()

    def reset_camera(self) -> None:
        """Show the beads at the start, with space for the later motion. Beads are not made too small for this purpose."""
        length, (left, right) = self.session.scene.view.length, self.scales.scales.window
        if self.session.edited:
            low, high = extent(beginning(self.session.history.newest_setup).lanes, length)
            room = MOST_ROOM * (high - low)
            left, right = max(left, low - room), min(right, high + room)
        room = OPENING_ROOM * length
        self.camera = Camera.of((left - room, right + room))

    def _frame_again(self) -> None:
        """Reset the camera after a restart, an edit of the start, an undo or a redo, unless the user has moved the
        view.

        After an undo, the scales of the run ahead arrive later, and the camera is reset again.
        """
        session, undone = self.session, len(self.session.undo_stack.undone)
        went = undone != self._undone or (self._went and self._seen is not self.scales.ahead)
        begun = session.frame == session.history.first
        self._undone, self._went, self._seen = undone, went, self.scales.ahead
        if (begun or went) and self.camera.automatic and not session.playing:
            self.reset_camera()

    def zoom(self, steps: float, point: tuple[int, int] | None = None) -> None:
        """Zoom in by `steps`, or out if negative, around `point`."""
        place = None if point is None else self.metres_at(point)
        # Beads have a largest size on screen, so a lane may show more than the width of the camera.
        self.camera.width = max(self.camera.width, self._visible())
        self.camera.zoom(steps, self.session.scene.view.length)
        self.follow()
        if point is not None and place is not None:
            self.camera.centre += place - self.metres_at(point)

    def pan(self, pixels: float) -> None:
        """Move the content by `pixels` to the right."""
        self.camera.pan(-self.lanes[0].metres(pixels))

    def fit(self) -> None:
        """Show all beads, and keep them visible from now on."""
        self.camera.fit(self.session.lanes, self.session.scene.view.length)

    def metres_at(self, point: tuple[int, int]) -> float:
        """Return the position on the line [m] at `point`."""
        lane = self.lanes[0]
        return self.camera.centre + lane.metres(point[0] - lane.drawing.rect.centerx)

    def _visible(self) -> float:
        """Return the visible width of the line of beads [m]."""
        return self.lanes[0].metres(self.lanes[0].drawing.rect.width)

    def follow(self) -> None:
        """Update beads and plots to the present lanes, scales, camera and layout."""
        self._grown.follow()
        self.drawn.follow()

    def _drawn_of(self) -> object:
        board, camera, lanes = self.board, self.camera, self.session.setup.chains
        plots = board.present, board.single, board.logarithmic, board.pair, self.first_row, self.panel_shown
        shown = self.scales.scales, camera.width, camera.automatic, self.arrows, bool(self.card.paragraphs)
        return self.host.look, self.session.scene, lanes, self.session.history.cuts, plots, shown, self.why.rows

    def _draw(self) -> None:
        """Create the drawings of beads and plots again."""
        self.arrange()
        lanes, unit, places = self.session.lanes, self.host.unit, self.places
        self.scales.reset_lanes(lanes)
        scales = self.camera.window(self.scales.scales)
        drawn = SessionLanes.of(self.session)
        own = [replace(scales, force=row.force) for row in self.why.rows] or [scales] * len(places.lanes)
        self.lanes = [
            LaneView(k, (rect, places.insets, places.energy_bars), unit, drawn, own[k])
            for k, rect in enumerate(places.lanes)
        ]
        for lane in self.lanes:
            lane.drawing.arrows = self.arrows
        for lane, row in zip(self.lanes, self.why.rows, strict=False):
            if row.approach is not None:
                lane.take_approach(*row.approach)
        self.board.whole = bool(self.card.paragraphs or self.why.rows)
        self.board.build(self.rows, places.plots, unit, scales)
        self.why.build(self.plots_area(), self.lanes)

    def update(self, seconds: float) -> None:
        """Update the view to the present state of the lanes."""
        lanes = self.session.lanes
        if not self.editor.preparing:
            self.follower.update(seconds)
        self.why.update()
        self.motions = [row.motion for row in self.why.rows] or [lane.motion for lane in lanes]
        if not self.why.rows:
            self._follow_collisions()
        self._framed.follow()
        self.camera.keep_in_sight(lanes, self.session.scene.view.length, self._visible())
        self._grown.follow()
        self.scales.fit(self.motions)
        self.follow()

    def _follow_collisions(self) -> None:
        """Update the marks of rigid clusters to the present collision."""
        for k, (view, lane) in enumerate(zip(self.lanes, self.session.lanes, strict=True)):
            same = len(view.drawing.chain.mass) == len(lane.chain.mass)
            new = same and self.session.frame != self._frame and (lane.state.force > 0.0).any()
            if new:
                view.take_approach(*self.session.approach(k))
        self._frame = self.session.frame

    def on_a_lane(self, point: tuple[int, int]) -> bool:
        """Return True if `point` is in the rectangle of a lane."""
        return any(rect.collidepoint(point) for rect in self.places.lanes)

    def pick(self, point: tuple[int, int]) -> Pick | None:
        """Return the bead or contact at `point`, or None."""
        return next((pick for lane in self.lanes if (pick := lane.pick(point)) is not None), None)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the backdrop, the beads and the plots."""
        pick = self.editor.selection
        self.backdrop.follow()
        surface.blit(self._backdrop, (0, 0))
        for lane, motion in zip(self.lanes, self.motions, strict=True):
            lane.paint(surface, motion, self.camera.centre)
        if pick is not None:
            self.lanes[pick.lane].paint_pick(surface, pick)
        if self.why.rows:
            self.why.paint(surface)
        elif not self.plots_covered:
            self.board.paint(surface)
            self._paint_scroll_bar(surface)

    def _backdrop_of(self) -> object:
        marks = [lane.marked for lane in self.lanes]
        panels = [(panel.rect, panel.pick, tuple(panel.controls)) for panel in self.panels]
        words = self.answered(), self.session.setup.starts  # If the scene was edited, a note replaces its text.
        return self.drawn.version, marks, panels, words, self.board.span.seconds, self.plots_covered

    def _draw_backdrop(self) -> None:
        places, size = self.places, self.host.size
        self._backdrop = backdrop = pygame.Surface(size, 0, 32)
        backdrop.fill(tones.background)
        for lane in self.lanes:
            lane.backdrop(backdrop)
        if self.why.rows:
            self.why.backdrop(backdrop)
        elif not self.plots_covered:
            self.board.backdrop(backdrop)
        for panel in self.panels:
            panel.backdrop(backdrop)
        for y in (places.toolbar.bottom - 1, places.footer.top):
            backdrop.fill(tones.faint, (0, y, size[0], 1))
        if self.panel_shown:
            backdrop.fill(tones.faint, (places.panel.left, places.panel.top, 1, places.panel.height))
