"""The paper's experiment (App. C): one on three and two on two on a bed of straws, and what friction explains of it.

The paper states masses, spring, precompression, and "relative deficits in the momentum and energy upon collision" of
5-10 % and 10-20 %. It does not state the launch speed, nor over which time the deficits were taken. Here they are taken
from the first touch to the last opening.

The text bounds the speed. A target cluster that leaves as one body needs less than the critical speed (1.01 m/s at one
on three). A kymograph with bars of 100 ms and 12 cm shows slopes well below that of its bars' diagonal, 1.2 m/s. Its
marker still moves some 100 ms later, on a bed that costs 5-10 % a collision. So the speed is 0.25 to 1 m/s, and 0.5 m/s
where one number is needed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from softcradle.physics import Chain, draft_gear, simulate

MASS = (0.3945, 0.3980, 0.3967, 0.3938)  # [kg]
STIFFNESS = 770.0  # [N/m]
PRECOMPRESSION = 0.0177  # [m]
STRIKERS = {"one on three": 1, "two on two": 2}  # by experiment
SPEEDS = (0.25, 0.5, 0.75, 1.0)  # [m/s] launch speeds that the text allows
MOMENTUM_DEFICIT = (0.05, 0.10)  # as stated
ENERGY_DEFICIT = (0.10, 0.20)  # as stated
LARGEST_FRICTION = 1.0  # upper end of the search for the coefficient


@dataclass(frozen=True)
class Deficits:
    """Parts of momentum and energy that a collision has lost, and its time [s] from first touch to last opening."""

    momentum: float
    energy: float
    time: float


@dataclass(frozen=True)
class Fit:
    """Friction of the bed, fitted at a launch speed [m/s], and the deficits that it gives with gears without loss."""

    experiment: str
    speed: float
    friction: float
    deficits: Deficits


@cache
def deficits(strikers: int, speed: float, friction: float, loss: float = 0.0, method: str = "conserving") -> Deficits:
    """Deficits when `strikers` at `speed` [m/s] collide with the rest, which just touch, on a bed with friction."""
    chain = Chain(MASS, draft_gear(STIFFNESS, PRECOMPRESSION, loss), friction=friction)
    velocity = [speed] * strikers + [0.0] * (len(MASS) - strikers)
    whole = simulate(chain, velocity, method=method, samples=2)
    end = max(opened for intervals in whole.contact_intervals for _, opened in intervals if np.isfinite(opened))
    found = simulate(chain, velocity, end, method=method, samples=2)
    momentum, energy = (values[-1] / values[0] for values in (found.momentum, found.kinetic_energy))
    return Deficits(1.0 - float(momentum), 1.0 - float(energy), end)


def friction_for(momentum: float, strikers: int, speed: float) -> float:
    """Coefficient of friction at which the collision loses the part `momentum`, with gears without loss."""
    from scipy.optimize import brentq  # not needed to list the claims

    return float(
        brentq(lambda friction: deficits(strikers, speed, friction).momentum - momentum, 0.0, LARGEST_FRICTION)
    )


def friction_range(strikers: int, speed: float) -> tuple[float, float]:
    """Coefficients whose momentum deficit is within the stated one, with gears without loss."""
    low, high = (friction_for(part, strikers, speed) for part in MOMENTUM_DEFICIT)
    return low, high


def fit_friction(speed: float) -> list[Fit]:
    """Friction alone: one coefficient for both experiments, in the middle of what their momentum deficits allow."""
    ranges = [friction_range(strikers, speed) for strikers in STRIKERS.values()]
    low, high = max(low for low, _ in ranges), min(high for _, high in ranges)
    friction = 0.5 * (low + high)
    return [Fit(name, speed, friction, deficits(k, speed, friction)) for name, k in STRIKERS.items()]
