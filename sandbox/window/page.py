"""What a page is to the window, and the window to a page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import pygame
import pygame_gui

from sandbox.window.messages import Messages
from sandbox.window.warm import Warmer


class Host(Protocol):
    """The window as its pages see it.

    Attributes:
        size: pixels.
        unit: pixels that a pixel of the 1280x720 design is now.
        manager: where widgets belong; a new one after every change of size or unit.
        messages: to say things.
        warmer: the thread behind the window.
    """

    size: tuple[int, int]
    unit: float
    manager: pygame_gui.UIManager
    messages: Messages
    warmer: Warmer

    def quit(self) -> None:
        """End at the end of this frame."""


class Page(Protocol):
    """One of the window's pages. `actions` are those of the table of keys that it offers."""

    actions: dict[str, Callable[[], None]]

    def build(self) -> None:
        """Make the widgets for the host's size and unit; the old ones are gone."""

    def handle(self, event: pygame.Event) -> bool:
        """Take an event that no widget took; whether it was of use."""

    def update(self, seconds: float) -> None:
        """Let `seconds` of wall time pass."""

    def paint(self, surface: pygame.Surface) -> None:
        """Draw all but the widgets."""
