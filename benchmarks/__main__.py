"""All measurements in one command: ``make bench``, or ``python -m benchmarks [--json FILE] [NAME ...]``.

Some names are separate commands with their own ``--help``:

- ``scan`` compares random chains with the reference.
- ``conserving`` tests steps of the method conserving.
- ``mutants`` counts the changes of a kernel that tests notice.
- ``soft-contacts`` measures the energy of SoftContacts.
- ``two-versions`` compares two checkouts.
- ``fit`` tests the error bars of fits.
- ``hits`` compares tables of collisions with the reference.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from rich.console import Console
from softcradle.sandbox.studies.precision.measurement import processor

PACKAGES = ("softcradle", "numba", "numpy", "scipy", "pymunk", "CyRK", "numbalsoda", "heyoka", "scikit-sundae")


BENCHMARKS = {
    name: f"benchmarks.{name.replace('-', '_')}"
    for name in (
        "steps", "many-chains", "long-chains", "work-precision", "tolerances",
        "callbacks", "render", "window", "sweeps", "cold-start",
    )
}  # fmt: skip
COMMANDS = {
    "scan": "benchmarks.scan.command",
    "mutants": "benchmarks.mutants",
    "conserving": "benchmarks.conserving_scan",
    "auto": "benchmarks.auto_choice",
    "soft-contacts": "benchmarks.soft_contacts",
    "soft-chains": "benchmarks.soft_chains",
    "two-versions": "benchmarks.two_versions",
    "fit": "benchmarks.fit",
    "hits": "benchmarks.hits",
}


def main(arguments: list[str] | None = None) -> int:
    """Run the benchmarks called `arguments`, or all. Print tables, and write JSON if requested."""
    given = sys.argv[1:] if arguments is None else arguments
    if given and given[0] in COMMANDS:
        command: Callable[[list[str]], int] = import_module(COMMANDS[given[0]]).main
        return command(given[1:])
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(BENCHMARKS)}; default: all")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write every number there")
    args = parser.parse_args(given)
    unknown = [name for name in args.names if name not in BENCHMARKS]
    if unknown:
        parser.error(f"there is no benchmark {unknown[0]!r}; there are {', '.join(BENCHMARKS)}")
    console = Console()
    found: dict[str, Any] = {"versions": _versions()}
    for name in args.names or BENCHMARKS:
        data = found.setdefault(name, [])
        for report in import_module(BENCHMARKS[name]).reports():
            report.show(console)
            data.append(report.data)
            if args.json:  # The file is written after every table, because all tables together take minutes.
                _write(args.json, found)
    return 0


def _versions() -> dict[str, str | None]:
    found: dict[str, str | None] = {"python": platform.python_version(), "machine": platform.machine()}
    found |= {"processor": processor(), "cores": str(os.cpu_count())}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = None
    return found


def _write(path: Path, content: dict[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_suffix(".part")
    temporary.write_text(json.dumps(content, indent=1) + "\n")
    temporary.replace(path)


if __name__ == "__main__":
    raise SystemExit(main())
