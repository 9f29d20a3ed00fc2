"""The pointer tool: selecting, dragging and throwing beads with the mouse, and slow motion by its wheel."""

from __future__ import annotations

import math

import pygame
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.scene.pick import Pick
from softcradle.sandbox.window.scene.scene_editor import SceneEditor
from softcradle.sandbox.window.scene.scene_view import SceneView
from softcradle.sandbox.window.scene.time_controls import TimeControls
from softcradle.sandbox.window.window_page import Host

STILL = 4.0  # design pixels: a click may move by so much without becoming a drag
WHEEL = 1.0 / 8.0  # decades of slow motion for a notch of the wheel


class PointerTool:
    """What the mouse does to the beads of a page."""

    def __init__(
        self, host: Host, session: Session, editor: SceneEditor, view: SceneView, time_controls: TimeControls
    ) -> None:
        self.host, self.session, self.editor, self.view, self.time_controls = host, session, editor, view, time_controls
        self.pressed: Pick | None = None  # the bead on which the button was pressed
        self.dragging = False
        self._start, self._pointer, self._offset = (0, 0), (0, 0), 0.0

    def handle(self, event: pygame.Event) -> bool:
        """Press, move, release, wheel."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            return self._press(event.pos)
        if event.type == pygame.MOUSEMOTION and self.pressed is not None:
            self._move(event.pos)
            return True
        if event.type == pygame.MOUSEBUTTONUP and event.button == 1 and self.pressed is not None:
            self.release()
            return True
        return event.type == pygame.MOUSEWHEEL and self._wheel(event)

    def _press(self, point: tuple[int, int]) -> bool:
        pick = self.view.pick(point)
        if pick is None and not self.view.on_a_lane(point):
            return False
        self.editor.selection = pick
        if pick is not None and pick.kind == "bead":
            self.pressed, self.dragging = pick, False
            self._start = self._pointer = point
            self._offset = float(self.view.lanes[pick.lane].edges[pick.index]) - point[0]
        return True

    def _move(self, point: tuple[int, int]) -> None:
        self._pointer = point
        if math.dist(point, self._start) > STILL * self.host.unit:
            self.dragging = True

    def release(self) -> None:
        """Release the bead: while running it keeps its velocity."""
        self.pressed, self.dragging = None, False
        self.session.drop()

    def update(self) -> None:
        """Once a frame: drag the bead to the pointer."""
        if self.pressed is None or not self.dragging or self.editor.preparing:
            return
        pick, lane = self.pressed, self.view.lanes[self.pressed.lane]
        if pick.index >= len(lane.edges):
            self.release()
            return
        offset = self._pointer[0] + self._offset - float(lane.edges[pick.index])
        position = float(self.session.lanes[pick.lane].position[pick.index]) + lane.metres(offset)
        try:
            self.session.drag(pick.lane, pick.index, position)
        except ValueError as error:
            self.host.messages.show(str(error), warning=True)
            self.release()

    def _wheel(self, event: pygame.Event) -> bool:
        point = pygame.mouse.get_pos()
        if pygame.key.get_mods() & pygame.KMOD_CTRL:
            self.view.zoom(1 if event.y > 0 else -1)
            return True
        if self.view.places.panel.collidepoint(point):
            return False
        slow = self.time_controls.slow * 10.0 ** (-event.y * WHEEL)
        self.time_controls.set_slow(float(f"{slow:.2g}"))
        return True

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the grip on the pressed bead."""
        if self.pressed is not None and self.pressed.index < len(self.view.lanes[self.pressed.lane].edges):
            spring = self.dragging and self.session.playing
            self.view.lanes[self.pressed.lane].paint_grip(surface, self.pressed.index, self._pointer, spring)
