"""The protocols between the window and its pages."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import pygame
import pygame_gui
from softcradle.sandbox.window.kernel_warmup import KernelWarmup
from softcradle.sandbox.window.messages import Messages


class Host(Protocol):
    """The window as its pages see it.

    Attributes:
        size: pixels.
        unit: pixels that a pixel of the 1280x720 design is.
        manager: of the widgets; a new one after every change of size or unit.
        messages: those on screen.
        warmup: the thread behind the window.
        surface: what is drawn on.
    """

    surface: pygame.Surface
    size: tuple[int, int]
    unit: float
    manager: pygame_gui.UIManager
    messages: Messages
    warmup: KernelWarmup

    def quit(self) -> None:
        """End at the end of this frame."""

    def rebuild(self) -> None:
        """Make all widgets anew."""

    def show(self, page: Page) -> None:
        """Bring `page` on screen."""

    def toggle_help(self) -> None:
        """Show or hide the help overlay."""

    def ask(self, title: str, note: str, text: str, take: Callable[[str], None]) -> None:
        """Ask the user for a line of text, beginning with `text`."""


class Page(Protocol):
    """One of the window's pages. `actions` are those of the table of keys that it offers."""

    actions: dict[str, Callable[[], None]]

    @property
    def typing(self) -> bool:
        """Whether keys go into a text field."""

    def build(self) -> None:
        """Make the widgets for the host's size and unit; the old ones are gone."""

    def handle(self, event: pygame.Event) -> bool:
        """Take an event that no widget took; whether the page used it."""

    def update(self, seconds: float) -> None:
        """Let `seconds` of wall time pass."""

    def paint(self, surface: pygame.Surface) -> None:
        """Draw all but the widgets."""

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw what lies above the widgets."""

    def after_frame(self, surface: pygame.Surface, seconds: float) -> None:
        """Use the finished picture, `seconds` after the last one."""

    def close(self) -> None:
        """Close what is open: the page is being left."""
