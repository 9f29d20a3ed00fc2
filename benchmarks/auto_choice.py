"""``python -m benchmarks auto``: test the choices of the method `auto` on random collisions with fixed seeds.

The test checks that each choice reaches the wanted error, and measures its cost. Each collision is also computed with
`accurate`, `radau` and `conserving`, with the settings that `auto` would choose for this error. The cost is the number
of contacts times the number of evaluations, so it does not depend on the machine.
"""

from __future__ import annotations

import argparse
import os
import warnings
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from softcradle.physics.advice.auto_method import LIVE_ERROR, choose, conserving_step
from softcradle.physics.chain import Chain
from softcradle.physics.scales import speed_scale
from softcradle.physics.simulation import solve

from benchmarks.reports import Report
from benchmarks.scan.families import motion

FAMILIES = ("power", "mixed", "hooke-hertz", "gears", "extreme", "one-on-n", "clusters", "walls")
ERRORS = (1e-2, 1e-3, 1e-4, 1e-6)
# Range of the masses of every second chain, in decades. Light beads between heavy beads have short contacts.
UNEVEN = 3.0
LONGEST = 3.0  # Largest random duration, as a multiple of the duration of the collision. Users choose such durations.
# Largest number of steps of an alternative. An alternative that needs more is stopped before its end.
MOST_STEPS = 1_000_000
FINE = 1e-11  # Tolerance of the true result.
DOUBTED = 0.1  # Chains whose true result has an uncertainty above this fraction of the wanted error are not judged.
HELD = 3.0  # Largest error of a choice that the tests allow, as a multiple of the wanted error.
# A choice is too expensive if it needs more than DEAR times the evaluations of the cheapest alternative, and more than
# MANY evaluations.
DEAR, MANY = 5.0, 20_000


@dataclass(frozen=True)
class Judged:
    """One choice of `auto`: the chain, the wanted error, the error of the choice, and numbers of evaluations.

    The evaluations of an alternative are infinite if it did not reach the end.
    """

    seed: int
    wanted: float
    method: str
    evaluations: float
    others: dict[str, float]
    error: float  # Error of the final velocities, relative to the closing speed.

    @property
    def ratio(self) -> float:
        """Number of evaluations divided by the number that the cheapest alternative needs.

        A motion without contacts needs no evaluations.
        """
        return self.evaluations / max(min(self.others.values()), 1.0)

    @property
    def dear(self) -> bool:
        """True if another method needs far fewer evaluations."""
        return self.evaluations > max(DEAR * min(self.others.values()), MANY)


def collision(number: int) -> tuple[Chain, np.ndarray, float]:
    """Return the chain, start velocities [m/s] and duration [s] of a random collision, generated from `number`."""
    moving, draw = motion(FAMILIES[number % len(FAMILIES)], number), np.random.default_rng([number, 59])
    chain, velocity = moving.chain, np.array(moving.velocity)
    if number // len(FAMILIES) % 2:
        mass = np.array(chain.mass) * 10.0 ** draw.uniform(-UNEVEN, UNEVEN, velocity.size)
        chain = Chain(mass, chain.contact, chain.gap)
    end = moving.duration or float(solve(chain, velocity, tolerance=1e-4, samples=2, most_steps=MOST_STEPS).time[-1])
    return chain, velocity, end * (float(draw.uniform(0.5, LONGEST)) if moving.duration is None else 1.0)


def judged(number: int) -> list[Judged]:
    """Return the choice of `auto` for each wanted error, with the alternatives."""
    found = []
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        chain, velocity, duration = collision(number)
        speed = speed_scale(chain, velocity)
        truth = solve(chain, velocity, duration, tolerance=FINE, samples=2)

        def run(method: str, step: float, tolerance: float) -> tuple[float, float]:
            if step and duration / step > MOST_STEPS:
                return np.inf, np.inf
            # Only `accurate` confirms its end, so its number of steps is not limited.
            most = None if method == "accurate" else MOST_STEPS
            run = solve(chain, velocity, duration, method, step or None, 2, tolerance or 1e-8, most)
            off = float(np.abs(run.final_velocity - truth.final_velocity).max()) / speed
            return (np.inf if run.status.gave_up else float(run.evaluations)), off

        for wanted in ERRORS:
            if truth.velocity_error.max() > DOUBTED * wanted * speed:
                continue
            choice = choose(chain, velocity, duration, wanted)
            taken, error = run(choice.method, choice.step, choice.tolerance)
            others = {"accurate": run("accurate", 0.0, 0.5 * wanted)[0], "radau": run("radau", 0.0, 0.5 * wanted)[0]}
            if wanted >= LIVE_ERROR:
                others["conserving"] = run("conserving", conserving_step(chain, speed, wanted, velocity), 0.0)[0]
            found.append(Judged(number, wanted, choice.method, taken, others, error))
    return found


def report(found: Sequence[Judged], options: str) -> Report:
    """Return a table with one row for each wanted error and chosen method."""
    rows = []
    for wanted in ERRORS:
        for method in sorted({one.method for one in found if one.wanted == wanted}):
            mine = [one for one in found if (one.wanted, one.method) == (wanted, method)]
            ratios = sorted(one.ratio for one in mine)
            dear = sorted((one for one in mine if one.dear), key=lambda one: one.evaluations)
            beyond = [one.seed for one in mine if one.error > HELD * wanted]
            quantiles = [f"{ratios[int(part * (len(ratios) - 1))]:.2g}" for part in (0.5, 0.9, 1.0)]
            most = max(one.evaluations for one in mine)
            told = [" ".join(map(str, seeds[-6:])) for seeds in ([one.seed for one in dear], beyond)]
            counts = [str(len(dear)), told[0], str(len(beyond)), told[1]]
            rows.append([f"{wanted:g}", method, str(len(mine)), *quantiles, f"{most:.2g}", *counts])
    columns = [
        "wanted",
        "chosen",
        "chains",
        "median",
        "nine tenths",
        "largest",
        "most",
        "dear",
        "seeds",
        "beyond",
        "seeds",
    ]
    notes = [
        "median, nine tenths, largest: evaluations of the choice over those of the cheapest alternative; most: its evaluations",
        f"dear: more than {DEAR:g} times the cheapest and {MANY} evaluations; beyond: error above {HELD:g} times the wanted one",
        f"made by `python -m benchmarks auto{options}`",
    ]
    return Report("Choices of auto on random chains", columns, rows, notes)


def main(arguments: list[str]) -> int:
    """Run the scan. The exit code is 1 if a choice is too expensive, or if its error exceeds the allowed error."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks auto", description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=400, help="chains in all (default %(default)s)")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="the first seed (default 0)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes (default %(default)s)")
    parser.add_argument("--markdown", type=Path, metavar="FILE", help="write the table there as well")
    args = parser.parse_args(arguments)
    numbers = range(args.first, args.first + args.count)
    with ProcessPoolExecutor(args.jobs) as processes:
        each = list(track(processes.map(judged, numbers, chunksize=10), "auto", total=len(numbers)))
    found = [one for group in each for one in group]
    table = report(found, f" --first {args.first} --count {args.count}")
    table.show(Console())
    if args.markdown:
        args.markdown.write_text(table.markdown(), encoding="utf-8")
    return 1 if any(one.dear or one.error > HELD * one.wanted for one in found) else 0
