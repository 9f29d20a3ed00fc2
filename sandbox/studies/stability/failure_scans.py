"""The scans: one on n beads over exponent, number and preload, by every step or tolerance; what each run shows of failure."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import METHODS, Chain, Contact, Trajectory, one_on, power_law, stable_step
from softcradle.physics.advice.explicit_limits import TRUSTED_ERROR
from softcradle.physics.methods import Method
from softcradle.physics.simulation import solve

Array = NDArray[np.float64]

QUANTITIES = ("energy error", "velocity spread", "contact switches")
ALPHA, BEADS = 1 / 10, 4  # of the scans that vary something else
EXTRA = 2.0  # every run goes on for so many contact times of rigid clusters: chatter may never end
FINE = 1e-10  # tolerance of the motion that all are held against
STEPS = tuple(float(step) for step in np.geomspace(3e-4, 0.3, 13))  # [s]
TOLERANCES = tuple(float(10.0**-k) for k in np.linspace(8.0, 1.0, 8))
LEFT_OUT = ("pymunk", "scipy")  # the digits of euler, and the reference: thousands of runs of them take hours
KEPT = 3.0  # times its tolerance: what an adaptive method may be off by
TOO_MANY = 2  # contacts that close more often than they should by more than this chatter


@dataclass(frozen=True)
class Scan:
    """One thing that is varied.

    Attributes:
        name, label: for files, and for the axis.
        values: what it takes, ascending.
        chain: the chain at a value.
    """

    name: str
    label: str
    values: tuple[float, ...]
    chain: Callable[[float], Chain]


def _preloaded(ratio: float) -> Chain:
    """A draft gear whose preload is `ratio` of the force at the greatest overlap of a bead alone; the stiffness is 1."""
    return one_on(BEADS, Contact(ratio, 1.0, 1.0))


SCANS: tuple[Scan, ...] = (
    Scan(
        "alpha", "exponent alpha, one on 4", tuple(float(a) for a in np.geomspace(0.01, 2.0, 12)),
        lambda alpha: one_on(BEADS, power_law(1.0, alpha)),
    ),
    Scan("n", "targets n, alpha = 1/10", (1.0, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 14.0, 20.0),
         lambda n: one_on(int(n), power_law(1.0, ALPHA))),
    Scan("preload", "preload / (stiffness x 1 m), one on 4", (0.0, *(float(f) for f in np.geomspace(0.01, 10.0, 10))),
         _preloaded),
)  # fmt: skip


@dataclass(frozen=True)
class Spot:
    """One run.

    Attributes:
        scan, value, method, fineness: what was run; the fineness is a step [s] or a tolerance.
        energy: largest distance of the energy from that at the start, relative to it, over the samples.
        final_energy: the same at the end.
        spread: root mean square distance of the target velocities from what they should be, by the closing speed.
        switches: how often contacts closed or opened beyond what they should, over all.
        warned: whether the trajectory said that something is wrong.
        limit: `stable_step` of the chain [s].
        allowed: what `spread` may be: TRUSTED_ERROR, or some times the tolerance where that is more.
    """

    scan: str
    value: float
    method: str
    fineness: float
    energy: float
    final_energy: float
    spread: float
    switches: int
    warned: bool
    limit: float
    allowed: float

    @property
    def failure(self) -> str:
        """How the run has failed: "blow-up", "chatter", "error"; "" where the velocities are as they should be."""
        if not self.spread <= self.allowed:
            if not self.final_energy <= 1.0:
                return "blow-up"
            return "chatter" if self.switches > TOO_MANY else "error"
        return ""


def methods() -> list[Method]:
    """Those that are mapped."""
    return [method for method in METHODS if method.name not in LEFT_OUT]


def finenesses(method: Method) -> tuple[float, ...]:
    """Steps [s], or tolerances."""
    return TOLERANCES if method.adaptive else STEPS


def spots(scan: Scan, method: Method, steps: Sequence[float] | None = None) -> Iterator[Spot]:
    """Every run of a scan by a method."""
    for value in scan.values:
        for fineness in finenesses(method) if steps is None else steps:
            yield spot(scan, value, method, fineness)


def spot(scan: Scan, value: float, method: Method, fineness: float) -> Spot:
    """One run, held against the true motion."""
    chain = scan.chain(value)
    velocity, true = _truth(chain)
    wish = {"tolerance": fineness} if method.adaptive else {"step": fineness}
    found = quietly(chain, velocity, float(true.time[-1]), method.name, **wish)
    energy = found.kinetic_energy + found.contact_energy
    off = np.abs(energy / energy[0] - 1.0)
    apart = np.sqrt(np.mean((found.final_velocity - true.final_velocity)[1:] ** 2))
    return Spot(
        scan.name, value, method.name, fineness, _finite(off.max()), _finite(off[-1]), _finite(apart),
        max(_switches(found) - _switches(true), 0), bool(found.warnings), stable_step(chain, velocity, TRUSTED_ERROR),
        max(TRUSTED_ERROR, KEPT * fineness) if method.adaptive else TRUSTED_ERROR,
    )  # fmt: skip


@lru_cache(maxsize=64)
def _truth(chain: Chain) -> tuple[Array, Trajectory]:
    """Start velocities and the true motion, some time beyond its end."""
    velocity = np.eye(1, chain.contacts + 1)[0]
    ended = quietly(chain, velocity, None, "accurate", tolerance=1e-6)
    return velocity, quietly(chain, velocity, EXTRA * min(float(ended.time[-1]), 100.0), "accurate", tolerance=FINE)


def quietly(chain: Chain, velocity: Array, duration: float | None, method: str, **fineness: float) -> Trajectory:
    """A run whose warnings are heard in the trajectory alone."""
    return solve(chain, velocity, duration, method, fineness.get("step"), 101, fineness.get("tolerance", FINE))


def _switches(found: Trajectory) -> int:
    """How often contacts have closed or opened."""
    return sum(2 * len(some) - sum(math.isinf(opened) for _, opened in some) for some in found.contact_intervals)


def _finite(value: float) -> float:
    return float(value) if np.isfinite(value) else math.inf
