"""Functions that open the window, switch it to full screen, and keep it at a usable size."""

from __future__ import annotations

import contextlib
import os
import sys
import warnings

import pygame
from softcradle.sandbox.files import resource
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.widgets import REPEAT

# Environment variables with which the user chooses a video driver explicitly.
CHOSEN = ("SDL_VIDEODRIVER", "SDL_VIDEO_DRIVER")
DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")
UNSEEN = ("offscreen", "dummy")  # Video drivers whose windows are invisible.

SMALLEST = (640, 400)  # Smallest size of the window in pixels.
# Height reserved for the title bar and the task bar. SDL reports the size of the whole desktop, which includes both
# bars. The reserved height is a number of pixels or a fraction of the desktop height, whichever is larger. Bars of
# large screens are higher.
BARS, BARS_SHARE = 72, 0.08


def require_display() -> None:
    """Raise UserError if there is no visible display. Without this check the program would run with an invisible
    window.
    """
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
    """Return the window size, reduced until it fits on the desktop. The title bar and the task bar need space as well."""
    width, height = desktop
    bars = max(BARS, round(BARS_SHARE * height))
    return max(SMALLEST[0], min(size[0], width)), max(SMALLEST[1], min(size[1], height - bars))


def open_display(size: tuple[int, int]) -> pygame.Surface:
    """Open a resizable window of `size`, or smaller if the desktop is smaller.

    Only the display and the fonts of pygame are initialised, because initialising all of pygame is slow.
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
        # Hide the warning: pygame offers no other way to set the minimum size yet.
        warnings.simplefilter("ignore", DeprecationWarning)
        pygame.Window.from_display_module().minimum_size = SMALLEST
    return surface


def toggle_fullscreen(size: tuple[int, int]) -> pygame.Surface:
    """Switch to full screen, or back to a window of `size`. Return the surface to draw on."""
    if pygame.display.is_fullscreen():
        return pygame.display.set_mode(size, pygame.RESIZABLE)
    return pygame.display.set_mode((0, 0), pygame.FULLSCREEN)


def not_too_small(surface: pygame.Surface) -> pygame.Surface:
    """Enlarge the window if it is smaller than SMALLEST, and return its surface."""
    (width, height), (wide, high) = surface.get_size(), SMALLEST
    if width >= wide and height >= high:
        return surface
    return pygame.display.set_mode((max(width, wide), max(height, high)), pygame.RESIZABLE)
