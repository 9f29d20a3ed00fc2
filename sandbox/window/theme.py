"""The theme of the widgets: the project's font, the tones in use, every length scaled; and their clean-up."""

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
    """Free what nothing refers to; the rest is not searched again in the middle of play.

    Python's own collection would come minutes and some 100 MB later, and it never searches frozen objects.
    """
    gc.unfreeze()
    gc.collect()
    gc.freeze()
    _trim_heap()


def _trim_heap() -> None:
    """Return holes in the heap to the system: surfaces of many sizes leave some 50 MB of them in an hour.

    Only glibc has a function for it; other systems do without.
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
SMALLEST_FONT = 6  # pixels
TRANSPARENT = "#ffffff00"


@lru_cache(maxsize=1)
def _theme() -> dict[str, Any]:
    theme: dict[str, Any] = json.loads(resource("theme.json").read_text(encoding="utf-8"))
    return theme


def manager(size: tuple[int, int], unit: float) -> pygame_gui.UIManager:
    """An empty manager of widgets for a window of `size`; `unit` is how many pixels a pixel of the design is."""
    created = pygame_gui.UIManager(size, enable_live_theme_updates=False, starting_language=language())
    set_default_manager(created)  # pygame_gui would hold the first one, with all its widgets, for ever
    regular, bold = str(resource("Inter-Regular.otf")), str(resource("Inter-SemiBold.otf"))
    created.add_font_paths("inter", regular, bold, regular, bold)
    created.get_theme().load_theme({name: _scaled(block, unit) for name, block in _theme().items()})
    return created


def _scaled(block: dict[str, Any], unit: float) -> dict[str, Any]:
    """A block of the theme with scaled lengths."""
    scaled = {key: dict(value) for key, value in block.items()}
    for key, value in scaled.get("colours", {}).items():
        scaled["colours"][key] = colour_code(value)
    if "font" in scaled:
        scaled["font"]["size"] = str(max(SMALLEST_FONT, round(scaled["font"]["size"] * unit)))
    for key, value in scaled.get("misc", {}).items():
        scaled["misc"][key] = str(round(value * unit) if key in _LENGTHS else value)
    return scaled


def colour_code(text: str) -> str:
    """The code of a colour: the name of a tone, or two with the per cent of the second in the first: "grid 20 accent"."""
    if text == "none":
        return TRANSPARENT
    first, *more = text.split()
    colour = getattr(tones, first)
    if more:
        colour = mix(colour, getattr(tones, more[1]), int(more[0]) / 100.0)
    return "#{:02x}{:02x}{:02x}".format(*colour)
