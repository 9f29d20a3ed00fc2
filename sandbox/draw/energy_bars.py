"""Bars of energy and momentum that show the part of each bead. Badges show the errors of the total energy and the total
momentum.
"""

import math
from collections.abc import Sequence

import pygame
from softcradle.sandbox.draw.palette import Colour, tones
from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.draw.supersampling import fill_rectangle
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.story.numbers import scientific
from softcradle.sandbox.story.verdict import GOOD, level_of

# Possible titles of the energy bar and of the momentum bar, starting with the longest. The longest title that fits is
# used.
ENERGY_TITLES = (N_("energy: motion of each bead, stored in contacts"), N_("energy, stored in contacts"), N_("energy"))
ABSORBED = N_("absorbed")  # Name of the energy that the friction bed and contacts with loss absorb.
KEY_WIDTH = 14.0  # Width of the space for the coloured square that follows a word of a title [design pixels].
WORDS_APART = 10.0  # Distance between two words of a title [design pixels].
MOMENTUM_TITLES = (
    N_("momentum of each bead; marks: zero and total"),
    N_("momentum; marks: zero, total"),
    N_("momentum"),
)

# Parts of a title. Each part consists of a word and its colour in the bar, or None for a word without a colour.
Words = Sequence[tuple[str, Colour | None]]


class EnergyBars:
    """Energy bar and momentum bar of one lane, with optional error badges.

    Arguments:
        rect: rectangle of the bars and badges [pixels].
        unit: pixels per design pixel.
        colours: colours of the beads.
        dissipative: True if contacts or the bed absorb energy.
        scales: common scales of all lanes.
        badges: True if the errors are shown.
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
        # Horizontal position of zero momentum [pixels].
        self.zero = self.bars[1].left - low / (high - low) * self.bars[1].width

    def backdrop(self, surface: pygame.Surface) -> None:
        """Draw the titles and the empty bars."""
        momentum: list[Words] = [[(_(title), None)] for title in MOMENTUM_TITLES]
        for rect, titles in zip(self.bars, (self._energy_titles(), momentum), strict=True):
            surface.fill(tones.grid, rect)
            fitting = [title for title in titles if self._room(title) < rect.width]
            self._title(surface, rect, fitting[0] if fitting else [])

    def _energy_titles(self) -> list[Words]:
        """Return the possible titles of the energy bar, starting with the longest. A title explains either all grey
        parts of the bar or none of them.
        """
        *long, bare = ENERGY_TITLES
        absorbed = [(_(ABSORBED), tones.muted)] if self.dissipative else []
        titles: list[Words] = [[(_(title), tones.steel), *absorbed] for title in long]
        return [*titles, [(_(bare), None)]]

    def _room(self, title: Words) -> float:
        """Return the width [pixels] that a title needs."""
        keys = sum(KEY_WIDTH for _word, colour in title if colour is not None)
        words = sum(width(word, 13 * self.unit) for word, _colour in title)
        return words + (keys + WORDS_APART * (len(title) - 1)) * self.unit

    def _title(self, surface: pygame.Surface, rect: pygame.Rect, title: Words) -> None:
        """Write the words of a title above a bar. Draw a square after each word that has a colour in the bar."""
        unit, x = self.unit, float(rect.left)
        for word, colour in title:
            x = write(surface, word, (x, rect.top - 3 * unit), 13 * unit, tones.muted, align=(0, 1)).right
            if colour is not None:
                fill_rectangle(surface, colour, (x + 4 * unit, rect.top - 14 * unit, 9 * unit, 9 * unit))
                x += KEY_WIDTH * unit
            x += WORDS_APART * unit

    def paint(self, surface: pygame.Surface, motion: Motion, row: int) -> None:
        """Draw the energy, the momentum and their errors for the sample `row` of `motion`."""
        absorbed = float(motion.absorbed[row]) if motion.absorbed.size else 0.0
        self._energy(surface, motion.kinetic[row], float(motion.stored[row]), absorbed)
        self._momentum(surface, motion.momentum[row])
        if not self.has_badges:
            return
        if math.isfinite(motion.energy_error[row]):
            self._badge(surface, 0, _("energy error"), float(motion.energy_error[row]))
        if not (motion.chain.walls or motion.chain.takes_momentum):  # Walls also exchange momentum with the beads.
            self._badge(surface, 1, _("momentum error"), float(motion.momentum_error[row]))

    def _energy(self, surface: pygame.Surface, kinetic: Array, stored: float, absorbed: float) -> None:
        """Draw the parts of the energy bar. From left to right, they are the kinetic energy of each bead, the energy
        stored in contacts and the absorbed energy.
        """
        rect, x = self.bars[0], float(self.bars[0].left)
        for value, colour in zip(
            (*kinetic.tolist(), stored, absorbed), (*self.colours, tones.steel, tones.muted), strict=True
        ):
            wide = value / self.scales.energy * rect.width
            fill_rectangle(surface, colour, (x, rect.top, wide, rect.height))
            x += wide

    def _momentum(self, surface: pygame.Surface, momentum: Array) -> None:
        """Draw the momentum of each bead. Positive momenta are to the right of zero, negative momenta to the left."""
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
