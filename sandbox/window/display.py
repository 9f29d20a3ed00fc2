"""The display: a window with a title and an icon."""

from __future__ import annotations

import contextlib
import os
import sys
import warnings

import pygame
from softcradle.sandbox.files import resource
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.widgets import REPEAT

CHOSEN = ("SDL_VIDEODRIVER", "SDL_VIDEO_DRIVER")  # variables that choose a driver on purpose
DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")
UNSEEN = ("offscreen", "dummy")  # drivers whose windows nobody sees

SMALLEST = (640, 400)  # pixels of a window
# Room for the title bar of the window and the task bar of the desktop: SDL reports the whole desktop. Pixels, and a share of the
# height of the desktop, whichever is more: bars of large screens are higher.
BARS, BARS_SHARE = 72, 0.08


def require_display() -> None:
    """Raise UserError where a window would open that nobody could see, which would look as if the program hung."""
    if any(map(os.environ.get, CHOSEN)):
        return
    unset = sys.platform.startswith("linux") and not any(map(os.environ.get, DISPLAYS))
    if not unset:
        pygame.display.init()
    if unset or pygame.display.get_driver() in UNSEEN:
        raise UserError(
            "cannot open a window: there is no display; softcradle render writes films and pictures without one"
        )


def usable_size(size: tuple[int, int], desktop: tuple[int, int]) -> tuple[int, int]:
    """Return the `size` of a window, reduced to what a `desktop` of that size shows of it with title bar and task bar."""
    width, height = desktop
    bars = max(BARS, round(BARS_SHARE * height))
    return max(SMALLEST[0], min(size[0], width)), max(SMALLEST[1], min(size[1], height - bars))


def open_display(size: tuple[int, int]) -> pygame.Surface:
    """Open a resizable window of `size`, or as large as the desktop allows.

    Only the display and the fonts of pygame are initialised, which is quick.
    """
    os.environ.setdefault("SDL_VIDEO_CENTERED", "1")
    os.environ.setdefault("SDL_MOUSE_FOCUS_CLICKTHROUGH", "1")
    pygame.display.init()
    pygame.font.init()
    pygame.display.set_icon(pygame.image.load(str(resource("icon.png"))))
    pygame.display.set_caption("softcradle")
    if pygame.display.get_driver() not in UNSEEN:
        size = usable_size(size, pygame.display.get_desktop_sizes()[0])
    surface = pygame.display.set_mode(size, pygame.RESIZABLE)
    pygame.key.set_repeat(*REPEAT)
    with warnings.catch_warnings(), contextlib.suppress(AttributeError, pygame.error):
        warnings.simplefilter("ignore", DeprecationWarning)  # pygame has no other way yet
        pygame.Window.from_display_module().minimum_size = SMALLEST
    return surface


def toggle_fullscreen(size: tuple[int, int]) -> pygame.Surface:
    """Fill the screen, or go back to a window of `size`; returns the surface to draw on."""
    if pygame.display.is_fullscreen():
        return pygame.display.set_mode(size, pygame.RESIZABLE)
    return pygame.display.set_mode((0, 0), pygame.FULLSCREEN)


def not_too_small(surface: pygame.Surface) -> pygame.Surface:
    """The surface of a window, made larger where it is smaller than SMALLEST."""
    (width, height), (wide, high) = surface.get_size(), SMALLEST
    if width >= wide and height >= high:
        return surface
    return pygame.display.set_mode((max(width, wide), max(height, high)), pygame.RESIZABLE)
