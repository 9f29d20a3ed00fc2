"""Names of files that come from a session: free ones, typed ones, and how they are shown."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

LONGEST_STEM = 40  # characters of a file name that is made from a title


def free_path(title: str, suffix: str) -> Path:
    """A path named after a `title`; with a number before its last suffix where there is such a file already."""
    stem = re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")[:LONGEST_STEM] or "scene"
    path = free = Path(f"{stem}{suffix}")
    number = 1
    while free.exists():
        number += 1
        free = path.with_name(f"{path.stem}-{number}{path.suffix}")
    return free


def typed_path(text: str, endings: Sequence[str]) -> Path:
    """The path that was typed: ~ is the home folder, and the first of `endings` is added where it has none of them."""
    path = Path(text).expanduser()
    return path if path.suffix.lower() in endings else path.with_name(path.name + endings[0])


def shown_path(path: Path) -> str:
    """The path with its full folder, the home folder as ~."""
    full = path.resolve()
    home = Path.home()
    return f"~/{full.relative_to(home)}" if full.is_relative_to(home) else str(full)
