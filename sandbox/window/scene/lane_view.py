"""The beads of one lane on the page: drawn by softcradle.sandbox.draw, found under the pointer, held by the hand."""

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
from softcradle.scenes import View

REACH = 9.0  # design pixels around a contact's bar that still mean it


@dataclass(frozen=True)
class Pick:
    """What is under the pointer or selected: a bead or a contact of a lane."""

    lane: int
    kind: str  # "bead" or "contact"
    index: int


@dataclass(frozen=True)
class ShownLane:
    """A live lane as the stage wants it."""

    label: str
    velocity: tuple[float, ...]
    row: Chain
    locked: tuple[bool, ...]

    def chain(self) -> Chain:
        """The chain."""
        return self.row


@dataclass(frozen=True)
class ShownScene:
    """The lanes of a session as they are now, as the stage wants them."""

    lanes: tuple[ShownLane, ...]
    view: View

    @classmethod
    def of(cls, lanes: Sequence[LiveLane], view: View) -> ShownScene:
        """A picture of `lanes`."""
        return cls(tuple(map(_shown, lanes)), view)


def _shown(lane: LiveLane) -> ShownLane:
    locked = tuple(law is not None for law in lane.setup.locked)
    return ShownLane(lane.label, tuple(lane.velocity.tolist()), lane.chain, locked)


class StageView:
    """One lane's beads. Made anew after every edit or change of scale; drawing changes nothing in it."""

    def __init__(
        self,
        number: int,
        rects: tuple[pygame.Rect, pygame.Rect, pygame.Rect],
        unit: float,
        scene: ShownScene,
        scales: Scales,
    ) -> None:
        self.number, self.unit, self.view, self.scales = number, unit, scene.view, scales
        self.stage = LaneDrawing(rects[0], unit, scene, number, scales)
        self.loupes = MagnifiedInsets(rects[1], unit, self.stage, scales.deepest[number]) if rects[1].height else None
        self.shares = EnergyBars(rects[2], unit, self.stage.colours, scales, badges=False) if rects[2].height else None
        lane = scene.lanes[number]
        self.locked = lane.locked
        self.edges: Array = np.zeros(lane.row.contacts + 1)  # pixels, of the last picture
        self.contacts: Array = np.zeros(lane.row.contacts)

    def backdrop(self, surface: pygame.Surface) -> None:
        """What stands still."""
        self.stage.backdrop(surface)
        if self.loupes is not None:
            self.loupes.backdrop(surface)
        if self.shares is not None:
            self.shares.backdrop(surface)

    def paint(self, surface: pygame.Surface, track: Motion, centre: float) -> None:
        """Draw the one row of `track`, the camera at `centre` [m]."""
        left = self.stage.left(centre)
        edges = left_edges(track.position[0], track.overlap[0], self.view.length, self.scales.magnify)
        self.edges = left + self.stage.scale * edges
        self.contacts = self.stage.paint(surface, track, 0, left)
        self._locks(surface)
        if self.loupes is not None:
            self.loupes.paint(surface, track, 0, self.contacts)
        if self.shares is not None:
            self.shares.paint(surface, track, 0)

    def _locks(self, surface: pygame.Surface) -> None:
        """A padlock on the ground under every locked piston."""
        size = 9.0 * self.unit
        for x in (float(x) for x, locked in zip(self.contacts, self.locked, strict=False) if locked):
            if self.stage.rect.left < x < self.stage.rect.right:
                body = pygame.Rect(0, 0, round(size), round(0.8 * size))
                body.midtop = (round(x), round(self.stage.ground + 6 * self.unit))
                pygame.draw.rect(surface, FOREGROUND, body, border_radius=2)
                ring = pygame.Rect(0, 0, round(0.64 * size), round(0.9 * size))
                ring.midbottom = (body.centerx, body.top + round(0.45 * size))
                pygame.draw.arc(surface, FOREGROUND, ring, 0.0, math.pi, max(1, round(1.5 * self.unit)))

    def paint_hold(self, surface: pygame.Surface, bead: int, pointer: tuple[int, int], spring: bool) -> None:
        """The hand: a ring about the bead, and a line to the pointer where a spring pulls."""
        centre = self.centre(bead)
        pygame.draw.aacircle(
            surface, WARNING, centre, 0.5 * self.stage.bead + 3 * self.unit, max(2, round(2 * self.unit))
        )
        if spring:
            pygame.draw.aaline(surface, WARNING, centre, pointer, max(2, round(2 * self.unit)))
            pygame.draw.aacircle(surface, WARNING, pointer, 4 * self.unit)

    def paint_pick(self, surface: pygame.Surface, pick: Pick) -> None:
        """Mark the selected bead or contact."""
        thick = max(2, round(2 * self.unit))
        surface.set_clip(self.stage.rect)
        if pick.kind == "bead" and pick.index < len(self.edges):
            pygame.draw.aacircle(
                surface, FOREGROUND, self.centre(pick.index), 0.5 * self.stage.bead + 4 * self.unit, thick
            )
        elif pick.kind == "contact" and pick.index < len(self.contacts):
            x, foot = round(float(self.contacts[pick.index])), round(self.stage.ground + 3 * self.unit)
            half = round(6 * self.unit)
            pygame.draw.polygon(surface, FOREGROUND, [(x, foot), (x - half, foot + half), (x + half, foot + half)])
            top = self.stage.bar_base + 3 * self.unit
            pygame.draw.line(surface, FOREGROUND, (x, round(top)), (x, foot), 1)
        surface.set_clip(None)

    def centre(self, bead: int) -> tuple[float, float]:
        """Middle of a bead [pixels]."""
        return float(self.edges[bead]) + 0.5 * self.stage.bead, self.stage.ground - 0.5 * self.stage.bead

    def pick(self, point: tuple[int, int]) -> Pick | None:
        """What is at `point`: a loupe or a force bar means its contact."""
        if self.loupes is not None and self.loupes.rect.collidepoint(point):
            for slot, contact in enumerate(self.loupes.shown):
                if math.dist(point, self.loupes.centre(slot)) <= self.loupes.radius + 4 * self.unit:
                    return Pick(self.number, "contact", contact)
        if not self.stage.rect.collidepoint(point):
            return None
        bead = self._bead(point)
        if bead is not None:
            return Pick(self.number, "bead", bead)
        return self._contact(point[0])

    def _bead(self, point: tuple[int, int]) -> int | None:
        """The bead at `point`; over its own part of a gap between small ones, the nearest."""
        if not self.stage.ground - self.stage.bead - 3 * self.unit <= point[1] <= self.stage.rect.bottom:
            return None
        distance = abs(self.edges + 0.5 * self.stage.bead - point[0])
        nearest = int(distance.argmin())
        return nearest if distance[nearest] <= max(0.5 * self.stage.bead, 5 * self.unit) else None

    def _contact(self, x: int) -> Pick | None:
        if not len(self.contacts):
            return None
        distance = abs(self.contacts - x)
        nearest = int(distance.argmin())
        near = distance[nearest] <= max(REACH * self.unit, 0.2 * self.stage.bead)
        return Pick(self.number, "contact", nearest) if near else None

    def metres(self, pixels: float) -> float:
        """A length on screen as one of the model."""
        return pixels / self.stage.scale
