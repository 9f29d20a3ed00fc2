"""The unsaved scene: written behind the edits, and offered at the next start where the window was killed."""

from __future__ import annotations

import contextlib
from pathlib import Path

from softcradle.physics.atomic_files import output_file
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.settings import settings_path

WAIT = 1.0  # seconds after an edit: less than it takes until a window at rest draws no frames


def unsaved_path() -> Path:
    """The file, beside that of the settings."""
    return settings_path().with_name("unsaved.toml")


def forget_unsaved() -> None:
    """Remove it: what it holds was saved, or discarded."""
    with contextlib.suppress(OSError):
        unsaved_path().unlink(missing_ok=True)


class UnsavedScene:
    """Writes the edited scene of a session while it is in no file."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self._seen, self._age = 0, WAIT + 1.0  # the edit that was noticed last, and seconds since

    def update(self, seconds: float) -> None:
        """Write the scene a moment after an edit, and remove the file once it is saved."""
        stack = self.session.undo_stack
        number = (stack.done[-1].number if stack.done else -1) if stack.unsaved else 0
        if number != self._seen:
            self._seen, self._age = number, 0.0
        before, self._age = self._age, self._age + seconds
        if before <= WAIT < self._age:
            self._write() if number else forget_unsaved()

    def _write(self) -> None:
        with contextlib.suppress(OSError, ValueError):  # no place to write, or no scene file can say it
            text = self.session.to_scene().to_toml()
            unsaved_path().parent.mkdir(parents=True, exist_ok=True)
            with output_file(unsaved_path()) as temporary:
                temporary.write_text(text, encoding="utf-8")
