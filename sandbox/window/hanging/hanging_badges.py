"""The badges of the hanging cradle: for each side what became of its energy, and what to do about it."""

from __future__ import annotations

from typing import NamedTuple

import pygame
from softcradle.sandbox.draw.number_format import fixed, scientific
from softcradle.sandbox.draw.palette import mix, tones
from softcradle.sandbox.draw.text import shortened, wrapped, write
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.session.badge_numbers import BAD, FAIR, GOOD
from softcradle.sandbox.window.hanging.hanging_cradle import CHAIN
from softcradle.sandbox.window.hanging.hanging_model import HangingModel

FAIR_CHANGE = 0.02  # of the energy, the largest that is good: less cannot be seen in the height of a swing
BAD_CHANGE = 0.10  # of the energy, the largest that is fair
HEIGHT, WITH_NUMBERS, LEAST_HEIGHT = 118.0, 88.0, 66.0  # design pixels of a badge: usual; least with numbers; without
GAP = 8.0  # design pixels between badges
NAMES = (N_("soft contacts"), N_("pymunk's rigid collisions"))
LOST = N_("{percent:.2g} % of the energy was lost; {remedy}")


class Verdict(NamedTuple):
    """Level, sentence, and the numbers that they follow from: change of the energy (a share), stretch of a string [m]."""

    level: str
    sentence: str
    change: float
    stretch: float


def verdict(model: HangingModel, side: int) -> Verdict:
    """How far a side can be trusted at the frame that is shown; side 0 is the soft one."""
    now = model.moment
    change, greatest = (now.share(side, energy[side]) - 1.0 for energy in (now.energies, now.greatest))
    stretch, tangled = now.stretches[side], now.tangled[side]
    worst = max(abs(change), greatest)
    level = GOOD if worst <= FAIR_CHANGE else FAIR if worst <= BAD_CHANGE else BAD
    if tangled is not None and level != BAD:
        text = _("balls {left} and {right} have passed each other: begin anew (R)", left=tangled, right=tangled + 1)
        return Verdict(BAD, text, change, stretch)
    if level == GOOD:
        return Verdict(level, _("the energy is kept to {percent:.2g} %", percent=100.0 * worst), change, stretch)
    remedy = _("strings lose it too: take more steps a second")
    if side == 0 and model.method != CHAIN:
        remedy = _("each spring is a step late: take {method}, or more steps a second", method=CHAIN)
    gained = greatest > abs(change) or change > 0.0
    text = N_("{percent:.2g} % of the energy was gained; {remedy}") if gained else LOST
    return Verdict(level, _(text, percent=100.0 * worst, remedy=remedy), change, stretch)


def paint_badge(surface: pygame.Surface, rect: pygame.Rect, unit: float, side: int, model: HangingModel) -> None:
    """Draw the badge of a side, in the look of the cards of a scene."""
    found = verdict(model, side)
    tint, x = getattr(tones, found.level), rect.left + 10 * unit
    pygame.draw.rect(surface, mix(tones.background, tint, 0.16 if found.level == BAD else 0.05), rect, border_radius=6)
    border = tones.faint if found.level == GOOD else tint
    pygame.draw.rect(surface, border, rect, max(1, round(1.5 * unit)), border_radius=6)
    room = rect.width - 20 * unit
    title = shortened(_(NAMES[side]), 14 * unit, room, bold=True)
    write(surface, title, (x, rect.top + 9 * unit), 14 * unit, tones.foreground, bold=True)
    y = rect.top + 32 * unit
    if rect.height >= round(WITH_NUMBERS * unit):
        _paint_numbers(surface, rect, y, unit, found)
        y += 38 * unit
    mark = "✓" if found.level == GOOD else "!"
    write(surface, mark, (x, y), 13 * unit, tint, bold=True)
    lines = wrapped(found.sentence, 12 * unit, room - 14 * unit)
    most = max(1, int((rect.bottom - y - 2 * unit) // (15 * unit)))
    for row, line in enumerate(lines[:most]):
        shown = shortened(f"{line} …", 12 * unit, room - 14 * unit) if row == most - 1 < len(lines) - 1 else line
        write(surface, shown, (x + 15 * unit, y + 15 * row * unit), 12 * unit, tint)


def badge_places(room: pygame.Rect, unit: float) -> list[pygame.Rect]:
    """Places of the two badges at the top of a part of the panel, as high as it has room for."""
    gap = round(GAP * unit)
    high = min(round(HEIGHT * unit), max(round(LEAST_HEIGHT * unit), (room.height - gap) // 2))
    return [pygame.Rect(room.left, room.top + side * (high + gap), room.width, high) for side in (0, 1)]


def _paint_numbers(surface: pygame.Surface, rect: pygame.Rect, top: float, unit: float, found: Verdict) -> None:
    change = f"{fixed(100.0 * found.change, 2)} %"
    numbers = ((_("energy"), change), (_("strings stretched"), f"{scientific(found.stretch, 1)} m"))
    for row, (name, text) in enumerate(numbers):
        x, y = rect.left + 10 * unit, top + 17 * row * unit
        write(surface, name, (x, y), 12.5 * unit, tones.muted)
        write(surface, text, (rect.right - 10 * unit, y), 12.5 * unit, tones.foreground, align=(1, 0))
