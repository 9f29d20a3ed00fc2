"""The picture of a scene: all its parts at one size; every lane shows the same time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pygame
from softcradle.sandbox.draw.curve_panels import Panel, decade_axis, linear_axis
from softcradle.sandbox.draw.energy_bars import EnergyBars
from softcradle.sandbox.draw.lane_drawing import KEY, LaneDrawing
from softcradle.sandbox.draw.layout import LaneLayout, Layout, picture_layout
from softcradle.sandbox.draw.magnified_insets import MagnifiedInsets
from softcradle.sandbox.draw.number_format import factor, fixed, subscript, time_unit
from softcradle.sandbox.draw.palette import mix, tones
from softcradle.sandbox.draw.shared_scales import Scales, scales_of
from softcradle.sandbox.draw.text import shortened, wrapped, write
from softcradle.sandbox.languages import _, scene_words
from softcradle.sandbox.motion import Array, Motion
from softcradle.scenes import Scene


class Picture:
    """Everything about the pictures of a scene that is the same in every frame, drawn once.

    Arguments:
        scene: the Scene.
        motions: one Motion for each lane, all with the same times.
        size: pixels.
        scales: the scales of all lanes; None fits them to the motions.
        slow: seconds of film for one of motion, for the label; None takes the scene's.
        ahead: strength of the curves beyond the cursor, from 0 to 1.
    """

    def __init__(
        self,
        scene: Scene,
        motions: Sequence[Motion],
        size: tuple[int, int],
        *,
        scales: Scales | None = None,
        slow: float | None = None,
        ahead: float = 0.2,
    ) -> None:
        self.scene, self.motions, self.size = scene, tuple(motions), size
        self.ahead = ahead
        self.slow = scene.view.slow if slow is None else slow
        self.scales = scales_of(scene, motions) if scales is None else scales
        self.layout: Layout = picture_layout(size, len(self.motions))
        self.lanes = [_LanePicture(self, k, place) for k, place in enumerate(self.layout.lanes)]
        self.background = pygame.Surface(size, 0, 32)
        self._backdrop(self.background)

    def paint(self, surface: pygame.Surface, row: int, centre: float | None = None, text_opacity: float = 0.0) -> None:
        """Draw row `row` of the motions on `surface`, which has the picture's size.

        `centre` [m] moves the camera; `text_opacity` (0 to 1) is that of the scene's text above the beads.
        """
        surface.blit(self.background, (0, 0))
        self._write_time(surface, float(self.motions[0].time[row]))
        for lane in self.lanes:
            lane.paint(surface, row, centre)
        if text_opacity > 0.0:
            self._write_text(surface, min(text_opacity, 1.0))

    def _backdrop(self, surface: pygame.Surface) -> None:
        surface.fill(tones.background)
        header, unit = self.layout.header, self.layout.unit
        room, line_y = header.width - 200 * unit, header.top + 35 * unit
        title = shortened(scene_words(self.scene.title), 25 * unit, room, bold=True)
        write(surface, title, header.topleft, 25 * unit, tones.foreground, bold=True)
        line = "  ·  ".join(part for part in (scene_words(self.scene.source), self.motions[0].method) if part)
        write(surface, shortened(line, 14 * unit, room), (header.left, line_y), 14 * unit, tones.muted)
        write(surface, _speed(self.slow), (header.right, line_y), 14 * unit, tones.muted, align=(1, 0))
        for lane in self.lanes:
            lane.backdrop(surface)

    def _write_text(self, surface: pygame.Surface, opacity: float) -> None:
        """Write the scene's text above the beads of the first lane, and below its key."""
        drawing, unit = self.lanes[0].drawing, self.layout.unit
        size = min(15.5 * unit, drawing.rect.width / 42)
        lines = wrapped(scene_words(self.scene.text), size, 0.62 * drawing.rect.width)
        centred = (drawing.rect.top + drawing.bar_base + 10 * unit) / 2 - 0.7 * size * len(lines)
        y = max(centred, drawing.rect.top + (KEY + 2) * unit)
        veil = pygame.Surface((round(0.64 * drawing.rect.width), round(1.4 * size * len(lines))), 0, 32)
        veil.fill(tones.lane_background)
        veil.set_alpha(round(255 * opacity))
        surface.blit(veil, veil.get_rect(midtop=(drawing.rect.centerx, round(y))))
        colour = mix(tones.lane_background, tones.foreground, opacity)
        for k, line in enumerate(lines):
            write(surface, line, (drawing.rect.centerx, y + 1.4 * size * k), size, colour, align=(0.5, 0))

    def _write_time(self, surface: pygame.Surface, time: float) -> None:
        header, unit = self.layout.header, self.layout.unit
        span = self.scales.time[1] - self.scales.time[0]
        size, name = time_unit(span)
        decimals = max(0, 3 - int(np.floor(np.log10(span / size))))
        text = f"t = {fixed(time / size, decimals)} {name}"
        write(surface, text, header.topright, 25 * unit, tones.foreground, bold=True, align=(1, 0))


