"""The mouse on the lanes. It selects, drags and throws beads, and moves the view. The module also contains a ruler and
a stopwatch.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pygame
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.story.numbers import scientific
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.scene.editor import Pick, SceneEditor
from softcradle.sandbox.window.scene.view import SceneView

REACH = 8.0  # Largest distance in design pixels at which the mouse takes an end of the ruler.


class Stopwatch:
    """A stopwatch for model time. One key starts, stops and removes it. It also works while the user scrubs."""

    def __init__(self, host: Host, session: Session, clock: Callable[[float], str]) -> None:
        """Create a stopwatch. The function `clock` formats a time [s] as text."""
        self.host, self.session, self.clock = host, session, clock
        self.begin: float | None = None
        self.end: float | None = None

    def press(self) -> None:
        """Start, stop, or remove the stopwatch, in this order."""
        if self.begin is None:
            self.begin = self.session.time
        elif self.end is None:
            self.end = self.session.time
        else:
            self.begin = self.end = None

    @property
    def elapsed(self) -> float | None:
        """Measured model time [s], or None if the stopwatch is not in use."""
        if self.begin is None:
            return None
        return (self.session.time if self.end is None else self.end) - self.begin

    def paint(self, surface: pygame.Surface, place: tuple[float, float]) -> None:
        """Draw the time, centred at `place`."""
        if self.elapsed is None:
            return
        text = N_("stopwatch {time} (running)") if self.end is None else N_("stopwatch {time} (stopped)")
        _tag(surface, _(text, time=self.clock(self.elapsed)), place, self.host.unit)


class Ruler:
    """A ruler on the line of the beads. Both ends can be dragged. They keep their positions on the line when the view
    moves.
    """

    def __init__(self, host: Host, session: Session, view: SceneView) -> None:
        self.host, self.session, self.view = host, session, view
        self.ends: list[float] | None = None  # Positions of both ends on the line of the beads [m].
        self.dragged: int | None = None

    def toggle(self) -> None:
        """Place the ruler on the ground of the first lane, or remove it."""
        rect = self.view.places.lanes[0]
        places = [(round(rect.left + share * rect.width), 0) for share in (0.3, 0.7)]
        self.ends = [self.view.metres_at(place) for place in places] if self.ends is None else None

    @property
    def distance(self) -> float | None:
        """Distance between both ends [m]."""
        return None if self.ends is None else abs(self.ends[1] - self.ends[0])

    def points(self) -> list[tuple[int, int]]:
        """Return both ends on screen [pixels]."""
        y, zero = round(self.view.lanes[0].drawing.ground), self.view.metres_at((0, 0))
        scale = self.view.metres_at((1000, 0)) - zero
        return [(round((end - zero) / scale * 1000), y) for end in self.ends or ()]

    def handle(self, event: pygame.Event) -> bool:
        """Handle an event: an end of the ruler can be dragged."""
        if self.ends is None:
            return False
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            near = [k for k, end in enumerate(self.points()) if math.dist(end, event.pos) < REACH * self.host.unit]
            self.dragged = near[0] if near else None
            return self.dragged is not None
        if event.type == pygame.MOUSEMOTION and self.dragged is not None:
            self.ends[self.dragged] = self.view.metres_at(event.pos)
            return True
        return False

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the ruler and its length."""
        if self.ends is None or self.distance is None:
            return
        unit, (first, last) = self.host.unit, self.points()
        pygame.draw.line(surface, tones.accent, first, last, max(2, round(2 * unit)))
        for x, y in (first, last):
            pygame.draw.circle(surface, tones.accent, (x, y), 5 * unit)
        text, end = f"{scientific(self.distance, 2)} m", max(first[0], last[0])
        beside = end + 16 * unit + width(text, 13 * unit) / 2
        _tag(surface, text, (beside, first[1]), unit)


def _tag(surface: pygame.Surface, text: str, place: tuple[float, float], unit: float) -> None:
    """Draw light text on a dark plate, centred at `place`."""
    box = write(surface, text, place, 13 * unit, tones.background, align=(0.5, 0.5))
    pygame.draw.rect(surface, tones.foreground, box.inflate(14 * unit, 6 * unit), border_radius=5)
    write(surface, text, place, 13 * unit, tones.background, align=(0.5, 0.5))


STILL = 4.0  # Distance in design pixels by which the mouse may move during a click. A longer movement counts as a drag.


class PointerTool:
    """The actions of the mouse on the beads of a page."""

    def __init__(self, host: Host, session: Session, editor: SceneEditor, view: SceneView) -> None:
        self.host, self.session, self.editor, self.view = host, session, editor, view
        self.panned: int | None = None  # Last position of the pointer while it moves the view, or None.
        self.pressed: Pick | None = None  # The bead on which the button was pressed.
        self.dragging = False
        self._start, self._pointer, self._offset, self._beads = (0, 0), (0, 0), 0.0, 0

    def handle(self, event: pygame.Event) -> bool:
        """Handle a mouse press, a mouse movement or the wheel. The page handles the release of the button."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            return self._press(event.pos)
        if event.type == pygame.MOUSEMOTION and self.panned is not None:
            self.view.pan(event.pos[0] - self.panned)
            self.panned = event.pos[0]
            return True
        if event.type == pygame.MOUSEMOTION and self.pressed is not None:
            self._move(event.pos)
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
        """Release the held bead. In a running scene it keeps its velocity."""
        self.pressed, self.dragging = None, False
        self.session.drop()

    @property
    def grip(self) -> Pick | None:
        """The bead that is held, or None. It is released if the number of beads in its lane changes."""
        if self.pressed is not None and len(self.session.lanes[self.pressed.lane].chain.mass) != self._beads:
            self.release()
        return self.pressed

    def update(self) -> None:
        """Drag the held bead to the pointer. This is called once per frame."""
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
        """Draw a line around the held bead."""
        pick = self.grip
        if pick is not None:
            spring = self.dragging and self.session.playing
            self.view.lanes[pick.lane].paint_grip(surface, pick.index, self._pointer, spring)
