"""Relations that hold for any motion of any chain with any method: energy, momentum, order of the beads."""

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
# Guaranteed error of final velocities in adaptive methods, in tolerances. A run with a larger error must warn.
PROMISE = 10.0
# Round-off of the momentum per step and bead, relative to the sum of momenta. Light beads between heavy ones amplify
# round-off. The worst of 12 800 random collisions had a third of this bound.
MOMENTUM_ROUND_OFF = 10_000 * EPSILON


def simulate_quietly(*arguments: Any, **options: Any) -> Trajectory:
    """Call `simulate` without its RuntimeWarnings. The Trajectory still lists them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return simulate(*arguments, **options)


def run(*arguments: Any, **options: Any) -> Trajectory:
    """Call `simulate` with two samples by default."""
    return simulate(*arguments, **{"samples": 2} | options)


def fineness(method: str, step: float, **of_adaptive: float) -> dict[str, float]:
    """Return the step size for a fixed-step method, or the keywords `of_adaptive` (a tolerance) for an adaptive method."""
    return of_adaptive if find_method(method).adaptive else {"step": step}


def struck(chain: Chain) -> Array:
    """Return start velocities: the first bead at 1 m/s, all others at rest."""
    return np.eye(1, chain.contacts + 1)[0]


def closing_speed(velocity: ArrayLike) -> float:
    """Return the largest minus the smallest velocity [m/s], or 1 if all beads have the same velocity."""
    return float(np.ptp(np.asarray(velocity))) or 1.0


def momentum(chain: Chain, velocity: ArrayLike) -> float:
    return float(chain.finite_mass @ np.asarray(velocity))


def momentum_scale(chain: Chain, velocity: ArrayLike) -> float:
    """Return the sum of the absolute momenta of the beads [N s], the scale of the round-off of the momentum."""
    return float(chain.finite_mass @ np.abs(np.asarray(velocity))) or 1.0


def kinetic_energy(chain: Chain, velocity: ArrayLike) -> float:
    return 0.5 * float(chain.finite_mass @ np.asarray(velocity) ** 2)


def total_energy(chain: Chain, state: State) -> float:
    return kinetic_energy(chain, state.velocity(chain)) + float(
        chain.stored_energy(state.overlap, force=state.force).sum()
    )


def energy_error(found: Trajectory, velocity: ArrayLike) -> float:
    """Return the largest error of the energy over the run, relative to the sum of the kinetic energies at the start."""
    energy = found.kinetic_energy + found.contact_energy
    scale = kinetic_energy(found.chain, np.abs(velocity)) or 1.0
    return float(np.abs(energy - energy[0]).max()) / scale


def ledger_error(found: Trajectory) -> float:
    """Return the largest change of the energy balance (with absorbed energy) over the run, relative to the energies in
    the motion.
    """
    scale = found.kinetic_energy[0] + found.contact_energy[0] + np.abs(found.driven).max()
    return float(np.ptp(found.ledger)) / scale


def digits(found: Trajectory) -> list[object]:
    """Return all results that must be bitwise equal in two runs with the same steps."""
    arrays = found.time, found.overlap, found.velocity, found.force, found.final_velocity, found.velocity_error
    counted = found.contact_intervals, found.steps, found.evaluations, found.status
    return [*(array.tobytes() for array in arrays), *counted]


def assert_momentum(found: Trajectory, velocity: ArrayLike, tolerance: float = 0.0) -> None:
    """Check that the momentum minus external impulses stays constant, up to round-off and ten times `tolerance`.

    Chains with a wall are skipped because their momentum is not conserved. Velocities are sums over the chain, and
    rounding errors add up over the steps like a random walk.
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
    """Check that all samples are finite, that contacts only push, and that the switching times of each contact are in
    order.
    """
    for array in (found.position, found.velocity, found.overlap, found.force, found.final_velocity):
        assert np.isfinite(array).all()
    for intervals in found.contact_intervals:
        times = [time for interval in intervals for time in interval]
        assert times == sorted(times)
    assert (found.force >= 0.0).all()
