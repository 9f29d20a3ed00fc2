"""The version of softcradle that is installed."""

from __future__ import annotations

from importlib import metadata


def version() -> str:
    """Version as in pyproject.toml, or "not installed" in a bare checkout."""
    try:
        return metadata.version("softcradle")
    except metadata.PackageNotFoundError:
        return "not installed"
