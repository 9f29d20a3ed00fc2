"""Checking what the methods answer now against a golden record."""

from __future__ import annotations

import gzip
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter

from benchmarks.golden.golden_chains import ALL
from benchmarks.golden.golden_record import closing_speed, machine, tell
from benchmarks.golden.golden_run import ADAPTIVE, Run, Table, numbers
from benchmarks.golden.golden_worker import Worker, warm_up

PATIENCE = 60.0  # processor time [s] that a run may take
ROUND_OFF = 1e-12  # of the closing speed: what `conserving` may differ by
AMPLIFIED = 100.0  # times what a nudge of the velocities grows to: what `conserving` may differ by on a chaotic motion
WORST_LISTED = 15  # runs


@dataclass(frozen=True)
class Verdict:
    """How a run differs from its record: `failures` break a rule, `notes` do not."""

    key: str
    method: str
    equal: bool
    velocity: float
    intervals: float
    failures: tuple[str, ...]
    notes: tuple[str, ...]


def check(file: str, only: str = "") -> int:
    """Run everything again and compare; 1 where a rule is broken."""
    with gzip.open(file, "rt", encoding="utf-8") as stream:
        book = json.load(stream)
    if book["machine"] != machine():
        print(f"recorded on another machine, bits may differ:\n  {book['machine']}\n  {machine()}")
    chosen = {key: entry for key, entry in book["runs"].items() if only in key and entry["answer"]["status"] != "slow"}
    if not chosen:
        print(f"no run has a key with {only!r} in it")
        return 1
    warm_up(sorted({entry["method"] for entry in chosen.values()}))
    worker, began, verdicts = Worker(), perf_counter(), []
    for count, (key, entry) in enumerate(chosen.items()):
        verdicts.append(judge(key, entry, book["chains"][entry["chain"]], worker))
        tell(f"{count + 1} of {len(chosen)}, {perf_counter() - began:.0f} s: {key}")
    tell("", end="\n")
    print(f"{len(verdicts)} runs in {perf_counter() - began:.0f} s, {len(book['runs']) - len(chosen)} left out")
    return report(verdicts)


def judge(key: str, entry: Table, chain: Table, worker: Worker) -> Verdict:
    """One run again, held against its record."""
    duration, step = (None if entry[name] is None else float.fromhex(entry[name]) for name in ("duration", "step"))
    old, new = entry["answer"], worker(Run(chain, entry["method"], duration, step, entry["pushes"]), PATIENCE)
    if "done" not in (old["status"], new["status"]) and old["status"] == new["status"]:
        return Verdict(key, entry["method"], True, 0.0, 0.0, (), ())
    if old["status"] != new["status"]:
        failure = f"was {old['status']}, is {new['status']}"
        return Verdict(key, entry["method"], False, math.inf, math.inf, (failure,), ())
    speed = closing_speed(numbers(chain["velocity"]), numbers(old["final_velocity"]))
    velocity = difference(old["final_velocity"], new["final_velocity"]) / speed
    changed = [name for name in old if name not in ("seconds", "spread") and old[name] != new[name]]
    failures, notes = _rules(entry["method"], old, velocity, changed)
    return Verdict(key, entry["method"], not changed, velocity, _interval_difference(old, new), failures, notes)


def _rules(method: str, old: Table, velocity: float, changed: list[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """What of the `changed` breaks a rule, and what does not."""
    if method == "conserving":
        bound = max(ROUND_OFF, AMPLIFIED * float.fromhex(old["spread"]))
        strict: set[str] = set()
        failures = [] if velocity <= bound else [f"final_velocity is off by more than {bound:.1e}"]
    else:
        strict, failures = {"final_velocity", "steps"}, []
    if method in ADAPTIVE:
        strict |= {"intervals", "interval_counts", "interval_digest"}
    failures += [name for name in changed if name in strict]
    return tuple(failures), tuple(name for name in changed if name not in strict)


def difference(old: Sequence[str], new: Sequence[str]) -> float:
    """Largest difference; none between numbers of the same bits, such as two that are not finite."""
    if len(old) != len(new):
        return math.inf
    apart = [abs(float.fromhex(a) - float.fromhex(b)) for a, b in zip(old, new, strict=True) if a != b]
    return max((math.inf if math.isnan(gap) else gap for gap in apart), default=0.0)


def _interval_difference(old: Table, new: Table) -> float:
    """Largest difference of a listed switch time, of the end of the run; inf where their numbers differ."""
    pairs = zip(old.get("intervals", ()), new.get("intervals", ()), strict=True)
    apart = max((difference(a, b) for a, b in pairs), default=0.0)
    return apart / (abs(float.fromhex(old["end"])) or 1.0)


def report(verdicts: list[Verdict]) -> int:
    """Print the table and the worst; 1 where a rule is broken."""
    print(f"{'method':12}{'runs':>6}{'equal':>7}{'failed':>7}{'velocity':>11}{'intervals':>11}{'differ':>8}")
    for method in ALL:
        mine = [verdict for verdict in verdicts if verdict.method == method]
        if mine:
            print(_row(method, mine))
    print(
        "velocity: worst, of the closing speed; intervals: worst, of the end of the run; differ: runs whose intervals do"
    )
    unequal = sorted((v for v in verdicts if not v.equal), key=lambda v: (-len(v.failures), -v.velocity, -v.intervals))
    _listing("worst", unequal, WORST_LISTED)
    _listing("intervals differ, no failure", [v for v in unequal if not v.failures and _booked_anew(v)])
    failed = sum(bool(verdict.failures) for verdict in verdicts)
    print(f"{failed} failed" if failed else "no rule is broken")
    return int(failed > 0)


def _row(method: str, mine: list[Verdict]) -> str:
    equal, failed = sum(v.equal for v in mine), sum(bool(v.failures) for v in mine)
    velocity, intervals = max(v.velocity for v in mine), max(v.intervals for v in mine)
    differ = sum(_booked_anew(v) for v in mine)
    return f"{method:12}{len(mine):6}{equal:7}{failed:7}{velocity:11.2e}{intervals:11.2e}{differ:8}"


def _booked_anew(verdict: Verdict) -> bool:
    return any(name.startswith("interval") for name in verdict.failures + verdict.notes)


def _listing(title: str, verdicts: list[Verdict], most: int | None = None) -> None:
    if verdicts:
        print(f"\n{title}: {len(verdicts)}")
    for verdict in verdicts[:most]:
        said = "; ".join(verdict.failures) or "ok"
        noted = f" (also {', '.join(verdict.notes)})" if verdict.notes else ""
        print(f"  {verdict.key}: velocity {verdict.velocity:.2e}, intervals {verdict.intervals:.2e}; {said}{noted}")
