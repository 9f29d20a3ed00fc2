"""``python -m benchmarks conserving``: seeded random chains at steps from fine to coarse; does every step converge and conserve?

A step of the discrete gradient solves for the forces of all contacts at once. Chains come from the families of the scan, most of
them with friction or loss; momentum and the ledger of energy hold to round-off at any step, so both are asked at all of them.
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
from softcradle.physics.default_step import default_step
from softcradle.physics.simulation import solve
from softcradle.physics.status import WarningCode

from benchmarks.reports import Report
from benchmarks.scan.families import motion

FAMILIES = ("friction", "loss", "friction", "loss", "clusters", "mixed", "driven", "walls", "gears", "hooke-hertz")
COARSER = (0.3, 3.0, 30.0)  # times the default step: the next chain takes the next
LONGEST = 2000.0  # steps: longer motions end there
CHUNK = 50  # chains that a process takes at once


@dataclass(frozen=True)
class Found:
    """One run: its chain, and by how much momentum and energy are off, relative to the largest there were."""

    family: str
    seed: int
    coarser: float
    steps: int
    unconverged: bool
    gave_up: bool
    momentum: float
    energy: float


def run(number: int) -> Found:
    """The run of that number."""
    family, coarser = FAMILIES[number % len(FAMILIES)], COARSER[number // len(FAMILIES) % len(COARSER)]
    moving = motion(family, number)
    chain, velocity = moving.chain, np.array(moving.velocity)
    step = coarser * default_step(chain, velocity)
    duration = min(moving.duration or np.inf, LONGEST * step)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = solve(chain, velocity, duration, "conserving", step=step, samples=20)
    codes = {warning.code for warning in found.warnings}
    mass = chain.finite_mass
    force = np.abs(chain.drive_force).sum() if chain.drive else 0.0
    worked = force * np.abs(found.position).max(axis=1)  # the ledger tells work by positions, to round-off of this
    free = not chain.friction and not chain.walls
    moved = found.velocity @ mass - found.impulse if free else np.zeros(1)
    most = float(np.abs(found.velocity * mass).sum(axis=1).max()) or 1.0
    largest = float((found.kinetic_energy + found.contact_energy + worked).max()) or 1.0
    return Found(
        family, number, coarser, found.steps, WarningCode.UNCONVERGED in codes, found.status.gave_up,
        float(np.ptp(moved)) / most, float(np.ptp(found.ledger)) / largest,
    )  # fmt: skip


def report(found: Sequence[Found]) -> Report:
    """A row for each family and each step."""
    rows = []
    for family in (*dict.fromkeys(FAMILIES), "all"):
        mine = [one for one in found if family in (one.family, "all")]
        bad = [one.seed for one in mine if one.unconverged or one.gave_up]
        worst = (
            [f"{max(getattr(one, name) for one in mine):.1e}" for name in ("momentum", "energy")] if mine else ["", ""]
        )
        steps = sum(one.steps for one in mine)
        rows.append(
            [
                family,
                str(len(mine)),
                str(steps),
                str(len(bad)),
                *worst,
                " ".join(map(str, bad[:9])) if family != "all" else "",
            ]
        )
    notes = [
        f"steps of {', '.join(f'{part:g}' for part in COARSER)} times the default one, in turn; at most {LONGEST:g} of them",
        "momentum: of chains without friction and walls, beside the impulse of the drive; energy: what the ledger lacks",
        f"made by `python -m benchmarks conserving --count {len(found)}`",
    ]
    columns = ["family", "chains", "steps", "not converged", "momentum off", "energy off", "seeds"]
    return Report("Random chains by conserving", columns, rows, notes)


def main(arguments: list[str]) -> int:
    """Run the scan; the exit code is 1 where a step did not converge."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks conserving", description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=1000, help="chains in all (default %(default)s)")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="the first seed (default 0)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes (default %(default)s)")
    parser.add_argument(
        "--markdown", type=Path, metavar="FILE", help="write the table there too, for the documentation"
    )
    args = parser.parse_args(arguments)
    numbers = range(args.first, args.first + args.count)
    with ProcessPoolExecutor(args.jobs) as processes:
        found = list(track(processes.map(run, numbers, chunksize=CHUNK), "conserving", total=len(numbers)))
    table = report(found)
    table.show(Console())
    if args.markdown:
        args.markdown.write_text(table.markdown(), encoding="utf-8")
    return 1 if any(one.unconverged or one.gave_up for one in found) else 0
