"""How far each constant of the adaptive methods can move before errors leave what is promised, or the work grows.

The kernels run as plain Python, so that a constant can be replaced in every module that has imported it. What no factor
tried here moves is either a guard against motions that these cases do not have, or not needed.
"""

from __future__ import annotations

import argparse
import ast
import os
import sys
import warnings
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from softcradle.physics import Chain, draft_gear, hertz, hooke, one_on, power_law, simulate, step_force
from softcradle.physics.source_digest import digest_of

from benchmarks.json_lines import append, lines
from benchmarks.reports import Report
from softcradle import physics

Array = NDArray[np.float64]

ROOM = Path(physics.__file__).parent / "adaptive"
NOT_TUNED = (  # files of codes, indices and coefficients; what is kept in memory and which part is stepped changes no digit
    "step_records",
    "radau_tableau",
    "dop853_tableau",
    "kept_steps",
)
CODES = {"NONE", "NO_GUESS", "CANDIDATE"}  # marks and indices in the other files
PAUSES = {
    "PAUSE",
    "PLAIN_PAUSE",
    "PLAIN_COST",
}  # when a kernel hands back, and which tier is called: no digit follows them
FACTORS = (3.0, 10.0, 100.0)  # and one over each
TOLERANCES = (1e-4, 1e-7)
PROMISED = 10.0  # tolerances
MORE_WORK = 1.25  # times the evaluations as they are


@dataclass(frozen=True)
class Constant:
    """A number at the top of a module, with the comment behind it."""

    module: str
    name: str
    value: float
    what: str


@dataclass(frozen=True)
class Outcome:
    """What a set of constants gives on all cases.

    Attributes:
        errors: of each case and tolerance, in tolerances; inf where it gave up.
        evaluations: of all contacts, in all cases together.
    """

    errors: Array
    evaluations: int


def constants() -> list[Constant]:
    """Every number that a person has chosen, file by file."""
    found = []
    for path in sorted(ROOM.glob("*.py")):
        if path.stem in NOT_TUNED:
            continue
        source = path.read_text(encoding="utf-8")
        for node in ast.parse(source).body:
            if not (isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)):
                continue
            name, value = node.targets[0].id, _number(node.value)
            if value and name.isupper() and name not in CODES | PAUSES:
                lines = source.splitlines()[node.lineno - 1 : node.end_lineno]
                if "#" not in lines[0]:
                    lines = source.splitlines()[node.lineno - 2 : node.lineno - 1]
                what = " ".join(line.partition("#")[2].strip() for line in lines if "#" in line)
                found.append(Constant(path.stem, name, value, what))
    return found


def _number(node: ast.expr) -> float | None:
    try:
        value = eval(compile(ast.Expression(node), "", "eval"), {"__builtins__": {}})
    except (NameError, TypeError):
        return None
    return value if isinstance(value, int | float) else None


def cases() -> list[tuple[Any, list[float], float | None]]:
    """Chain, start velocities and duration of every case: one at least of each kind of switch."""
    mixed = [hooke(1.46), hooke(27.17), hertz(11.06)]
    lossy = power_law(1.0, 0.5, loss=0.2)
    return [
        (one_on(4, power_law(1.0, 0.1)), [1, 0, 0, 0, 0], None),
        (one_on(5, power_law(1.0, 1 / 14)), [1, 0, 0, 0, 0, 0], None),
        (one_on(3, power_law(1.0, 0.02)), [1, 0, 0, 0], None),
        (one_on(2, power_law(1.0, 0.5)), [1, 0, 0], None),
        (one_on(8, hertz(1.0)), [1] + [0] * 8, None),
        (one_on(100, power_law(1.0, 0.5)), [1] + [0] * 100, 3.0),
        (one_on(3, draft_gear(0.5, 0.05)), [1, 0, 0, 0], None),
        (one_on(3, step_force(1.0)), [1, 0, 0, 0], None),
        (Chain([1.1, 3.1, 0.6, 0.4], mixed), [1, 1, 0, 0], None),
        (Chain([1] * 5, [hooke(1.0), *[power_law(1.0, 0.1)] * 3]), [1, 0, 0, 0, 0], None),
        (Chain([1] * 4, lossy, gap=[0, 0.02, 0]), [1, 0, 0, 0], None),
        (Chain([1] * 4, power_law(1.0, 0.2), friction=0.03), [1, 0, 0, 0], 4.0),
        (Chain([1, np.inf], hertz(1e3), gap=0.5, drive=[-9.8, 0]), [4, 0], 1.5),
        (Chain([np.inf, 1, 1, np.inf], hooke(50.0), gap=[0.3, 0.1, 0.2]), [0, 1, -0.5, 0], 3.0),
        (Chain([1, 2, 1], draft_gear(1.0, 0.1), drive=[0.4, 0, -0.4]), [0, 0, 0], 1.0),
    ]


def measure(constant: Constant) -> dict[str, Any]:
    """How far `constant` can be moved; called in processes of their own, whose kernels are plain Python."""
    base, truths = _base()
    reached = {sign: _reach(constant, sign, base, truths) for sign in (-1, 1)}
    return {
        **vars(constant),
        "least": reached[-1],
        "most": reached[1],
        "evaluations": base.evaluations,
        "runs": base.errors.size,
    }


@cache
def _base() -> tuple[Outcome, list[Array]]:
    """What the constants as they are give, and the truths."""
    truths = [_ends(chain, velocity, duration, 1e-11)[0] for chain, velocity, duration in cases()]
    return _outcome(truths), truths


