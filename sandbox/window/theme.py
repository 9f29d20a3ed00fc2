"""The theme of the widgets: font, colours of the current palette and scaled lengths. It also frees memory of old
widgets.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import json
from functools import lru_cache
from typing import Any

import pygame_gui
from pygame_gui.core.utility import set_default_manager
from softcradle.sandbox.draw.palette import mix, tones
from softcradle.sandbox.files import resource
from softcradle.sandbox.languages import language


def collect_garbage() -> None:
    """Free unreachable objects now. Exclude all other objects from later collections, which would interrupt the motion.

    Without this call, Python would free the objects minutes and about 100 MB later. Python never examines excluded
    objects.
    """
    gc.unfreeze()
    gc.collect()
    gc.freeze()
    _trim_heap()


def _trim_heap() -> None:
    """Return free parts of the heap to the operating system. Surfaces of many sizes leave about 50 MB of free parts per
    hour.

    Only glibc has a function for this purpose. On other systems nothing happens.
    """
    with contextlib.suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).malloc_trim(0)


_LENGTHS = (
    "shape_corner_radius",
    "sliding_button_width",
    "list_item_height",
    "open_button_width",
    "rect_width",
    "text_horiz_alignment_padding",
)
SMALLEST_FONT = 6  # Smallest font size in pixels.
TRANSPARENT = "#ffffff00"


@lru_cache(maxsize=1)
def _theme() -> dict[str, Any]:
    theme: dict[str, Any] = json.loads(resource("theme.json").read_text(encoding="utf-8"))
    return theme


def manager(size: tuple[int, int], unit: float) -> pygame_gui.UIManager:
    """Return an empty widget manager for a window of `size`. `unit` is the number of pixels per design pixel."""
    created = pygame_gui.UIManager(size, enable_live_theme_updates=False, starting_language=language())
    # Replace the default manager. Otherwise pygame_gui would keep the first manager and all its widgets for ever.
    set_default_manager(created)
    regular, bold = str(resource("Inter-Regular.otf")), str(resource("Inter-SemiBold.otf"))
    created.add_font_paths("inter", regular, bold, regular, bold)
    created.get_theme().load_theme({name: _scaled(block, unit) for name, block in _theme().items()})
    return created


def _scaled(block: dict[str, Any], unit: float) -> dict[str, Any]:
    """Return `block`, a part of the theme, with scaled lengths."""
    scaled = {key: dict(value) for key, value in block.items()}
    for key, value in scaled.get("colours", {}).items():
        scaled["colours"][key] = colour_code(value)
    if "font" in scaled:
        scaled["font"]["size"] = str(max(SMALLEST_FONT, round(scaled["font"]["size"] * unit)))
    for key, value in scaled.get("misc", {}).items():
        scaled["misc"][key] = str(round(value * unit) if key in _LENGTHS else value)
    return scaled


def colour_code(text: str) -> str:
    """Return the hexadecimal code of a colour.

    `text` is the name of a colour in the palette, or a mixture. For example, "grid 20 accent" is grid with 20 % of
    accent.
    """
    if text == "none":
        return TRANSPARENT
    first, *more = text.split()
    colour = getattr(tones, first)
    if more:
        colour = mix(colour, getattr(tones, more[1]), int(more[0]) / 100.0)
    return "#{:02x}{:02x}{:02x}".format(*colour)
