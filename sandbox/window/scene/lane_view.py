"""The beads of one lane on the page. They are drawn, found under the pointer, and marked if they are selected."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pygame
from softcradle.physics import Chain
from softcradle.sandbox.draw.bodies import has_marks
from softcradle.sandbox.draw.energy_bars import EnergyBars
from softcradle.sandbox.draw.lane_drawing import LaneDrawing
from softcradle.sandbox.draw.magnified_insets import MagnifiedInsets
from softcradle.sandbox.draw.palette import Colour, tones
from softcradle.sandbox.draw.shared_scales import Scales, left_edges
from softcradle.sandbox.draw.text import write
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.scene.editor import Pick
from softcradle.scenes import View

HANDLE = 7.0  # Half the diagonal of a contact handle in design pixels.
LEAST_HANDLED = 6.0 * HANDLE  # Smallest size of a bead that gets handles, in design pixels.
REACH = 9.0  # Largest horizontal distance in design pixels between a click and the contact that it selects.
REACH_OF_BEAD = 0.2  # The same distance as a fraction of the length of a bead. The larger of the two distances applies.
# Largest horizontal distance in design pixels between a click and the centre of a bead that it selects, if the bead is
# small.
LEAST_REACH = 5.0


@dataclass(frozen=True)
class SessionLane:
    """A lane of a running session, in the form that LaneDrawing needs. It includes the state before the collision and
    the locked pistons.
    """

    label: str
    approach: tuple[Array, Array]
    live_chain: Chain
    locked: tuple[bool, ...]

    @property
    def velocity(self) -> tuple[float, ...]:
        """(n+1,) velocities of the beads before the collision [m/s]."""
        return tuple(self.approach[1].tolist())

    def chain(self) -> Chain:
        """Return the chain. It is a method because a Lane of a scene has to create its chain."""
        return self.live_chain


@dataclass(frozen=True)
class SessionLanes:
    """The present lanes of a session in the form that LaneDrawing needs."""

    lanes: tuple[SessionLane, ...]
    view: View

    @classmethod
    def of(cls, session: Session) -> SessionLanes:
        """Return the present lanes of a session."""
        return cls(tuple(_session_lane(session, k) for k in range(len(session.lanes))), session.scene.view)


def _session_lane(session: Session, number: int) -> SessionLane:
    lane = session.lanes[number]
    locked = tuple(law is not None for law in lane.setup.locked)
    return SessionLane(session.label(number), session.approach(number), lane.chain, locked)


class LaneView:
    """The drawing of the beads of lane `number`. A new one is created after every edit and every change of scale.

    Attributes:
        edges: (n+1,) left edges of the beads in the last frame [pixels].
        contacts: (n,) positions of the contacts in the last frame [pixels].
    """

    def __init__(
        self,
        number: int,
        rects: tuple[pygame.Rect, pygame.Rect, pygame.Rect],
        unit: float,
        scene: SessionLanes,
        scales: Scales,
    ) -> None:
        self.number, self.unit, self.view, self.scales = number, unit, scene.view, scales
        beads, insets, bars = rects
        self.drawing = LaneDrawing(beads, unit, scene, number, scales)
        self.insets = MagnifiedInsets(insets, unit, self.drawing, scales.deepest[number]) if insets.height else None
        colours, dissipative = self.drawing.colours, self.drawing.chain.dissipative
        self.energy_bars = EnergyBars(bars, unit, colours, dissipative, scales, badges=False) if bars.height else None
        lane = scene.lanes[number]
        self.take_approach(*lane.approach)
        self.locked = lane.locked
        self.edges: Array = np.zeros(lane.live_chain.contacts + 1)
        self.contacts: Array = np.zeros(lane.live_chain.contacts)

    def take_approach(self, overlap: Array, velocity: Array) -> None:
        """Store the overlaps and velocities before the present collision."""
        self.drawing.take_approach(overlap.tolist(), velocity.tolist())

    @property
    def marked(self) -> bool:
        """True if the drawing marks the forces of rigid clusters."""
        return has_marks(self.drawing.ends)

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw the parts that do not change with time."""
        self.drawing.backdrop(surface)
        if self.insets is not None:
            self.insets.backdrop(surface)
        if self.energy_bars is not None:
            self.energy_bars.backdrop(surface)

    def paint(self, surface: pygame.Surface, motion: Motion, centre: float) -> None:
        """Draw the single sample of `motion`, with the camera at `centre` [m]."""
        left = self.drawing.left(centre)
        edges = left_edges(motion.position[0], motion.overlap[0], self.view.length, self.scales.magnify)
        self.edges = left + self.drawing.scale * edges
        self.contacts = self.drawing.paint(surface, motion, 0, left)
        self._padlocks(surface)
        self._outside(surface)
        if self.insets is not None:
            self.insets.paint(surface, motion, 0, self.contacts)
        if self.energy_bars is not None:
            self.energy_bars.paint(surface, motion, 0)

    def _outside(self, surface: pygame.Surface) -> None:
        """Draw an arrow at each end of the lane, with the number of beads outside the view."""
        rect, unit = self.drawing.rect, self.unit
        beyond = int((self.edges + self.drawing.bead < rect.left).sum()), int((self.edges > rect.right).sum())
        y, size = self.drawing.ground - 14 * unit, 7 * unit
        for count, x, side in zip(beyond, (rect.left + 6 * unit, rect.right - 6 * unit), (-1, 1), strict=True):
            if count:
                points = [(x, y), (x - side * size, y - size), (x - side * size, y + size)]
                pygame.draw.polygon(surface, tones.warning, points)
                place = (x - side * (size + 4 * unit), y)
                write(
                    surface, str(count), place, 13 * unit, tones.warning, bold=True, align=(0 if side < 0 else 1, 0.5)
                )

    def _padlocks(self, surface: pygame.Surface) -> None:
        """Draw a padlock on the ground below every locked piston."""
        size = 9.0 * self.unit
        for x in (float(x) for x, locked in zip(self.contacts, self.locked, strict=False) if locked):
            if self.drawing.rect.left < x < self.drawing.rect.right:
                body = pygame.Rect(0, 0, round(size), round(0.8 * size))
                body.midtop = (round(x), round(self.drawing.ground + 6 * self.unit))
                pygame.draw.rect(surface, tones.foreground, body, border_radius=2)
                ring = pygame.Rect(0, 0, round(0.64 * size), round(0.9 * size))
                ring.midbottom = (body.centerx, body.top + round(0.45 * size))
                pygame.draw.arc(surface, tones.foreground, ring, 0.0, math.pi, max(1, round(1.5 * self.unit)))

    def paint_grip(self, surface: pygame.Surface, bead: int, pointer: tuple[int, int], spring: bool) -> None:
        """Draw a line around the bead that the pointer holds. If a `spring` pulls the bead, draw a line from it to the
        pointer.
        """
        centre, thickness = self.centre(bead), max(2, round(2 * self.unit))
        self._outline(surface, bead, tones.warning)
        if spring:
            pygame.draw.aaline(surface, tones.warning, centre, pointer, thickness)
            pygame.draw.aacircle(surface, tones.warning, pointer, 4 * self.unit)

    def _outline(self, surface: pygame.Surface, bead: int, colour: Colour) -> None:
        """Draw a line around a bead, in the shape of the bead."""
        (rect, corner), gap = self.drawing.body_shape(bead, float(self.edges[bead])), round(4 * self.unit)
        thickness = max(2, round(2 * self.unit))
        if 2.0 * corner >= rect.width:
            pygame.draw.aacircle(surface, colour, rect.center, corner + gap, thickness)
        else:
            frame = rect.inflate(2 * gap, 2 * gap)
            pygame.draw.rect(surface, colour, frame, thickness, border_radius=round(corner + gap))

    def paint_pick(self, surface: pygame.Surface, pick: Pick) -> None:
        """Mark the selected bead or contact."""
        drawing = self.drawing
        surface.set_clip(drawing.rect)
        if pick.kind == "bead" and pick.index < len(self.edges):
            self._outline(surface, pick.index, tones.foreground)
        elif pick.kind == "contact" and pick.index < len(self.contacts):
            x, foot = round(float(self.contacts[pick.index])), round(drawing.ground + 3 * self.unit)
            half = round(6 * self.unit)
            pygame.draw.polygon(
                surface, tones.foreground, [(x, foot), (x - half, foot + half), (x + half, foot + half)]
            )
            top = drawing.bar_base + 3 * self.unit
            pygame.draw.line(surface, tones.foreground, (x, round(top)), (x, foot), 1)
        surface.set_clip(None)

    def centre(self, bead: int) -> tuple[float, float]:
        """Return the centre of a bead [pixels]."""
        return float(self.edges[bead]) + 0.5 * self.drawing.bead, self.drawing.ground - 0.5 * self.drawing.bead

    def pick(self, point: tuple[int, int]) -> Pick | None:
        """Return the bead or contact at `point`, or None. A contact can also be selected at its inset and at its force
        bar.
        """
        contact = self._inset(point)
        if contact is not None:
            return Pick(self.number, "contact", contact)
        if not self.drawing.rect.collidepoint(point):
            return None
        contact = self._handle(point)
        if contact is not None:
            return Pick(self.number, "contact", contact)
        bead = self._bead(point)
        if bead is not None:
            return Pick(self.number, "bead", bead)
        contact = self._contact(point[0])
        return None if contact is None else Pick(self.number, "contact", contact)

    def _inset(self, point: tuple[int, int]) -> int | None:
        """Return the contact whose magnified inset is at `point`, or None."""
        insets = self.insets
        if insets is None or not insets.rect.collidepoint(point):
            return None
        for slot, contact in enumerate(insets.shown):
            if math.dist(point, insets.centre(slot)) <= insets.radius + 4 * self.unit:
                return contact
        return None

    def handles(self) -> list[tuple[float, float]]:
        """Return the positions of the contact handles, which are drawn where two beads touch.

        The list is empty if the beads are too small for handles.
        """
        y = self.drawing.ground - 0.5 * self.drawing.bead
        roomy = self.drawing.bead >= LEAST_HANDLED * self.unit
        return [(x, y) for x in self.contacts.tolist()] if roomy else []

    def _handle(self, point: tuple[int, int]) -> int | None:
        """Return the contact whose handle is at `point`, or None."""
        reach = 1.3 * HANDLE * self.unit
        return next((k for k, place in enumerate(self.handles()) if math.dist(place, point) <= reach), None)

    def paint_handles(self, surface: pygame.Surface, point: tuple[int, int]) -> None:
        """Draw the contact handles while the pointer is over the lane. The handle under the pointer is filled."""
        if not self.drawing.rect.collidepoint(point):
            return
        surface.set_clip(self.drawing.rect)
        half, held = HANDLE * self.unit, self._handle(point)
        for k, (x, y) in enumerate(self.handles()):
            points = [(x - half, y), (x, y - half), (x + half, y), (x, y + half)]
            pygame.draw.polygon(surface, tones.foreground if k == held else tones.background, points)
            pygame.draw.aalines(surface, tones.foreground, True, points)
        surface.set_clip(None)

    def _bead(self, point: tuple[int, int]) -> int | None:
        """Return the bead at `point`, or None. If beads are small, return the nearest bead within LEAST_REACH."""
        drawing = self.drawing
        if not drawing.ground - drawing.bead - 3 * self.unit <= point[1] <= drawing.rect.bottom:
            return None
        distance = abs(self.edges + 0.5 * drawing.bead - point[0])
        nearest = int(distance.argmin())
        return nearest if distance[nearest] <= max(0.5 * drawing.bead, LEAST_REACH * self.unit) else None

    def _contact(self, x: int) -> int | None:
        """Return the contact at the horizontal pixel `x`, or None."""
        if not len(self.contacts):
            return None
        distance = abs(self.contacts - x)
        nearest = int(distance.argmin())
        return nearest if distance[nearest] <= max(REACH * self.unit, REACH_OF_BEAD * self.drawing.bead) else None

    def metres(self, pixels: float) -> float:
        """Convert a length on screen from pixels to metres."""
        return pixels / self.drawing.scale
