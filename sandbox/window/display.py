"""The display: a window with a title and an icon."""

from __future__ import annotations

import os

import pygame
from softcradle.sandbox.resources import resource


def open_display(size: tuple[int, int]) -> pygame.Surface:
    """A resizable window; of pygame only the display and the fonts are initialised, which is quick."""
    os.environ.setdefault("SDL_VIDEO_CENTERED", "1")
    os.environ.setdefault("SDL_MOUSE_FOCUS_CLICKTHROUGH", "1")
    pygame.display.init()
    pygame.font.init()
    pygame.display.set_icon(pygame.image.load(str(resource("icon.png"))))
    pygame.display.set_caption("softcradle")
    surface = pygame.display.set_mode(size, pygame.RESIZABLE)
    pygame.key.set_repeat(350, 45)
    return surface
