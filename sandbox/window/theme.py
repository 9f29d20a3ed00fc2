"""The look of the widgets: assets/theme.json with the project's font put in and every length scaled."""

from __future__ import annotations

import json
from functools import lru_cache
from typing import Any

import pygame_gui
from pygame_gui.core.utility import set_default_manager
from softcradle.sandbox.resources import resource

_LENGTHS = (
    "shape_corner_radius",
    "sliding_button_width",
    "list_item_height",
    "rect_width",
    "text_horiz_alignment_padding",
)


@lru_cache(maxsize=1)
def _theme() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(resource("theme.json").read_text(encoding="utf-8"))
    return found


def manager(size: tuple[int, int], unit: float) -> pygame_gui.UIManager:
    """An empty manager of widgets for a window of `size`; `unit` is how many pixels a pixel of the design is."""
    made = pygame_gui.UIManager(size, enable_live_theme_updates=False)
    set_default_manager(made)  # pygame_gui would keep the first one, with all its widgets, for ever
    paths = {"regular": resource("Inter-Regular.otf"), "bold": resource("Inter-SemiBold.otf")}
    made.add_font_paths("inter", str(paths["regular"]), str(paths["bold"]), str(paths["regular"]), str(paths["bold"]))
    made.get_theme().load_theme({name: _scaled(block, unit) for name, block in _theme().items()})
    return made


def _scaled(block: dict[str, Any], unit: float) -> dict[str, Any]:
    made = {key: dict(value) for key, value in block.items()}
    if "font" in made:
        made["font"]["size"] = str(max(6, round(made["font"]["size"] * unit)))
    for key, value in made.get("misc", {}).items():
        scaled = round(value * unit) if key in _LENGTHS else value
        made["misc"][key] = str(scaled)
    return made