class _LanePicture:
    """The parts of one lane."""

    def __init__(self, picture: Picture, number: int, place: LaneLayout) -> None:
        scene, scales, unit = picture.scene, picture.scales, picture.layout.unit
        self.motion = picture.motions[number]
        self.drawing = LaneDrawing(place.drawing, unit, scene, number, scales)
        self.insets = MagnifiedInsets(place.insets, unit, self.drawing, scales.deepest[number])
        self.bars = EnergyBars(place.bars, unit, self.drawing.colours, scales)
        self.panels = [self._panel(rect, kind, scales, unit) for kind, rect in enumerate(place.panels)]
        self.ahead = picture.ahead
        for panel, values in zip(self.panels, _curves(self.motion), strict=False):
            panel.draw_curves(self.motion.time, values)

    def _panel(self, rect: pygame.Rect, kind: int, scales: Scales, unit: float) -> Panel:
        """The panel of velocities (kind 0), forces (1) or overlaps (2)."""
        colours, contact_colours = self.drawing.colours, self.drawing.contact_colours
        contacts = range(len(contact_colours))
        if kind == 0:
            axis, names = (
                linear_axis(_("velocity (m/s)"), *scales.velocity),
                [f"v{subscript(i)}" for i in range(len(colours))],
            )
            return Panel(rect, unit, scales.time, axis, colours=colours, names=names)
        if kind == 1:
            axis, letter = linear_axis(_("contact force (N)"), scales.pull, scales.force), "f"
        else:
            axis, letter = decade_axis(_("overlap (m), logarithmic"), *scales.decades), "δ"
        names = [letter + subscript(i, i + 1) for i in contacts]
        return Panel(rect, unit, scales.time, axis, colours=contact_colours, names=names)

    def backdrop(self, surface: pygame.Surface) -> None:
        self.drawing.backdrop(surface)
        self.insets.backdrop(surface)
        self.bars.backdrop(surface)
        for kind, (panel, values) in enumerate(zip(self.panels, _curves(self.motion), strict=False)):
            peaks = values[-1] if kind == 0 else _extremes(values)
            panel.backdrop(surface, self.motion.time, values, peaks, self.ahead)

    def paint(self, surface: pygame.Surface, row: int, centre: float | None) -> None:
        contacts = self.drawing.paint(surface, self.motion, row, self.drawing.left(centre))
        self.insets.paint(surface, self.motion, row, contacts)
        self.bars.paint(surface, self.motion, row)
        for panel, values in zip(self.panels, _curves(self.motion), strict=False):
            panel.paint(surface, float(self.motion.time[row]), values[row])


def _curves(motion: Motion) -> tuple[Array, Array, Array]:
    """The curves of the panels, in their order; several lanes have two panels each."""
    return motion.velocity, motion.force, motion.overlap


def _speed(slow: float) -> str:
    if abs(slow - 1.0) < 1e-9:
        return _("real time")
    if slow > 1.0:
        return _("slow motion 1/{times:.4g}", times=slow)
    return _("quick motion {times}", times=factor(1.0 / slow))


def _extremes(values: Array) -> Array:
    """(n,) the value of each curve (T, n) that is farthest from 0."""
    low, high = values.min(axis=0), values.max(axis=0)
    found: Array = np.where(-low > high, low, high)
    return found
