"""The kinds of plots: curves, the energy split, the space-time strip, the kymograph, the difference of two lanes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pygame
from softcradle.sandbox.draw.curve_panels import Axis, decade_axis, linear_axis
from softcradle.sandbox.draw.number_format import subscript
from softcradle.sandbox.draw.palette import BACKGROUND, FOREGROUND, STEEL, Colour, bead_colours, mix
from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.draw.supersampling import SUBPIXELS
from softcradle.sandbox.motion import Array
from softcradle.sandbox.session.history import History
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.window.plots.history_curves import Rows, at_frame, stretches
from softcradle.sandbox.window.plots.live_plots import THICK, Content, Plot, Source, strokes
from softcradle.sandbox.window.plots.time_axis import TimeSpan

KINDS = ("velocities", "forces", "overlaps", "energy", "strip", "kymograph", "difference")
CHIPS = {
    "velocities": "velocities",
    "forces": "forces",
    "overlaps": "overlaps",
    "energy": "energy",
    "strip": "space-time",
    "kymograph": "kymograph",
    "difference": "difference",
}
HEAT: tuple[Colour, ...] = (BACKGROUND, (198, 222, 240), (86, 160, 211), (0, 94, 160), (10, 34, 82))
SHADES = 256
BODY_SEEN, PALE = 0.8, 0.45  # of a bead's length, and how much paper is in its colour, in a kymograph


class StackPlot(Plot):
    """The energy split: the kinetic energy of each bead and what the contacts store, piled up."""

    marked = False

    def ink(self, first: int, last: int) -> pygame.Surface:
        """Piles in columns `first` to `last`."""
        height = self.area.height
        pixels = pygame.surfarray.array3d(self.sheet.ground)[:1].repeat(last - first, axis=0)
        middles = np.arange(height) + 0.5
        for time, values in self.curves(first, last):
            table = np.array(
                [*_pile_colours(values.shape[1]), BACKGROUND], dtype=np.uint8
            )  # there may have been more beads
            tops = self.y(np.cumsum(values, axis=1))
            for column, row in _latest(time / self.span.column, first, last):
                layer = np.searchsorted(-tops[row], -middles)  # the first pile that reaches as high as the pixel
                inside = layer < values.shape[1]
                pixels[column - first, inside] = table[layer[inside]]
        return pygame.surfarray.make_surface(pixels)


def _pile_colours(count: int) -> tuple[Colour, ...]:
    """Colours of the kinetic energies of all beads and of what is stored, from below."""
    return *bead_colours(count - 1), STEEL


def _latest(places: Array, first: int, last: int) -> list[tuple[int, int]]:
    """(column, row) for the columns `first` to `last`: the newest row in it, or before; `places` (T,) in columns."""
    columns = np.arange(first, last)
    rows = np.searchsorted(places, columns + 1) - 1
    held = (rows >= 0) & (columns <= places[-1])
    return list(zip(columns[held].tolist(), rows[held].tolist(), strict=True))


class StripPlot(Plot):
    """The space-time strip: a row a contact, from left to right downwards; the darker the greater the force."""

    marked = False

    def ink(self, first: int, last: int) -> pygame.Surface:
        """Shades in columns `first` to `last`."""
        image = np.zeros((last - first, self.area.height), dtype=np.uint8)
        for time, values in self.curves(first, last):
            columns = np.floor(time / self.span.column).astype(int) - first
            kept = (columns >= 0) & (columns < last - first)
            shade = np.clip(values[kept] / self.source.most * (SHADES - 1), 0, SHADES - 1).astype(np.uint8)
            lines = (np.arange(self.area.height) * values.shape[1]) // self.area.height
            np.maximum.at(image, columns[kept], shade[:, lines])
        return pygame.surfarray.make_surface(_heat()[image])


class KymographPlot(Plot):
    """The bodies over time, as a camera sees them from the side, with a marker on each: the paper's Fig. 4 (c)."""

    marked = False
    half = 0.5 * BODY_SEEN  # of the axis: set with the length of the beads

    def ink(self, first: int, last: int) -> pygame.Surface:
        """Bands with markers in columns `first` to `last`."""
        size = (last - first) * SUBPIXELS, self.area.height * SUBPIXELS
        fine = pygame.transform.scale(self.sheet.ground.subsurface((0, 0, 1, self.area.height)), size)
        for time, values in self.curves(first, last):
            across = (time / self.span.column - first + 0.5) * SUBPIXELS
            across[[0, -1]] += -SUBPIXELS, SUBPIXELS  # stretches join
            low, high = ((self.y(values + side * self.half) + 0.5) * SUBPIXELS for side in (-1.0, 1.0))
            for k in range(min(values.shape[1], len(self.colours))):
                edge = np.concatenate((across, across[::-1])), np.concatenate((low[:, k], high[::-1, k]))
                if len(across) > 1:
                    pygame.draw.polygon(fine, mix(self.colours[k], BACKGROUND, PALE), np.column_stack(edge).tolist())
            down = (self.y(values) + 0.5) * SUBPIXELS
            strokes(fine, [FOREGROUND] * values.shape[1], across, down, THICK * self.unit * SUBPIXELS)
        return pygame.transform.smoothscale(fine, (last - first, self.area.height))


