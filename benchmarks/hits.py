"""``python -m benchmarks hits [--chains N] [--seed N]``: compare tables of hits of random chains with the reference.

The reference integrates the equations of motion with SciPy and shares no kernel with the tested method. The dense
solution gives the contact times and the speeds. A root search of the overlap rate gives the largest forces. The
dissipated energies are the integrals of force times rate.
"""

from __future__ import annotations

import argparse
import warnings
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from scipy.optimize import brentq
from softcradle.physics.hit_table import COLUMNS
from softcradle.physics.problem import Problem
from softcradle.physics.reference.runner import GAUSS, _Run
from softcradle.physics.state import State, from_anchor
from softcradle.physics.status import Status
from softcradle.sandbox.console import ProgressShown
from softcradle.sandbox.sweeps import grid
from softcradle.sandbox.sweeps.run_sweep import Progress, map_points

from benchmarks.reports import Report
from softcradle import Chain, Contact, draft_gear, hertz, hooke, power_law, simulate, step_force

Array = NDArray[np.float64]

CHAINS = 1000
TOLERANCE = 1e-6  # Tolerance of the tested simulations, relative to the closing speed.
FINE = 1e-8  # Tolerance of the reference. A smaller tolerance would take minutes for a soft contact.
# Allowed error of a value in units of the tolerance times its scale. Later collisions amplify the errors of earlier
# ones.
ALLOWED = 100.0
LOOKS = 33  # Number of times in a collision at which the reference looks for the largest overlap.
COMPARED = tuple(name for name in COLUMNS if name != "contact")


def random_chain(seed: int) -> tuple[Chain, Array]:
    """Return a random chain of 2 or 3 beads with its velocities. All kinds of contacts occur, and half of the chains
    have loss.
    """
    draw = np.random.default_rng(seed)
    n = int(draw.integers(1, 3))
    lossy = draw.random() < 0.5

    def law() -> Contact:
        size, loss = 10.0 ** draw.uniform(-1.0, 2.0), float(draw.choice([0.1, 0.4, 0.7])) if lossy else 0.0
        kinds = (
            lambda: power_law(size, float(draw.uniform(0.1, 0.9)), loss),
            lambda: hertz(10.0 * size, loss),
            lambda: hooke(size, loss),
            lambda: step_force(size, loss),
            lambda: draft_gear(size, float(draw.uniform(0.01, 0.3)), loss),
            lambda: Contact(0.1 * size, size, float(draw.uniform(0.5, 2.0)), loss),
        )
        return kinds[int(draw.integers(len(kinds)))]()

    mass = 10.0 ** draw.uniform(-0.7, 0.7, n + 1)
    gap = draw.uniform(0.05, 1.0, n)
    return Chain(mass, [law() for _ in range(n)], gap), -np.sort(-draw.uniform(-1.0, 1.0, n + 1))


def reference_hits(chain: Chain, velocity: Array) -> Array | None:
    """Return the table of collisions by the reference as rows (contact, begin, end, ...).

    Return None if the table would not be complete.
    """
    solved = _Run(Problem(chain, State.at_start(chain, velocity), "scipy", None, tolerance=FINE), None)
    solved.begin()
    solved.until(np.inf)
    if solved.status is not Status.SEPARATED:
        return None
    spans: dict[int, list[list[float]]] = {k: [] for k in range(chain.contacts)}
    for contact, time in solved.switches:
        own = spans[contact]
        if own and len(own[-1]) == 1:
            own[-1].append(time)
        else:
            own.append([time])
    rows = []
    for contact, own in spans.items():
        for span in own:
            if len(span) == 1:
                return None
            rows.append((contact, *span, *_numbers(solved, chain, contact, *span)))
    return np.array(sorted(rows, key=lambda row: (row[1], row[0])), float).reshape(-1, len(COLUMNS))


def _numbers(solved: _Run, chain: Chain, contact: int, begin: float, end: float) -> tuple[float, float, float, float]:
    """Return impulse, closing speed, largest force and dissipated energy of a collision."""
    # The state at the end of the simulation is its last sample, so times are kept below the end.
    ends = np.array([begin, np.nextafter(end, begin)])
    rows = solved.samples(ends)
    bead = from_anchor(rows["rate"], rows["anchor"][:, 1], chain.anchor)
    right = slice(contact + 1, None)
    impulse = float(np.asarray(chain.mass)[right] @ (bead[1, right] - bead[0, right]))
    times = np.linspace(*ends, LOOKS)
    looked = solved.samples(times)
    k = int(np.argmax(looked["overlap"][:, contact]))

    def rate(time: float) -> float:
        return float(solved.samples(np.array([time]))["rate"][0, contact])

    top = float(looked["overlap"][k, contact])
    for low, high in ((max(k - 1, 0), k), (k, min(k + 1, LOOKS - 1))):
        if low < high and rate(times[low]) > 0.0 > rate(times[high]):
            time = brentq(rate, times[low], times[high], xtol=1e-15)
            top = max(top, float(solved.samples(np.array([time]))["overlap"][0, contact]))
    force = max(float(looked["force"][:, contact].max()), float(chain.contact[contact].force(top)))
    return impulse, float(rows["rate"][0, contact]), force, _work(solved, contact, begin, end)


