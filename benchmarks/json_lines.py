"""Storage of results as JSON lines. Each result is written at once, so an interrupted command can continue."""

from __future__ import annotations

import gzip
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any


def lines(path: Path) -> Iterator[dict[str, Any]]:
    """Yield the entries of a file of JSON lines. The file is compressed if its name ends in .gz.

    A line that was cut off is skipped.
    """
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
    """Append one entry to the file."""
    with path.open("a", encoding="utf-8") as file:
        # The line break comes first, so a line that was cut off does not damage the next line.
        file.write("\n" + json.dumps(entry))
