"""The bar above a scene: back to the gallery, and what can be kept."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import pygame
from pygame_gui.elements import UIButton
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.window_page import Host

TOOLS = (
    ("save_scene", "Save scene", 92.0),
    ("save_session", "Save session", 102.0),
    ("export", "Export", 64.0),
    ("screenshot", "Screenshot", 86.0),
    ("film", "Film", 52.0),
    ("help", "Help", 52.0),
)


def build_toolbar(
    host: Host, top: pygame.Rect, actions: Mapping[str, Callable[[], None]], leave: Callable[[], None]
) -> float:
    """Make the buttons; returns how many pixels the title between them has."""
    unit, manager, high = host.unit, host.manager, round(30 * host.unit)
    y = top.centery - high // 2
    place = pygame.Rect(round(12 * unit), y, round(84 * unit), high)
    UIButton(place, "← Scenes", manager, tool_tip_text="back to the gallery", command=leave)
    x = top.right - round(12 * unit)
    for name, text, wide in reversed(TOOLS):
        x -= round((wide + 5) * unit)
        place = pygame.Rect(x, y, round(wide * unit), high)
        UIButton(place, text, manager, tool_tip_text=hint(name), command=actions[name])
    return x - 120.0 * unit
