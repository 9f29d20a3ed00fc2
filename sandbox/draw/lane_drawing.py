"""Drawing of one lane. The drawing shows beads on the ground, a force bar above each contact and an arrow below each
bead.
"""

import math
from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
import pygame
from softcradle.physics import Chain
from softcradle.sandbox.draw.bead_sprites import (
    bead_sprite,
    cylinder_sprite,
    number_sprite,
    outline_colour,
    piston_sprite,
    wagon_sprite,
    wall_sprite,
)
from softcradle.sandbox.draw.bodies import (
    CYLINDER_HEIGHT,
    CYLINDER_LENGTH,
    EQUAL_MASSES,
    WALL_HEIGHT,
    body_height,
    cluster_ends,
    has_marks,
    locomotives,
    mass_labels,
    solid_force,
    visible_marks,
)
from softcradle.sandbox.draw.palette import bead_colours, mix, text_on, tones
from softcradle.sandbox.draw.shared_scales import FORCE_MARGIN, Scales, left_edges
from softcradle.sandbox.draw.supersampling import blit_sprite, draw_arrow, fill_rectangle
from softcradle.sandbox.draw.text import shortened, width, write
from softcradle.sandbox.languages import N_, _, scene_words
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.quantities import FORCE
from softcradle.sandbox.story.bodies import body_word, is_gear
from softcradle.sandbox.story.numbers import (
    axis_prefix,
    beside,
    factor,
    round_down,
    scientific,
    ticks,
    with_prefix,
)
from softcradle.scenes import View

Shares = Callable[[Motion, int, Scales], Array]


def _velocity(motion: Motion, row: int, scales: Scales) -> Array:
    return motion.velocity[row] / max(map(abs, scales.velocity))


def _momentum(motion: Motion, row: int, scales: Scales) -> Array:
    mass = motion.chain.finite_mass
    shares: Array = mass * motion.velocity[row] / (mass.max() * max(map(abs, scales.velocity)) or 1.0)
    return shares


def _force(motion: Motion, row: int, scales: Scales) -> Array:
    """Return the net force of the two contacts of each bead. The force is relative to the end of the force axis (-1 to
    1).
    """
    force = np.concatenate(([0.0], motion.force[row], [0.0]))
    shares: Array = np.clip(-np.diff(force) / scales.force, -1.0, 1.0)
    return shares


def _none(motion: Motion, row: int, scales: Scales) -> Array:
    return np.zeros(len(motion.chain.mass))


ARROWS: dict[str, Shares] = {
    N_("velocity"): _velocity,
    N_("momentum"): _momentum,
    N_("net force"): _force,
    N_("none"): _none,
}


KEY = 26.0  # Height of the line above the force bars that contains the name of the lane and the key [design pixels].
FORCE_LABEL = 17.0  # Height of the space for a force label above its bar [design pixels].
# Height of a bead as a fraction of the height of the drawing. The first number is the usual height. The second number
# is the smallest height, which is used in low drawings.
TALLEST_BEAD, LEAST_BEAD = 0.40, 0.22
# Height of a bead on a string as a fraction of the height of the drawing. This height leaves space for the strings.
HANGING_BEAD = 0.25
BAR_LIFT = 8.0  # Distance between the tops of the beads and the zero line of the bars [design pixels].
# Smallest height of the force bar of the largest force [design pixels]. Beads shrink to make space for it.
LEAST_BAR = 18.0
GROUND = 30.0  # Distance between the ground line and the lower edge of the drawing [design pixels].
SMALLEST_NUMBER = 8.0  # Smallest legible height of the numbers on beads [pixels]. Smaller numbers are omitted.
MASS_LABEL = 12.0  # Size of the masses that are written below beads [design pixels].
# Smallest length of a bead with text below it [design pixels]. Below smaller beads, there is not enough space.
SMALLEST_LABELLED = 26.0
VISIBLE_FORCE = 0.01  # Smallest force with a label or a mark of a rigid cluster, as a fraction of the force axis.
# Share of the foreground colour in the colour of an arrow. With this share, arrows stand out from the ground in both
# themes.
ARROW_TONE = 0.35
MARKED = N_("if the row were one solid block")
# Width of the example of a mark in the legend, including the space before its meaning [design pixels].
LEGEND_MARK = 20.0
PULL_RIM = 2.5  # Thickness of the outline of a hollow bar [design pixels]. A hollow bar shows a pulling force.


