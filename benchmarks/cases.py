"""The collisions of the work-precision table: unit masses, unit speed, each with its true final velocities."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from physics import Chain, draft_gear, hertz, one_on, power_law, simulate
from physics.closed_forms import critical_speed

Array = NDArray[np.float64]

TRUTH = Path(__file__).parents[1] / "tests" / "data" / "truth.json"
REACHES = (1e-3, 1e-6, 1e-9)  # errors of final velocities, relative to the closing speed
FINE, CHECK = 1e-12, 3e-12  # tolerances of radau as the truth, and of accurate as its check
MARGIN = 1.001  # a peer that does not know when the collision is over runs this much longer


@dataclass(frozen=True)
class Case:
    """One collision.

    Attributes:
        name, chain, velocity: what collides.
        duration: None until the collision is over, else [s].
        end: when it is over [s].
        truth: (n+1,) final velocities [m/s].
        doubt: how far two ways to the truth lie apart; 0 where it is known in quadruple precision.
        aims: milliseconds wished for, by error reached.
    """

    name: str
    chain: Chain
    velocity: Array
    duration: float | None
    end: float
    truth: Array
    doubt: float
    aims: dict[float, float] = field(default_factory=dict)

    def error(self, velocity: Array) -> float:
        """Largest error of any final velocity, relative to the closing speed; inf for what is no number."""
        found = float(np.abs(velocity - self.truth).max() / np.ptp(self.velocity))
        return found if np.isfinite(found) else np.inf


@dataclass(frozen=True)
class Recipe:
    """A case before its truth is computed."""

    name: str
    build: Callable[[], Chain]
    duration: float | None = None
    aims: dict[float, float] = field(default_factory=dict)

    def cook(self) -> Case:
        """Compute, or look up, the truth."""
        chain = self.build()
        velocity = np.eye(1, chain.contacts + 1)[0]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # rescued Newton steps at the limit of round-off
            fine = simulate(chain, velocity, self.duration, method="radau", tolerance=FINE, samples=2)
            check = simulate(chain, velocity, self.duration, method="accurate", tolerance=CHECK, samples=2)
        known = _quadruple(self.name)
        truth = fine.final_velocity if known is None else known
        doubt = 0.0 if known is not None else float(np.abs(fine.final_velocity - check.final_velocity).max())
        return Case(self.name, chain, velocity, self.duration, float(fine.time[-1]), truth, doubt, self.aims)


def _quadruple(name: str) -> Array | None:
    found = json.loads(TRUTH.read_text()).get(name) if TRUTH.exists() else None
    return None if found is None else np.array([float(value) for value in found["vfinal"]])


def _gears() -> Chain:
    """One on ten draft gears whose precompression is such that unit speed is three times critical."""
    unit = critical_speed(draft_gear(1.0, 1.0), np.ones(11), 1)
    return one_on(10, draft_gear(1.0, 1.0 / (3.0 * unit)))


RECIPES = (
    Recipe("one on 4, alpha 1/10", lambda: one_on(4, power_law(1.0, 1 / 10)), aims={1e-6: 0.4, 1e-9: 0.7}),
    Recipe("one on 5, alpha 1/14", lambda: one_on(5, power_law(1.0, 1 / 14)), aims={1e-6: 1.0, 1e-9: 4.0}),
    Recipe("one on 10, alpha 1/30", lambda: one_on(10, power_law(1.0, 1 / 30)), aims={1e-6: 2.0, 1e-9: 8.0}),
    Recipe("one on 20, alpha 1/50", lambda: one_on(20, power_law(1.0, 1 / 50)), aims={1e-6: 8.0}),
    Recipe("one on 100, Hertz, t = 200", lambda: one_on(100, hertz(1.0)), 200.0, {1e-6: 2.0, 1e-9: 9.0}),
    Recipe("draft gear, one on 10, 3x critical", _gears, aims={1e-9: 2.0}),
)
