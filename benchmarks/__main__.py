"""All measurements in one run: ``make bench``, or ``python -m benchmarks [--json FILE] [NAME ...]``.

``scan``, ``conserving`` and ``mutants`` are commands of their own, each with its ``--help``: random chains against the
reference; steps of conserving; which changes of a kernel the tests notice.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
from collections.abc import Callable, Iterator
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from rich.console import Console
from softcradle.sandbox.studies.precision.measurement import processor

from benchmarks.reports import Report, at_least, at_most

PACKAGES = ("softcradle", "numba", "numpy", "scipy", "pymunk", "CyRK", "numbalsoda", "heyoka", "scikit-sundae")


def steps() -> Iterator[Report]:
    """Cost of a step of verlet and conserving."""
    from benchmarks.steps import reports

    return reports()


def chain_lengths() -> Iterator[Report]:
    """Steps of verlet against the powers that they take, up to a million contacts; many chains at once."""
    from benchmarks.chain_lengths import reports

    return reports()


def many_chains() -> Iterator[Report]:
    """Very many short chains at once."""
    from benchmarks.many_chains import reports

    return reports()


def long_chains() -> Iterator[Report]:
    """A collision with a thousand beads, and a pulse that crosses as many."""
    from benchmarks.long_chains import reports

    return reports()


def added_cost() -> Iterator[Report]:
    """What samples, friction and loss add to a solve."""
    from benchmarks.added_cost import reports

    return reports()


def work_precision() -> Iterator[Report]:
    """Time to reach an error, of our methods and of the peers."""
    from benchmarks.work_precision import reports

    return reports()


def tolerances() -> Iterator[Report]:
    """Error against tolerance, over all scenes."""
    from benchmarks.tolerances import reports

    return reports()


def callbacks() -> Iterator[Report]:
    """Contacts in pymunk, compiled and in Python."""
    from benchmarks.callbacks import reports

    return reports()


def render() -> Iterator[Report]:
    """Rate of rendering, in order and in segments side by side."""
    from benchmarks.render import WAYS, measure

    found = measure("one-on-four", (1280, 720))
    rows = [[title, f"{found[way]:.0f}", f"{found[f'{way}_ms']:.2f}"] for way, title in WAYS.items()]
    rows.append(["segments over in order", at_least(f"{found['gain']:.2f}", found["gain"], 1.7), ""])
    rows.append(["first frame [s]", at_most(found["first_frame_seconds"], 2.0), ""])
    note = f"median of 5 rounds of {found['frames']} frames"
    columns = ["", "frames a second (aim)", "processor ms a frame"]
    yield Report("one-on-four as mp4, 1280x720", columns, rows, [note], found)


def window() -> Iterator[Report]:
    """Start and frames of the window."""
    if not os.environ.get("DISPLAY") and platform.system() == "Linux" and not os.environ.get("WAYLAND_DISPLAY"):
        os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    os.environ["PYGAME_HIDE_SUPPORT_PROMPT"] = "1"
    from benchmarks import window

    start, paused, frame = window.starts(), window.paused(), window.frames(10.0)
    rows = [[name.replace("_", " "), f"{value:.2f}"] for name, value in start.items()]
    rows += [["paused, per cent of a core", f"{paused:.2f}"]]
    rows += [[name.replace("_", " "), f"{value:.2f}"] for name, value in frame.items() if name.endswith("_ms")]
    note = f"{frame['frames']} frames, driver {frame['driver']}, {frame['late']} later than a sixtieth of a second"
    yield Report(
        "The window, 50 beads at 1280x720", ["", ""], rows, [note], {"start": start, "paused": paused, "frame": frame}
    )


def sweeps() -> Iterator[Report]:
    """What a sweep costs beside its work."""
    from benchmarks.sweep_cost import reports

    yield from reports()


def cold_start() -> Iterator[Report]:
    """The first use, with an empty cache of kernels."""
    from benchmarks.cold_start import reports

    return reports()


BENCHMARKS: dict[str, Callable[[], Iterator[Report]]] = {
    "steps": steps,
    "chain-lengths": chain_lengths,
    "many-chains": many_chains,
    "long-chains": long_chains,
    "added-cost": added_cost,
    "work-precision": work_precision,
    "tolerances": tolerances,
    "callbacks": callbacks,
    "render": render,
    "window": window,
    "sweeps": sweeps,
    "cold-start": cold_start,
}
COMMANDS = {
    "scan": "benchmarks.scan.command",
    "mutants": "benchmarks.mutants",
    "conserving": "benchmarks.conserving_scan",
    "soft-contacts": "benchmarks.soft_contacts",
}


def main(arguments: list[str] | None = None) -> int:
    """Run the benchmarks of those names, or all; print tables, and write JSON if wanted."""
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
        for report in BENCHMARKS[name]():
            report.show(console)
            data.append(report.data)
            if args.json:  # after every table, because all take minutes
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
