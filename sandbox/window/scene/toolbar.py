"""The toolbar above a scene: back to the gallery, and what can be saved."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import pygame
from pygame_gui.elements import UIButton
from softcradle.sandbox.window.keys import hint
from softcradle.sandbox.window.window_page import Host

# Action, text and width [design pixels] of each button on the right.
TOOLS = (
    ("save_scene", "Save scene", 92.0),
    ("save_session", "Save session", 102.0),
    ("export", "Export", 64.0),
    ("screenshot", "Screenshot", 86.0),
    ("film", "Film", 52.0),
    ("help", "Help", 52.0),
)


def build_toolbar(
    host: Host, rect: pygame.Rect, actions: Mapping[str, Callable[[], None]], leave: Callable[[], None]
) -> float:
    """Make the buttons; returns the width [pixels] between them, for the title."""
    unit, manager, height = host.unit, host.manager, round(30 * host.unit)
    y = rect.centery - height // 2
    place = pygame.Rect(round(12 * unit), y, round(84 * unit), height)
    UIButton(place, "← Scenes", manager, tool_tip_text="back to the gallery", command=leave)
    x = rect.right - round(12 * unit)
    for name, text, width in reversed(TOOLS):
        x -= round((width + 5) * unit)
        place = pygame.Rect(x, y, round(width * unit), height)
        UIButton(place, text, manager, tool_tip_text=hint(name), command=actions[name])
    return x - 120.0 * unit
