"""``python -m benchmarks coverage``: branches of the kernels that quick tests take, with the kernels as plain Python.

Tests of single kernels and of short motions run in a process of their own under coverage.py; the table has a row a file. Kernels
are the functions that `jit` and its neighbours decorate; what else is in their files calls or compiles them, and is not counted.
Other tests are given by ``--tests``, and ``--add`` adds what they take.
"""

from __future__ import annotations

import argparse
import ast
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
FIXED, SOFT = "tests/physics/fixed_step", "tests/physics/pymunk_contacts"
TESTS = (
    "tests/physics/test_contact.py",
    "tests/physics/test_whole_motions.py",
    "tests/physics/numerics/test_contact_solve.py",
    "tests/physics/numerics/test_coupler_kernels.py",
    "tests/physics/numerics/test_law_curve.py",
    "tests/physics/numerics/test_simd_power.py",
    f"{FIXED}/test_gradient_step.py",
    f"{FIXED}/test_checkpoint_rows.py",
    f"{FIXED}/test_explicit_steps_simd.py::test_same_digits_where_no_power_is_taken",
    f"{FIXED}/test_explicit_steps_simd.py::test_stops_in_the_step_in_which_a_contact_switches",
    f"{FIXED}/test_discrete_gradient.py::test_the_resolvent_solves_its_equation",
    f"{FIXED}/test_discrete_gradient.py::test_a_touching_contact_carries_what_it_must",
    f"{FIXED}/test_discrete_gradient.py::test_a_failure_to_converge_is_returned",
    f"{FIXED}/test_discrete_gradient.py::test_a_step_on_which_newton_cycles_keeps_the_energy",
    f"{FIXED}/test_discrete_gradient.py::test_beads_at_rest_between_two_walls_stay",
    f"{FIXED}/test_discrete_gradient.py::test_contacts_that_push_no_more_end_a_run",
    "tests/physics/adaptive/test_radau_step.py",
    "tests/physics/adaptive/test_radau_guess.py",
    "tests/physics/adaptive/test_fallback_step.py",
    "tests/physics/adaptive/test_find_event.py",
    "tests/physics/adaptive/test_guards.py",
    "tests/physics/adaptive/test_first_root.py",
    "tests/physics/adaptive/test_yield_or_slip.py",
    f"{SOFT}/test_soft_chain.py::test_a_wall_that_moves",
    f"{SOFT}/test_soft_chain.py::test_a_row_in_any_direction",
    f"{SOFT}/test_soft_chain.py::test_a_column_rests_on_its_preload",
    f"{SOFT}/test_soft_chain_use.py::test_a_body_moved_away_and_back",
    f"{SOFT}/test_soft_chain_use.py::test_overlaps_follow_bodies_whose_positions_are_set",
    f"{SOFT}/test_soft_chain_use.py::test_a_changing_step",
    f"{SOFT}/test_soft_loss.py::test_a_soft_chain_with_loss[draft gear]",
)
DECORATORS = ("jit", "inlined", "fused")
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
    """The table of a JSON file of coverage.py: the branches within kernels."""
    rows, all_taken, all_missed = [], 0, 0
    for name, file in sorted(found["files"].items()):
        lines = kernel_lines((ROOT / name).read_text(encoding="utf-8"))
        taken = sum(start in lines for start, _ in file["executed_branches"])
        missed = [f"{start}-{'end' if end < 0 else end}" for start, end in file["missing_branches"] if start in lines]
        if not taken + len(missed):
            continue
        more = f" and {len(missed) - MOST_LINES} more" if len(missed) > MOST_LINES else ""
        listed = ", ".join(missed[:MOST_LINES]) + more
        total = taken + len(missed)
        rows.append([f"`{name}`", str(total), str(taken), f"{_share(taken, total):.0f} %", listed])
        all_taken, all_missed = all_taken + taken, all_missed + len(missed)
    total = all_taken + all_missed
    percent = _share(all_taken, total)
    rows.append(["all", str(total), str(all_taken), f"{percent:.1f} %", ""])
    notes = [f"made by `python -m benchmarks coverage`, softcradle {version()}"]
    columns = ["file", "branches", "taken", "share", "from line - to line not taken"]
    return Report("Branches of the kernels taken by quick tests", columns, rows, notes, {"percent": percent})


def kernel_lines(source: str) -> set[int]:
    """Numbers of the lines of all functions that one of DECORATORS decorates."""
    functions = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.FunctionDef))
    kernels = (node for node in functions if any(ast.unparse(one) in DECORATORS for one in node.decorator_list))
    return {line for kernel in kernels for line in range(kernel.lineno, (kernel.end_lineno or 0) + 1)}


def _share(taken: int, total: int) -> float:
    """Percent of the branches that are taken."""
    return 100.0 * taken / max(1, total)