class DrawnLane(Protocol):
    """Lane that can be drawn. A drawn lane is either a Lane of a scene or a live lane of the window."""

    @property
    def label(self) -> str:
        """The name above the lane."""

    @property
    def velocity(self) -> Sequence[float]:
        """The (n+1,) velocities [m/s] at the start. These velocities distinguish the beads that strike from the beads
        that are struck.
        """

    def chain(self) -> Chain:
        """Return the chain of the lane."""


class DrawnScene(Protocol):
    """Scene that can be drawn. A drawn scene is either a Scene or the live lanes of the window."""

    @property
    def lanes(self) -> Sequence[DrawnLane]:
        """The lanes, each with one chain."""

    @property
    def view(self) -> View:
        """The length of the beads, and the flag that shows numbers on beads."""


class LaneDrawing:
    """Parts of the drawing of a lane that are the same in every frame, such as the scale, the sprites and the colours.

    Arguments:
        rect: rectangle of the drawing [pixels].
        unit: pixels per design pixel.
        scene: the scene.
        number: index of the lane in the scene.
        scales: common scales of all lanes.
    """

    def __init__(self, rect: pygame.Rect, unit: float, scene: DrawnScene, number: int, scales: Scales) -> None:
        self.rect, self.unit, self.scales = rect, unit, scales
        lane = scene.lanes[number]
        self.label, self.length, self.numbered = scene_words(lane.label), scene.view.length, scene.view.labels
        self.chain: Chain = lane.chain()
        self.train, self.locomotives = body_word(self.chain) == "wagon", locomotives(self.chain)
        beads = range(self.chain.contacts + 1)
        self.balls = tuple(math.isfinite(self.chain.mass[i]) and not self._is_gear(i) for i in beads)
        palette = bead_colours(self.chain.contacts + 1)
        # A contact has the colour of the bead on its right, because it pushes this bead.
        self.contact_colours = palette[1:]
        self.colours = tuple(tones.muted if math.isinf(m) else c for m, c in zip(self.chain.mass, palette, strict=True))
        low, high = scales.window
        height = body_height([lane.chain() for lane in scene.lanes])
        hangs = any(lane.chain().swing for lane in scene.lanes)
        tallest = min(_tallest(rect, unit), HANGING_BEAD * rect.height) if hangs else _tallest(rect, unit)
        self.scale = min(rect.width / (high - low), tallest / (height * self.length))  # pixels per metre
        self.bead = self.length * self.scale  # length of a bead [pixels]
        self.number_size = (0.31 * CYLINDER_HEIGHT if height < 1.0 else 0.36) * self.bead
        self.ground = rect.bottom - GROUND * unit
        self.bar_base = self.ground - max(height * self.bead, 12 * unit) - BAR_LIFT * unit
        # height of the force bar of the largest force [pixels]
        self.bar_room = max(self.bar_base - rect.top - (KEY + FORCE_LABEL) * unit, 0.0)
        self.heading: tuple[pygame.Rect, ...] = ()  # rectangles of the key, the ruler and the axis labels after drawing
        self._prefix = ""  # prefix of the unit of forces, such as "k"
        self._legend: tuple[float, float] | None = None  # position of the legend of the marks; None if it is not shown
        # `hangs` contains the upper end of the string and the rise of each bead in the last picture. The other
        # attribute is the drawn length of the strings [pixels].
        self.hangs: list[tuple[float, float]] = []
        self.string = 0.0
        self.arrows = "velocity"  # quantity that the arrows show; a key of ARROWS
        self.take_approach([-gap for gap in self.chain.gap], lane.velocity)
        masses = mass_labels(self.chain) if self.bead >= SMALLEST_LABELLED * unit else ()
        # Beads that touch are one bead length apart.
        fit = all(width(text, MASS_LABEL * unit) <= self.bead for text in masses)
        self.mass_labels = masses if fit else ()

    def take_approach(self, overlap: Sequence[float], velocity: Sequence[float]) -> None:
        """Find the rigid clusters before a collision, because the marks on force bars depend on them.

        `overlap` (n,) [m] and `velocity` (n+1,) [m/s] are the overlaps and velocities before the collision.
        """
        self.ends = cluster_ends(overlap, velocity, self.length)

    def left(self, centre: float | None = None) -> float:
        """Return the pixel of position 0 if the centre of the camera is at `centre` [m]. If `centre` is None, the
        camera is in the middle of the scene.
        """
        middle = sum(self.scales.window) / 2 if centre is None else centre
        return self.rect.centerx - middle * self.scale

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw the parts that are the same in every frame: the ground, the force axis, the name of the lane and the
        ruler.
        """
        unit, rect = self.unit, self.rect
        surface.fill(tones.lane_background, rect)
        labels, most = [], max(1, min(4, int(self.bar_room / (24 * unit))))
        size, self._prefix = axis_prefix(self.scales.force)
        for value, text in ticks(0.0, self.scales.force / FORCE_MARGIN / size, most):
            y = self._bar_top(value * size)
            surface.fill(tones.grid, (rect.left, round(y), rect.width, 1))
            # The name of the lane and the key are above this vertical position.
            if y > rect.top + (KEY + FORCE_LABEL + 2) * unit:
                place = rect.left + 8 * unit, y - 2 * unit
                labels.append(write(surface, text, place, 13 * unit, tones.muted, align=(0, 1)))
        surface.fill(tones.faint, (rect.left, round(self.ground), rect.width, max(1, round(1.5 * unit))))
        ruler, words = self._ruler(surface)
        self.heading = self._key(surface, ruler.left), ruler, words, *labels
        if self.arrows != "velocity":
            place = rect.right - 12 * unit, rect.bottom - 4 * unit
            write(surface, _("arrows: {what}", what=_(self.arrows)), place, 13 * unit, tones.muted, align=(1, 1))

    def _key(self, surface: pygame.Surface, end: int) -> pygame.Rect:
        """Write the name of the lane and the meaning of bars and lines. Omit the parts that do not fit to the left of
        `end`. Return the rectangle of the text.
        """
        unit, rect, small = self.unit, self.rect, 13 * self.unit
        x, y, space = rect.left + 8 * unit, rect.top + 8 * unit, 14 * unit
        if self.label:
            name = shortened(self.label, 16 * unit, end - x, bold=True)
            x = write(surface, name, (x, y - 3 * unit), 16 * unit, bold=True).right + space
        notes = (
            (with_prefix(_(FORCE.title), self._prefix), True),
            (_("hollow: pulls"), self.chain.pulls),
            (_("dark: solid"), any(coupler.stop for i, coupler in self.chain.couplers)),
        )
        for words, true in notes:
            if true and x + width(words, small) < end:
                x = write(surface, words, (x, y), small, tones.muted).right + space
        wide = LEGEND_MARK * unit + width(_(MARKED), small)
        self._legend = (x, y) if has_marks(self.ends) and x + wide < end else None
        x += wide + space if self._legend else 0.0
        return pygame.Rect(rect.left, rect.top, round(x - rect.left), round((KEY - 2) * unit))

    def _paint_legend(self, surface: pygame.Surface) -> None:
        """Draw an example of the mark for rigid clusters, followed by its meaning."""
        if self._legend is None:
            return
        (x, y), unit = self._legend, self.unit
        fill_rectangle(surface, tones.foreground, (x, y + 7 * unit, 0.7 * LEGEND_MARK * unit, 1.5 * unit))
        write(surface, _(MARKED), (x + LEGEND_MARK * unit, y), 13 * unit, tones.muted)

    def _ruler(self, surface: pygame.Surface) -> tuple[pygame.Rect, pygame.Rect]:
        """Draw the length scale. Below it, write the factor by which overlaps are magnified. Return the rectangles of
        both.
        """
        unit, rect = self.unit, self.rect
        magnification = (
            _("drawn to scale")
            if self.scales.magnify == 1.0
            else _("overlaps drawn {times}", times=factor(self.scales.magnify))
        )
        length = round_down(min(1.6 * self.length, 0.3 * rect.width / self.scale))
        right, y = rect.right - 12 * unit, rect.top + 20 * unit
        left = right - length * self.scale
        wide = width(magnification, 13 * unit)
        surface.fill(tones.lane_background, (right - wide - 4 * unit, y + 8 * unit, wide + 8 * unit, 18 * unit))
        fill_rectangle(surface, tones.muted, (left, y, right - left, max(1.0, 1.5 * unit)))
        for x in (left, right):
            fill_rectangle(surface, tones.muted, (x - 0.75 * unit, y - 4 * unit, max(1.0, 1.5 * unit), 9 * unit))
        name, middle = f"{scientific(length, 0)} m", (left + right) / 2
        named = write(surface, name, (middle, y - 3 * unit), 13 * unit, tones.muted, align=(0.5, 1))
        words = write(surface, magnification, (right, y + 8 * unit), 13 * unit, tones.muted, align=(1, 0))
        first, low = round(min(left, named.left) - 4 * unit), round(y + 8 * unit)
        return pygame.Rect(first, rect.top, rect.right - first, low - rect.top), words

    def _hangs(self, edges: Array, motion: Motion, row: int) -> list[tuple[float, float]]:
        """Return two values for each bead on a string: the pixel of the upper end of the string, and the height of the
        bead above the ground [pixels].

        The strings are drawn to scale, but do not reach above the lower edge of the key. The beads move along arcs.
        """
        if not self.chain.swing:
            return []
        highest = self.rect.top + KEY * self.unit
        self.string = min(self.scale * (self.chain.strings or 0.0), self.ground - 0.5 * self.bead - highest)
        aside = self.scale * motion.displacement[row]
        way = np.minimum(np.abs(aside), 0.99 * self.string)
        rises = self.string - np.sqrt(self.string**2 - way**2)
        return list(zip((edges + 0.5 * self.bead - aside).tolist(), rises.tolist(), strict=True))

    def _strings(self, surface: pygame.Surface, edges: list[float]) -> None:
        """Draw the strings of the beads, and the bar to which the strings are attached."""
        if not self.hangs:
            return
        top, thick = self.ground - 0.5 * self.bead - self.string, max(1.0, self.unit)
        first, last = self.hangs[0][0] - self.bead, self.hangs[-1][0] + self.bead
        fill_rectangle(surface, tones.muted, (first, top - 2 * thick, last - first, 2 * thick))
        for x, (end, rise) in zip(edges, self.hangs, strict=True):
            middle = x + 0.5 * self.bead, self.ground - 0.5 * self.bead - rise
            pygame.draw.aaline(surface, tones.muted, (end, top), middle)

    def paint(self, surface: pygame.Surface, motion: Motion, row: int, left: float) -> Array:
        """Draw the sample `row` of `motion`, with position 0 at pixel `left`. Return the (n,) horizontal positions of
        the contacts [pixels].
        """
        overlap = motion.overlap[row]
        edges = left + self.scale * left_edges(motion.position[row], overlap, self.length, self.scales.magnify)
        faces = edges[:-1] + self.bead, edges[1:]
        contacts = (faces[0] + faces[1]) / 2
        self.hangs = self._hangs(edges, motion, row)
        surface.set_clip(self.rect)
        self._strings(surface, edges.tolist())
        self._bodies(surface, edges.tolist(), (faces[0] - np.maximum(faces[0] - faces[1], 0.0)).tolist())
        self._bars(surface, contacts.tolist(), overlap.tolist(), motion.force[row].tolist())
        self._arrows(surface, edges.tolist(), ARROWS[self.arrows](motion, row, self.scales).tolist())
        surface.set_clip(None)
        return np.asarray(contacts)

    def _bodies(self, surface: pygame.Surface, edges: list[float], faces: list[float]) -> None:
        """Draw the bodies. The pistons come first because the bodies partly cover them. The numbers come last."""
        on_screen = [i for i, x in enumerate(edges) if self.rect.left - self.bead < x < self.rect.right]
        for i in on_screen:
            if self._is_gear(i):
                end = faces[i] if i < len(faces) else edges[i] + self.bead
                top = self.ground - self.bead * (0.5 * CYLINDER_HEIGHT + 0.22) - self.rise(i)
                blit_sprite(surface, piston_sprite(self.bead, self.bead), end - 0.5 * self.bead, top)
        pressed = self._pressed(edges)
        for i in on_screen:
            if pressed[i] or pressed[i + 1]:
                self._cut(surface, edges, i, pressed)
                self._body(surface, i, edges[i])
                surface.set_clip(self.rect)
            else:
                self._body(surface, i, edges[i])
        for i in on_screen:
            if pressed[i]:
                self._face(surface, i, edges[i], pressed[i])
        if self.numbered and self.number_size >= SMALLEST_NUMBER:
            for i in on_screen:
                self._number(surface, i, edges[i])

    def _pressed(self, edges: list[float]) -> list[float]:
        """Return the overlap [pixels] on the left side of each bead. Append 0 for the right side of the last bead.

        The overlap is 0 if two bodies are apart, or if one of the two bodies is not a ball.
        """
        found, balls, size = [0.0], self.balls, self.bead
        for i in range(len(edges) - 1):
            overlap = edges[i] + size - edges[i + 1] if balls[i] and balls[i + 1] else 0.0
            found.append(overlap if 0.0 < overlap < size else 0.0)
        return [*found, 0.0]

    def _cut(self, surface: pygame.Surface, edges: list[float], bead: int, pressed: list[float]) -> None:
        """Clip the surface to the part of a ball between its two flat faces."""
        left, right = self.rect.left, self.rect.right
        if pressed[bead]:
            left = max(left, round(edges[bead] + pressed[bead] / 2))
        if pressed[bead + 1]:
            right = min(right, round(edges[bead + 1] + pressed[bead + 1] / 2))
        surface.set_clip((left, self.rect.top, max(1, right - left), self.rect.height))

    def _face(self, surface: pygame.Surface, bead: int, edge: float, overlap: float) -> None:
        """Draw the flat face between a ball and its left neighbour if they are pressed together."""
        x, radius = edge + overlap / 2, self.bead / 2
        half, wide = math.sqrt(radius**2 - (radius - overlap / 2) ** 2), max(1, round(0.03 * self.bead))
        place = round(x - wide / 2), round(self.ground - radius - half), wide, max(1, round(2 * half))
        surface.fill(outline_colour(self.colours[bead]), place)

    def _body(self, surface: pygame.Surface, bead: int, x: float) -> None:
        size = self.bead
        if math.isinf(self.chain.mass[bead]):
            blit_sprite(surface, wall_sprite(size, WALL_HEIGHT * size), x, self.ground - WALL_HEIGHT * size)
        elif self._is_gear(bead):
            colour, gear = self.colours[bead], cylinder_sprite
            image = wagon_sprite(size, size, colour, self.locomotives[bead]) if self.train else gear(size, size, colour)
            blit_sprite(surface, image, x, self.ground - CYLINDER_HEIGHT * size - self.rise(bead))
        else:
            image = bead_sprite(size, self.colours[bead], self._core(bead))
            blit_sprite(surface, image, x, self.ground - math.ceil(size) - self.rise(bead))

    def rise(self, bead: int) -> float:
        """Return how many pixels a bead on a string was above its lowest position in the last picture. Return 0 if the
        beads do not hang on strings.
        """
        return self.hangs[bead][1] if self.hangs else 0.0

    def body_shape(self, bead: int, x: float) -> tuple[pygame.Rect, float]:
        """Return the rectangle around a body and the radius of its corners [pixels]. `x` is the pixel of the left edge
        of the body.
        """
        wall = math.isinf(self.chain.mass[bead])
        height = self.bead * (WALL_HEIGHT if wall else CYLINDER_HEIGHT if self._is_gear(bead) else 1.0)
        rect = pygame.Rect(round(x), round(self.ground - height - self.rise(bead)), round(self.bead), round(height))
        round_body = not wall and not self._is_gear(bead)
        return rect, 0.5 * self.bead if round_body else 0.08 * self.bead

    def _number(self, surface: pygame.Surface, bead: int, x: float) -> None:
        if math.isinf(self.chain.mass[bead]):
            return
        size = self.number_size
        middle = x + self.bead * (0.5 * CYLINDER_LENGTH if self._is_gear(bead) else 0.5)
        y = self.ground - self.bead * (0.5 * CYLINDER_HEIGHT if self._is_gear(bead) else 0.5) - self.rise(bead)
        half = math.ceil(3 * size) / 2
        blit_sprite(surface, number_sprite(str(bead), size, text_on(self.colours[bead])), middle - half, y - half)

    def _is_gear(self, bead: int) -> bool:
        """Return True if the bead pushes its right neighbour with a piston.

        The last bead looks like its left neighbour. A wall is drawn without a piston.
        """
        return math.isfinite(self.chain.mass[bead]) and is_gear(self.chain.contact[min(bead, self.chain.contacts - 1)])

    def _core(self, bead: int) -> float:
        """Return the radius of the dark core of a bead, relative to the radius of the bead. Return 0 if all masses are
        equal.

        The area of the core is proportional to the mass of the bead divided by the largest mass of the chain.
        """
        finite = [mass for mass in self.chain.mass if math.isfinite(mass)]
        if max(finite) <= EQUAL_MASSES * min(finite):
            return 0.0
        return math.sqrt(self.chain.mass[bead] / max(finite)) * 0.92

    def _bar_top(self, force: float) -> float:
        return self.bar_base - self.bar_room * force / (self.scales.force / FORCE_MARGIN)

    def _bars(self, surface: pygame.Surface, contacts: list[float], overlaps: list[float], forces: list[float]) -> None:
        """Draw a force bar for each contact. Draw a line across the bar at the force that the contact would carry in a
        rigid cluster, Eq. (5).
        """
        unit, visible = self.unit, VISIBLE_FORCE * self.scales.force
        wide = min(max(0.26 * self.bead, 3 * unit), 30 * unit)
        rigid = visible_marks(self.chain.mass, self.ends, overlaps, forces, self.length, visible)
        if any(rigid):
            self._paint_legend(surface)
        for i, (x, force, expected) in enumerate(zip(contacts, forces, rigid, strict=True)):
            self._bar(surface, i, x - wide / 2, wide, force)
            if expected:
                reach = wide / 2 + 5 * unit
                line = (x - reach, self._bar_top(expected) - 0.75 * unit, 2 * reach, 1.5 * unit)
                fill_rectangle(surface, tones.foreground, line)
        self._force_labels(surface, contacts, forces, rigid)

    def _bar(self, surface: pygame.Surface, contact: int, left: float, wide: float, force: float) -> None:
        """Draw the bar of a force. The bar is filled for a pushing force and hollow for a pulling force.

        The bar is dark above the force at which the draft gear becomes solid.
        """
        colour, top, rim = self.contact_colours[contact], self._bar_top(abs(force)), max(1.0, PULL_RIM * self.unit)
        fill_rectangle(surface, colour, (left, top, wide, self.bar_base - top))
        if force < 0.0:
            hollow = left + rim, top + rim, wide - 2 * rim, self.bar_base - top - 2 * rim
            fill_rectangle(surface, tones.lane_background, hollow)
        solid = solid_force(self.chain.contact[contact], force)
        if abs(force) > solid:
            fill_rectangle(surface, tones.foreground, (left, top, wide, self._bar_top(solid) - top))

    def _force_labels(
        self, surface: pygame.Surface, contacts: list[float], forces: list[float], rigid: list[float]
    ) -> None:
        """Write the forces above their bars, starting with the largest force. Omit a label that would cover another
        label or the heading.
        """
        size, visible, taken = 13 * self.unit, VISIBLE_FORCE * self.scales.force, list(self.heading)
        prefix = axis_prefix(self.scales.force)[1]
        unit = (
            f" {prefix}N" if prefix and not self.heading else ""
        )  # A thumbnail lacks the heading with the unit, so the label contains the unit.
        for i in sorted(range(len(forces)), key=lambda i: -abs(forces[i])):
            if abs(forces[i]) <= visible:
                return
            text = f"{beside(forces[i], self.scales.force)}{unit}"
            wide, foot = width(text, size, bold=True) + 4 * self.unit, self._label_foot(forces[i], rigid[i])
            place = pygame.Rect(round(contacts[i] - wide / 2), round(foot - size), round(wide), round(size))
            if self.rect.left <= contacts[i] <= self.rect.right and place.collidelist(taken) < 0:
                taken.append(place)
                place.left = min(max(place.left, self.rect.left), self.rect.right - place.width)
                write(surface, text, (place.centerx, foot), size, bold=True, align=(0.5, 1))

    def _label_foot(self, force: float, rigid: float) -> float:
        """Return the pixel of the lower edge of a force label.

        The label is above the force bar. If the mark of a rigid cluster is near, the label is also above this mark.
        """
        foot, mark = self._bar_top(abs(force)), self._bar_top(rigid)
        near = foot - FORCE_LABEL * self.unit < mark <= foot
        return (mark if near else foot) - 3 * self.unit

    def _arrows(self, surface: pygame.Surface, edges: list[float], shares: list[float]) -> None:
        """Draw an arrow below each bead. `shares` contains the lengths of the arrows relative to the longest arrow.

        If the masses of the beads differ, write them below the arrows.
        """
        y, size = self.ground + 11 * self.unit, MASS_LABEL * self.unit
        for i, (x, share) in enumerate(zip(edges, shares, strict=True)):
            middle = x + self.bead / 2
            length = 0.85 * self.bead * share
            draw_arrow(surface, mix(self.colours[i], tones.foreground, ARROW_TONE), (middle, y), length, self.unit)
            if self.mass_labels:
                write(surface, self.mass_labels[i], (middle, y + 5 * self.unit), size, tones.muted, align=(0.5, 0))


def _tallest(rect: pygame.Rect, unit: float) -> float:
    """Return the height [pixels] of the tallest bead.

    If the drawing is low, the beads shrink to leave the height LEAST_BAR for the force bars. The beads do not become
    smaller than LEAST_BEAD.
    """
    room = rect.height - (KEY + FORCE_LABEL + LEAST_BAR + BAR_LIFT + GROUND) * unit
    return min(TALLEST_BEAD * rect.height, max(room, LEAST_BEAD * rect.height))
