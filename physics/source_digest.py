"""Digests of source files, used as names of results that are cached for these sources."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable
from pathlib import Path

PHYSICS = Path(__file__).parent
_IMPORTS = re.compile(r"^from softcradle\.physics\.([\w.]+) import", re.MULTILINE)
_JIT = "numerics.jit"


def digest_of(paths: Iterable[Path], *more: str) -> str:
    """Return 16 hexadecimal digits computed from the names and contents of all files and from the texts `more`."""
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    for text in more:
        digest.update(b"\0" + text.encode())
    return digest.hexdigest()[:16]


def kernel_sources(physics: Path = PHYSICS) -> list[Path]:
    """Return every file of the folder `physics` that contains compiled code, and all files that these import from it."""
    imports = {path: set(_IMPORTS.findall(path.read_text(encoding="utf-8"))) for path in physics.rglob("*.py")}
    found = {path for path, names in imports.items() if _JIT in names}
    waiting = list(found)
    while waiting:
        names = imports[waiting.pop()]
        new = {physics / (name.replace(".", "/") + ".py") for name in names} & imports.keys() - found
        found |= new
        waiting += new
    return sorted(found)
