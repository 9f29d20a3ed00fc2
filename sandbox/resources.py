"""Paths of fonts, icons and themes: inside the installed package, or beside it in a checkout."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).parent


def resource(name: str) -> Path:
    """Path of the file `name` under assets/. Raises FileNotFoundError where the installation is incomplete."""
    for folder in (_PACKAGE / "assets", _PACKAGE.parent / "assets"):
        if (folder / name).is_file():
            return folder / name
    raise FileNotFoundError(f"{name} is missing from softcradle's assets: install softcradle again")
