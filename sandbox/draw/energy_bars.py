"""The bars of energy and momentum: each bead's part, a total that must not change, and the errors of both as badges."""

import math
from collections.abc import Sequence

import pygame
from softcradle.sandbox.draw.number_format import scientific
from softcradle.sandbox.draw.palette import Colour, tones
from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.draw.supersampling import fill_rectangle
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.motion import GOOD, Array, Motion, level_of

# Titles of the energy bar, of which the longest that fits is written with a key of its greys, and those of the momentum bar.
ENERGY_TITLES = (N_("energy: motion of each bead, stored in contacts"), N_("energy, stored in contacts"), N_("energy"))
ABSORBED = N_("absorbed")  # by contacts with loss and by the bed
KEY_WIDTH = 14.0  # design pixels of a colour behind its word
WORDS_APART = 10.0  # design pixels
MOMENTUM_TITLES = (
    N_("momentum of each bead; marks: zero and total"),
    N_("momentum; marks: zero, total"),
    N_("momentum"),
)

Words = Sequence[tuple[str, Colour | None]]  # parts of a title, and the colour in the bar that each names


class EnergyBars:
    """Energy bar, momentum bar and, unless they are shown elsewhere, error badges of one lane.

    Arguments:
        rect: where they are drawn.
        unit: pixels of a design pixel.
        colours: of the beads.
        dissipative: whether contacts or the bed absorb energy.
        scales: the scales of all lanes.
        badges: whether the errors are shown.
    """

    def __init__(
        self,
        rect: pygame.Rect,
        unit: float,
        colours: tuple[Colour, ...],
        dissipative: bool,
        scales: Scales,
        badges: bool = True,
    ) -> None:
        self.unit, self.colours, self.dissipative = unit, colours, dissipative
        self.scales, self.has_badges = scales, badges
        gap = 22 * unit
        wide = (rect.width - 2 * gap) / 3 if badges else (rect.width - gap) / 2
        top, height = round(rect.bottom - 15 * unit), round(11 * unit)
        self.bars = [pygame.Rect(round(rect.left + k * (wide + gap)), top, round(wide), height) for k in range(2)]
        self.badges = pygame.Rect(round(rect.right - wide), rect.top, round(wide), rect.height)
        low, high = scales.momentum
        self.zero = self.bars[1].left - low / (high - low) * self.bars[1].width  # pixel of momentum 0

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw titles and empty bars."""
        momentum: list[Words] = [[(_(title), None)] for title in MOMENTUM_TITLES]
        for rect, titles in zip(self.bars, (self._energy_titles(), momentum), strict=True):
            surface.fill(tones.grid, rect)
            fitting = [title for title in titles if self._room(title) < rect.width]
            self._title(surface, rect, fitting[0] if fitting else [])

    def _energy_titles(self) -> list[Words]:
        """The longest first; a grey has a name in all of them, or in none."""
        *long, bare = ENERGY_TITLES
        absorbed = [(_(ABSORBED), tones.muted)] if self.dissipative else []
        titles: list[Words] = [[(_(title), tones.steel), *absorbed] for title in long]
        return [*titles, [(_(bare), None)]]

    def _room(self, title: Words) -> float:
        """Pixels that a title needs."""
        keys = sum(KEY_WIDTH for _word, colour in title if colour is not None)
        words = sum(width(word, 13 * self.unit) for word, _colour in title)
        return words + (keys + WORDS_APART * (len(title) - 1)) * self.unit

    def _title(self, surface: pygame.Surface, rect: pygame.Rect, title: Words) -> None:
        """Write the words above a bar, behind each the colour that it names."""
        unit, x = self.unit, float(rect.left)
        for word, colour in title:
            x = write(surface, word, (x, rect.top - 3 * unit), 13 * unit, tones.muted, align=(0, 1)).right
            if colour is not None:
                fill_rectangle(surface, colour, (x + 4 * unit, rect.top - 14 * unit, 9 * unit, 9 * unit))
                x += KEY_WIDTH * unit
            x += WORDS_APART * unit

    def paint(self, surface: pygame.Surface, motion: Motion, row: int) -> None:
        """Draw energy, momentum and errors at row `row` of `motion`."""
        absorbed = float(motion.absorbed[row]) if motion.absorbed.size else 0.0
        self._energy(surface, motion.kinetic[row], float(motion.stored[row]), absorbed)
        self._momentum(surface, motion.momentum[row])
        if not self.has_badges:
            return
        if math.isfinite(motion.energy_error[row]):
            self._badge(surface, 0, _("energy error"), float(motion.energy_error[row]))
        if not (motion.chain.walls or motion.chain.on_bed):  # walls and the bed take momentum
            self._badge(surface, 1, _("momentum error"), float(motion.momentum_error[row]))

    def _energy(self, surface: pygame.Surface, kinetic: Array, stored: float, absorbed: float) -> None:
        """From left to right: kinetic energies of the beads, energy stored in contacts, energy absorbed by gears and bed."""
        rect, x = self.bars[0], float(self.bars[0].left)
        for value, colour in zip(
            (*kinetic.tolist(), stored, absorbed), (*self.colours, tones.steel, tones.muted), strict=True
        ):
            wide = value / self.scales.energy * rect.width
            fill_rectangle(surface, colour, (x, rect.top, wide, rect.height))
            x += wide

    def _momentum(self, surface: pygame.Surface, momentum: Array) -> None:
        """Momenta to the right are drawn to the right of zero, those to the left to the left of it."""
        rect, (low, high) = self.bars[1], self.scales.momentum
        ends = [self.zero, self.zero]
        for value, colour in zip(momentum.tolist(), self.colours, strict=True):
            wide = value / (high - low) * rect.width
            side = 1 if wide > 0 else 0
            fill_rectangle(surface, colour, (min(ends[side], ends[side] + wide), rect.top, abs(wide), rect.height))
            ends[side] += wide
        total = self.zero + float(momentum.sum()) / (high - low) * rect.width
        wide, high = 1.5 * self.unit, rect.height + 6 * self.unit
        for x, colour in ((self.zero, tones.muted), (total, tones.foreground)):
            fill_rectangle(surface, colour, (x - wide / 2, rect.top - 3 * self.unit, wide, high))

    def _badge(self, surface: pygame.Surface, line: int, name: str, error: float) -> None:
        unit, good, size = self.unit, level_of(error) == GOOD, 13 * self.unit
        y = self.badges.top + (6 + 17 * line) * unit
        text = f"{name}  {scientific(error) if error >= 1e-17 else '0'}"
        colour = tones.foreground if good else tones.warning
        place = write(surface, text, (self.badges.right, y), size, colour, bold=not good, align=(1, 0))
        mark, colour = ("✓", tones.good) if good else ("!", tones.warning)
        write(surface, mark, (place.left - 6 * unit, y), size, colour, bold=True, align=(1, 0))
