"""The picture: all parts of one scene at one size, put together; every lane shows the same time."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pygame
from softcradle.sandbox.draw.curve_panels import Panel, decade_axis, linear_axis
from softcradle.sandbox.draw.energy_bars import EnergyBars
from softcradle.sandbox.draw.lane_drawing import LaneDrawing
from softcradle.sandbox.draw.layout import LaneLayout, Layout, layout
from softcradle.sandbox.draw.magnified_insets import MagnifiedInsets
from softcradle.sandbox.draw.number_format import factor, fixed, subscript, time_unit
from softcradle.sandbox.draw.palette import BACKGROUND, FOREGROUND, LANE_BACKGROUND, MUTED, mix
from softcradle.sandbox.draw.shared_scales import Scales, scales_of
from softcradle.sandbox.draw.text import shortened, wrapped, write
from softcradle.sandbox.motion import Array, Motion
from softcradle.scenes import Scene


class Picture:
    """Everything about a scene's pictures that does not change from frame to frame, drawn once.

    Arguments:
        scene: the Scene.
        tracks: one Motion a lane: the history. All have the same times.
        size: pixels.
        scales: what stands for what; None fits them to the tracks.
        slow: seconds of film for one of motion, for the label; None takes the scene's.
        ahead: how strong the curves beyond the cursor are, from 0 to 1.
    """

    def __init__(
        self,
        scene: Scene,
        tracks: Sequence[Motion],
        size: tuple[int, int],
        *,
        scales: Scales | None = None,
        slow: float | None = None,
        ahead: float = 0.2,
    ) -> None:
        self.scene, self.tracks, self.size = scene, tuple(tracks), size
        self.ahead = ahead
        self.slow = scene.view.slow if slow is None else slow
        self.scales = scales_of(scene, tracks) if scales is None else scales
        self.layout: Layout = layout(size, len(self.tracks))
        self.lanes = [_LanePicture(self, k, place) for k, place in enumerate(self.layout.lanes)]
        self.ground = pygame.Surface(size, 0, 32)
        self._backdrop(self.ground)

    def paint(self, surface: pygame.Surface, row: int, centre: float | None = None, told: float = 0.0) -> None:
        """Draw row `row` of the tracks on `surface`, which has the picture's size.

        `centre` [m] moves the camera; `told` (0 to 1) is the opacity of the scene's text above the beads.
        """
        surface.blit(self.ground, (0, 0))
        self._clock(surface, float(self.tracks[0].time[row]))
        for lane, track in zip(self.lanes, self.tracks, strict=True):
            lane.paint(surface, track, row, centre)
        if told > 0.0:
            self._tell(surface, min(told, 1.0))

    def extend(self, tracks: Sequence[Motion]) -> None:
        """Take longer `tracks` with the same beginning, for live use: only their new part is inked."""
        for lane, track in zip(self.lanes, tracks, strict=True):
            lane.ink(track, float(lane.track.time[-1]))
            lane.track = track
        self.tracks = tuple(tracks)

    def _backdrop(self, surface: pygame.Surface) -> None:
        surface.fill(BACKGROUND)
        header, unit = self.layout.header, self.layout.unit
        room = header.width - 200 * unit
        write(
            surface,
            shortened(self.scene.title, 25 * unit, room, bold=True),
            header.topleft,
            25 * unit,
            FOREGROUND,
            bold=True,
        )
        line = "  ·  ".join(part for part in (self.scene.source, self.tracks[0].method) if part)
        write(surface, shortened(line, 14 * unit, room), (header.left, header.top + 35 * unit), 14 * unit, MUTED)
        place = (header.right, header.top + 35 * unit)
        write(surface, _speed(self.slow), place, 14 * unit, MUTED, align=(1, 0))
        for lane in self.lanes:
            lane.backdrop(surface)

    def _tell(self, surface: pygame.Surface, opacity: float) -> None:
        stage, unit = self.lanes[0].stage, self.layout.unit
        size = min(15.5 * unit, stage.rect.width / 42)
        lines = wrapped(self.scene.text, size, 0.62 * stage.rect.width)
        y = (stage.rect.top + stage.foot_of_bars + 10 * unit) / 2 - 0.7 * size * len(lines)
        veil = pygame.Surface((round(0.64 * stage.rect.width), round(1.4 * size * len(lines))), 0, 32)
        veil.fill(LANE_BACKGROUND)
        veil.set_alpha(round(255 * opacity))
        surface.blit(veil, veil.get_rect(midtop=(stage.rect.centerx, round(y))))
        colour = mix(LANE_BACKGROUND, FOREGROUND, opacity)
        for k, line in enumerate(lines):
            write(surface, line, (stage.rect.centerx, y + 1.4 * size * k), size, colour, align=(0.5, 0))

    def _clock(self, surface: pygame.Surface, time: float) -> None:
        header, unit = self.layout.header, self.layout.unit
        span = self.scales.time[1] - self.scales.time[0]
        size, name = time_unit(span)
        decimals = max(0, 3 - int(np.floor(np.log10(span / size))))
        text = f"t = {fixed(time / size, decimals)} {name}"
        write(surface, text, header.topright, 25 * unit, FOREGROUND, bold=True, align=(1, 0))


class _LanePicture:
    """The parts of one lane."""

    def __init__(self, picture: Picture, number: int, place: LaneLayout) -> None:
        scene, scales, unit = picture.scene, picture.scales, picture.layout.unit
        self.track = picture.tracks[number]
        self.stage = LaneDrawing(place.stage, unit, scene, number, scales)
        self.loupes = MagnifiedInsets(place.loupes, unit, self.stage, scales.deepest[number], scales)
        self.shares = EnergyBars(place.shares, unit, self.stage.colours, scales)
        self.panels = [self._panel(rect, kind, scales, unit) for kind, rect in enumerate(place.panels)]
        self.ahead = picture.ahead
        self.ink(self.track)

    def ink(self, track: Motion, since: float = -math.inf) -> None:
        """Ink the curves of `track` later than `since` [s]."""
        for panel, values in zip(self.panels, _curves(track), strict=False):
            panel.ink(track.time, values, since)

    def _panel(self, rect: pygame.Rect, kind: int, scales: Scales, unit: float) -> Panel:
        beads, contacts = len(self.stage.colours), len(self.stage.colours) - 1
        axis = (
            linear_axis("velocity (m/s)", *scales.velocity),
            linear_axis("contact force (N)", 0.0, scales.force),
            decade_axis("overlap (m), logarithmic", *scales.decades),
        )[kind]
        letters = "vfδ"[kind]
        names = (
            [letters + subscript(i) for i in range(beads)]
            if kind == 0
            else [letters + subscript(i, i + 1) for i in range(contacts)]
        )
        colours = self.stage.colours if kind == 0 else self.stage.contact_colours
        return Panel(rect, unit, scales.time, axis, colours=colours, names=names)

    def backdrop(self, surface: pygame.Surface) -> None:
        self.stage.backdrop(surface)
        self.loupes.backdrop(surface)
        self.shares.backdrop(surface)
        for kind, (panel, values) in enumerate(zip(self.panels, _curves(self.track), strict=False)):
            peaks = values[-1] if kind == 0 else values.max(axis=0)
            panel.backdrop(surface, self.track.time, values, peaks, self.ahead)

    def paint(self, surface: pygame.Surface, track: Motion, row: int, centre: float | None) -> None:
        contacts = self.stage.paint(surface, track, row, self.stage.left(centre))
        self.loupes.paint(surface, track, row, contacts)
        self.shares.paint(surface, track, row)
        for panel, values in zip(self.panels, _curves(track), strict=False):
            panel.paint(surface, float(track.time[row]), values[row])


def _curves(track: Motion) -> tuple[Array, Array, Array]:
    return track.velocity, track.force, track.overlap


def _speed(slow: float) -> str:
    if abs(slow - 1.0) < 1e-9:
        return "real time"
    return f"slow motion 1/{slow:.4g}" if slow > 1.0 else f"quick motion {factor(1.0 / slow)}"
