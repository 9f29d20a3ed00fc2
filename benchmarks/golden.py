"""A golden record of the engine: what every method answers on many chains, bit for bit, to hold a refactoring against.

    python -m benchmarks.golden record FILE.json.gz
    python -m benchmarks.golden check FILE.json.gz [--only KEY-SUBSTRING]

The file holds the problems themselves as well as the answers, so that `check` needs neither the catalogue nor the generator
of random chains. It is a record for one machine and is not committed: another Python, numba, numpy, pymunk, libm or
processor rounds in other places, so `check` then finds runs that are not bit-equal though nothing is wrong.

A run that takes more than its limit of processor time is recorded as slow, and is not checked.
"""

from __future__ import annotations

import argparse
import gzip
import hashlib
import json
import math
import multiprocessing
import platform
import signal
import sys
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from multiprocessing.connection import Connection
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics import METHODS, Chain, Contact, State, Trajectory, advance, simulate
from softcradle.scenes import load, names

Array = NDArray[np.float64]
Table = dict[str, Any]

LIMIT, RANDOM_LIMIT = 2.5, 0.8  # processor time [s] that a run may take when recorded: of the catalogue or live; random
PATIENCE = 60.0  # and when checked
SAMPLES, TOLERANCE = 33, 1e-8
SEEDS, LIVE_SEEDS, FRAMES = 200, 40, 60
LEFT_OUT = ("scipy",)
MOST_STEPS = {"conserving": 20_000, "pymunk": 10_000}  # of a run, by making the step larger
MOST_STEPS_ELSE = 200_000
PARTS = 200  # steps in the shortest contact of a random chain
LISTED_INTERVALS = 200  # of one contact; the digest covers them all
NUDGE = 1e-15  # of every velocity: what it grows to tells how chaotic a motion is
ROUND_OFF, AMPLIFIED = 1e-12, 100.0  # what `conserving` may differ by, of the closing speed, or in nudges
WORST_LISTED = 15
ADAPTIVE = {method.name for method in METHODS if method.adaptive}
ALL = [method.name for method in METHODS if method.name not in LEFT_OUT]


# ---- one run


@dataclass(frozen=True)
class Run:
    """One call of `simulate`, or with `pushes` of `advance` frame by frame; all that it needs, as plain numbers."""

    chain: Table
    method: str
    duration: float | None
    step: float | None
    pushes: dict[str, list[str] | None] | None = None
    samples: int = SAMPLES


def hexed(values: ArrayLike) -> list[str]:
    """Numbers as text that keeps every bit."""
    return [float(value).hex() for value in np.asarray(values, dtype=np.float64).ravel()]


def numbers(texts: Sequence[str]) -> Array:
    """Numbers from what `hexed` made."""
    return np.array([float.fromhex(text) for text in texts])


def digest(*arrays: ArrayLike) -> str:
    """A hash of all bits."""
    found = hashlib.sha256()
    for array in arrays:
        found.update(np.ascontiguousarray(array, dtype=np.float64).tobytes())
    return found.hexdigest()[:32]


def written(chain: Chain, velocity: ArrayLike) -> Table:
    """A chain and its start as plain numbers."""
    return {
        "mass": hexed(chain.mass),
        "contact": [hexed([c.preload, c.stiffness, c.exponent, c.loss]) for c in chain.contact],
        "gap": hexed(chain.gap),
        "drive": None if chain.drive is None else hexed(chain.drive),
        "friction": float(chain.friction).hex(),
        "velocity": hexed(velocity),
    }


def read(table: Table) -> tuple[Chain, Array]:
    """The chain and its start from what `written` made."""
    contacts = [Contact(*numbers(law).tolist()) for law in table["contact"]]
    drive = None if table["drive"] is None else numbers(table["drive"])
    friction = float.fromhex(table["friction"])
    return Chain(numbers(table["mass"]), contacts, numbers(table["gap"]), drive, friction), numbers(table["velocity"])


