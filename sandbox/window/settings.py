"""Settings that the window keeps from one start to the next, and the unsaved scene of one that was killed."""

from __future__ import annotations

import contextlib
import json
import os
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path

import pygame
from softcradle.physics.atomic_files import output_file
from softcradle.sandbox.draw.palette import THEMES
from softcradle.sandbox.languages import ENGLISH, LANGUAGES, VARIABLES, language_of_environment
from softcradle.sandbox.session.session import Session

FILE = "window.json"
MOST_RECENT = 6  # files that are remembered
LEAST_SCALE, MOST_SCALE = 0.7, 2.0


def settings_path() -> Path:
    """The file of the settings; SOFTCRADLE_CONFIG gives another folder."""
    given = os.environ.get("SOFTCRADLE_CONFIG")
    if given:
        return Path(given) / FILE
    import platformdirs

    return Path(platformdirs.user_config_dir("softcradle", appauthor=False)) / FILE


@dataclass
class Settings:
    """What is kept.

    Attributes:
        theme: a name of THEMES.
        language: a code of LANGUAGES; empty until one is chosen: that of the locale.
        explore: whether the window is at its first level, with few controls.
        scale: of everything in the window, relative to the usual size.
        plots: names of the kinds of plots that are shown; None until they are chosen.
        recent: paths of files, the one opened or saved last first.
    """

    theme: str = "light"
    language: str = ""
    scale: float = 1.0
    explore: bool = True
    plots: list[str] | None = None
    recent: list[str] = field(default_factory=list)

    @classmethod
    def load(cls) -> Settings:
        """The settings of the last start; the usual ones where there are none, or none that can be read."""
        try:
            table = json.loads(settings_path().read_text(encoding="utf-8"))
            known = {one.name: table[one.name] for one in fields(cls) if one.name in table}
            loaded = cls(**known)
            loaded.recent = [str(path) for path in loaded.recent][:MOST_RECENT]
            loaded.scale = min(max(float(loaded.scale), LEAST_SCALE), MOST_SCALE)
            loaded.explore = bool(loaded.explore)
            loaded.plots = None if loaded.plots is None else [str(name) for name in loaded.plots]
        except (OSError, ValueError, TypeError):
            return cls()
        loaded.theme = loaded.theme if loaded.theme in THEMES else cls.theme
        loaded.language = loaded.language if loaded.language in LANGUAGES else cls.language
        return loaded

    def save(self) -> None:
        """Write them; a folder that cannot be written to keeps none."""
        path = settings_path()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with output_file(path) as temporary:
                temporary.write_text(json.dumps(asdict(self), indent=1), encoding="utf-8")
        except OSError:
            return

    def remember(self, path: str | Path) -> None:
        """Put a file at the head of the recent ones, where it is a file."""
        try:
            found = Path(os.path.expanduser(path))
            whole = str(found.resolve()) if found.is_file() else ""
        except (OSError, RuntimeError, ValueError):  # a scene as text is longer than any path
            return
        if whole:
            self.recent = [whole, *(other for other in self.recent if other != whole)][:MOST_RECENT]
            self.save()


def system_language() -> str:
    """A code of LANGUAGES; systems without variables for the locale (Windows, macOS) are asked by SDL."""
    if any(os.environ.get(name) for name in VARIABLES):
        return language_of_environment()
    preferred = [locale["language"] for locale in pygame.system.get_pref_locales()]
    return next((code for code in preferred if code in LANGUAGES), ENGLISH)


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
            self._write() if number else forget_unsaved()

    def _write(self) -> None:
        with contextlib.suppress(OSError, ValueError):  # no place to write, or no scene file can say it
            text = self.session.to_scene().to_toml()
            unsaved_path().parent.mkdir(parents=True, exist_ok=True)
            with output_file(unsaved_path()) as temporary:
                temporary.write_text(text, encoding="utf-8")
