"""The help overlay: the table of keys, and what the mouse does, over a dimmed page."""

from __future__ import annotations

import pygame
from softcradle.sandbox.draw.palette import BACKGROUND, FAINT, FOREGROUND, LANE_BACKGROUND, MUTED
from softcradle.sandbox.draw.text import width, write
from softcradle.sandbox.window.keys import Binding, groups

LINE = 21.0  # design pixels
TITLE = 27.0  # design pixels
MOUSE = (
    ("drag a bead", "pull it by a spring; release to throw"),
    ("drag it, paused", "place it"),
    ("click", "select a bead or a contact"),
    ("wheel", "slow motion, over the beads"),
    ("drag the timeline", "scrub; playing on starts a new branch"),
    ("over a plot", "read values at the cursor"),
    ("drop a file", "open a scene or a session"),
)
COLUMNS = (("Time", "Mouse"), ("Beads", "Window"), ("Plots", "View", "Save"))


def paint_help(surface: pygame.Surface, unit: float) -> None:
    """Draw the overlay over all of `surface`."""
    size = surface.get_size()
    shade = pygame.Surface(size)
    shade.fill(FOREGROUND)
    shade.set_alpha(130)
    surface.blit(shade, (0, 0))
    blocks = {name: [(_keys(b), b.text) for b in bindings] for name, bindings in groups().items()}
    blocks["Mouse"] = list(MOUSE)
    rows = max(sum(len(blocks[name]) * LINE + TITLE + 10 for name in column) for column in COLUMNS)
    unit = min(unit, size[1] / (rows + 100), size[0] / 1230)
    board = pygame.Rect(0, 0, round(1190 * unit), round((rows + 78) * unit))
    board.center = (size[0] // 2, size[1] // 2)
    pygame.draw.rect(surface, BACKGROUND, board, border_radius=round(10 * unit))
    write(surface, "Keys and mouse", (board.left + 26 * unit, board.top + 16 * unit), 22 * unit, FOREGROUND, bold=True)
    place = (board.right - 26 * unit, board.top + 22 * unit)
    write(surface, "Esc or a click closes this", place, 13.5 * unit, MUTED, align=(1, 0))
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
    write(surface, name, (x, y), 15 * unit, FOREGROUND, bold=True)
    surface.fill(FAINT, (round(x), round(y + 21 * unit), round(362 * unit), max(1, round(unit))))
    y += TITLE * unit
    for keys, text in rows:
        _cap(surface, keys, (x, y), unit)
        write(surface, text, (x + 128 * unit, y + 1 * unit), 13 * unit, FOREGROUND)
        y += LINE * unit
    return y + 10 * unit


def _cap(surface: pygame.Surface, keys: str, place: tuple[float, float], unit: float) -> None:
    """Keys, each on a small plate."""
    x, y = place
    for text in keys.split("  "):
        wide = width(text, 12 * unit, bold=True) + 10 * unit
        plate = pygame.Rect(round(x), round(y), round(wide), round(18 * unit))
        pygame.draw.rect(surface, LANE_BACKGROUND, plate, border_radius=round(4 * unit))
        pygame.draw.rect(surface, FAINT, plate, 1, border_radius=round(4 * unit))
        write(surface, text, plate.center, 12 * unit, FOREGROUND, bold=True, align=(0.5, 0.5))
        x += wide + 4 * unit
