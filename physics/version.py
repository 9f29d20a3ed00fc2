"""Version number of the installed package softcradle."""

from __future__ import annotations

from importlib import metadata


def version() -> str:
    """Return the version of pyproject.toml, or "not installed" if softcradle runs from a checkout without installation."""
    try:
        return metadata.version("softcradle")
    except metadata.PackageNotFoundError:
        return "not installed"
