"""The plot of one signal against another: a loop of force over overlap, a path in phase space, whatever a person chooses."""

from __future__ import annotations

import math

import numpy as np
import pygame
from softcradle.sandbox.draw.curve_panels import linear_axis, ticks_apart
from softcradle.sandbox.draw.number_format import TIMES, power_of_ten
from softcradle.sandbox.draw.palette import mix, tones
from softcradle.sandbox.draw.supersampling import draw_marker
from softcradle.sandbox.draw.text import shortened, width, write
from softcradle.sandbox.languages import _
from softcradle.sandbox.motion import Array
from softcradle.sandbox.session.history_slices import history_slices
from softcradle.sandbox.window.plots.live_plots import LINE, Plot

MOST_POINTS = 1500  # of the curve, evenly thinned
MARGIN = 0.06  # of the axes beyond the values
LATER = 0.25  # strength of the curve later than the frame shown


class PhasePlot(Plot):
    """The whole history as one curve; its axes reach as far as its values. `values` of the content are (T, 2): y, x."""

    timed = marked = False

    def __init__(self, *arguments: object) -> None:
        super().__init__(*arguments)  # type: ignore[arg-type]
        self._seen: tuple[object, ...] = ()
        self._points = np.zeros((0, 3))  # time, y, x

    def update(self, grown: bool, budget: int) -> int:
        """Nothing is drawn ahead."""
        return 0

    @property
    def complete(self) -> bool:
        """Nothing is left to be drawn."""
        return True

    def points(self) -> Array:
        """(T, 3) time, y and x of the history."""
        history = self.history
        seen = (history.blocks[-1], history.blocks[-1].revision, history.first, history.last)
        if seen != self._seen:
            parts = history_slices(history, self.lane, history.first, history.last, MOST_POINTS)
            self._points = np.concatenate(
                [np.column_stack((part.time, self.content.values(part))) for part in parts] or [np.zeros((0, 3))]
            )
            self._seen = seen
        return self._points

    def backdrop(self, surface: pygame.Surface) -> None:
        """The axes change with the values: nothing stays."""

    def paint(self, surface: pygame.Surface, time: float, values: Array) -> None:
        """Draw axes and curve, strong up to the frame shown, and a marker there."""
        unit, area, points = self.unit, self.area, self.points()
        surface.fill(tones.background, self.rect)
        low, high = (_ends(points[:, column], values[column - 1]) for column in (1, 2))
        names = [f"{name}{_factor(ends)}" for name, ends in zip(self.content.names, (low, high), strict=True)]
        title = shortened(
            _("{vertical} against {horizontal}", vertical=names[0], horizontal=names[1]),
            13 * unit,
            area.width + 20 * unit,
        )
        write(surface, title, (area.left, area.top - 4 * unit), 13 * unit, tones.foreground, align=(0, 1))

        def places(rows: Array) -> Array:
            across = area.left + (rows[:, 1] - high[0]) / (high[1] - high[0]) * area.width
            down = area.bottom - (rows[:, 0] - low[0]) / (low[1] - low[0]) * area.height
            return np.column_stack((across, down))

        for value, text in ticks_apart(scaled_ticks(low), area.height / (low[1] - low[0]), LINE * unit):
            y = float(places(np.array([[value, high[0]]]))[0, 1])
            surface.fill(tones.grid, (area.left, round(y), area.width, 1))
            write(surface, text, (area.left - 6 * unit, y), 11.5 * unit, tones.muted, align=(1, 0.5))
        across = scaled_ticks(high)
        gap = max((width(text, 11.5 * unit) for _value, text in across), default=0.0) + 8 * unit
        for value, text in ticks_apart(across, area.width / (high[1] - high[0]), gap):
            x = float(places(np.array([[low[0], value]]))[0, 0])
            half = 0.5 * width(text, 11.5 * unit)
            if area.left - 4 * unit < x - half and x + half < area.right - width(names[1], 11.5 * unit) - 6 * unit:
                write(surface, text, (x, area.bottom + 3 * unit), 11.5 * unit, tones.muted, align=(0.5, 0))
            surface.fill(tones.grid, (round(x), area.top, 1, area.height))
        place = (area.right, area.bottom + 3 * unit)
        write(surface, names[1], place, 11.5 * unit, tones.muted, align=(1, 0))
        colour = self.content.colours[0]
        known = np.isfinite(points).all(axis=1)
        for rows, tint in (
            (points[known & (points[:, 0] >= time)], mix(tones.background, colour, LATER)),
            (points[known & (points[:, 0] <= time)], colour),
        ):
            if len(rows) > 1:
                pygame.draw.aalines(surface, tint, False, places(rows[:, 1:]).tolist())
        if np.isfinite(values).all():
            draw_marker(surface, 0, tuple(places(values[None])[0].tolist()), 3.6 * unit, colour)


def exponent_of(ends: tuple[float, float]) -> int:
    """Exponent of the power of a thousand that labels of an axis leave out; 0 where they are short anyway."""
    greatest = math.log10(max(map(abs, ends)))
    return 0 if -2.0 < greatest < 4.0 else 3 * math.floor(greatest / 3.0)


def scaled_ticks(ends: tuple[float, float]) -> list[tuple[float, str]]:
    """(value, label) of an axis, labels without their common power of ten."""
    size = 10.0 ** exponent_of(ends)
    return [(value * size, text) for value, text in linear_axis("", ends[0] / size, ends[1] / size).ticks]


def _factor(ends: tuple[float, float]) -> str:
    exponent = exponent_of(ends)
    return f" {TIMES}{power_of_ten(exponent)}" if exponent else ""


def _ends(values: Array, present: float) -> tuple[float, float]:
    """Ends of an axis on which all values are."""
    known = values[np.isfinite(values)]
    low = float(min(known.min(initial=np.inf), present if np.isfinite(present) else np.inf))
    high = float(max(known.max(initial=-np.inf), present if np.isfinite(present) else -np.inf))
    if not np.isfinite(low) or low == high:
        middle = low if np.isfinite(low) else 0.0
        half = 0.5 * abs(middle) or 1.0
        return middle - half, middle + half
    margin = MARGIN * (high - low)
    return low - margin, high + margin
