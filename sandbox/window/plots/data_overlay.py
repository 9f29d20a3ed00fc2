"""Overlays on live plots. Measured numbers are drawn as rings, and a measured kymograph is drawn as a picture."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np
import pygame
from softcradle.sandbox.draw.palette import mix, tones
from softcradle.sandbox.languages import _
from softcradle.sandbox.measured_table import FORCE, POSITION, VELOCITY, MeasuredTable
from softcradle.sandbox.motion import Array
from softcradle.sandbox.story.numbers import MINUS
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.plots.curves import Plot
from softcradle.sandbox.window.plots.kinds import FORCES, KYMOGRAPH, VELOCITIES

TABLES = (".csv", ".tsv", ".txt")
PICTURES = (".png", ".jpg", ".jpeg", ".bmp", ".webp")
# Measured quantity that belongs to each kind of plot. A table with several quantities is drawn over the first of these
# plots.
MEASURED_KINDS = {VELOCITIES: VELOCITY, KYMOGRAPH: POSITION, FORCES: FORCE}
RING = 3.6  # Radius of a ring in design pixels.
PICTURE_OPACITY = 150  # Opacity of the picture, from 0 to 255.


@dataclass(frozen=True, eq=False)
class NumbersOverlay:
    """Measured numbers: times (T,) [s] and values (T, k) in SI units. Column k belongs to curve k."""

    time: Array
    values: Array

    @classmethod
    def of(cls, table: MeasuredTable, quantity: str) -> NumbersOverlay:
        """Return the overlay of all columns of one quantity."""
        return cls(table.time, np.column_stack([column.values for column in table.along_row(quantity)]))

    def paint(self, surface: pygame.Surface, plot: Plot) -> None:
        """Draw a ring for each measured number that lies within the axes."""
        area, unit = plot.area, plot.unit
        surface.set_clip(area)
        across = np.array([plot.span.x(time) for time in self.time.tolist()]) + area.left
        for k in range(min(self.values.shape[1], len(plot.content.colours))):
            values = self.values[:, k]
            shown = np.isfinite(values) & (across >= area.left) & (across <= area.right)
            down = area.top + plot.y(plot.axis.on(values[shown]))
            colour = mix(plot.content.colours[k], tones.foreground, 0.35)
            for place in zip(across[shown].tolist(), down.tolist(), strict=True):
                pygame.draw.aacircle(surface, colour, place, RING * unit, max(1, round(1.4 * unit)))
        surface.set_clip(None)

    def differences(self, plot: Plot) -> Array:
        """Return the (m,) differences, measured minus computed value, at all measured times that the history covers."""
        samples = plot.samples_of_frames(plot.history.first, plot.history.last)
        found: list[Array] = []
        # Compare parts with equal numbers of columns, because the number of beads may change during the history.
        for _count, parts in groupby(samples, key=lambda part: part[1].shape[1]):
            time, values = map(np.concatenate, zip(*parts, strict=True))
            inside = (self.time >= time[0]) & (self.time <= time[-1])
            at, measured = self.time[inside], self.values[inside]
            pairs = zip(measured.T, values.T, strict=False)
            found.extend(column - np.interp(at, time, computed) for column, computed in pairs)
        joined = np.concatenate(found) if found else np.zeros(0)
        return joined[np.isfinite(joined)]


@dataclass(frozen=True, eq=False)
class PictureOverlay:
    """A picture of a measured kymograph. Its left and right edges are times [s]. Its top and bottom edges are
    positions.
    """

    picture: pygame.Surface
    edges: tuple[float, float, float, float]

    def paint(self, surface: pygame.Surface, plot: Plot) -> None:
        """Draw the visible part of the picture translucently over the plot."""
        begin, end, top, bottom = self.edges
        area = plot.area
        left, right = (area.left + plot.span.x(time) for time in (begin, end))
        high, low = (area.top + float(_place(plot, value)) for value in (top, bottom))
        rect = pygame.Rect(
            round(left), round(min(high, low)), max(1, round(right - left)), max(1, round(abs(low - high)))
        )
        seen = rect.clip(area)
        if not seen.width or not seen.height:
            return
        sx, sy = self.picture.get_width() / rect.width, self.picture.get_height() / rect.height
        source = pygame.Rect(
            int((seen.left - rect.left) * sx),
            int((seen.top - rect.top) * sy),
            max(1, int(seen.width * sx)),
            max(1, int(seen.height * sy)),
        ).clip(self.picture.get_rect())
        image = pygame.transform.scale(self.picture.subsurface(source), seen.size)
        image.set_alpha(PICTURE_OPACITY)
        surface.blit(image, seen)


def _place(plot: Plot, value: float) -> float:
    """Return the vertical pixel of `value`, even if the value is far outside the axis."""
    share = (value - plot.axis.low) / (plot.axis.high - plot.axis.low)
    return (plot.area.height - 1) * (1.0 - share)


def load_picture(path: Path) -> pygame.Surface:
    """Return a picture from a file. Raise UserError if it cannot be read."""
    try:
        return pygame.image.load(str(path)).convert()
    except (OSError, pygame.error) as error:
        raise UserError(
            _("{path}: cannot be read as a picture ({error})", path=path, error=str(error).lower())
        ) from None


def edges_of(text: str) -> tuple[float, float, float, float]:
    """Return the four numbers in `text`: times at the left and right edge, and positions at the top and bottom edge.

    Raise ValueError if the text does not contain four suitable numbers.
    """
    parts = [part.replace(",", ".").replace(MINUS, "-") for part in text.replace(", ", " ").replace(";", " ").split()]
    if len(parts) == 1:
        parts = text.split(",")
    try:
        begin, end, top, bottom = map(float, parts)
    except ValueError:
        raise ValueError(_("{text!r}: four numbers are needed: t left, t right, x top, x bottom", text=text)) from None
    if not (np.isfinite([begin, end, top, bottom]).all() and end > begin and top != bottom):
        wrong = _("{text!r}: t right must be later than t left, and x top must differ from x bottom", text=text)
        raise ValueError(wrong)
    return begin, end, top, bottom
