"""The edits of a window that are in no file: a copy on the disk, for the next start where the window crashes or is killed."""

from __future__ import annotations

import contextlib
import sys
from pathlib import Path
from secrets import token_hex
from typing import IO

from softcradle.physics.atomic_files import output_file
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.settings import settings_path

WAIT = 1.0  # seconds after an edit: less than it takes until a window at rest draws no frames


class UnsavedFile:
    """A file beside the settings that one window owns: it alone writes and removes it.

    Its owner holds a lock of the system, which ends with the process however that ends: no number of a process is asked
    for, which another may have by then.
    """

    def __init__(self, path: Path | None = None) -> None:
        self.path = path or settings_path().with_name(f"unsaved-{token_hex(4)}.toml")
        self._lock: IO[bytes] | None = None

    def own(self) -> bool:
        """Become its owner; False where another window is, or nothing can be written there."""
        if self._lock is None:
            with contextlib.suppress(OSError), contextlib.ExitStack() as kept:
                self.path.parent.mkdir(parents=True, exist_ok=True)
                file = kept.enter_context(self._lock_path.open("ab"))
                _lock(file)
                kept.pop_all()
                self._lock = file
        return self._lock is not None

    def write(self, text: str) -> None:
        """Write it as its owner. OSError where it cannot be written."""
        if self.own():
            with output_file(self.path) as temporary:
                temporary.write_text(text, encoding="utf-8")

    def forget(self) -> None:
        """Remove it, where this window owns it: what it holds was saved, or discarded."""
        if self._lock is not None:
            with contextlib.suppress(OSError):
                self.path.unlink(missing_ok=True)
            self.release()
            with contextlib.suppress(OSError):
                self._lock_path.unlink(missing_ok=True)

    def release(self) -> None:
        """Leave it, as it is, to the next window."""
        if self._lock is not None:
            self._lock.close()
            self._lock = None

    @property
    def _lock_path(self) -> Path:
        """A file of its own: the other one is replaced whenever it is written."""
        return self.path.with_suffix(".lock")


def unsaved_paths() -> list[Path]:
    """The files of all windows, of those that run too, the newest first."""
    return sorted(settings_path().parent.glob("unsaved*.toml"), key=_changed, reverse=True)


def left_over() -> UnsavedFile | None:
    """The newest of those that no window owns, owned by now; the others are for later starts."""
    for found in map(UnsavedFile, unsaved_paths()):
        if found.own():
            if found.path.exists():  # still: its owner may have removed it
                return found
            found.forget()
    return None


class UnsavedScene:
    """Writes the edited scene of a session, while it is in no file, to the UnsavedFile of the window."""

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session
        self._seen: tuple[object, ...] = (0, None, None)  # number of the last edit, setup and words: noticed last
        self._age = WAIT + 1.0  # seconds since

    def update(self, seconds: float) -> None:
        """Write the scene a moment after an edit, and remove the file once it is saved."""
        stack = self.session.undo_stack
        number = (stack.done[-1].number if stack.done else -1) if stack.unsaved else 0
        found = (number, self.session.setup, self.session.scene) if number else (0, None, None)
        if number != self._seen[0] or any(one is not seen for one, seen in zip(found[1:], self._seen[1:], strict=True)):
            self._seen, self._age = found, 0.0
        before, self._age = self._age, self._age + seconds
        if before <= WAIT < self._age:
            self._write() if number else self.host.unsaved_file.forget()

    def _write(self) -> None:
        with contextlib.suppress(OSError, ValueError):  # no place to write, or no scene file can say it
            self.host.unsaved_file.write(self.session.to_scene().to_toml())


def _changed(path: Path) -> float:
    """When a file was written last; 0 for one that is gone."""
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0


def _lock(file: IO[bytes]) -> None:
    """Lock an open file until it is closed. OSError where it is locked already."""
    if sys.platform == "win32":
        import msvcrt

        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
