"""The scenery of a page: beads and plots at the scales and the camera that hold now, and all that stands still."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pygame
from softcradle.sandbox.draw.palette import BACKGROUND, FAINT, FOREGROUND
from softcradle.sandbox.draw.shared_scales import Scales, scales_of
from softcradle.sandbox.draw.text import shortened, write
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.gallery.thumbnails import motion
from softcradle.sandbox.window.plots.live_scales import LiveScales, estimated, moment
from softcradle.sandbox.window.scene.camera import Camera
from softcradle.sandbox.window.scene.lane_view import ShownScene, StageView

if TYPE_CHECKING:
    from softcradle.sandbox.window.scene.scene_page import Play


class Scenery:
    """What is seen of a session, apart from widgets.

    Attributes:
        scales: what stands for what.
        camera: which part of the line is seen.
        views: beads, one a lane.
        tracks: the lanes now, one row each.
    """

    def __init__(self, page: Play) -> None:
        self.page, self.session = page, page.session
        self.views: list[StageView] = []
        self._ground: pygame.Surface | None = None
        self.look_ahead()

    def look_ahead(self) -> None:
        """Take scales and camera from a run ahead: those of the film. Before the physics is ready, estimate them."""
        self.scales = LiveScales(self._first_scales(), self.session.lanes)
        self.camera = Camera.of(self.scales.scales)
        self.tracks = [moment(lane) for lane in self.session.lanes]

    def _first_scales(self) -> Scales:
        scene = self.session.scene
        if not self.page.waiting:
            try:
                return scales_of(scene, motion(scene))
            except (UserError, ValueError, RuntimeError, ArithmeticError):
                pass  # a scene whose run ahead fails can still be played
        return estimated(scene, self.session)

    def reset_camera(self) -> None:
        """Show what was seen at first."""
        self.camera = Camera.of(self.scales.scales)
        self.rebuild()

    def rebuild(self) -> None:
        """Make beads and plots anew: scales, camera, lanes or places have changed."""
        lanes, unit, places = self.session.lanes, self.page.host.unit, self.page.places
        self.scales.reset_lanes(lanes)
        scales = self.camera.window(self.scales.scales)
        shown = ShownScene.of(lanes, self.session.scene.view)
        self.views = [
            StageView(k, (rect, places.loupes, places.shares), unit, shown, scales)
            for k, rect in enumerate(places.stages)
        ]
        self.page.board.build(places.plots, unit, scales)
        self.redraw()

    def redraw(self) -> None:
        """What stands still must be drawn again."""
        self._ground = None

    def update(self, seconds: float) -> None:
        """Follow the lanes."""
        lanes = self.session.lanes
        self.camera.follow(lanes, self.session.scene.view.length, seconds)
        self.tracks = [moment(lane) for lane in lanes]
        if self.scales.fit(self.tracks):
            self.rebuild()

    def paint(self, surface: pygame.Surface) -> None:
        """Draw it."""
        if self._ground is None:
            self._ground = self._drawn_ground(surface.get_size())
        surface.blit(self._ground, (0, 0))
        for view, track in zip(self.views, self.tracks, strict=True):
            view.paint(surface, track, self.camera.centre)
        if self.page.pick is not None:
            self.views[self.page.pick.lane].paint_pick(surface, self.page.pick)
        self.page.board.paint(surface)

    def _drawn_ground(self, size: tuple[int, int]) -> pygame.Surface:
        page, unit, places = self.page, self.page.host.unit, self.page.places
        ground = pygame.Surface(size, 0, 32)
        ground.fill(BACKGROUND)
        for view in self.views:
            view.backdrop(ground)
        page.board.backdrop(ground)
        page.inspector.backdrop(ground)
        for y in (places.top.bottom - 1, places.foot.top):
            ground.fill(FAINT, (0, y, size[0], 1))
        if page.side:
            ground.fill(FAINT, (places.side.left, places.side.top, 1, places.side.height))
        title = shortened(self.session.scene.title, 19 * unit, page.title_room, bold=True)
        write(ground, title, (110 * unit, places.top.centery), 19 * unit, FOREGROUND, bold=True, align=(0, 0.5))
        return ground
