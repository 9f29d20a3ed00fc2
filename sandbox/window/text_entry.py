"""The line to type in, of which a screen reader says what it is for."""

from __future__ import annotations

from pygame_gui.elements import UITextEntryLine


class TextEntry(UITextEntryLine):
    """A line to type in; its `name` is for screen readers."""

    name = ""

    def select_all(self) -> None:
        """Select the text: what is typed next takes its place."""
        self.place_cursor(len(self.text))
        self.select_range = [0, len(self.text)]

    def place_cursor(self, position: int) -> None:
        """Put the cursor before letter `position`."""
        self.edit_position, self.cursor_has_moved_recently = position, True
