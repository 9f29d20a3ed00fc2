"""Save dialogs: the scene, the session, the export of its history, and screenshots."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pygame
from softcradle.sandbox.output_files import output_file
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.messages import Messages
from softcradle.sandbox.window.window_page import Host

LONGEST_STEM = 40  # characters of a file name that is made from a title


class SaveDialogs:
    """Files that come from a session."""

    def __init__(self, host: Host, session: Session) -> None:
        self.host, self.session = host, session
        self.actions: dict[str, Callable[[], None]] = {
            "save_scene": self.ask_scene,
            "save_session": self.ask_session,
            "export": self.ask_export,
            "screenshot": self.screenshot,
        }

    def _ask(self, title: str, note: str, suffix: str, take: Callable[[str], None]) -> None:
        self.host.ask(title, note, str(free_path(self.session, suffix)), take)

    def _save(self, work: Callable[[], object], done: str) -> None:
        report(self.host.messages, work, done)

    def ask_scene(self) -> None:
        """Save the scene with all edits."""
        self._ask("Save the scene", "a .toml file, to be opened here, rendered or run", "-edited.toml", self.save_scene)

    def save_scene(self, path: str) -> None:
        """Write the scene file."""
        path = path if path.endswith(".toml") else f"{path}.toml"
        self._save(lambda: self.session.save_scene(path), f"saved {path}")

    def ask_session(self) -> None:
        """Save the session."""
        note = "an .npz file: drop it here to replay the session"
        self._ask("Save the session", note, "-session.npz", self.save_session)

    def save_session(self, path: str) -> None:
        """Write the recording."""
        path = path if path.endswith(".npz") else f"{path}.npz"
        self._save(lambda: self.session.save_recording(path), f"saved {path}")

    def ask_export(self) -> None:
        """Export the history."""
        self._ask("Export the history", ".npz (everything) or .csv (a table); a file a lane", ".csv", self.export)

    def export(self, path: str) -> None:
        """Write the trajectories."""
        self._save(lambda: self.session.export(path), f"saved the history to {path}")

    def screenshot(self) -> None:
        """Write the window as it is, as a PNG file in the working folder."""
        path = free_path(self.session, ".png")

        def work() -> None:
            with output_file(path) as temporary:
                pygame.image.save(self.host.surface, str(temporary))

        self._save(work, f"saved {path}")


def report(messages: Messages, work: Callable[[], object], done: str) -> None:
    """Do `work` and show the message `done`, or what went wrong."""
    try:
        work()
    except (UserError, OSError, ValueError) as error:
        messages.show(str(error), warning=True)
    else:
        messages.show(done)


def free_path(session: Session, suffix: str) -> Path:
    """A path named after the scene; with a number before its last suffix where there is such a file already."""
    stem = re.sub(r"[^a-z0-9]+", "-", session.scene.title.lower()).strip("-")[:LONGEST_STEM] or "scene"
    path = free = Path(f"{stem}{suffix}")
    number = 1
    while free.exists():
        number += 1
        free = path.with_name(f"{path.stem}-{number}{path.suffix}")
    return free
