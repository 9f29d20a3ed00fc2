"""The pointer tool: selecting, dragging and throwing beads with the mouse, moving the view, zooming by the wheel."""

from __future__ import annotations

import math

import pygame
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.scene.pick import Pick
from softcradle.sandbox.window.scene.scene_editor import SceneEditor
from softcradle.sandbox.window.scene.scene_view import SceneView
from softcradle.sandbox.window.window_page import Host

STILL = 4.0  # design pixels: a click may move by so much without becoming a drag


class PointerTool:
    """What the mouse does to the beads of a page."""

    def __init__(self, host: Host, session: Session, editor: SceneEditor, view: SceneView) -> None:
        self.host, self.session, self.editor, self.view = host, session, editor, view
        self.panned: int | None = None  # where the pointer was last while it moves the view
        self.pressed: Pick | None = None  # the bead on which the button was pressed
        self.dragging = False
        self._start, self._pointer, self._offset, self._beads = (0, 0), (0, 0), 0.0, 0

    def handle(self, event: pygame.Event) -> bool:
        """Press, move, release, wheel."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            return self._press(event.pos)
        if event.type == pygame.MOUSEMOTION and self.panned is not None:
            self.view.pan(event.pos[0] - self.panned)
            self.panned = event.pos[0]
            return True
        if event.type == pygame.MOUSEBUTTONUP and event.button == 1 and self.panned is not None:
            self.panned = None
            return True
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
        self.panned = point[0] if pick is None else None
        if pick is not None and pick.kind == "bead":
            self.pressed, self.dragging = pick, False
            self._start = self._pointer = point
            self._beads = len(self.session.lanes[pick.lane].chain.mass)
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

    @property
    def grip(self) -> Pick | None:
        """The bead that is held; it is let go when beads are added to or removed from its lane."""
        if self.pressed is not None and len(self.session.lanes[self.pressed.lane].chain.mass) != self._beads:
            self.release()
        return self.pressed

    def update(self) -> None:
        """Once a frame: drag the bead to the pointer."""
        pick = self.grip
        if pick is None or not self.dragging or self.editor.preparing:
            return
        lane = self.view.lanes[pick.lane]
        offset = self._pointer[0] + self._offset - float(lane.edges[pick.index])
        position = float(self.session.lanes[pick.lane].position[pick.index]) + lane.metres(offset)
        try:
            self.session.drag(pick.lane, pick.index, position)
        except ValueError as error:
            self.host.messages.show(str(error), warning=True)
            self.release()

    def _wheel(self, event: pygame.Event) -> bool:
        point = pygame.mouse.get_pos()
        if self.view.scroll_plots(point, -1 if event.y > 0 else 1):
            return True
        if self.view.on_a_lane(point):
            self.view.zoom(event.y, point)
            return True
        return False

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the grip on the pressed bead."""
        pick = self.grip
        if pick is not None:
            spring = self.dragging and self.session.playing
            self.view.lanes[pick.lane].paint_grip(surface, pick.index, self._pointer, spring)
