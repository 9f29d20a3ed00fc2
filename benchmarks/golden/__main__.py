"""The command line of the golden record."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from benchmarks.golden.golden_check import check
from benchmarks.golden.golden_record import record


def main(arguments: Sequence[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description="record what the engine answers, or check it against a record")
    parser.add_argument("task", choices=["record", "check"])
    parser.add_argument("file")
    parser.add_argument("--only", default="", help="check: runs whose key contains this")
    given = parser.parse_args(arguments)
    if given.task == "check":
        return check(given.file, given.only)
    record(given.file)
    return 0


if __name__ == "__main__":
    sys.exit(main())
