"""Version number of the installed package softcradle."""

from __future__ import annotations

from importlib import metadata


def version() -> str:
    """Return the version of the installed package, which is defined in pyproject.toml.

    Return "not installed" if softcradle runs from a checkout without installation.
    """
    try:
        return metadata.version("softcradle")
    except metadata.PackageNotFoundError:
        return "not installed"
