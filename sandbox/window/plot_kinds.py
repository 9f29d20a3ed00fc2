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
        for time, values in self.curves(first, last):
            columns = np.floor(time / self.span.column).astype(int) - first
            tops = self.y(np.cumsum(values, axis=1))
            held = np.flatnonzero((columns >= 0) & (columns < last - first))
            filled = np.unique(columns[held], return_index=True)
            ends = [*filled[0][1:], last - first]
            for column, row, end in zip(filled[0], held[filled[1]], ends, strict=True):
                until = column + 1 if end == last - first and row != len(time) - 1 else end
                layer = np.searchsorted(-tops[row], -np.arange(height, dtype=float) - 0.5, side="left")
                inside = layer < values.shape[1]
                pixels[column:until, inside] = table[layer[inside]]
        return pygame.surfarray.make_surface(pixels)


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
    """Velocities of the second lane less those of the first, bead by bead."""

    def curves(self, first: int, last: int) -> list[tuple[Array, Array]]:
        """See `Plot.curves`."""
        frames = self.frames(first, last)
        lanes = [list(stretches(self.source.history, lane, *frames)) for lane in (0, 1)]
        return [(a.time, b.velocity - a.velocity) for a, b in zip(*lanes, strict=True) if comparable(a, b)]

    def now(self, frame: int) -> Array:
        """See `Plot.now`."""
        a, b = (at_frame(self.source.history, lane, frame) for lane in (0, 1))
        return (b.velocity - a.velocity)[0] if comparable(a, b) else np.zeros(0)


def comparable(a: Rows, b: Rows) -> bool:
    """Whether two lanes have as many beads."""
    return a.velocity.shape == b.velocity.shape


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
    letter = {"velocities": "v", "forces": "f", "overlaps": "δ", "difference": "Δv"}.get(kind, "f")
    of_beads, of_contacts = [letter + index(i) for i in range(beads)], [letter + index(i, i + 1) for i in range(beads - 1)]
    what = (rect, unit, _title(kind, lanes, number), _axis(kind, scales, number, beads, logarithmic))
    if kind in ("velocities", "difference"):
        made = Plot if kind == "velocities" else DifferencePlot
        return made(*what, of_beads, palette, Source(history, number, lambda rows: rows.velocity), span)
    if kind == "energy":
        of_energy = [*("E" + index(i) for i in range(beads)), "stored"]
        return StackPlot(*what, of_energy, (*palette, STEEL), Source(history, number, lambda rows: rows.energies), span)
    if kind == "strip":
        return StripPlot(*what, of_contacts, palette[1:], Source(history, number, lambda rows: rows.force, scales.force), span)
    source = Source(history, number, (lambda r: r.force) if kind == "forces" else (lambda r: r.overlap))
    return Plot(*what, of_contacts, palette[1:], source, span)


def _title(kind: str, lanes: Sequence[LiveLane], number: int) -> str:
    titles = {
        "velocities": "velocity (m/s)",
        "forces": "contact force (N)",
        "overlaps": "overlap (m)",
        "energy": "energy (J): beads, contacts grey",
        "strip": "contact forces, row by row",
        "difference": "velocity, second lane less first (m/s)",
    }
    label = lanes[number].label
    return f"{titles[kind]} · {label}" if len(lanes) > 1 and label and kind != "difference" else titles[kind]


def _axis(kind: str, scales: Scales, number: int, beads: int, logarithmic: bool) -> Axis:
    if kind == "velocities":
        return linear_axis("", *scales.velocity)
    if kind == "difference":
        reach = max(map(abs, scales.velocity)) * 0.5
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
