"""Overlays: what lies over a page with widgets of its own, so that no click reaches those of the page."""

from __future__ import annotations

from collections.abc import Sequence

import pygame
from pygame_gui.core import UIElement
from pygame_gui.core.utility import set_default_manager
from softcradle.sandbox.window import theme
from softcradle.sandbox.window.window_page import Host

POINTER_EVENTS = (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP, pygame.MOUSEMOTION, pygame.MOUSEWHEEL)
KEY_EVENTS = (pygame.KEYDOWN, pygame.KEYUP, pygame.TEXTINPUT)


class Overlay:
    """A box with widgets; it takes every key and click while it is open.

    Attributes:
        open: whether it is on screen.
        manager: of its widgets.
        box: its rectangle.
    """

    def __init__(self, host: Host) -> None:
        self.host, self.open = host, True
        self.box = pygame.Rect(0, 0, 0, 0)
        self.build()

    def build(self) -> None:
        """Make the widgets; again when the window has changed."""
        self.manager = theme.manager(self.host.size, self.host.unit)
        self.make_widgets()

    def make_widgets(self) -> None:
        """Take a place and make the widgets on it."""
        raise NotImplementedError

    def widgets(self) -> Sequence[UIElement]:
        """The widgets."""
        raise NotImplementedError

    def key(self, event: pygame.Event) -> None:
        """Take a pressed key."""
        raise NotImplementedError

    def handle(self, event: pygame.Event) -> bool:
        """Take every key and click: the page below gets none."""
        if event.type == pygame.KEYDOWN:
            self.key(event)
        elif event.type in (*KEY_EVENTS, *POINTER_EVENTS):
            self.manager.process_events(event)
        return event.type in (*KEY_EVENTS, *POINTER_EVENTS)

    def update(self, seconds: float) -> None:
        """Let time pass."""
        self.manager.update(seconds)

    def close(self) -> None:
        """Remove it."""
        self.open = False
        set_default_manager(self.host.manager)  # pygame_gui would hold the other one

    def paint(self, surface: pygame.Surface) -> None:
        """Draw it over the page."""
        self.manager.draw_ui(surface)
