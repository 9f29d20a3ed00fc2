"""Error of final velocities over the tolerance asked for, scanned over tolerances: the promise is ten at the most."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, one_on, power_law, simulate

from benchmarks.report import Report
from softcradle import scenes

Array = NDArray[np.float64]

TOLERANCES = 10.0 ** (-0.25 * np.arange(12, 41))  # quarter decades, 1e-3 to 1e-10
METHODS = ("accurate", "radau")
FINEST, FINER = 1e-13, 1e-12  # the truth is by radau, where these two agree so well,
SURE = 1e-7  # [m/s]
CONFIRMED = (1e-10, 1e-9)  # else the finer of these that does not warn
PROMISE = 10.0
DEEP = {5: 14, 10: 30, 20: 50}  # one on n, alpha = 1 / this


@dataclass(frozen=True)
class Motion:
    """A motion to scan: chain, start (n+1,) [m/s], duration [s] or None until it is over."""

    name: str
    chain: Chain
    velocity: tuple[float, ...]
    duration: float | None = None


def motions() -> Iterator[Motion]:
    """Deep clusters, and every lane of every scene once."""
    for n, softness in DEEP.items():
        yield Motion(f"one on {n}, alpha 1/{softness}", one_on(n, power_law(1.0, 1.0 / softness)), (1.0,) + (0.0,) * n)
    seen = set()
    for name in scenes.names():
        scene = scenes.load(name)
        for k, lane in enumerate(scene.lanes):
            chain, velocity = lane.chain(), tuple(float(v) for v in lane.velocity)
            if (chain, velocity) not in seen and not chain.dissipative:
                seen.add((chain, velocity))
                ends = chain.walls < 2 and chain.drive is None
                yield Motion(f"{name}, lane {k + 1}", chain, velocity, None if ends else scene.duration)


def final(motion: Motion, method: str, tolerance: float) -> tuple[Array, bool]:
    """(n+1,) final velocities, and whether the run says that something is wrong."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # counted instead
        found = simulate(motion.chain, motion.velocity, motion.duration, method, samples=2, tolerance=tolerance)
    return found.final_velocity, bool(found.warnings)


def best_known(motion: Motion) -> Array:
    """(n+1,) final velocities [m/s]; a chain that rattles is not the better known the finer the tolerance."""
    fine, check = (final(motion, "radau", tolerance)[0] for tolerance in (FINEST, FINER))
    if np.abs(fine - check).max() < SURE:
        return fine
    runs = [final(motion, "radau", tolerance) for tolerance in CONFIRMED]
    return next((velocity for velocity, said in runs if not said), runs[-1][0])


def scan(motion: Motion, method: str, truth: Array) -> dict[str, Any]:
    """Worst error in tolerances, where, and how many runs said something."""
    speed = float(np.ptp(motion.velocity)) or 1.0
    silent, warned = [], 0
    for tolerance in TOLERANCES:
        velocity, said = final(motion, method, tolerance)
        warned += said
        if not said:
            silent.append((float(np.abs(velocity - truth).max() / (speed * tolerance)), float(tolerance)))
    worst, at = max(silent, default=(np.nan, np.nan))
    above = sum(bool(error > PROMISE) for error, _ in silent)
    return {"motion": motion.name, "method": method, "worst": worst, "at": at, "above": above, "warned": warned}


def reports() -> Iterator[Report]:
    """One table over all motions."""
    found = []
    for motion in motions():
        truth = best_known(motion)
        found += [scan(motion, method, truth) for method in METHODS]
    rows = [
        [f"{r['motion']}, {r['method']}", f"{r['worst']:.2g}", f"{r['at']:.1e}", str(r["above"]), str(r["warned"])]
        for r in found
    ]
    note = f"{TOLERANCES.size} tolerances from 1e-3 to 1e-10; truth: the finest run of radau that is sure of itself"
    columns = ["", "worst error / tolerance", "at", f"above {PROMISE:g}, unsaid", "runs that warn"]
    yield Report("Error of final velocities against the tolerance", columns, rows, [note], found)
