"""``python -m benchmarks conserving``: test method conserving on random chains with steps from fine to coarse.

A step of the discrete gradient solves for the forces of all contacts at once. The scan checks that every step converges
and conserves momentum and energy. The chains come from the families of the scan, most of them with friction or loss.
Momentum and the energy balance must hold up to round-off at any step size.
"""

from __future__ import annotations

import argparse
import os
import warnings
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from softcradle.physics.scales import default_step, speed_scale
from softcradle.physics.simulation import solve
from softcradle.physics.status import WarningCode

from benchmarks.reports import Report
from benchmarks.scan.families import motion

FAMILIES = ("friction", "loss", "friction", "loss", "clusters", "mixed", "driven", "walls", "gears", "hooke-hertz")
COARSER = (0.3, 3.0, 30.0)  # Step sizes in units of the default step. Successive chains use them in turn.
LONGEST = 2000.0  # Largest number of steps of a simulation. Longer motions are stopped.
# Families of chains without friction and loss, used by `--errors`.
KEEPING = ("power", "mixed", "clusters", "walls", "hooke-hertz", "gears", "extreme", "driven")
LOSING = ("friction", "loss")  # Families of chains used by `--errors --lossy`.
STEPS_OF_ERRORS = (1.0, 4.0)  # Step sizes of `--errors` in units of the default step.
LONGEST_COLLISION = 12_000.0  # Longest simulation of `--errors`, in default steps.
FINER = 9.3  # Ratio of the default step to the step of the simulation with which the others are compared.
LARGE = 1e-3  # Error above which a simulation is listed, as a fraction of the closing speed.
CHUNK = 50  # Number of chains that a process gets at once.


@dataclass(frozen=True)
class Found:
    """Result of one simulation: its chain, and the errors of momentum and energy, relative to their largest values.

    The error of the momentum is None on a bed or with walls.
    """

    family: str
    seed: int
    coarser: float
    steps: int
    unconverged: bool
    gave_up: bool
    momentum: float | None
    energy: float


def run(number: int) -> Found:
    """Return the result for the random chain `number`."""
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
    # The energy balance computes work from positions, so its round-off is relative to this product.
    worked = force * np.abs(found.position).max(axis=1)
    free = not chain.friction and not chain.walls
    moved = found.velocity @ mass - found.impulse
    most = float(np.abs(found.velocity * mass).sum(axis=1).max()) or 1.0
    largest = float((found.kinetic_energy + found.contact_energy + worked).max()) or 1.0
    return Found(
        family, number, coarser, found.steps, WarningCode.UNCONVERGED in codes, found.status.gave_up,
        float(np.ptp(moved)) / most if free else None, float(np.ptp(found.ledger)) / largest,
    )  # fmt: skip


def report(found: Sequence[Found]) -> Report:
    """Return the table with one row for each family of chains."""
    rows = []
    for family in (*dict.fromkeys(FAMILIES), "all"):
        mine = [one for one in found if family in (one.family, "all")]
        bad = [one.seed for one in mine if one.unconverged or one.gave_up]
        told = [[getattr(one, name) for one in mine] for name in ("momentum", "energy")]
        worst = [f"{max(values):.1e}" if (values := [x for x in column if x is not None]) else "-" for column in told]
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
        f"steps of {', '.join(f'{part:g}' for part in COARSER)} times the default step, in turn; at most {LONGEST:g} steps",
        "momentum: error in chains without friction and walls, relative to the impulse of the drive; energy: error of the ledger",
        f"made by `python -m benchmarks conserving --count {len(found)}`",
    ]
    columns = ["family", "chains", "steps", "not converged", "momentum off", "energy off", "seeds"]
    return Report("Random chains by conserving", columns, rows, notes)


@dataclass(frozen=True)
class Error:
    """Error of the final velocities, and the number of contacts that closed again.

    The error is relative to the closing speed, or to the speed that the external force gives.
    """

    seed: int
    coarser: float
    returns: int
    error: float
    warned: bool


