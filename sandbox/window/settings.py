"""Settings of the window that are stored in a file."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import pygame
from softcradle.physics.atomic_files import output_file
from softcradle.sandbox.draw.palette import THEMES
from softcradle.sandbox.languages import ENGLISH, LANGUAGES, VARIABLES, language_of_environment

FILE = "window.json"
MOST_RECENT = 6  # Number of recent files that are stored.
SCALES = (0.7, 0.8, 0.9, 1.0, 1.15, 1.3, 1.5, 1.75, 2.0)  # Scales that the user can select with keys.


def settings_path() -> Path:
    """Return the path of the settings file. The variable SOFTCRADLE_CONFIG sets another folder."""
    given = os.environ.get("SOFTCRADLE_CONFIG")
    if given:
        return Path(given) / FILE
    import platformdirs

    return Path(platformdirs.user_config_dir("softcradle", appauthor=False)) / FILE


@dataclass
class Settings:
    """The stored settings.

    Attributes:
        theme: a name in THEMES.
        language: a code in LANGUAGES; empty means the language of the locale.
        explore: True for Explore (few controls), False for Lab (all controls).
        scale: size of everything in the window, relative to the usual size.
        beside: True if Explore opens scenes of soft beads next to steel balls. It is the last choice of the user.
        plots: names of the visible kinds of plots; None until the user chooses some.
        recent: paths of recently opened or saved files, the newest first.
    """

    theme: str = "light"
    language: str = ""
    scale: float = 1.0
    explore: bool = True
    beside: bool = True
    plots: list[str] | None = None
    recent: list[str] = field(default_factory=list)

    @classmethod
    def load(cls) -> Settings:
        """Return the stored settings, or the defaults if the file is missing or cannot be read."""
        try:
            table = json.loads(settings_path().read_text(encoding="utf-8"))
            known = {one.name: table[one.name] for one in fields(cls) if one.name in table}
            loaded = cls(**known)
            loaded.recent = [str(path) for path in loaded.recent][:MOST_RECENT]
            loaded.scale = min(max(float(loaded.scale), SCALES[0]), SCALES[-1])
            loaded.explore, loaded.beside = bool(loaded.explore), bool(loaded.beside)
            loaded.plots = None if loaded.plots is None else [str(name) for name in loaded.plots]
        except (OSError, ValueError, TypeError):
            return cls()
        loaded.theme = loaded.theme if loaded.theme in THEMES else cls.theme
        loaded.language = loaded.language if loaded.language in LANGUAGES else cls.language
        return loaded

    def keep(self, **changed: Any) -> None:
        """Change the given settings and write them to the file. Other settings in the file are not touched, because
        another window may have changed them.

        If the folder is not writable, nothing is stored.
        """
        vars(self).update(changed)
        path, kept = settings_path(), asdict(replace(Settings.load(), **changed))
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with output_file(path) as temporary:
                temporary.write_text(json.dumps(kept, indent=1), encoding="utf-8")
        except OSError:
            return

    def remember(self, path: str | Path) -> None:
        """Put `path` at the head of the recent files, if it is the path of a file."""
        try:
            found = Path(os.path.expanduser(path))
            whole = str(found.resolve()) if found.is_file() else ""
        # The text of a scene may be given instead of a path, and is longer than any valid path.
        except (OSError, RuntimeError, ValueError):
            return
        if whole:
            files = dict.fromkeys([whole, *Settings.load().recent, *self.recent])
            self.keep(recent=[*files][:MOST_RECENT])


def system_language() -> str:
    """Return the code of the system's language. It is read from environment variables.

    If these are not set, SDL reports the language (Windows, macOS).
    """
    if any(os.environ.get(name) for name in VARIABLES):
        return language_of_environment()
    preferred = [locale["language"] for locale in pygame.system.get_pref_locales()]
    return next((code for code in preferred if code in LANGUAGES), ENGLISH)
