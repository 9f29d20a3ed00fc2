"""What the window shows: a page. What most pages do alike stands here once."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import pygame

if TYPE_CHECKING:
    from softcradle.sandbox.window.app import App

    Host = App  # the window, which imports its pages
else:
    Host = Any

Actions = dict[str, Callable[[], None]]
UNMADE = object()


class Derived:
    """What is made of other things, and made anew once these are others: the one rule by which all that is shown keeps up.

    Whoever changes something need not know what was made of it.

    Arguments:
        of: what it is made of, as values to be compared; cheap, for it is asked at every picture.
        make: makes it.

    Attributes:
        version: how often it was made.
    """

    def __init__(self, of: Callable[[], object], make: Callable[[], object]) -> None:
        self.of, self.make, self.version = of, make, 0
        self._of: object = UNMADE

    def follow(self) -> bool:
        """Make it where what it is made of has changed; whether it was made."""
        of = self.of()
        if of == self._of:
            return False
        self._of = of
        self.version += 1
        self.make()
        self.note()
        return True

    def note(self) -> None:
        """Take it for up to date: it has been made, which may have settled some of what it is made of."""
        self._of = self.of()

    def forget(self) -> None:
        """Make it at the next `follow` in any case."""
        self._of = UNMADE


class Page:
    """One of the window's pages.

    Attributes:
        actions: those of the table of keys that it offers.
        title: what the frame of the window calls it; empty for the gallery.
        unsaved: whether leaving it loses edits; it then has the action "save_scene".
        moving: whether the next picture differs from this one though nobody does anything.
        typing: whether keys go into a text field.
    """

    actions: Actions
    title = ""
    unsaved = moving = typing = False

    def call_unsaved(self) -> None:
        """Call what it shows unsaved, where that can be."""

    def cancel_typing(self) -> None:
        """Drop what is being typed: keys are keys of the window again."""

    def message_place(self, size: tuple[int, int], unit: float) -> pygame.Rect:
        """The rectangle for messages in a window of that `size`."""
        return pygame.Rect(0, 0, size[0], size[1] - round(24 * unit))

    def made_of(self) -> object:
        """What its widgets are made of, besides size, unit, level, theme and language of the window."""
        return ()

    def build(self) -> None:
        """Make the widgets for the host's size and unit; the old ones are gone."""

    def follow(self) -> None:
        """Let what is drawn, besides the widgets, be of the present state."""

    def handle(self, event: pygame.Event) -> bool:
        """Take an event that no widget took; whether the page used it."""
        return False

    def let_go(self) -> None:
        """Let go of what is dragged: the button was released, be it over what lies over the page."""

    def take_file(self, path: str, point: tuple[int, int]) -> bool:
        """Take a file that was dropped at `point`; False where it is to be opened."""
        return False

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
