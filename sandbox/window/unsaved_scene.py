"""Backup of unsaved edits. A copy of the scene is stored on disk. If the window crashed or was killed, the next start
offers the copy.
"""

from __future__ import annotations

import contextlib
from pathlib import Path
from secrets import token_hex
from typing import TYPE_CHECKING

from softcradle.physics.atomic_files import output_file
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.settings import settings_path

if TYPE_CHECKING:
    from filelock import BaseFileLock

# Delay in seconds between an edit and its backup. It must be shorter than the time after which an idle window stops
# drawing frames.
WAIT = 1.0


class UnsavedFile:
    """A backup file in the settings folder. It is owned by one window, and only this window writes and removes it.

    The owner holds a file lock, which the system releases when the process ends for any reason. A process number would
    be unreliable, because another process may later have the same number.
    """

    def __init__(self, path: Path | None = None) -> None:
        self.path = path or settings_path().with_name(f"unsaved-{token_hex(4)}.toml")
        self._lock: BaseFileLock | None = None

    def own(self) -> bool:
        """Acquire the backup file. Return False if another window owns it or the folder is not writable."""
        if self._lock is None:
            from filelock import FileLock  # Import here, because most windows start and end without a backup.

            # If another window holds the lock, a TimeoutError is raised, which is an OSError.
            with contextlib.suppress(OSError):
                self.path.parent.mkdir(parents=True, exist_ok=True)
                lock = FileLock(self._lock_path)
                lock.acquire(timeout=0)
                self._lock = lock
        return self._lock is not None

    def write(self, text: str) -> None:
        """Write `text` to the file, if this window owns it. Raise OSError if it cannot be written."""
        if self.own():
            with output_file(self.path) as temporary:
                temporary.write_text(text, encoding="utf-8")

    def forget(self) -> None:
        """Remove the file if this window owns it. Its content was saved or discarded."""
        if self._lock is not None:
            with contextlib.suppress(OSError):
                self.path.unlink(missing_ok=True)
            self.release()
            with contextlib.suppress(OSError):
                self._lock_path.unlink(missing_ok=True)

    def release(self) -> None:
        """Release the file without changing it. Another window can then open it."""
        if self._lock is not None:
            self._lock.release()
            self._lock = None

    @property
    def _lock_path(self) -> Path:
        """Path of the lock file. The lock file is separate because the backup file is replaced at every write."""
        return self.path.with_suffix(".lock")


def unsaved_paths() -> list[Path]:
    """Return the backup files of all windows, the newest first. This includes windows that are still open."""
    return sorted(settings_path().parent.glob("unsaved*.toml"), key=_changed, reverse=True)


def left_over() -> UnsavedFile | None:
    """Acquire and return the newest backup that no open window owns, or None. Older backups are offered at later
    starts.
    """
    for found in map(UnsavedFile, unsaved_paths()):
        if found.own():
            if found.path.exists():  # The owner may have removed the file in the meantime.
                return found
            found.forget()
    return None


class UnsavedScene:
    """Writes the edited scene of a session to the backup file of the window, until the scene is saved."""

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session
        # Last state of the session that was noticed: number of the last edit, setup, and scene.
        self._seen: tuple[object, ...] = (0, None, None)
        self._age = WAIT + 1.0  # Seconds since the last state was noticed.

    def update(self, seconds: float) -> None:
        """Write the scene shortly after an edit. Remove the backup file after the scene has been saved."""
        stack = self.session.undo_stack
        number = (stack.done[-1].number if stack.done else -1) if stack.unsaved else 0
        found = (number, self.session.setup, self.session.scene) if number else (0, None, None)
        if number != self._seen[0] or any(one is not seen for one, seen in zip(found[1:], self._seen[1:], strict=True)):
            self._seen, self._age = found, 0.0
        before, self._age = self._age, self._age + seconds
        if before <= WAIT < self._age:
            self._write() if number else self.host.unsaved_file.forget()

    def _write(self) -> None:
        # Ignore the error if the folder is not writable or if a scene file cannot express the scene.
        with contextlib.suppress(OSError, ValueError):
            self.host.unsaved_file.write(self.session.to_scene().to_toml())


def _changed(path: Path) -> float:
    """Return the modification time of a file, or 0 if the file no longer exists."""
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0