def _reach(constant: Constant, sign: int, base: Outcome, truths: list[Array]) -> float:
    """The largest factor tried (or one over it) up to which all cases are as good as with 1."""
    reached = 1.0
    for factor in FACTORS:
        value = constant.value * factor**sign
        if isinstance(constant.value, int):
            value = max(round(value), 1)
        try:
            with _replaced(constant, value):
                good = _as_good(truths, base)
        except (ArithmeticError, IndexError, ValueError):  # plain Python raises what machine code computes on with
            good = False
        if not good:
            break
        reached = factor**sign
    return reached


def _as_good(truths: list[Array], base: Outcome) -> bool:
    """Whether no case errs beyond what is promised and all together take little more work; ends at the first that tells."""
    work, most = 0, MORE_WORK * base.evaluations
    for (error, spent), usual in zip(_runs(truths), base.errors, strict=True):
        work += spent
        if error > max(PROMISED, usual) or work > most:
            return False
    return True


@contextmanager
def _replaced(constant: Constant, value: float) -> Iterator[None]:
    """`constant` with another value in all modules that have it."""
    source = sys.modules[f"softcradle.physics.adaptive.{constant.module}"]
    holders = [
        module
        for name, module in sys.modules.items()
        if name.startswith("softcradle.physics.adaptive.")
        and hasattr(module, constant.name)
        and (module is source or constant.name in _imported(module, constant.module))
    ]
    for module in holders:
        setattr(module, constant.name, value)
    try:
        yield
    finally:
        for module in holders:
            setattr(module, constant.name, constant.value)


def _imported(module: Any, source: str) -> set[str]:
    """Names that `module` imports from the file `source` of the same room."""
    tree = ast.parse(Path(module.__file__).read_text(encoding="utf-8"))
    found = (node for node in tree.body if isinstance(node, ast.ImportFrom) and str(node.module).endswith(f".{source}"))
    return {alias.name for node in found for alias in node.names}


def _outcome(truths: list[Array]) -> Outcome:
    errors, work = zip(*_runs(truths), strict=True)
    return Outcome(np.array(errors), sum(work))


def _runs(truths: list[Array]) -> Iterator[tuple[float, int]]:
    """Error beyond the stated one, in tolerances, and evaluations of each case and tolerance."""
    for (chain, velocity, duration), truth in zip(cases(), truths, strict=True):
        for tolerance in TOLERANCES:
            end, stated, spent = _ends(chain, velocity, duration, tolerance)
            beyond = np.maximum(np.abs(end - truth) - stated, 0.0)
            yield float(beyond.max()) / tolerance if np.isfinite(end).all() else np.inf, spent


def _ends(chain: Any, velocity: list[float], duration: float | None, tolerance: float) -> tuple[Array, Array, int]:
    """Final velocities (n+1,), what the run states of their error, and its evaluations of all contacts."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = simulate(chain, velocity, duration, tolerance=tolerance, samples=2)
    ends = np.full(found.final_velocity.size, np.inf) if found.status.gave_up else found.final_velocity
    return ends, found.velocity_error, found.evaluations


def report(rows: list[dict[str, Any]]) -> Report:
    """The table of constants."""
    table = [
        [f"{one['module']}.{one['name']}", f"{one['value']:g}", _shown(one["least"]), _shown(one["most"]), one["what"]]
        for one in rows
    ]
    idle = [one["name"] for one in rows if one["least"] == 1.0 / FACTORS[-1] and one["most"] == FACTORS[-1]]
    notes = [
        f"{len(rows)} constants, {rows[0]['runs']} runs of {rows[0]['evaluations']} evaluations in all; factors up to which "
        f"errors stay within what is stated and {PROMISED:g} tolerances, and evaluations below {MORE_WORK:g} times as many",
        f"{len(idle)} that no factor tried moves, guards against motions that these cases do not have: {', '.join(idle)}",
        "made by `python -m benchmarks constants`",
    ]
    return Report(
        "Constants of the adaptive methods", ["", "value", "down to", "up to", "what it is"], table, notes, rows
    )


def _shown(factor: float) -> str:
    return f"x {factor:g}" if factor >= 1.0 else f"/ {1.0 / factor:g}"


def main(arguments: list[str]) -> int:
    """Move every constant, on all cores; print the table, and write it if wanted."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks constants", description=__doc__.splitlines()[0])
    parser.add_argument(
        "--markdown", type=Path, metavar="FILE", help="write the table there too, for the documentation"
    )
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes (default %(default)s)")
    parser.add_argument(
        "--kept", type=Path, default=Path("out/constants.jsonl"), metavar="FILE",
        help="what is measured goes there at once, and is not measured again (default %(default)s)",
    )  # fmt: skip
    args = parser.parse_args(arguments)
    os.environ["NUMBA_DISABLE_JIT"] = "1"  # for the processes
    args.kept.parent.mkdir(parents=True, exist_ok=True)
    every, source = constants(), digest_of(sorted(ROOM.parent.rglob("*.py")))
    known = {(row["module"], row["name"]): row for row in lines(args.kept) if row["source"] == source}
    wanted = [constant for constant in every if (constant.module, constant.name) not in known]
    with ProcessPoolExecutor(args.jobs, mp_context=get_context("spawn")) as processes:
        for row in track(processes.map(measure, wanted), "constants", total=len(wanted)):
            known[row["module"], row["name"]] = row
            append(args.kept, {"source": source, **row})
    found = report([known[constant.module, constant.name] for constant in every])
    found.show(Console())
    if args.markdown:
        args.markdown.write_text(found.markdown(), encoding="utf-8")
    return 0
