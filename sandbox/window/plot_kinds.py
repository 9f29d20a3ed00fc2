"""The kinds of plots: curves of velocities, forces and overlaps, the energy split, the space-time strip, the difference."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pygame

from sandbox.draw.numbers import index
from sandbox.draw.palette import PAPER, STEEL, Colour, bead_colours, mix
from sandbox.draw.plots import Axis, decade_axis, linear_axis
from sandbox.draw.scales import Scales
from sandbox.draw.track import Array
from sandbox.session.history import History
from sandbox.session.lanes import LiveLane
from sandbox.window.plots import Plot, Source
from sandbox.window.records import Rows, at_frame, stretches
from sandbox.window.timespan import TimeSpan

KINDS = ("velocities", "forces", "overlaps", "energy", "strip", "difference")
CHIPS = {
    "velocities": "velocities",
    "forces": "forces",
    "overlaps": "overlaps",
    "energy": "energy",
    "strip": "space-time",
    "difference": "difference",
}
HEAT: tuple[Colour, ...] = (PAPER, (198, 222, 240), (86, 160, 211), (0, 94, 160), (10, 34, 82))
SHADES = 256


class StackPlot(Plot):
    """The energy split: the kinetic energy of each bead and what the contacts store, piled up."""

    marked = False

    def ink(self, first: int, last: int) -> pygame.Surface:
        """Piles in columns `first` to `last`."""
        height = self.area.height
        pixels = pygame.surfarray.array3d(self.sheet.ground)[:1].repeat(last - first, axis=0)
        table = np.array([*self.colours, PAPER], dtype=np.uint8)
        middles = np.arange(height) + 0.5
        for time, values in self.curves(first, last):
            tops = self.y(np.cumsum(values, axis=1))
            for column, row in _latest(time / self.span.column, first, last):
                layer = np.searchsorted(-tops[row], -middles)  # the first pile that reaches as high as the pixel
                inside = layer < values.shape[1]
                pixels[column - first, inside] = table[layer[inside]]
        return pygame.surfarray.make_surface(pixels)


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


def make_plot(
    kind: str,
    rect: pygame.Rect,
    unit: float,
    lanes: Sequence[LiveLane],
    number: int,
    scales: Scales,
    history: History,
    span: TimeSpan,
    logarithmic: bool,
) -> Plot:
    """The plot `kind` of lane `number`."""
    beads = lanes[number].chain.contacts + 1
    palette = bead_colours(beads)
    letter = {"velocities": "v", "overlaps": "δ"}.get(kind, "f")
    of_beads, of_contacts = (
        [letter + index(i) for i in range(beads)],
        [letter + index(i, i + 1) for i in range(beads - 1)],
    )
    what = (rect, unit, _title(kind, lanes, number), _axis(kind, scales, number, beads, logarithmic))
    if kind == "velocities":
        return Plot(*what, of_beads, palette, Source(history, number, _velocity), span)
    if kind == "difference" and number == 0:
        return DifferencePlot(
            *what, ["Δv" + index(i) for i in range(beads)], palette, Source(history, 0, _velocity), span
        )
    if kind == "difference":
        return DifferencePlot(
            *what, ["Δ" + name for name in of_contacts], palette[1:], Source(history, 0, _force), span
        )
    if kind == "energy":
        of_energy = [*("E" + index(i) for i in range(beads)), "stored"]
        return StackPlot(*what, of_energy, (*palette, STEEL), Source(history, number, lambda rows: rows.energies), span)
    if kind == "strip":
        return StripPlot(*what, of_contacts, palette[1:], Source(history, number, _force, scales.force), span)
    source = Source(history, number, _force if kind == "forces" else _overlap)
    return Plot(*what, of_contacts, palette[1:], source, span)


def _velocity(rows: Rows) -> Array:
    return rows.velocity


def _force(rows: Rows) -> Array:
    return rows.force


def _overlap(rows: Rows) -> Array:
    return rows.overlap


def _title(kind: str, lanes: Sequence[LiveLane], number: int) -> str:
    titles = {
        "velocities": "velocity (m/s)",
        "forces": "contact force (N)",
        "overlaps": "overlap (m)",
        "energy": "energy (J): beads, contacts grey",
        "strip": "contact forces, row by row",
        "difference": "second less first (m/s)" if number == 0 else "second less first (N)",
    }
    label = lanes[number].label
    return f"{titles[kind]} · {label}" if len(lanes) > 1 and label and kind != "difference" else titles[kind]


def _axis(kind: str, scales: Scales, number: int, beads: int, logarithmic: bool) -> Axis:
    if kind == "velocities":
        return linear_axis("", *scales.velocity)
    if kind == "difference":
        reach = 0.5 * (max(map(abs, scales.velocity)) if number == 0 else scales.force)
        return linear_axis("", -reach, reach)
    if kind == "forces":
        return linear_axis("", 0.0, scales.force)
    if kind == "energy":
        return linear_axis("", 0.0, 1.05 * scales.energy)
    if kind == "strip":
        step = max(1, (beads - 1 + 4) // 5)
        rows = range(0, beads - 1, step)
        return Axis("", float(beads - 1), 0.0, tuple((k + 0.5, index(k, k + 1)) for k in rows))
    if logarithmic:
        return decade_axis("", *scales.decades)
    deepest = max(max(one) for one in scales.deepest) or 1.0
    return linear_axis("", 0.0, 1.1 * deepest)
