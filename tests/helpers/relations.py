"""Relations that hold for every motion of every chain with every method. The relations concern energy, momentum and the
order of the beads.
"""

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
# Guaranteed error of final velocities in adaptive methods, as a multiple of the tolerance. A run with a larger error
# must warn.
PROMISE = 10.0
# Round-off of the momentum per step and bead, relative to the sum of the absolute momenta. Light beads between heavy
# beads amplify round-off. In 12 800 random collisions, the largest round-off was a third of this limit.
MOMENTUM_ROUND_OFF = 10_000 * EPSILON


def simulate_quietly(*arguments: Any, **options: Any) -> Trajectory:
    """Call `simulate` without showing its RuntimeWarnings. The Trajectory still contains them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return simulate(*arguments, **options)


def run(*arguments: Any, **options: Any) -> Trajectory:
    """Call `simulate`. If the number of samples is not given, use two samples."""
    return simulate(*arguments, **{"samples": 2} | options)


def fineness(method: str, step: float, **of_adaptive: float) -> dict[str, float]:
    """Return the keyword arguments that determine the accuracy of a method. A fixed-step method gets a step size. An
    adaptive method gets the keywords `of_adaptive`, for example a tolerance.
    """
    return of_adaptive if find_method(method).adaptive else {"step": step}


def struck(chain: Chain) -> Array:
    """Return start velocities: 1 m/s for the first bead and 0 for all other beads."""
    return np.eye(1, chain.contacts + 1)[0]


def closing_speed(velocity: ArrayLike) -> float:
    """Return the largest velocity minus the smallest velocity [m/s]. Return 1 if all beads have the same velocity."""
    return float(np.ptp(np.asarray(velocity))) or 1.0


def momentum(chain: Chain, velocity: ArrayLike) -> float:
    return float(chain.finite_mass @ np.asarray(velocity))


def momentum_scale(chain: Chain, velocity: ArrayLike) -> float:
    """Return the sum of the absolute momenta of the beads [N s]. The round-off of the momentum is proportional to this
    sum.
    """
    return float(chain.finite_mass @ np.abs(np.asarray(velocity))) or 1.0


def kinetic_energy(chain: Chain, velocity: ArrayLike) -> float:
    return 0.5 * float(chain.finite_mass @ np.asarray(velocity) ** 2)


def total_energy(chain: Chain, state: State) -> float:
    return kinetic_energy(chain, state.velocity(chain)) + float(
        chain.stored_energy(state.overlap, force=state.force).sum()
    )


def energy_error(found: Trajectory, velocity: ArrayLike) -> float:
    """Return the largest energy error during the run, as a fraction of the kinetic energies of the beads at the start."""
    energy = found.kinetic_energy + found.contact_energy
    scale = kinetic_energy(found.chain, np.abs(velocity)) or 1.0
    return float(np.abs(energy - energy[0]).max()) / scale


def ledger_error(found: Trajectory) -> float:
    """Return the largest error of the energy balance during the run, as a fraction of the energies in the motion. The
    balance includes absorbed energy.
    """
    scale = found.kinetic_energy[0] + found.contact_energy[0] + np.abs(found.driven).max()
    return float(np.ptp(found.ledger)) / scale


def digits(found: Trajectory) -> list[object]:
    """Return the results of a run that must be bitwise equal in two runs with the same steps."""
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
    """Check that all samples are finite and that contacts do not pull. The times at which each contact closes and opens
    must be in order.
    """
    for array in (found.position, found.velocity, found.overlap, found.force, found.final_velocity):
        assert np.isfinite(array).all()
    for intervals in found.contact_intervals:
        times = [time for interval in intervals for time in interval]
        assert times == sorted(times)
    assert (found.force >= 0.0).all()
