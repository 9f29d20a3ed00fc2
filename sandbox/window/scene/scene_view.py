"""The view of a scene: beads and plots at the present scales and camera, and the backdrop, which does not change."""

from __future__ import annotations

import pygame
from softcradle.sandbox.draw.palette import BACKGROUND, FAINT, FOREGROUND
from softcradle.sandbox.draw.shared_scales import Scales, scales_of
from softcradle.sandbox.draw.text import shortened, write
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.look_ahead import motions_ahead
from softcradle.sandbox.window.page_geometry import Geometry, geometry
from softcradle.sandbox.window.plots.live_scales import LiveScales, estimated_scales
from softcradle.sandbox.window.plots.plot_board import PlotBoard
from softcradle.sandbox.window.scene.camera import Camera
from softcradle.sandbox.window.scene.inspector import Inspector
from softcradle.sandbox.window.scene.lane_view import LaneView, SessionLanes
from softcradle.sandbox.window.scene.pick import Pick
from softcradle.sandbox.window.scene.scene_editor import SceneEditor
from softcradle.sandbox.window.window_page import Host


class SceneView:
    """What is shown of a session, apart from widgets.

    Attributes:
        scales: of beads and plots.
        camera: which part of the line is shown.
        lanes: the beads, a LaneView for each lane.
        motions: the lanes now, one row each.
        places: rectangles of the page.
        panel_shown: whether the panel on the right is there.
        title_room: width for the title [pixels].
    """

    def __init__(
        self, host: Host, session: Session, editor: SceneEditor, board: PlotBoard, inspector: Inspector
    ) -> None:
        self.host, self.session, self.editor, self.board, self.inspector = host, session, editor, board, inspector
        self.lanes: list[LaneView] = []
        self.panel_shown, self.title_room = True, 0.0
        self.places: Geometry = self._geometry()
        self._backdrop: pygame.Surface | None = None
        self._backdrop_pick: Pick | None = None
        self.look_ahead()

    def look_ahead(self) -> None:
        """Take scales and camera from a run ahead, as a film does; estimate them before the physics is ready."""
        self.scales = LiveScales(self._first_scales(), self.session.lanes)
        self.camera = Camera.of(self.scales.scales)
        self.motions = [lane.motion for lane in self.session.lanes]

    def _first_scales(self) -> Scales:
        scene = self.session.scene
        if not self.editor.preparing:
            try:
                return scales_of(scene, motions_ahead(scene))
            except (UserError, ValueError, RuntimeError, ArithmeticError):
                pass  # a scene whose run ahead fails can still be played
        return estimated_scales(scene, self.session)

    def _geometry(self) -> Geometry:
        rows = [len(row) for row in self.board.rows()]
        return geometry(self.host.size, self.host.unit, len(self.session.lanes), rows, self.panel_shown)

    def arrange(self) -> None:
        """Find the places for the host's size and unit and the plots that are shown."""
        self.places = self._geometry()

    def reset_camera(self) -> None:
        """Show the part of the line that was shown first."""
        self.camera = Camera.of(self.scales.scales)
        self.rebuild()

    def zoom(self, steps: int) -> None:
        """Zoom in by `steps`, out if negative."""
        self.camera.zoom(steps)
        self.rebuild()

    def rebuild(self) -> None:
        """Make beads and plots anew: scales, camera, lanes or places have changed."""
        lanes, unit, places = self.session.lanes, self.host.unit, self.places
        self.scales.reset_lanes(lanes)
        scales = self.camera.window(self.scales.scales)
        drawn = SessionLanes.of(lanes, self.session.scene.view)
        self.lanes = [
            LaneView(k, (rect, places.insets, places.energy_bars), unit, drawn, scales)
            for k, rect in enumerate(places.lanes)
        ]
        self.board.build(places.plots, unit, scales)
        self.redraw()

    def redraw(self) -> None:
        """Draw the backdrop again."""
        self._backdrop = None

    def update(self, seconds: float) -> None:
        """Follow the lanes."""
        lanes = self.session.lanes
        self.camera.follow(lanes, self.session.scene.view.length, seconds)
        self.motions = [lane.motion for lane in lanes]
        if self.scales.fit(self.motions):
            self.rebuild()

    def on_a_lane(self, point: tuple[int, int]) -> bool:
        """Whether `point` is where beads are drawn."""
        return any(rect.collidepoint(point) for rect in self.places.lanes)

    def pick(self, point: tuple[int, int]) -> Pick | None:
        """The bead or contact at `point`."""
        return next((pick for lane in self.lanes if (pick := lane.pick(point)) is not None), None)

    def paint(self, surface: pygame.Surface) -> None:
        """Draw it."""
        pick = self.editor.selection
        if self._backdrop is None or pick != self._backdrop_pick:
            self._backdrop, self._backdrop_pick = self._drawn_backdrop(surface.get_size()), pick
        surface.blit(self._backdrop, (0, 0))
        for lane, motion in zip(self.lanes, self.motions, strict=True):
            lane.paint(surface, motion, self.camera.centre)
        if pick is not None:
            self.lanes[pick.lane].paint_pick(surface, pick)
        self.board.paint(surface)

    def _drawn_backdrop(self, size: tuple[int, int]) -> pygame.Surface:
        unit, places = self.host.unit, self.places
        backdrop = pygame.Surface(size, 0, 32)
        backdrop.fill(BACKGROUND)
        for lane in self.lanes:
            lane.backdrop(backdrop)
        self.board.backdrop(backdrop)
        self.inspector.backdrop(backdrop)
        for y in (places.toolbar.bottom - 1, places.footer.top):
            backdrop.fill(FAINT, (0, y, size[0], 1))
        if self.panel_shown:
            backdrop.fill(FAINT, (places.panel.left, places.panel.top, 1, places.panel.height))
        title = shortened(self.session.scene.title, 19 * unit, self.title_room, bold=True)
        write(backdrop, title, (110 * unit, places.toolbar.centery), 19 * unit, FOREGROUND, bold=True, align=(0, 0.5))
        return backdrop
