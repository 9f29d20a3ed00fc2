"""Recording what every method answers on every chain of the golden record."""

from __future__ import annotations

import gzip
import json
import platform
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from importlib.metadata import version
from time import perf_counter

import numpy as np

from benchmarks.golden.golden_chains import ALL, LIMIT, Problem, contact_times, problems
from benchmarks.golden.golden_run import ADAPTIVE, Array, Run, Table, hexed, numbers, written
from benchmarks.golden.golden_worker import Worker, warm_up

MOST_STEPS = {"conserving": 20_000, "pymunk": 10_000}  # of a run, by making the step larger
MOST_STEPS_ELSE = 200_000  # of a run by another method
NUDGE = 1e-15  # relative change of every velocity: what it grows to tells how chaotic a motion is


def record(file: str) -> None:
    """Run everything and write it down."""
    warm_up(ALL)
    worker, began, chains, runs = Worker(), perf_counter(), {}, {}
    for count, problem in enumerate(problems()):
        chains[problem.name] = written(problem.chain, problem.velocity)
        runs.update(_recorded(problem, chains[problem.name], worker))
        tell(f"{count + 1} chains, {len(runs)} runs, {perf_counter() - began:.0f} s: {problem.name}")
    with gzip.open(file, "wt", encoding="utf-8") as stream:
        json.dump({"machine": machine(), "chains": chains, "runs": runs}, stream)
    tell("", end="\n")
    _counts(runs, perf_counter() - began)


def _recorded(problem: Problem, chain: Table, worker: Worker) -> Iterator[tuple[str, Table]]:
    """The runs of one chain: `accurate` first, which tells how long the others will take."""
    end = problem.duration
    for method in sorted(problem.methods, key=lambda name: name != "accurate"):
        duration = (problem.short if method in ADAPTIVE else None) or problem.duration
        run = Run(chain, method, duration, _step(problem, method, end))
        found = _with_spread(run, worker, problem.limit)
        if method == "accurate" and found["status"] == "done" and duration is None:
            end = float.fromhex(found["end"])
        yield f"{problem.name}/{method}", _entry(problem.name, run, found)
    if problem.live:
        yield from _recorded_live(problem, chain, worker, end)


def _recorded_live(problem: Problem, chain: Table, worker: Worker, end: float | None) -> Iterator[tuple[str, Table]]:
    """The same chain frame by frame, as in a window."""
    length = end or 3.0 * float(contact_times(problem.chain, problem.velocity).max())
    for method in ("accurate", "verlet", "conserving"):
        duration = problem.short if problem.short and method in ADAPTIVE else length
        run = Run(chain, method, duration, _step(problem, method, length), _pushes(problem))
        yield f"live/{problem.name}/{method}", _entry(problem.name, run, _with_spread(run, worker, LIMIT))


def _entry(name: str, run: Run, found: Table) -> Table:
    exact = {key: None if (value := getattr(run, key)) is None else float(value).hex() for key in ("duration", "step")}
    return {"chain": name, "method": run.method, **exact, "pushes": run.pushes, "answer": found}


def _step(problem: Problem, method: str, end: float | None) -> float | None:
    if method in ADAPTIVE:
        return None
    return max(problem.step, (end or 0.0) / MOST_STEPS.get(method, MOST_STEPS_ELSE))


def _pushes(problem: Problem) -> dict[str, list[str] | None]:
    """By frame: a hand pushes the first bead, lets go, pushes all a little, lets go, pulls the last."""
    force = 0.2 * float(np.mean([c.preload + c.stiffness for c in problem.chain.contact]))
    free = np.isfinite(problem.chain.mass)
    beads = np.arange(free.size)
    hands = {5: beads == 0, 20: beads >= 0, 40: beads == free.size - 1}
    sizes = {5: force, 20: 0.1 * force, 40: -force}
    found: dict[str, list[str] | None] = {str(k): hexed(sizes[k] * (hand & free)) for k, hand in hands.items()}
    return found | {"8": None, "22": None, "43": None}


def _with_spread(run: Run, worker: Worker, limit: float) -> Table:
    """The answer; for `conserving` with what nudges of the start velocities grow to, of the closing speed."""
    found = worker(run, limit)
    if run.method != "conserving" or found["status"] != "done":
        return found
    velocity, final = numbers(run.chain["velocity"]), numbers(found["final_velocity"])
    ones = np.ones(velocity.size)
    spread = 0.0
    for signs in (ones, (-1.0) ** np.arange(velocity.size)):
        nudged = hexed(velocity * (1.0 + NUDGE * signs))
        other = worker(replace(run, chain={**run.chain, "velocity": nudged}, samples=2), limit)
        if other["status"] == "done":
            change = np.abs(numbers(other["final_velocity"]) - final).max() / closing_speed(velocity, final)
            spread = max(spread, float(change))
    return {**found, "spread": spread.hex()}


def closing_speed(velocity: Array, final: Array) -> float:
    """The closing speed, or where nothing moves at the start that at the end."""
    return float(np.ptp(velocity)) or float(np.abs(final).max()) or 1.0


def machine() -> Table:
    """What the digits depend on."""
    packages = {name: version(name) for name in ("numpy", "numba", "llvmlite", "scipy", "pymunk")}
    return {"python": platform.python_version(), "platform": platform.platform(), "processor": _processor(), **packages}


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as stream:
            return next((line.split(":")[1].strip() for line in stream if line.startswith("model name")), "")
    except OSError:
        return platform.processor()


def _counts(runs: dict[str, Table], seconds: float) -> None:
    found: dict[str, Counter[str]] = {}
    for key, entry in runs.items():
        kind = f"{key.split('/')[0]} {entry['method']}"
        found.setdefault(kind, Counter()).update([entry["answer"]["status"].split(":")[0]])
    print(f"{len(runs)} runs in {seconds:.0f} s")
    for kind in sorted(found):
        print(f"  {kind:22} " + ", ".join(f"{count} {status}" for status, count in sorted(found[kind].items())))


def tell(sentence: str, end: str = "\r") -> None:
    print(f"{sentence:100}", end=end, file=sys.stderr, flush=True)
