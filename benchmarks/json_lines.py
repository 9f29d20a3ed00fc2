"""Results kept as they come, one JSON object a line, so that a command that was stopped goes on."""

from __future__ import annotations

import gzip
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any


def lines(path: Path) -> Iterator[dict[str, Any]]:
    """Entries of a file of JSON lines, packed where it is called .gz; one that was cut off is left out."""
    if not path.exists():
        return
    data = path.read_bytes()
    for line in (gzip.decompress(data) if path.suffix == ".gz" else data).decode("utf-8").splitlines():
        if not line:
            continue
        try:
            yield json.loads(line)
        except json.JSONDecodeError:
            continue


def append(path: Path, entry: Mapping[str, Any]) -> None:
    """Add an entry at the end of the file."""
    with path.open("a", encoding="utf-8") as file:
        file.write("\n" + json.dumps(entry))  # a line that was cut off does not spoil the next
