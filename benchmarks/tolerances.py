"""Error of final velocities relative to the tolerance, for many tolerances and scenes.

The guaranteed error is ten times the tolerance.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, one_on, power_law
from softcradle.physics.simulation import solve

from benchmarks.reports import Report
from softcradle import scenes

Array = NDArray[np.float64]

TOLERANCES = 10.0 ** (-0.25 * np.arange(12, 41))  # Tolerances from 1e-3 to 1e-10 in steps of a quarter of a decade.
METHODS = ("accurate", "radau")
PROMISED_ERROR = 10.0  # Guaranteed error as a multiple of the tolerance.
DEEP_CLUSTERS = {5: 14, 10: 30, 20: 50}  # Maps the number n of targets to 1/alpha.

# The true result is that of radau with the first of these tolerances, if the second one confirms it.
TRUTH_TOLERANCES = (1e-13, 1e-12)
AGREEMENT = 1e-7  # For chattering chains, the true result is that of the first of these tolerances without a warning.
# For chattering chains, the true result is that with the first of these tolerances that gives no warning.
UNWARNED_TOLERANCES = (1e-10, 1e-9)


@dataclass(frozen=True)
class Motion:
    """Motion that is scanned: chain, initial velocities (n+1,) [m/s], and duration [s] or None until the motion is
    over.
    """

    name: str
    chain: Chain
    velocity: tuple[float, ...]
    duration: float | None = None


def motions() -> Iterator[Motion]:
    """Yield collisions with long clusters, and every lane of every scene once."""
    for n, inverse_alpha in DEEP_CLUSTERS.items():
        chain = one_on(n, power_law(1.0, 1.0 / inverse_alpha))
        yield Motion(f"one on {n}, alpha 1/{inverse_alpha}", chain, (1.0,) + (0.0,) * n)
    seen = set()
    for name in scenes.names():
        scene = scenes.load(name)
        for k, lane in enumerate(scene.lanes):
            chain, velocity = lane.chain(), tuple(float(v) for v in lane.velocity)
            if (chain, velocity) not in seen and not chain.dissipative:
                seen.add((chain, velocity))
                ends = chain.walls < 2 and chain.drive is None
                yield Motion(f"{name}, lane {k + 1}", chain, velocity, None if ends else scene.duration)


def final_velocity(motion: Motion, method: str, tolerance: float) -> tuple[Array, bool]:
    """Return the (n+1,) final velocities, and True if the simulation contains a warning."""
    found = solve(motion.chain, motion.velocity, motion.duration, method, samples=2, tolerance=tolerance)
    return found.final_velocity, bool(found.warnings)


def true_velocity(motion: Motion) -> Array:
    """Return the best known (n+1,) final velocities [m/s]."""
    fine, check = (final_velocity(motion, "radau", tolerance)[0] for tolerance in TRUTH_TOLERANCES)
    if np.abs(fine - check).max() < AGREEMENT:
        return fine
    runs = [final_velocity(motion, "radau", tolerance) for tolerance in UNWARNED_TOLERANCES]
    return next((velocity for velocity, warned in runs if not warned), runs[-1][0])


def scan(motion: Motion, method: str, truth: Array) -> dict[str, Any]:
    """Return the largest error relative to its tolerance, among simulations without a warning.

    The result also contains the tolerance of this simulation, and the numbers of failures and warnings.
    """
    speed = float(np.ptp(motion.velocity)) or 1.0
    unwarned, warnings = [], 0
    for tolerance in TOLERANCES:
        velocity, warned = final_velocity(motion, method, tolerance)
        warnings += warned
        if not warned:
            unwarned.append((float(np.abs(velocity - truth).max() / (speed * tolerance)), float(tolerance)))
    worst, at = max(unwarned, default=(np.nan, np.nan))
    above = sum(bool(error > PROMISED_ERROR) for error, _ in unwarned)
    return {"motion": motion.name, "method": method, "worst": worst, "at": at, "above": above, "warned": warnings}


def reports() -> Iterator[Report]:
    """Yield one table over all motions."""
    found = []
    for motion in motions():
        truth = true_velocity(motion)
        found += [scan(motion, method, truth) for method in METHODS]
    rows = [
        [f"{r['motion']}, {r['method']}", f"{r['worst']:.2g}", f"{r['at']:.1e}", str(r["above"]), str(r["warned"])]
        for r in found
    ]
    note = f"{TOLERANCES.size} tolerances from 1e-3 to 1e-10; truth: the finest run of radau without doubt or warning"
    columns = ["", "worst error / tolerance", "at", f"above {PROMISED_ERROR:g} without warning", "runs that warn"]
    yield Report("Error of final velocities against the tolerance", columns, rows, [note], found)
