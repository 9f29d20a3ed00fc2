"""The stage: the beads of one lane on the ground, a force bar over every contact, a velocity arrow under every bead."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
import pygame
from softcradle.physics import Chain, Contact
from softcradle.sandbox.draw import bead_sprites as shapes
from softcradle.sandbox.draw.number_format import factor, fixed, round_down, scientific, ticks
from softcradle.sandbox.draw.palette import FAINT, FOREGROUND, GRID, LANE_BACKGROUND, MUTED, bead_colours
from softcradle.sandbox.draw.shared_scales import Scales, left_edges
from softcradle.sandbox.draw.supersampling import blit_sprite, draw_arrow, fill_rectangle
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.motion import Array, Motion
from softcradle.scenes import View

TALLEST_BEAD = 0.40  # of the stage
GROUND = 30.0  # design pixels from the ground line to the foot of the stage
LEAST_NUMBER = 8.0  # pixels high
LEAST_LABELLED = 26.0  # design pixels of a bead that still carries texts beside it


class Row(Protocol):
    """What the stage asks of a lane: a name, the velocities (n+1,) by which clusters are told apart, and the chain."""

    @property
    def label(self) -> str:
        """Written above it."""

    @property
    def velocity(self) -> Sequence[float]:
        """[m/s]."""

    def chain(self) -> Chain:
        """The chain."""


class Shown(Protocol):
    """What the stage asks of a scene: lanes, and a view. A Scene is one, and so are lanes that are being edited."""

    @property
    def lanes(self) -> Sequence[Row]:
        """One a chain."""

    @property
    def view(self) -> View:
        """Length of the beads, and whether they are numbered."""


class LaneDrawing:
    """What is the same in every frame of one lane: scale, sprites, colours. Drawing changes nothing in it."""

    def __init__(self, rect: pygame.Rect, unit: float, scene: Shown, number: int, scales: Scales) -> None:
        self.rect, self.unit, self.scales = rect, unit, scales
        lane = scene.lanes[number]
        self.label, self.length, self.numbered = lane.label, scene.view.length, scene.view.labels
        self.chain: Chain = lane.chain()
        palette = bead_colours(self.chain.contacts + 1)
        self.contact_colours = palette[1:]  # of the bead on the right, which the contact pushes on
        self.colours = tuple(MUTED if math.isinf(m) else c for m, c in zip(self.chain.mass, palette, strict=True))
        low, high = scales.window
        slim = _slimness(scene)
        self.scale = min(rect.width / (high - low), TALLEST_BEAD * rect.height / (slim * self.length))  # pixels a metre
        self.bead = self.length * self.scale  # pixels
        self.number_size = (0.31 if slim < 1.0 else 0.36) * slim * self.bead
        self.ground = rect.bottom - GROUND * unit
        self.foot_of_bars = self.ground - max(slim * self.bead, 12 * unit) - 8 * unit
        self.bar_room = self.foot_of_bars - rect.top - 24 * unit
        self.interface, self.rigid = rigid_shares(self.chain.mass, lane.velocity)
        self.masses = _mass_texts(self.chain) if self.bead >= LEAST_LABELLED * unit else ()

    def left(self, centre: float | None = None) -> float:
        """Pixel of position 0 when the view is centred on `centre` [m]; None is the middle of the scene's window."""
        middle = sum(self.scales.window) / 2 if centre is None else centre
        return self.rect.centerx - middle * self.scale

    def backdrop(self, surface: pygame.Surface) -> None:
        """Ground, force scale, ruler, and what the magnification is."""
        unit, rect = self.unit, self.rect
        surface.fill(LANE_BACKGROUND, rect)
        for value, text in ticks(0.0, self.scales.force / 1.12, max(1, min(4, int(self.bar_room / (24 * unit))))):
            y = self._bar_top(value)
            surface.fill(GRID, (rect.left, round(y), rect.width, 1))
            if y > rect.top + 58 * unit:  # the lane's name and the key stand above
                write(surface, text, (rect.left + 8 * unit, y - 2 * unit), 12 * unit, MUTED, align=(0, 1))
        x, y = rect.left + 8 * unit, rect.top + 8 * unit
        if self.label:
            x = write(surface, self.label, (x, y - 3 * unit), 15 * unit, bold=True).right + 14 * unit
        write(surface, "contact force (N)", (x, y), 12.5 * unit, MUTED)
        if any(share != 0.0 for share in self.rigid):
            x, y = rect.left + 8 * unit, rect.top + 26 * unit
            fill_rectangle(surface, FOREGROUND, (x, y + 7 * unit, 14 * unit, 1.5 * unit))
            write(surface, "if clusters were rigid", (x + 20 * unit, y), 12.5 * unit, MUTED)
        surface.fill(FAINT, (rect.left, round(self.ground), rect.width, max(1, round(1.5 * unit))))
        self._ruler(surface)

    def paint(self, surface: pygame.Surface, track: Motion, row: int, left: float) -> Array:
        """Draw row `row` of `track` with position 0 at pixel `left`; returns (n,) where the contacts are [pixels]."""
        overlap = track.overlap[row]
        edges = left + self.scale * left_edges(track.position[row], overlap, self.length, self.scales.magnify)
        faces = edges[:-1] + self.bead, edges[1:]
        contacts = (faces[0] + faces[1]) / 2
        surface.set_clip(self.rect)
        self._bodies(surface, edges.tolist(), (faces[0] - np.maximum(faces[0] - faces[1], 0.0)).tolist())
        self._bars(surface, contacts.tolist(), track.force[row].tolist())
        self._arrows(surface, edges.tolist(), track.velocity[row].tolist())
        surface.set_clip(None)
        return np.asarray(contacts)

    def _bar_top(self, force: float) -> float:
        return self.foot_of_bars - self.bar_room * force / (self.scales.force / 1.12)

    def _bodies(self, surface: pygame.Surface, edges: list[float], faces: list[float]) -> None:
        on_screen = [i for i, x in enumerate(edges) if self.rect.left - self.bead < x < self.rect.right]
        for i in on_screen:
            if self._is_gear(i):
                end = faces[i] if i < len(faces) else edges[i] + self.bead
                image = shapes.piston(self.bead, self.bead)
                blit_sprite(
                    surface, image, end - 0.5 * self.bead, self.ground - self.bead * (0.5 * shapes.BODY_HEIGHT + 0.22)
                )
        for i in on_screen:
            if math.isinf(self.chain.mass[i]):
                blit_sprite(surface, shapes.wall(self.bead, 1.2 * self.bead), edges[i], self.ground - 1.2 * self.bead)
            elif self._is_gear(i):
                image = shapes.cylinder(self.bead, self.bead, self.colours[i])
                blit_sprite(surface, image, edges[i], self.ground - shapes.BODY_HEIGHT * self.bead)
            else:
                image = shapes.bead(self.bead, self.colours[i], self._core(i))
                blit_sprite(surface, image, edges[i], self.ground - math.ceil(self.bead))

        size = self.number_size
        for i in on_screen if self.numbered and size >= LEAST_NUMBER else ():
            if math.isinf(self.chain.mass[i]):
                continue
            middle = edges[i] + self.bead * (0.5 * shapes.BODY if self._is_gear(i) else 0.5)
            y = self.ground - self.bead * (0.5 * shapes.BODY_HEIGHT if self._is_gear(i) else 0.5)
            half = math.ceil(3 * size) / 2
            blit_sprite(surface, shapes.number(str(i), size), middle - half, y - half)

    def _is_gear(self, bead: int) -> bool:
        """Whether the bead pushes to its right with a piston; the last one looks like its neighbour."""
        return is_gear(self.chain.contact[min(bead, self.chain.contacts - 1)])

    def _core(self, bead: int) -> float:
        finite = [mass for mass in self.chain.mass if math.isfinite(mass)]
        return math.sqrt(self.chain.mass[bead] / max(finite)) * 0.92 if max(finite) > 1.02 * min(finite) else 0.0

    def _bars(self, surface: pygame.Surface, contacts: list[float], forces: list[float]) -> None:
        """A bar a contact; across it a line where it would end if each cluster were rigid, Eq. (4)."""
        unit, seen = self.unit, 0.01 * self.scales.force
        wide = min(max(0.26 * self.bead, 3 * unit), 30 * unit)
        decimals = max(0, 2 - math.floor(math.log10(self.scales.force)))
        for i, (x, force) in enumerate(zip(contacts, forces, strict=True)):
            top = self._bar_top(force)
            fill_rectangle(surface, self.contact_colours[i], (x - wide / 2, top, wide, self.foot_of_bars - top))
            expected = forces[self.interface] * self.rigid[i]
            if i != self.interface and expected > seen:
                reach = wide / 2 + 5 * unit
                fill_rectangle(
                    surface, FOREGROUND, (x - reach, self._bar_top(expected) - 0.75 * unit, 2 * reach, 1.5 * unit)
                )
            if force > seen and self.bead >= 1.5 * LEAST_LABELLED * unit:
                write(surface, fixed(force, decimals), (x, top - 3 * unit), 13 * unit, bold=True, align=(0.5, 1))

    def _arrows(self, surface: pygame.Surface, edges: list[float], speeds: list[float]) -> None:
        fastest = max(abs(speed) for speed in self.scales.velocity)
        y, size = self.ground + 11 * self.unit, 12 * self.unit
        for i, (x, speed) in enumerate(zip(edges, speeds, strict=True)):
            middle = x + self.bead / 2
            colour = shapes.dark(self.colours[i])
            draw_arrow(surface, colour, (middle, y), 0.85 * self.bead * speed / fastest, self.unit)
            if self.masses:
                write(surface, self.masses[i], (middle, y + 5 * self.unit), size, MUTED, align=(0.5, 0))

    def _ruler(self, surface: pygame.Surface) -> None:
        unit, rect = self.unit, self.rect
        drawn = "drawn to scale" if self.scales.magnify == 1.0 else f"overlaps drawn {factor(self.scales.magnify)}"
        length = round_down(min(1.6 * self.length, 0.3 * rect.width / self.scale))
        right, y = rect.right - 12 * unit, rect.top + 20 * unit
        left = right - length * self.scale
        wide = width(drawn, 12.5 * unit)
        surface.fill(LANE_BACKGROUND, (right - wide - 4 * unit, y + 8 * unit, wide + 8 * unit, 18 * unit))
        fill_rectangle(surface, MUTED, (left, y, right - left, max(1.0, 1.5 * unit)))
        for x in (left, right):
            fill_rectangle(surface, MUTED, (x - 0.75 * unit, y - 4 * unit, max(1.0, 1.5 * unit), 9 * unit))
        name, middle = f"{scientific(length, 0)} m", (left + right) / 2
        write(surface, name, (middle, y - 3 * unit), 12.5 * unit, MUTED, align=(0.5, 1))
        write(surface, drawn, (right, y + 8 * unit), 12.5 * unit, MUTED, align=(1, 0))


