"""All measurements in one run: ``make bench``, or ``python -m benchmarks [--json FILE] [NAME ...]``."""

from __future__ import annotations

import argparse
import json
import os
import platform
from collections.abc import Callable, Iterator
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from rich.console import Console

from benchmarks.report import Report, against

PACKAGES = ("softcradle", "numba", "numpy", "scipy", "pymunk", "CyRK", "numbalsoda", "heyoka", "scikit-sundae")


def steps() -> Iterator[Report]:
    """Cost of a step of verlet and conserving."""
    from benchmarks.steps import reports

    return reports()


def floor() -> Iterator[Report]:
    """Steps of verlet against the bare powers that they take, up to a million contacts; ensembles."""
    from benchmarks.floor import reports

    return reports()


def precision() -> Iterator[Report]:
    """Time to reach an accuracy, and the same of the peers."""
    from benchmarks.precision import reports

    return reports()


def errors() -> Iterator[Report]:
    """Error against tolerance, over all scenes."""
    from benchmarks.errors import reports

    return reports()


def callbacks() -> Iterator[Report]:
    """Contacts in pymunk, compiled and in Python."""
    from softcradle.physics.pymunk_contacts import compiled_force as native

    from benchmarks import callbacks

    if native.unavailable():
        yield Report(f"no compiled pymunk callbacks here: {native.unavailable()}", [], [])
        return
    found = [callbacks.measure(contacts, turns) for contacts in callbacks.CONTACTS for turns in callbacks.ITERATIONS]
    rows = [
        [
            f"{row['contacts']} contacts, {row['iterations']} iterations",
            f"{row['compiled_microseconds']:.2f}",
            f"{row['python_microseconds']:.2f}",
            f"{row['ratio']:.1f}" + (_at_least(row["ratio"], 3.0) if row["contacts"] == 4 else ""),
        ]
        for row in found
    ]
    columns = ["", "compiled [us]", "Python [us]", "ratio (aim)"]
    note = f"least of {callbacks.ROUNDS} rounds of {callbacks.STEPS} steps"
    yield Report("One step of a pymunk Space, contacts as callbacks", columns, rows, [note], found)


def render() -> Iterator[Report]:
    """Rate of rendering against that of the encoder alone."""
    from benchmarks.render import measure

    found = measure("one-on-four", (1280, 720))
    rows = [[name, f"{found[name]:.0f}"] for name in ("drawing", "encoder", "render")]
    rows.append(["render, % of the encoder alone", f"{100 * found['share']:.0f}" + _at_least(100 * found["share"], 60)])
    rows.append(["first frame [s]", against(found["first_frame_seconds"], 3.0)])
    note = f"median of 5 rounds of {found['frames']} frames"
    yield Report("one-on-four as mp4, 1280x720", ["", "frames a second (aim)"], rows, [note], found)


def window() -> Iterator[Report]:
    """Start and frames of the window."""
    if not os.environ.get("DISPLAY") and platform.system() == "Linux" and not os.environ.get("WAYLAND_DISPLAY"):
        os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
    os.environ["PYGAME_HIDE_SUPPORT_PROMPT"] = "1"
    from benchmarks import window

    start, frame = window.starts(), window.frames(10.0)
    rows = [[name.replace("_", " "), f"{value:.2f}"] for name, value in start.items()]
    rows += [[name.replace("_", " "), f"{value:.2f}"] for name, value in frame.items() if name.endswith("_ms")]
    note = f"{frame['frames']} frames, driver {frame['driver']}, {frame['late']} later than a sixtieth of a second"
    yield Report("The window, 50 beads at 1280x720", ["", ""], rows, [note], {"start": start, "frame": frame})


PARTS: dict[str, Callable[[], Iterator[Report]]] = {
    part.__name__: part for part in (steps, floor, precision, errors, callbacks, render, window)
}


def _at_least(value: float, aim: float) -> str:
    return f" (at least {aim:g})" + ("" if value >= aim else " missed")


def _versions() -> dict[str, str | None]:
    found: dict[str, str | None] = {"python": platform.python_version(), "machine": platform.machine()}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = None
    return found


def main(arguments: list[str] | None = None) -> int:
    """Run the parts named, or all; print tables, write JSON where asked to."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(PARTS)}; all where none is given")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write every number there")
    args = parser.parse_args(arguments)
    unknown = [name for name in args.names if name not in PARTS]
    if unknown:
        parser.error(f"unknown part {unknown[0]!r}; there are {', '.join(PARTS)}")
    console = Console()
    found: dict[str, Any] = {"versions": _versions()}
    for name in args.names or PARTS:
        reports = found.setdefault(name, [])
        for report in PARTS[name]():
            report.show(console)
            reports.append(report.data)
            if args.json:  # kept after every table: the whole takes minutes
                _write(args.json, found)
    return 0


def _write(path: Path, content: dict[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    whole = path.with_suffix(".part")
    whole.write_text(json.dumps(content, indent=1) + "\n")
    whole.replace(path)


if __name__ == "__main__":
    raise SystemExit(main())
