"""What holds for any motion of any chain, whatever the method: energies, momenta, order of the beads."""

import math
import warnings
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics import METHODS, Chain, State, Trajectory, simulate
from softcradle.physics.methods import Family, find_method

Array = NDArray[np.float64]

NAMES = tuple(method.name for method in METHODS)
FIXED_STEP = tuple(method for method in METHODS if not method.adaptive)
ADAPTIVE = tuple(method for method in METHODS if method.adaptive)
SET_VALUED = tuple(method for method in METHODS if method.set_valued)
LIVE = tuple(method for method in FIXED_STEP if method.family is Family.FIXED_STEP)

KERNELS = tuple(method.name for method in METHODS if method.family is Family.ADAPTIVE)

EPSILON = float(np.finfo(float).eps)
PROMISE = 10.0  # tolerances: the error of final velocities in adaptive methods, or there is a warning
# of the sum of momenta, for a step and a bead: light beads between heavy ones multiply round-off; the worst of 12 800 random
# collisions had a third of it
MOMENTUM_ROUND_OFF = 10_000 * EPSILON


def simulate_quietly(*arguments: Any, **options: Any) -> Trajectory:
    """`simulate`, with its warnings on the Trajectory alone."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return simulate(*arguments, **options)


def run(*arguments: Any, **options: Any) -> Trajectory:
    """`simulate` with two samples unless more are wanted."""
    return simulate(*arguments, **{"samples": 2} | options)


def fineness(method: str, step: float, **of_adaptive: float) -> dict[str, float]:
    """The step of a fixed-step method, which adaptive ones have not; what is given of these, a tolerance, otherwise."""
    return of_adaptive if find_method(method).adaptive else {"step": step}


def struck(chain: Chain) -> Array:
    """Start velocities: the first bead at 1 m/s, all others at rest."""
    return np.eye(1, chain.contacts + 1)[0]


def closing_speed(velocity: ArrayLike) -> float:
    """Largest less smallest velocity; 1 where all beads move alike."""
    return float(np.ptp(np.asarray(velocity))) or 1.0


def momentum(chain: Chain, velocity: ArrayLike) -> float:
    return float(chain.finite_mass @ np.asarray(velocity))


def momentum_scale(chain: Chain, velocity: ArrayLike) -> float:
    """Sum of the beads' momenta without their signs: what round-off is measured against."""
    return float(chain.finite_mass @ np.abs(np.asarray(velocity))) or 1.0


def kinetic_energy(chain: Chain, velocity: ArrayLike) -> float:
    return 0.5 * float(chain.finite_mass @ np.asarray(velocity) ** 2)


def total_energy(chain: Chain, state: State) -> float:
    return kinetic_energy(chain, state.velocity(chain)) + float(chain.stored_energy(state.overlap).sum())


def energy_error(found: Trajectory, velocity: ArrayLike) -> float:
    """Largest error of the energy over the run, relative to the kinetic energy of all beads at the start."""
    energy = found.kinetic_energy + found.contact_energy
    scale = kinetic_energy(found.chain, np.abs(velocity)) or 1.0
    return float(np.abs(energy - energy[0]).max()) / scale


def ledger_error(found: Trajectory) -> float:
    """Largest change over the run of the sum of all energies, absorbed ones included, relative to the energy involved."""
    scale = found.kinetic_energy[0] + found.contact_energy[0] + np.abs(found.driven).max()
    return float(np.ptp(found.ledger)) / scale


def digits(found: Trajectory) -> list[object]:
    """All that two runs have alike which take the same steps."""
    arrays = found.time, found.overlap, found.velocity, found.force, found.final_velocity, found.velocity_error
    counted = found.contact_intervals, found.steps, found.evaluations, found.status
    return [*(array.tobytes() for array in arrays), *counted]


def assert_momentum(found: Trajectory, velocity: ArrayLike, tolerance: float = 0.0) -> None:
    """Momentum less what is given stays, to round-off and ten times `tolerance`; a chain with a wall has none of its own.

    Velocities are sums over the chain, and rounding errors add up over the steps as a random walk.
    """
    if found.chain.walls:
        return
    before = momentum(found.chain, velocity)
    scale = max(momentum_scale(found.chain, row) for row in found.velocity)
    round_off = MOMENTUM_ROUND_OFF * math.sqrt(found.steps + 1) * (found.chain.contacts + 1) * scale
    last = momentum(found.chain, found.final_velocity) - found.impulse[-1]
    kept = np.append(found.momentum - found.impulse, last)
    assert np.abs(kept - before).max() < round_off + 10.0 * tolerance * scale


def assert_sound(found: Trajectory) -> None:
    """All samples are finite, contacts only push, and each contact's closings and openings are in order of time."""
    for array in (found.position, found.velocity, found.overlap, found.force, found.final_velocity):
        assert np.isfinite(array).all()
    for intervals in found.contact_intervals:
        times = [time for interval in intervals for time in interval]
        assert times == sorted(times)
    assert (found.force >= 0.0).all()