def errors(number: int, families: Sequence[str] = KEEPING) -> list[Error]:
    """Return the errors of the method conserving in the random collision `number`. The list has one error for each step
    size.
    """
    moving = motion(families[number % len(families)], number)
    chain, velocity = moving.chain, np.array(moving.velocity)
    step, found = default_step(chain, velocity, moving.duration), []
    probe = solve(chain, velocity, min(moving.duration or np.inf, LONGEST_COLLISION * step), "conserving", step, 2)
    duration = float(probe.time[-1])
    truth = solve(chain, velocity, duration, "conserving", step / FINER, 2).final_velocity
    for coarser in STEPS_OF_ERRORS:
        run = solve(chain, velocity, duration, "conserving", coarser * step, 2)
        again = sum(max(len(each) - 1, 0) for each in run.contact_intervals)
        off = float(np.abs(run.final_velocity - truth).max()) / speed_scale(chain, velocity, duration)
        warned = any(warning.code is WarningCode.RETURNS for warning in run.warnings)
        found.append(Error(number, coarser, again, off, warned))
    return found


def error_report(found: Sequence[Error], options: str = "") -> Report:
    """Return the table with two rows for each step size: simulations with and without the warning that contacts close
    again.
    """
    rows = []
    for coarser in STEPS_OF_ERRORS:
        for warned in (False, True):
            mine = sorted(
                (one for one in found if one.coarser == coarser and one.warned == warned), key=lambda one: one.error
            )
            beyond = [one for one in mine if one.error > LARGE]
            middle, high, worst = (
                f"{mine[k].error:.1e}" if mine else "" for k in (len(mine) // 2, 9 * len(mine) // 10, -1)
            )
            seeds = " ".join(f"{one.seed} ({one.returns})" for one in beyond[-9:])
            rows.append(
                [
                    f"{coarser:g}",
                    "yes" if warned else "no",
                    str(len(mine)),
                    middle,
                    high,
                    worst,
                    str(len(beyond)),
                    seeds,
                ]
            )
    notes = [
        "error: difference of the final velocities from a run with a step "
        f"{FINER:g} times finer than the default one, as a fraction of the closing speed or of the speed that the drive reaches",
        "if contacts chatter, the finer run is not exact either: the error is then the difference of two runs",
        f"made by `python -m benchmarks conserving --errors{options} --count {len(found) // len(STEPS_OF_ERRORS)}`",
    ]
    columns = [
        "step / default",
        "warned",
        "runs",
        "median",
        "nine tenths below",
        "largest",
        f"beyond {LARGE:g}",
        "seeds (contacts closed again)",
    ]
    return Report("Errors of conserving, and its warning of contacts that close again", columns, rows, notes)


def main(arguments: list[str]) -> int:
    """Run the scan. Return the exit code, which is 1 if a step did not converge."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks conserving", description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=1000, help="chains in all (default %(default)s)")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="the first seed (default 0)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes (default %(default)s)")
    parser.add_argument(
        "--markdown", type=Path, metavar="FILE", help="write the table there too, for the documentation"
    )
    parser.add_argument(
        "--errors", action="store_true", help="what velocities are off by, and whether a warning says so"
    )
    parser.add_argument("--lossy", action="store_true", help="errors where friction or loss takes energy")
    args = parser.parse_args(arguments)
    if args.lossy and not args.errors:
        parser.error("--lossy is for --errors")
    numbers = range(args.first, args.first + args.count)
    with ProcessPoolExecutor(args.jobs) as processes:
        if args.errors:
            of_number = partial(errors, families=LOSING if args.lossy else KEEPING)
            each = list(track(processes.map(of_number, numbers, chunksize=CHUNK), "conserving", total=len(numbers)))
            found, table = [], error_report([one for group in each for one in group], " --lossy" * args.lossy)
        else:
            found = list(track(processes.map(run, numbers, chunksize=CHUNK), "conserving", total=len(numbers)))
            table = report(found)
    table.show(Console())
    if args.markdown:
        args.markdown.write_text(table.markdown(), encoding="utf-8")
    return 1 if any(one.unconverged or one.gave_up for one in found) else 0
