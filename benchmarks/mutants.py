"""``python -m benchmarks mutants``: change the kernels with cosmic-ray, and count the changes that tests notice.

Each change affects one place. The kernels run as plain Python, in a copy of the source tree. The results of each part
of the engine are stored in ``out/mutants``, so an interrupted command continues. cosmic-ray's ``cr-report`` and
``cr-html`` show each change with the output of the tests.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import subprocess
import sys
from contextlib import chdir
from pathlib import Path

from rich.console import Console
from softcradle.physics.atomic_files import output_file
from softcradle.physics.version import version

from benchmarks.reports import Report

ROOT = Path(__file__).parents[1]
COPIED = ("softcradle", "physics", "scenes", "sandbox", "assets", "tests", "benchmarks", "pyproject.toml")
ROOMS = {  # Source files of each part of the engine, and the arguments of pytest that select their tests.
    "law": (
        ("physics/numerics/law_kernels.py", "physics/numerics/law_curve.py", "physics/contact.py"),
        (
            "tests/physics/test_contact.py",
            "tests/physics/test_wrong_arguments.py",
            "tests/physics/numerics/test_law_curve.py",
        ),
    ),
    "conserving": (
        (
            "physics/fixed_step/discrete_gradient.py",
            "physics/numerics/touching.py",
            "physics/numerics/contact_solve.py",
            "physics/numerics/resolvent.py",
        ),
        (
            "tests/physics/numerics/test_contact_solve.py",
            "tests/physics/fixed_step/test_gradient_step.py",
            "tests/physics/fixed_step/test_discrete_gradient.py",
            "-k",
            "'contact_solve or gradient_step or resolvent or mean_force or guess or slope or carries or returned"
            " or cycles or restitution or slack'",
        ),
    ),
    "radau": (
        ("physics/adaptive/radau.py",),
        ("tests/physics/adaptive/test_radau_step.py", "tests/physics/adaptive/test_radau_guess.py"),
    ),
    "events": (
        ("physics/adaptive/corner_search.py", "physics/adaptive/corner_action.py"),
        (
            "tests/physics/adaptive/test_corner_search.py",
            "tests/physics/adaptive/test_corner_action.py",
            "tests/physics/adaptive/test_adaptive_methods.py::test_a_contact_with_a_largest_force_against_its_closed_form",
            "tests/physics/test_whole_motions.py",
            "-k",
            "'not whole_motions or (what_holds or reference_does) and accurate'",
        ),
    ),
}
# Changes that are left out because they mean nothing for a kernel in plain Python. Left out are the decorator that
# compiles the kernel, and operators of whole numbers.
LEFT_OUT = (
    r"core/(RemoveDecorator|ExceptionReplacer|.*_(BitOr|BitAnd|BitXor|LShift|RShift|FloorDiv|Mod|Pow|Invert|Is|IsNot))$"
)
# Longest time for the tests of a mutant [s]. The tests of one part take ten seconds, and twice that on a busy machine.
PATIENCE = 120.0
PYTEST = "-m pytest -x -q -n 0 -p no:cacheprovider -m 'not slow'"


def main(arguments: list[str]) -> int:
    """Test the mutants of each part of the engine, and print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks mutants", description=__doc__.splitlines()[0])
    parser.add_argument(
        "--of", nargs="+", choices=ROOMS, default=list(ROOMS), metavar="ROOM", help=f"of {', '.join(ROOMS)}"
    )
    parser.add_argument("--count", type=int, default=60, help="mutants of each room, drawn from all; 60 by default")
    parser.add_argument("--seed", type=int, default=1, help="of the draw")
    parser.add_argument("--folder", type=Path, default=Path("out/mutants"), help="where the sessions are kept")
    parser.add_argument("--markdown", type=Path, metavar="FILE", help="write the table there")
    args = parser.parse_args(arguments)
    folder = args.folder.absolute()
    rows = [row(room, folder, args.count, args.seed) for room in args.of]
    notes = [f"made by `python -m benchmarks mutants --count {args.count} --seed {args.seed}`, softcradle {version()}"]
    columns = ["room", "of", "tried", "killed", "share"]
    report = Report("Mutants killed by the quick tests of their room", columns, rows, notes)
    report.show(Console(width=160))
    if args.markdown is not None:
        with output_file(args.markdown) as temporary:
            temporary.write_text(report.markdown(), encoding="utf-8")
    return 0


def row(room: str, folder: Path, count: int, seed: int) -> list[str]:
    """Test the remaining mutants of one part of the engine, and return its row of counts."""
    from cosmic_ray.commands import execute, init
    from cosmic_ray.config import ConfigDict
    from cosmic_ray.work_db import use_db
    from cosmic_ray.work_item import TestOutcome, WorkerOutcome

    sources, tests = ROOMS[room]
    tree, session = folder / room / "tree", folder / f"{room}-{count}-{seed}.sqlite"
    _copy(tree)
    with chdir(tree), use_db(str(session)) as work:
        if work.num_work_items == 0:
            init(map(Path, sources), work, {})
            _draw(work, count, seed)
        os.environ |= {"NUMBA_DISABLE_JIT": "1", "PYTEST_ADDOPTS": "", "PYTHONPATH": str(tree)}
        command = f"{sys.executable} {PYTEST} {' '.join(tests)}"
        # This test run checks that the tests pass on the unchanged source.
        subprocess.run(command, shell=True, check=True, stdout=subprocess.DEVNULL)
        execute(work, ConfigDict({"test-command": command, "timeout": PATIENCE, "distributor": {"name": "local"}}))
        results = [result.test_outcome for _, result in work.results if result.worker_outcome == WorkerOutcome.NORMAL]
    # An incompetent mutant is one for which no test ran.
    found = [outcome for outcome in results if outcome != TestOutcome.INCOMPETENT]
    killed = sum(outcome == TestOutcome.KILLED for outcome in found)
    listed = ", ".join(f"`{source}`" for source in sources)
    return [room, listed, str(len(found)), str(killed), f"{100.0 * killed / max(1, len(found)):.0f} %"]


def _copy(tree: Path) -> None:
    """Copy the current source tree, because the sources are changed in the copy."""
    shutil.rmtree(tree, ignore_errors=True)
    tree.mkdir(parents=True)
    for name in COPIED:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, tree / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / name, tree / name)


def _draw(work: object, count: int, seed: int) -> None:
    """Reduce a session of cosmic-ray to `count` random mutants."""
    import re

    from cosmic_ray.work_item import WorkerOutcome, WorkResult

    def place(item: object) -> tuple:
        change = item.mutations[0]
        return str(change.module_path), change.start_pos, change.operator_name, change.occurrence

    items = sorted(work.pending_work_items, key=place)
    chosen = [item for item in items if not re.match(LEFT_OUT, item.mutations[0].operator_name)]
    kept = {item.job_id for item in random.Random(seed).sample(chosen, min(count, len(chosen)))}
    left = [item.job_id for item in items if item.job_id not in kept]
    work.set_multiple_results(left, WorkResult(worker_outcome=WorkerOutcome.SKIPPED))