def answer(run: Run) -> Table:
    """What the engine says: its result, or that it refuses."""
    began = perf_counter()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            found = _moved(run) if run.pushes is None else _played(run)
        except ValueError:
            return {"status": "refused"}
        except Exception as error:  # is a finding like any other
            return {"status": f"error: {type(error).__name__}: {error}"}
    return {"status": "done", "seconds": round(perf_counter() - began, 4), **found}


def _moved(run: Run) -> Table:
    chain, velocity = read(run.chain)
    found = simulate(chain, velocity, run.duration, run.method, run.step, run.samples, TOLERANCE)
    return {
        "final_velocity": hexed(found.final_velocity),
        "steps": found.steps,
        "end": float(found.time[-1]).hex() if found.time.size else "nan",
        "warned": bool(found.warnings),
        "ledger": hexed(found.ledger),
        "digest": digest(found.time, found.overlap, found.rate, found.anchor, found.force),
        "last": hexed(np.concatenate((found.overlap[-1:].ravel(), found.rate[-1:].ravel()))),
        **_switches(found),
    }


def _switches(found: Trajectory) -> Table:
    flat = [[time for interval in intervals for time in interval] for intervals in found.contact_intervals]
    return {
        "intervals": [hexed(times[: 2 * LISTED_INTERVALS]) for times in flat],
        "interval_counts": [len(times) // 2 for times in flat],
        "interval_digest": digest(*flat),
    }


def _played(run: Run) -> Table:
    chain, velocity = read(run.chain)
    assert run.duration is not None
    assert run.pushes is not None
    state, warned = State.at_start(chain, velocity), False
    for frame in range(FRAMES):
        if str(frame) in run.pushes:
            push = run.pushes[str(frame)]
            state.push = None if push is None else numbers(push)
        advance(chain, state, run.duration / FRAMES, run.method, run.step, TOLERANCE)
        warned = warned or bool(state.warnings)
    return {
        "final_velocity": hexed(state.velocity(chain)),
        "steps": state.switches,
        "end": float(state.time).hex(),
        "warned": warned,
        "ledger": hexed(state.absorbed),
        "digest": digest(state.overlap, state.rate, state.anchor, state.force, state.absorbed),
        "last": hexed(np.concatenate((state.overlap, state.rate, state.anchor, state.force))),
    }


# ---- a process of its own for the runs: a kernel that goes on for ever can only be stopped with its process


class Worker:
    """Answers runs in a forked process, which ends by itself when one of them takes more than `limit` [s]."""

    def __init__(self) -> None:
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("fork")  # the kernels that `warm_up` has loaded are there at once
        self.connection, other = context.Pipe()
        self.process: Any = context.Process(target=_serve, args=(other,), daemon=True)
        self.process.start()
        other.close()

    def __call__(self, run: Run, limit: float) -> Table:
        """The answer, or that it was slow."""
        self.connection.send((run, limit))
        try:
            found: Table = self.connection.recv()
        except (EOFError, ConnectionResetError):
            self.process.join()
            killed = self.process.exitcode == -signal.SIGPROF
            status = "slow" if killed else f"error: the process ended with {self.process.exitcode}"
            self._start()
            return {"status": status}
        return found


def _serve(connection: Connection) -> None:
    signal.signal(signal.SIGPROF, signal.SIG_DFL)  # ends the process
    while True:
        try:
            run, limit = connection.recv()
        except EOFError:
            return
        signal.setitimer(signal.ITIMER_PROF, limit)
        found = answer(run)
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        connection.send(found)


def warm_up(methods: Sequence[str]) -> None:
    """Load or compile every kernel before a clock runs."""
    laws = [Contact(0.0, 1.0, 0.1), Contact(0.5, 100.0, 1.0)]
    lossy = [replace(law, loss=0.5) for law in laws]
    for contacts, friction in ((laws, 0.0), (lossy, 0.0), (laws, 0.1), (lossy, 0.1)):
        for drive in (None, [0.1, 0.0, 0.0]):
            chain = written(Chain([1.0, 2.0, 1.0], contacts, 0.0, drive, friction), [1.0, 0.0, 0.0])
            for method in methods:
                step = None if method in ADAPTIVE else 0.01
                answer(Run(chain, method, 0.5, step))
                answer(Run(chain, method, 0.5, step, {"1": hexed([0.1, 0.0, 0.0]), "9": None}))


# ---- the chains: those of the catalogue, and random ones


@dataclass(frozen=True)
class Problem:
    """A chain with its start, and which methods shall move it for how long."""

    name: str
    chain: Chain
    velocity: Array
    duration: float | None
    step: float
    methods: Sequence[str]
    live: bool = False
    limit: float = LIMIT
    short: float | None = None  # duration of adaptive methods where it is another


def problems() -> Iterator[Problem]:
    """All of them."""
    for name in names():
        scene = load(name)
        for index, lane in enumerate(scene.lanes):
            chain, velocity = lane.chain(), np.array(lane.velocity)
            step = simulate(chain, velocity, 0.0, "verlet", samples=2).step
            yield Problem(f"scene/{name}/{index}", chain, velocity, scene.duration, step, ALL)
    for seed in range(SEEDS):
        yield from random_problems(seed)


def random_problems(seed: int) -> Iterator[Problem]:
    """A random chain without friction, with that of the bed, with loss in its contacts, and with both."""
    draw = np.random.default_rng(seed)
    plain, velocity = random_chain(draw, seed)
    times = contact_times(plain, velocity)
    closing = float(np.ptp(velocity)) or 1.0
    braked = closing / (9.81 * times.max() * 10 ** draw.uniform(0, 2))  # a bead stops within so many contacts
    lossy = [replace(c, loss=float(draw.choice([0.0, 0.3, 0.8, 0.95]))) for c in plain.contact]
    lossy[0] = replace(lossy[0], loss=0.4)
    wanted = 3.0 * float(times.max()) + np.abs(plain.gap).sum() / closing
    for name, contacts, friction in (
        ("plain", plain.contact, 0.0),
        ("bed", plain.contact, braked),
        ("loss", lossy, 0.0),
        ("both", lossy, braked),
    ):
        chain = Chain(plain.mass, contacts, plain.gap, plain.drive, friction)
        endless = plain.drive is None and (not chain.dissipative or seed % 8 == 0)
        live = seed < LIVE_SEEDS and seed % 4 == ("plain", "bed", "loss", "both").index(name)
        yield Problem(
            f"random/{seed}/{name}", chain, velocity, None if endless else wanted, float(times.min()) / PARTS,
            random_methods(seed, name), live, RANDOM_LIMIT, wanted / 3.0 if chain.dissipative and seed % 16 else None,
        )  # fmt: skip


def random_methods(seed: int, variant: str) -> list[str]:
    """Three methods always, the others in turn; adaptive ones are slow on chains that rub, so that few of those have two."""
    turn = [["radau", "yoshida4"], ["dop853", "euler"], ["euler", "yoshida4"]][seed % 3]
    taken = [name for name in turn if variant == "plain" or name == "euler" or (variant == "both" and name in ADAPTIVE)]
    return ["accurate", "verlet", "conserving", *taken]


def random_chain(draw: np.random.Generator, seed: int) -> tuple[Chain, Array]:
    """One of eight families of laws, in turn; masses, gaps, a wall and a drive as they come."""
    n = int(draw.integers(1, 13))
    contacts = _laws(draw, seed % 8, n)
    decades = 2.0 if seed % 8 == 5 else 0.5 * float(draw.random() < 0.4)
    mass = 10 ** draw.uniform(-decades, decades, n + 1)
    strikers = int(draw.integers(1, n + 1))
    clusters = seed % 8 == 6 or draw.random() < 0.4
    velocity = np.where(np.arange(n + 1) < strikers, 1.0, 0.0) if clusters else draw.normal(size=n + 1)
    gap = np.where(draw.random(n) < 0.6, 0.0, draw.uniform(0.0, 0.3, n))
    if clusters:
        gap = np.where(np.arange(n) == strikers - 1, 0.5 * float(draw.random() < 0.5), 0.0)
    if draw.random() < 0.2:
        wall = n if clusters else int(draw.choice([0, n]))
        mass[wall], velocity[wall] = math.inf, 0.0
    if seed % 10 == 7:  # one contact is pressed from the start
        gap[int(draw.integers(n))] = -0.01
    drive = np.where(np.isfinite(mass), draw.normal(size=n + 1), 0.0) if draw.random() < 0.15 else None
    return Chain(mass, contacts, gap, drive), velocity


def _laws(draw: np.random.Generator, family: int, n: int) -> list[Contact]:
    """(n) contacts: power laws, Hertz and Hooke, draft gears, mixed, step forces; then power laws and mixed again."""
    kinds: list[Callable[[], Contact]] = [
        lambda: Contact(0.0, 10 ** draw.uniform(-0.5, 0.5), 1.0 / draw.uniform(2.0, 30.0)),
        lambda: Contact(0.0, 10 ** draw.uniform(1.0, 3.0), float(draw.choice([1.0, 1.5]))),
        lambda: Contact(10 ** draw.uniform(-1.0, 1.0), 10 ** draw.uniform(0.5, 2.0), 1.0),
        lambda: Contact(draw.uniform(0.0, 2.0), draw.uniform(0.1, 10.0), float(draw.choice([0.1, 0.5, 1.0, 1.5]))),
        lambda: Contact(10 ** draw.uniform(-0.5, 0.5), 0.0, 1.0),
    ]
    if family in (3, 7):
        return [kinds[int(draw.integers(5))]() for _ in range(n)]
    kind = kinds[{5: 0, 6: 0}.get(family, family)]
    return [kind()] * n if draw.random() < 0.4 else [kind() for _ in range(n)]


def contact_times(chain: Chain, velocity: Array) -> Array:
    """(n,) times [s] of about one contact at the closing speed."""
    inverse_mass, speed = 1.0 / np.array(chain.mass), float(np.ptp(velocity)) or 1.0
    energy = 0.5 * speed**2 / (inverse_mass[:-1] + inverse_mass[1:])
    preload, stiffness, exponent = np.array([(c.preload, c.stiffness, c.exponent) for c in chain.contact]).T
    with np.errstate(divide="ignore"):
        by_power = ((1.0 + exponent) * energy / stiffness) ** (1.0 / (1.0 + exponent))
        depth = np.minimum(energy / preload, by_power)
    times: Array = 2.0 * depth / speed
    return times


# ---- record


def record(file: str) -> None:
    """Run everything and write it down."""
    warm_up(ALL)
    worker, began, chains, runs = Worker(), perf_counter(), {}, {}
    for count, problem in enumerate(problems()):
        chains[problem.name] = written(problem.chain, problem.velocity)
        runs.update(_recorded(problem, chains[problem.name], worker))
        _tell(f"{count + 1} chains, {len(runs)} runs, {perf_counter() - began:.0f} s: {problem.name}")
    with gzip.open(file, "wt", encoding="utf-8") as stream:
        json.dump({"machine": machine(), "chains": chains, "runs": runs}, stream)
    _tell("", end="\n")
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
            change = np.abs(numbers(other["final_velocity"]) - final).max() / _speed(velocity, final)
            spread = max(spread, float(change))
    return {**found, "spread": spread.hex()}


def _speed(velocity: Array, final: Array) -> float:
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


def _tell(sentence: str, end: str = "\r") -> None:
    print(f"{sentence:100}", end=end, file=sys.stderr, flush=True)


# ---- check


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
        _tell(f"{count + 1} of {len(chosen)}, {perf_counter() - began:.0f} s: {key}")
    _tell("", end="\n")
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
    speed = _speed(numbers(chain["velocity"]), numbers(old["final_velocity"]))
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
