"""The language of a window in which nobody has chosen one: that of the locale, of the environment or of the system."""

from __future__ import annotations

import os

import pygame
from softcradle.sandbox.languages import ENGLISH, LANGUAGES, VARIABLES, language_of_environment


def system_language() -> str:
    """A code of LANGUAGES; systems without variables for the locale (Windows, macOS) are asked by SDL."""
    if any(os.environ.get(name) for name in VARIABLES):
        return language_of_environment()
    preferred = [locale["language"] for locale in pygame.system.get_pref_locales()]
    return next((code for code in preferred if code in LANGUAGES), ENGLISH)
