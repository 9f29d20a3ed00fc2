"""Settings that the window keeps from one start to the next."""

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
MOST_RECENT = 6  # files that are remembered
SCALES = (0.7, 0.8, 0.9, 1.0, 1.15, 1.3, 1.5, 1.75, 2.0)  # that keys take


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
            loaded.scale = min(max(float(loaded.scale), SCALES[0]), SCALES[-1])
            loaded.explore = bool(loaded.explore)
            loaded.plots = None if loaded.plots is None else [str(name) for name in loaded.plots]
        except (OSError, ValueError, TypeError):
            return cls()
        loaded.theme = loaded.theme if loaded.theme in THEMES else cls.theme
        loaded.language = loaded.language if loaded.language in LANGUAGES else cls.language
        return loaded

    def keep(self, **changed: Any) -> None:
        """Change some and write these, the others as other windows left them; a folder that cannot be written to keeps none."""
        vars(self).update(changed)
        path, kept = settings_path(), asdict(replace(Settings.load(), **changed))
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with output_file(path) as temporary:
                temporary.write_text(json.dumps(kept, indent=1), encoding="utf-8")
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
            files = dict.fromkeys([whole, *Settings.load().recent, *self.recent])
            self.keep(recent=[*files][:MOST_RECENT])


def system_language() -> str:
    """A code of LANGUAGES; systems without variables for the locale (Windows, macOS) are asked by SDL."""
    if any(os.environ.get(name) for name in VARIABLES):
        return language_of_environment()
    preferred = [locale["language"] for locale in pygame.system.get_pref_locales()]
    return next((code for code in preferred if code in LANGUAGES), ENGLISH)
