"""The base class of the pages of the window, and a class for derived objects such as widgets."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import pygame

if TYPE_CHECKING:
    from softcradle.sandbox.window.app import App

    Host = App  # This import is only for type checks. The window imports its pages, so a real import would be circular.
else:
    Host = Any

Actions = dict[str, Callable[[], None]]
UNMADE = object()


class Derived:
    """An object that is made from other values, and made again when these values change.

    All visible parts of the window are kept up to date in this way. Code that changes a value need not refer to the
    objects that depend on it.

    Arguments:
        of: function that returns the values on which the object depends. It is called at every frame, so it must be
            fast.
        make: function that makes the object.

    Attributes:
        version: number of times that the object was made.
    """

    def __init__(self, of: Callable[[], object], make: Callable[[], object]) -> None:
        self.of, self.make, self.version = of, make, 0
        self._of: object = UNMADE

    def follow(self) -> bool:
        """If the values have changed, make the object again and return True."""
        of = self.of()
        if of == self._of:
            return False
        self._of = of
        self.version += 1
        self.make()
        self.note()
        return True

    def note(self) -> None:
        """Mark the object as up to date. This is necessary if making the object has changed some of its values."""
        self._of = self.of()

    def forget(self) -> None:
        """Force the next `follow` to make the object again."""
        self._of = UNMADE


class Page:
    """Base class of the pages of the window.

    Attributes:
        actions: actions of the key table that the page offers.
        title: title of the page in the title bar of the window; empty for the gallery.
        least_height: height [design pixels] that the page needs. A larger scale is reduced until it fits.
        unsaved: True if edits are lost when the page is left. The page then has the action "save_scene".
        moving: True if the next frame differs from the current one without user input.
        typing: True if keys go into a text field.
    """

    actions: Actions
    title = ""
    least_height = 0.0
    unsaved = moving = typing = False

    def call_unsaved(self) -> None:
        """Mark the content of the page as unsaved, if the page can be edited."""

    def cancel_typing(self) -> None:
        """Discard the text that is being typed. Afterwards, keys trigger actions again."""

    def message_place(self, size: tuple[int, int], unit: float) -> pygame.Rect:
        """Return the rectangle for messages in a window of the given `size`."""
        return pygame.Rect(0, 0, size[0], size[1] - round(24 * unit))

    def made_of(self) -> object:
        """Return the values on which the widgets depend.

        Size, unit, level, theme and language of the window are not included, because the window checks them itself.
        """
        return ()

    def build(self) -> None:
        """Create the widgets for the size and unit of the host. The old widgets have already been removed."""

    def follow(self) -> None:
        """Update all drawings to the present state. Widgets are not updated."""

    def handle(self, event: pygame.Event) -> bool:
        """Handle an event that no widget used. Return True if the page used it."""
        return False

    def let_go(self) -> None:
        """Release a dragged object, because the mouse button was released. The pointer may be over a dialog above the
        page.
        """

    def take_file(self, path: str, point: tuple[int, int]) -> bool:
        """Use the file `path` that was dropped at `point`. Return False if the window should open the file instead."""
        return False

    def update(self, seconds: float) -> None:
        """Advance the page by `seconds` of wall time."""

    def paint(self, surface: pygame.Surface) -> None:
        """Draw everything below the widgets."""

    def paint_over(self, surface: pygame.Surface) -> None:
        """Draw everything above the widgets."""

    def after_frame(self, surface: pygame.Surface, seconds: float) -> None:
        """Use the finished frame, for example to record it. It comes `seconds` after the previous frame."""

    def close(self) -> None:
        """Release the resources of the page before another page is shown."""
