"""The help overlay: the table of keys, and what the mouse does, over a dimmed page."""

from __future__ import annotations

import pygame
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.window.keys import Binding, groups

LINE = 21.0  # design pixels
KEYS = 126.0  # design pixels of the keys
COLUMN = 362.0  # design pixels
TITLE = 27.0  # design pixels
MOUSE = (
    (N_("drag a bead"), N_("pull it by a spring; release to throw")),
    (N_("drag it, paused"), N_("place it")),
    (N_("click"), N_("select a bead or a contact")),
    (N_("wheel"), N_("zoom, over the beads")),
    (N_("drag beside beads"), N_("move the view; F frames all beads")),
    (N_("drag the timeline"), N_("scrub; playing on starts a new branch")),
    (N_("over a plot"), N_("read values at the cursor")),
    (N_("drop a file"), N_("open it; a table or a picture: over a plot")),
)
COLUMNS = (
    (N_("Time"), N_("Mouse"), N_("Save")),
    (N_("Beads"), N_("Window"), N_("View")),
    (N_("Plots"), N_("Tools")),
)


def paint_help(surface: pygame.Surface, unit: float) -> None:
    """Draw the overlay over all of `surface`."""
    size = surface.get_size()
    shade = pygame.Surface(size)
    shade.fill(tones.shadow)
    shade.set_alpha(130)
    surface.blit(shade, (0, 0))
    blocks = {name: [(_keys(b), _(b.text)) for b in bindings] for name, bindings in groups().items()}
    blocks["Mouse"] = [(_(what), _(text)) for what, text in MOUSE]
    rows = max(sum(len(blocks[name]) * LINE + TITLE + 10 for name in column) for column in COLUMNS)
    unit = min(unit, size[1] / (rows + 100), size[0] / 1230)
    board = pygame.Rect(0, 0, round(1190 * unit), round((rows + 78) * unit))
    board.center = (size[0] // 2, size[1] // 2)
    pygame.draw.rect(surface, tones.background, board, border_radius=round(10 * unit))
    write(
        surface,
        _("Keys and mouse"),
        (board.left + 26 * unit, board.top + 16 * unit),
        22 * unit,
        tones.foreground,
        bold=True,
    )
    place = (board.right - 26 * unit, board.top + 22 * unit)
    write(surface, _("Esc or a click closes this"), place, 13.5 * unit, tones.muted, align=(1, 0))
    for k, column in enumerate(COLUMNS):
        x, y = board.left + (26 + k * 388) * unit, board.top + 58 * unit
        for name in column:
            y = _block(surface, name, blocks[name], (x, y), unit)


def _keys(binding: Binding) -> str:
    return "  ".join(str(key) for key in binding.keys)


def _block(
    surface: pygame.Surface, name: str, rows: list[tuple[str, str]], place: tuple[float, float], unit: float
) -> float:
    """Draw one group; returns where the next begins."""
    x, y = place
    write(surface, _(name), (x, y), 15 * unit, tones.foreground, bold=True)
    surface.fill(tones.faint, (round(x), round(y + 21 * unit), round(COLUMN * unit), max(1, round(unit))))
    y += TITLE * unit
    for keys, text in rows:
        _cap(surface, keys, (x, y), unit)
        write(surface, text, (x + (KEYS + 2) * unit, y + 1 * unit), 13 * unit, tones.foreground)
        y += LINE * unit
    return y + 10 * unit


def _cap(surface: pygame.Surface, keys: str, place: tuple[float, float], unit: float) -> None:
    """Keys, each on a small plate."""
    x, y = place
    for text in keys.split("  "):
        wide = width(text, 12 * unit, bold=True) + 10 * unit
        if x + wide > place[0] + KEYS * unit and x > place[0]:
            return  # no room for another key that does the same
        plate = pygame.Rect(round(x), round(y), round(wide), round(18 * unit))
        pygame.draw.rect(surface, tones.lane_background, plate, border_radius=round(4 * unit))
        pygame.draw.rect(surface, tones.faint, plate, 1, border_radius=round(4 * unit))
        write(surface, text, plate.center, 12 * unit, tones.foreground, bold=True, align=(0.5, 0.5))
        x += wide + 4 * unit