class DifferencePlot(Plot):
    """The second lane less the first, bead by bead or contact by contact."""

    def curves(self, first: int, last: int) -> list[tuple[Array, Array]]:
        """See `Plot.curves`."""
        frames, history, values = self.frames(first, last), self.source.history, self.source.values
        pairs = zip(stretches(history, 0, *frames), stretches(history, 1, *frames), strict=False)
        return [(a.time, values(b) - values(a)) for a, b in pairs if comparable(a, b)]

    def now(self, frame: int) -> Array:
        """See `Plot.now`."""
        a, b = (at_frame(self.source.history, lane, frame) for lane in (0, 1))
        return (self.source.values(b) - self.source.values(a))[0] if comparable(a, b) else np.zeros(0)


def comparable(a: Rows, b: Rows) -> bool:
    """Whether two lanes have as many beads, and the same frames are in hand."""
    return a.overlap.shape == b.overlap.shape


def _heat() -> Array:
    """(SHADES, 3) colours from none to the greatest force."""
    places = np.linspace(0, len(HEAT) - 1, SHADES)
    rows = [mix(HEAT[int(p)], HEAT[min(int(p) + 1, len(HEAT) - 1)], float(p) % 1.0) for p in places]
    return np.array(rows, dtype=np.uint8)


@dataclass(frozen=True)
class Setting:
    """What plots are made from, whatever their kind."""

    lanes: Sequence[LiveLane]
    scales: Scales
    history: History
    span: TimeSpan
    logarithmic: bool
    length: float  # of the beads [m]

    def names(self, lane: int) -> tuple[list[str], list[str]]:
        """Indices of the beads and of the contacts of a lane."""
        beads = self.lanes[lane].chain.contacts + 1
        return [subscript(i) for i in range(beads)], [subscript(i, i + 1) for i in range(beads - 1)]


def make_plot(kind: str, lane: int, rect: pygame.Rect, unit: float, setting: Setting) -> Plot:
    """The plot `kind` of lane number `lane`."""
    made = {"energy": StackPlot, "strip": StripPlot, "kymograph": KymographPlot, "difference": DifferencePlot}.get(
        kind, Plot
    )
    beads, contacts = setting.names(lane)
    palette = bead_colours(len(beads))
    names, colours, values = {
        "velocities": (["v" + name for name in beads], palette, _velocity),
        "forces": (["f" + name for name in contacts], palette[1:], _force),
        "overlaps": (["δ" + name for name in contacts], palette[1:], _overlap),
        "energy": ([*("E" + name for name in beads), "stored"], (*palette, STEEL), _energies),
        "strip": (["f" + name for name in contacts], palette[1:], _force),
        "kymograph": (["x" + name for name in beads], palette, _markers(setting.length)),
        "difference": (["Δv" + name for name in beads], palette, _velocity)
        if lane == 0
        else (["Δf" + name for name in contacts], palette[1:], _force),
    }[kind]
    source = Source(setting.history, lane, values, setting.scales.force)
    content = Content(_title(kind, setting, lane), _axis(kind, setting, lane), names, colours, source)
    plot = made(rect, unit, content, setting.span)
    if isinstance(plot, KymographPlot):
        plot.half *= setting.length
    return plot


def _velocity(rows: Rows) -> Array:
    return rows.velocity


def _markers(length: float) -> Callable[[Rows], Array]:
    """(T, n+1) where the middles of the beads are [m]."""

    def middles(rows: Rows) -> Array:
        places: Array = rows.position + length * (np.arange(rows.position.shape[1]) + 0.5)
        return places

    return middles


def _force(rows: Rows) -> Array:
    return rows.force


def _overlap(rows: Rows) -> Array:
    return rows.overlap


def _energies(rows: Rows) -> Array:
    return rows.energies


def _title(kind: str, setting: Setting, lane: int) -> str:
    titles = {
        "velocities": "velocity (m/s)",
        "forces": "contact force (N)",
        "overlaps": "overlap (m)",
        "energy": "energy (J): beads, contacts grey",
        "strip": "contact forces, row by row",
        "kymograph": "markers of the beads (m)",
        "difference": "second less first (m/s)" if lane == 0 else "second less first (N)",
    }
    label = setting.lanes[lane].label
    named = len(setting.lanes) > 1 and label and kind != "difference"
    return f"{titles[kind]} · {label}" if named else titles[kind]


def _axis(kind: str, setting: Setting, lane: int) -> Axis:
    scales = setting.scales
    half = 0.5 * (max(map(abs, scales.velocity)) if lane == 0 else scales.force)
    low, high = {
        "velocities": scales.velocity,
        "difference": (-half, half),
        "forces": (0.0, scales.force),
        "energy": (0.0, 1.05 * scales.energy),
        "overlaps": (0.0, 1.1 * (max(map(max, scales.deepest)) or 1.0)),
        "strip": (0.0, 1.0),
        "kymograph": scales.window,
    }[kind]
    if kind == "strip":
        return _row_axis(setting.names(lane)[1])
    if kind == "overlaps" and setting.logarithmic:
        return decade_axis("", *scales.decades)
    return linear_axis("", low, high)


def _row_axis(names: Sequence[str]) -> Axis:
    """A row a contact, the first on top; at most five carry their name."""
    step = max(1, (len(names) + 4) // 5)
    return Axis("", float(len(names)), 0.0, tuple((k + 0.5, names[k]) for k in range(0, len(names), step)))