def _work(solved: _Run, contact: int, begin: float, end: float) -> float:
    """Return the work [J] on the contact during a collision, by Gauss quadrature in every step of the integrator."""
    total = 0.0
    for segment in solved.segments:
        edges = segment.start + segment.scale * segment.solution.ts
        edges = np.unique(np.clip(edges, max(begin, segment.start), min(end, segment.end)))
        if edges.size < 2 or edges[-1] > segment.end or edges[0] < segment.start:
            continue
        half, middle = 0.5 * np.diff(edges)[:, None], 0.5 * (edges[1:] + edges[:-1])[:, None]
        at = (middle + half * GAUSS[0]).ravel()
        states = segment.at(at)
        power = segment.phase.force(at, states)[:, contact] * states[:, solved.system.m + contact]
        total += float((half * power.reshape(len(half), -1)) @ GAUSS[1] @ np.ones(len(half)))
    return total


@dataclass(frozen=True)
class Compared:
    """Result of one chain: the number of collisions, and the largest error of each column of the table.

    The errors are in units of the tolerance times the scale of the column.

    Attributes:
        growth: estimated error of the simulation relative to its tolerance, at least 1.
    """

    seed: int
    hits: int
    same: bool
    errors: tuple[float, ...]
    growth: float


def compare(seed: int) -> Compared | None:
    """Compare one chain with the reference. Return None if the reference gives up or if a contact stays closed."""
    chain, velocity = random_chain(seed)
    with np.errstate(under="ignore"):  # Powers of overlaps close to 0 underflow.
        expected = reference_hits(chain, velocity)
    if expected is None or not len(expected):
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run = simulate(chain, velocity, samples=2, tolerance=TOLERANCE)
        table = run.hits()
    speed = run.speed_scale
    growth = max(1.0, float(np.nan_to_num(run.velocity_error).max()) / (TOLERANCE * speed))
    same = table["contact"].tolist() == expected[:, 0].astype(int).tolist()
    if not same:
        return Compared(seed, len(expected), False, (np.inf,) * len(COMPARED), growth)
    found = np.array([[row[name] for name in COMPARED] for row in table])
    energy = 0.5 * float(np.asarray(chain.mass) @ velocity**2)
    # An error of the speed changes a contact time in proportion to its duration. An error of the position changes it in
    # proportion to the time since the start.
    span = expected[:, 2]
    scales = np.array([
        span, span, np.full(len(span), 2.0 * float(np.sum(chain.mass)) * speed), np.full(len(span), speed), expected[:, 5],
        np.full(len(span), 2.0 * energy),
    ])  # fmt: skip
    errors = np.abs(found - expected[:, 1:]).T / scales / TOLERANCE
    return Compared(seed, len(expected), True, tuple(errors.max(axis=1).tolist()), growth)


def numbers_of(seed: int) -> dict[str, object]:
    """Return the result of `compare` as numbers. Without a table by the reference, the number of collisions is 0."""
    one = compare(seed)
    if one is None:
        return {"hits": 0.0, "same": 0.0, "errors": [np.nan] * len(COMPARED), "growth": np.nan}
    return {"hits": float(one.hits), "same": float(one.same), "errors": list(one.errors), "growth": one.growth}


def results(seed: int, count: int, progress: Progress | None = None) -> list[Compared]:
    """Return the results of the random chains of `count` seeds. Chains without a table by the reference are left out."""
    rows = map_points(numbers_of, grid({"seed": list(range(seed, seed + count))}), None, progress, alike=False)
    return [
        Compared(seed + k, int(row["hits"]), bool(row["same"]), tuple(row["errors"].tolist()), float(row["growth"]))
        for k, row in enumerate(rows)
        if row["hits"]
    ]


def summary(found: list[Compared]) -> Report:
    """Return a table with the errors of each column of the tables of collisions."""
    same = [one for one in found if one.same]
    errors = np.array([one.errors for one in same]) if same else np.zeros((0, len(COMPARED)))
    growth = np.array([one.growth for one in same])
    rows = []
    for k, name in enumerate(COMPARED):
        parts = np.quantile(errors[:, k], [0.5, 0.99, 1.0]) if same else [np.nan] * 3
        rows.append([name, *(f"{part:.3g}" for part in parts)])
    held = int((errors.max(axis=1) <= ALLOWED * growth).sum()) if same else 0
    hits = sum(one.hits for one in found)
    notes = [
        f"{len(same)} of {len(found)} chains have the same {hits} hits as the reference",
        f"{held} chains have all values within {ALLOWED:g} tolerances times the estimated error amplification of the run",
    ]
    data = {"chains": len(found), "same": len(same), "held": held, "hits": hits, "largest": errors.max(axis=0).tolist()}
    titles = ["column", "median", "99 %", "largest"]
    return Report(
        f"Errors of hits in tolerances ({TOLERANCE:g}) times the scale of the value", titles, rows, notes, data
    )


def main(arguments: list[str]) -> int:
    """Compare the chains and print the table. Return 1 if a chain has other collisions or a too large error."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks hits", description=__doc__.splitlines()[0])
    parser.add_argument("--chains", type=int, default=CHAINS, help=f"number of chains (default {CHAINS})")
    parser.add_argument("--seed", type=int, default=0, help="first seed (default 0)")
    args = parser.parse_args(arguments)
    began = perf_counter()
    with ProgressShown("points") as progress:
        found = results(args.seed, args.chains, progress.tell)
    report = summary(found)
    report.show(Console())
    for one in found:
        if not one.same or max(one.errors) > ALLOWED * one.growth:
            print(
                f"seed {one.seed}: {'other hits' if not one.same else max(one.errors)}, amplification {one.growth:.3g}"
            )
    print(f"{perf_counter() - began:.0f} s")
    return 0 if report.data["held"] == report.data["chains"] else 1
