"""The beads of one lane on the page: drawn by softcradle.sandbox.draw, found under the pointer, marked when selected."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pygame
from softcradle.physics import Chain
from softcradle.sandbox.draw.energy_bars import EnergyBars
from softcradle.sandbox.draw.lane_drawing import LaneDrawing
from softcradle.sandbox.draw.magnified_insets import MagnifiedInsets
from softcradle.sandbox.draw.palette import FOREGROUND, WARNING
from softcradle.sandbox.draw.shared_scales import Scales, left_edges
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.window.scene.pick import Pick
from softcradle.scenes import View

REACH = 9.0  # design pixels: half the width in which a click means a contact
REACH_OF_BEAD = 0.2  # of a bead's length: the same, where it is more
LEAST_REACH = 5.0  # design pixels: half the width in which a click means a bead, however small


@dataclass(frozen=True)
class SessionLane:
    """A live lane as a LaneDrawing takes it, and which pistons are locked."""

    label: str
    velocity: tuple[float, ...]
    live_chain: Chain
    locked: tuple[bool, ...]

    def chain(self) -> Chain:
        """The chain, which a Lane of a scene makes."""
        return self.live_chain


@dataclass(frozen=True)
class SessionLanes:
    """The lanes of a session as they are now, as a LaneDrawing takes them."""

    lanes: tuple[SessionLane, ...]
    view: View

    @classmethod
    def of(cls, lanes: Sequence[LiveLane], view: View) -> SessionLanes:
        """The present `lanes`."""
        return cls(tuple(map(_session_lane, lanes)), view)


def _session_lane(lane: LiveLane) -> SessionLane:
    locked = tuple(law is not None for law in lane.setup.locked)
    return SessionLane(lane.label, tuple(lane.velocity.tolist()), lane.chain, locked)


class LaneView:
    """The beads of lane `number`. Made anew after every edit or change of scale.

    Attributes:
        edges: (n+1,) left edges of the beads when they were last drawn [pixels].
        contacts: (n,) places of the contacts when they were last drawn [pixels].
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
        self.energy_bars = EnergyBars(bars, unit, self.drawing.colours, scales, badges=False) if bars.height else None
        lane = scene.lanes[number]
        self.locked = lane.locked
        self.edges: Array = np.zeros(lane.live_chain.contacts + 1)
        self.contacts: Array = np.zeros(lane.live_chain.contacts)

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw what does not change."""
        self.drawing.backdrop(surface)
        if self.insets is not None:
            self.insets.backdrop(surface)
        if self.energy_bars is not None:
            self.energy_bars.backdrop(surface)

    def paint(self, surface: pygame.Surface, motion: Motion, centre: float) -> None:
        """Draw the one row of `motion`, the camera at `centre` [m]."""
        left = self.drawing.left(centre)
        edges = left_edges(motion.position[0], motion.overlap[0], self.view.length, self.scales.magnify)
        self.edges = left + self.drawing.scale * edges
        self.contacts = self.drawing.paint(surface, motion, 0, left)
        self._padlocks(surface)
        if self.insets is not None:
            self.insets.paint(surface, motion, 0, self.contacts)
        if self.energy_bars is not None:
            self.energy_bars.paint(surface, motion, 0)

    def _padlocks(self, surface: pygame.Surface) -> None:
        """A padlock on the ground below every locked piston."""
        size = 9.0 * self.unit
        for x in (float(x) for x, locked in zip(self.contacts, self.locked, strict=False) if locked):
            if self.drawing.rect.left < x < self.drawing.rect.right:
                body = pygame.Rect(0, 0, round(size), round(0.8 * size))
                body.midtop = (round(x), round(self.drawing.ground + 6 * self.unit))
                pygame.draw.rect(surface, FOREGROUND, body, border_radius=2)
                ring = pygame.Rect(0, 0, round(0.64 * size), round(0.9 * size))
                ring.midbottom = (body.centerx, body.top + round(0.45 * size))
                pygame.draw.arc(surface, FOREGROUND, ring, 0.0, math.pi, max(1, round(1.5 * self.unit)))

    def paint_grip(self, surface: pygame.Surface, bead: int, pointer: tuple[int, int], spring: bool) -> None:
        """Draw a ring about the bead that the pointer holds, and a line to the pointer where a `spring` pulls."""
        centre, thickness = self.centre(bead), max(2, round(2 * self.unit))
        pygame.draw.aacircle(surface, WARNING, centre, 0.5 * self.drawing.bead + 3 * self.unit, thickness)
        if spring:
            pygame.draw.aaline(surface, WARNING, centre, pointer, thickness)
            pygame.draw.aacircle(surface, WARNING, pointer, 4 * self.unit)

    def paint_pick(self, surface: pygame.Surface, pick: Pick) -> None:
        """Mark the selected bead or contact."""
        thickness, drawing = max(2, round(2 * self.unit)), self.drawing
        surface.set_clip(drawing.rect)
        if pick.kind == "bead" and pick.index < len(self.edges):
            radius = 0.5 * drawing.bead + 4 * self.unit
            pygame.draw.aacircle(surface, FOREGROUND, self.centre(pick.index), radius, thickness)
        elif pick.kind == "contact" and pick.index < len(self.contacts):
            x, foot = round(float(self.contacts[pick.index])), round(drawing.ground + 3 * self.unit)
            half = round(6 * self.unit)
            pygame.draw.polygon(surface, FOREGROUND, [(x, foot), (x - half, foot + half), (x + half, foot + half)])
            top = drawing.bar_base + 3 * self.unit
            pygame.draw.line(surface, FOREGROUND, (x, round(top)), (x, foot), 1)
        surface.set_clip(None)

    def centre(self, bead: int) -> tuple[float, float]:
        """Middle of a bead [pixels]."""
        return float(self.edges[bead]) + 0.5 * self.drawing.bead, self.drawing.ground - 0.5 * self.drawing.bead

    def pick(self, point: tuple[int, int]) -> Pick | None:
        """The bead or contact at `point`; a contact also at its inset and its force bar."""
        contact = self._inset(point)
        if contact is not None:
            return Pick(self.number, "contact", contact)
        if not self.drawing.rect.collidepoint(point):
            return None
        bead = self._bead(point)
        if bead is not None:
            return Pick(self.number, "bead", bead)
        contact = self._contact(point[0])
        return None if contact is None else Pick(self.number, "contact", contact)

    def _inset(self, point: tuple[int, int]) -> int | None:
        """The contact whose magnified inset is at `point`."""
        insets = self.insets
        if insets is None or not insets.rect.collidepoint(point):
            return None
        for slot, contact in enumerate(insets.shown):
            if math.dist(point, insets.centre(slot)) <= insets.radius + 4 * self.unit:
                return contact
        return None

    def _bead(self, point: tuple[int, int]) -> int | None:
        """The bead at `point`; of small beads the nearest within LEAST_REACH."""
        drawing = self.drawing
        if not drawing.ground - drawing.bead - 3 * self.unit <= point[1] <= drawing.rect.bottom:
            return None
        distance = abs(self.edges + 0.5 * drawing.bead - point[0])
        nearest = int(distance.argmin())
        return nearest if distance[nearest] <= max(0.5 * drawing.bead, LEAST_REACH * self.unit) else None

    def _contact(self, x: int) -> int | None:
        """The contact at pixel `x`."""
        if not len(self.contacts):
            return None
        distance = abs(self.contacts - x)
        nearest = int(distance.argmin())
        return nearest if distance[nearest] <= max(REACH * self.unit, REACH_OF_BEAD * self.drawing.bead) else None

    def metres(self, pixels: float) -> float:
        """A length on screen as one of the model."""
        return pixels / self.drawing.scale
