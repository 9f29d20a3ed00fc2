"""``python -m benchmarks coverage``: branches of the kernels that quick tests take, with the kernels as plain Python.

The tests of single kernels run in a process of their own under coverage.py; the table has a row a file. Others are given by
``--tests``, and ``--add`` adds what they take: whole motions take minutes to hours as plain Python.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from rich.console import Console
from softcradle.physics.atomic_files import output_file
from softcradle.physics.version import version

from benchmarks.reports import Report

ROOT = Path(__file__).parents[1]
FOLDERS = ("physics/numerics", "physics/fixed_step", "physics/adaptive", "physics/pymunk_contacts")
TESTS = (
    "tests/physics/test_contact.py",
    "tests/physics/numerics/test_law_curve.py",
    "tests/physics/fixed_step/test_gradient_step.py",
    "tests/physics/adaptive/test_radau_step.py",
    "tests/physics/adaptive/test_radau_guess.py",
    "tests/physics/adaptive/test_find_event.py",
    "tests/physics/adaptive/test_guards.py",
    "tests/physics/adaptive/test_first_root.py",
    "tests/physics/adaptive/test_acceleration_balance.py",
)
AIM = 95.0  # percent of the branches of all folders
MOST_LINES = 12  # numbers of a file that the table lists


def parser() -> argparse.ArgumentParser:
    """The command line."""
    found = argparse.ArgumentParser(prog="python -m benchmarks coverage", description=__doc__)
    found.add_argument("--tests", nargs="+", default=list(TESTS), help="arguments of pytest")
    found.add_argument("--folder", type=Path, default=Path("out/coverage"), help="where what was covered is kept")
    found.add_argument("--add", action="store_true", help="add to what was covered before, in pieces")
    found.add_argument("--markdown", type=Path, metavar="FILE", help="write the table there")
    found.add_argument("--require", action="store_true", help=f"exit with 1 below {AIM:g} %%")
    return found


def main(arguments: list[str]) -> int:
    """Run the tests and print the table; the exit code is that of the tests where these fail."""
    args = parser().parse_args(arguments)
    folder = args.folder.absolute()
    folder.mkdir(parents=True, exist_ok=True)
    failed = _covered(folder, args.tests, args.add)
    report = report_of(json.loads((folder / "coverage.json").read_text(encoding="utf-8")))
    report.show(Console(width=160))
    if args.markdown is not None:
        with output_file(args.markdown) as temporary:
            temporary.write_text(report.markdown(), encoding="utf-8")
    return failed or int(args.require and report.data["percent"] < AIM)


def _covered(folder: Path, tests: list[str], add: bool) -> int:
    """Run `tests` under coverage.py, and write what it found; returns the exit code of the tests."""
    data = folder / "data"
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "COVERAGE_FILE": str(data), "COVERAGE_CORE": "ctrace"}
    environment |= {"SDL_VIDEODRIVER": "dummy", "SDL_AUDIODRIVER": "dummy"}
    with tempfile.TemporaryDirectory() as temporary:
        settings = Path(temporary) / "settings"
        lines = ("[run]", "branch = True", f"source = {','.join(FOLDERS)}", "disable_warnings = module-not-measured")
        settings.write_text("\n".join(lines), encoding="utf-8")
        coverage = [sys.executable, "-m", "coverage"]
        pytest = ["-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", "-m", "not slow", *tests]
        added = ["--append"] if add and data.exists() else []
        run = [*coverage, "run", f"--rcfile={settings}", *added, *pytest]
        failed = subprocess.run(run, cwd=ROOT, env=environment, check=False).returncode
        out = [*coverage, "json", "-q", f"--rcfile={settings}", "-o", str(folder / "coverage.json")]
        subprocess.run(out, cwd=ROOT, env=environment, check=True)
    return failed


def report_of(found: dict[str, Any]) -> Report:
    """The table of a JSON file of coverage.py."""
    rows = []
    for name, file in sorted(found["files"].items()):
        total = file["summary"]
        if not total["num_statements"]:
            continue
        missed = [f"{start}-{'end' if end < 0 else end}" for start, end in file["missing_branches"]]
        listed = ", ".join(missed[:MOST_LINES]) + (
            f" and {len(missed) - MOST_LINES} more" if len(missed) > MOST_LINES else ""
        )
        rows.append(
            [f"`{name}`", str(total["num_branches"]), str(total["covered_branches"]), f"{_share(total):.0f} %", listed]
        )
    total = found["totals"]
    rows.append(["all", str(total["num_branches"]), str(total["covered_branches"]), f"{_share(total):.1f} %", ""])
    notes = [
        f"lines: {total['covered_lines']} of {total['num_statements']}",
        f"made by `python -m benchmarks coverage`, softcradle {version()}",
    ]
    columns = ["file", "branches", "taken", "share", "from line - to line not taken"]
    return Report("Branches of the kernels taken by quick tests", columns, rows, notes, {"percent": _share(total)})


def _share(total: dict[str, Any]) -> float:
    """Percent of the branches that are taken."""
    return 100.0 * total["covered_branches"] / max(1, total["num_branches"]) if total["num_branches"] else 100.0
