"""Who has the energy and the momentum: two slim bars whose full length must not change, and how well it does not."""

from __future__ import annotations

import pygame
from softcradle.sandbox.draw.number_format import scientific
from softcradle.sandbox.draw.palette import FOREGROUND, GOOD, GRID, MUTED, STEEL, WARNING, Colour
from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.draw.supersampling import fill_rectangle
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.motion import Array, Motion

HOLDS = 1e-3  # relative error up to which the badge is green: what one pixel of the bars could show
TITLES = (
    ("energy: motion of each bead, stored in contacts", "energy, stored in contacts", "energy"),
    ("momentum of each bead; marks: zero and total", "momentum; marks: zero, total", "momentum"),
)


class EnergyBars:
    """Energy bar, momentum bar and, unless they are shown elsewhere, error badges of one lane."""

    def __init__(
        self, rect: pygame.Rect, unit: float, colours: tuple[Colour, ...], scales: Scales, badges: bool = True
    ) -> None:
        self.unit, self.colours, self.scales, self.badged = unit, colours, scales, badges
        third = (rect.width - 2 * 22 * unit) / 3 if badges else (rect.width - 22 * unit) / 2
        self.bars = [
            pygame.Rect(
                round(rect.left + k * (third + 22 * unit)),
                round(rect.bottom - 15 * unit),
                round(third),
                round(11 * unit),
            )
            for k in range(2)
        ]
        self.badges = pygame.Rect(round(rect.right - third), rect.top, round(third), rect.height)
        low, high = scales.momentum
        self.zero = self.bars[1].left - low / (high - low) * self.bars[1].width

    def backdrop(self, surface: pygame.Surface) -> None:
        """Names and empty bars."""
        unit = self.unit
        for rect, titles in zip(self.bars, TITLES, strict=True):
            surface.fill(GRID, rect)
            fitting = [title for title in titles if width(title, 12.5 * unit) < rect.width - 14 * unit] or [""]
            end = write(surface, fitting[0], (rect.left, rect.top - 3 * unit), 12.5 * unit, MUTED, align=(0, 1)).right
            if fitting[0].endswith("contacts"):
                fill_rectangle(surface, STEEL, (end + 4 * unit, rect.top - 14 * unit, 9 * unit, 9 * unit))

    def paint(self, surface: pygame.Surface, track: Motion, row: int) -> None:
        """Draw the shares and errors at row `row` of `track`."""
        absorbed = float(track.absorbed[row]) if track.absorbed.size else 0.0
        self._energy(surface, track.kinetic[row], float(track.stored[row]), absorbed)
        self._momentum(surface, track.momentum[row])
        if not self.badged:
            return
        errors = (("energy error", track.energy_error[row]), ("momentum error", track.momentum_error[row]))
        takers = track.chain.walls or track.chain.friction  # of momentum
        for k, (name, error) in enumerate(errors[:1] if takers else errors):
            self._badge(surface, k, name, float(error))

    def _energy(self, surface: pygame.Surface, kinetic: Array, stored: float, absorbed: float) -> None:
        """What moves, what contacts hold, and behind it, muted, what gears and bed have absorbed."""
        rect, x = self.bars[0], float(self.bars[0].left)
        for value, colour in zip((*kinetic.tolist(), stored, absorbed), (*self.colours, STEEL, MUTED), strict=True):
            wide = value / self.scales.energy * rect.width
            fill_rectangle(surface, colour, (x, rect.top, wide, rect.height))
            x += wide

    def _momentum(self, surface: pygame.Surface, momentum: Array) -> None:
        """EnergyBars to the right lie right of the zero mark, those to the left lie left of it."""
        rect, (low, high) = self.bars[1], self.scales.momentum
        ends = [self.zero, self.zero]
        for value, colour in zip(momentum.tolist(), self.colours, strict=True):
            wide = value / (high - low) * rect.width
            side = 1 if wide > 0 else 0
            fill_rectangle(surface, colour, (min(ends[side], ends[side] + wide), rect.top, abs(wide), rect.height))
            ends[side] += wide
        total = self.zero + float(momentum.sum()) / (high - low) * rect.width
        wide, high = 1.5 * self.unit, rect.height + 6 * self.unit
        for x, colour in ((self.zero, MUTED), (total, FOREGROUND)):
            fill_rectangle(surface, colour, (x - wide / 2, rect.top - 3 * self.unit, wide, high))

    def _badge(self, surface: pygame.Surface, line: int, name: str, error: float) -> None:
        unit, good = self.unit, error <= HOLDS
        y = self.badges.top + (6 + 17 * line) * unit
        text = f"{name}  {scientific(error) if error >= 1e-17 else '0'}"
        place = write(
            surface,
            text,
            (self.badges.right, y),
            12.5 * unit,
            FOREGROUND if good else WARNING,
            bold=not good,
            align=(1, 0),
        )
        mark = "✓" if good else "!"
        write(
            surface, mark, (place.left - 6 * unit, y), 12.5 * unit, GOOD if good else WARNING, bold=True, align=(1, 0)
        )