def is_gear(contact: Contact) -> bool:
    """Whether the contact is drawn as a piston: a preloaded spring."""
    return contact.preload > 0.0 and contact.stiffness > 0.0


def _slimness(scene: Shown) -> float:
    """Height of the tallest body in lengths of a bead; one for all lanes, so that they have one scale."""
    all_gears = all(is_gear(contact) for lane in scene.lanes for contact in lane.chain().contact)
    return shapes.BODY_HEIGHT if all_gears else 1.0


def rigid_shares(mass: Sequence[float], velocity: Sequence[float]) -> tuple[int, tuple[float, ...]]:
    """The contact where two clusters meet, and what share of its force each contact would pass on if both were rigid.

    The share is that of the cluster's mass beyond the contact, Eq. (4). Zeros where no cluster has two beads, where
    nothing meets, or where a wall stands.
    """
    closing = [left - right for left, right in itertools.pairwise(velocity)]
    meeting = closing.index(max(closing))
    clusters = mass[: meeting + 1], mass[meeting + 1 :]
    if max(closing) <= 0.0 or math.inf in mass or len(mass) == 2:
        return meeting, (0.0,) * len(closing)
    behind = [sum(mass[: i + 1]) / sum(clusters[0]) for i in range(meeting + 1)]
    return meeting, (*behind, *(sum(mass[i + 1 :]) / sum(clusters[1]) for i in range(meeting + 1, len(closing))))


def _mass_texts(chain: Chain) -> tuple[str, ...]:
    """A text under every bead where masses differ by more than the eye would forgive."""
    finite = [mass for mass in chain.mass if math.isfinite(mass)]
    if max(finite) <= 1.02 * min(finite):
        return ()
    return tuple(f"{mass:.3g} kg" if math.isfinite(mass) else "wall" for mass in chain.mass)
