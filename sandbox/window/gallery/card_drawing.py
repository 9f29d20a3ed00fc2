"""The drawing of a card of the gallery: its caption and its border."""

from __future__ import annotations

import pygame
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import shortened, wrapped, write

HOVERED_OPACITY = 24  # of 255, of the tint of the card under the pointer
PRESSED_OPACITY = 48  # of 255, of the same card while the button is down


def paint_caption(surface: pygame.Surface, caption: tuple[str, str, str], picture: pygame.Rect, unit: float) -> None:
    """Title, the first two lines of the text, and source, below the `picture`."""
    (title, text, source), room = caption, picture.width - 20 * unit
    x, y = picture.left + 10 * unit, picture.bottom + 7 * unit
    write(surface, shortened(title, 15 * unit, room, bold=True), (x, y), 15 * unit, tones.foreground, bold=True)
    lines = wrapped(text, 12 * unit, room)
    for row, line in enumerate(lines[:2]):
        more = row == 1 and len(lines) > 2
        shown = shortened(f"{line} …" if more else line, 12 * unit, room)
        write(surface, shown, (x, y + (21 + 16 * row) * unit), 12 * unit, tones.muted)
    write(surface, shortened(source, 11.5 * unit, room), (x, y + 54 * unit), 11.5 * unit, tones.muted)


def paint_border(surface: pygame.Surface, place: pygame.Rect, hovered: bool, pressed: bool) -> None:
    """The border, and a tint under the pointer; widgets for it took 100 MB, and a third of a second to make."""
    if hovered:
        tint = pygame.Surface(place.size, pygame.SRCALPHA, 32)
        tint.fill((*tones.accent, PRESSED_OPACITY if pressed else HOVERED_OPACITY))
        surface.blit(tint, place)
    pygame.draw.rect(surface, tones.accent if hovered else tones.faint, place, 1)
