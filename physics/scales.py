"""Time scales of a chain, from energy alone: how deep and how long a contact can be pressed at given velocities."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.chain import GRAVITY, Chain

Array = NDArray[np.float64]

STEPS_A_CONTACT = 1000  # default fixed step: the shortest contact in this many steps
STEPS_A_STOP = 100  # and the stop of a bead on its bed


def closing_speed(velocity: ArrayLike) -> float:
    """Largest speed [m/s] at which any two beads approach; 1 where nothing moves, so that scales stay finite."""
    speeds = np.asarray(velocity, dtype=np.float64)
    return float(np.ptp(speeds)) or 1.0


def speed_scale(chain: Chain, velocity: ArrayLike) -> float:
    """Closing speed [m/s], or what the drive or the press at the start bring about where that is more; 1 where nothing does."""
    inner = max(_driven_speed(chain), _released_speed(chain))
    return max(float(np.ptp(np.asarray(velocity))), inner) if inner else closing_speed(velocity)


def _released_speed(chain: Chain) -> float:
    """Largest speed at which the two beads of a contact part that is pressed at the start, by its energy alone."""
    pressed = [i for i, gap in enumerate(chain.gap) if gap < 0.0]
    inverse_mass = chain.parameters.inverse_mass
    squares = [
        2.0 * float(chain.contact[i].energy(-chain.gap[i])) * float(inverse_mass[i] + inverse_mass[i + 1])
        for i in pressed
    ]
    return max(squares, default=0.0) ** 0.5


def _driven_speed(chain: Chain) -> float:
    """Largest speed that a contact reaches under the force by which the drive accelerates a rigid chain; 0 without."""
    if chain.drive_force is None:
        return 0.0
    law, inverse_mass = chain.parameters
    preload, stiffness, exponent = law.T
    force = np.maximum(_rigid_forces(chain, chain.drive_force) - preload, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = ((1.0 + exponent) * force / stiffness) ** (1.0 / exponent)
        speed = np.sqrt(2.0 * force * depth * (inverse_mass[:-1] + inverse_mass[1:]))
    return float(np.max(speed, where=np.isfinite(speed), initial=0.0))


def _rigid_forces(chain: Chain, drive: Array) -> Array:
    """(n,) contact forces [N] that let all beads accelerate as one; with a wall, at most what leans against it."""
    from_left, from_right = np.cumsum(drive)[:-1], -np.cumsum(drive[::-1])[-2::-1]
    if chain.walls:
        return np.maximum(from_left, from_right)
    share = np.cumsum(chain.mass)[:-1] / sum(chain.mass)
    rigid: Array = from_left - share * drive.sum()
    return rigid


def contact_scales(chain: Chain, velocity: ArrayLike) -> tuple[Array, Array]:
    """(n,) estimates of largest overlap [m] and contact time [s] if every contact were struck alone.

    Energy balance ``F d + K d**(1+a)/(1+a) = mu v**2 / 2`` with the reduced mass mu, taken from the smaller of its two
    one-term solutions; the time is that of crossing this overlap and back at the closing speed.
    """
    law, inverse_mass = chain.parameters
    preload, stiffness, exponent = law.T
    speed = speed_scale(chain, velocity)
    energy = 0.5 * speed**2 / (inverse_mass[:-1] + inverse_mass[1:])
    with np.errstate(divide="ignore"):
        by_power = ((1.0 + exponent) * energy / stiffness) ** (1.0 / (1.0 + exponent))
        depth = np.minimum(energy / preload, by_power)
    return depth, 2.0 * depth / speed


def default_step(chain: Chain, velocity: ArrayLike) -> float:
    """Step [s] of a fixed-step method where none is given: a thousandth of the shortest contact, or a hundredth of the time
    in which the bed stops a bead.
    """
    shortest = float(contact_scales(chain, velocity)[1].min()) / STEPS_A_CONTACT
    if not chain.friction:
        return shortest
    return min(shortest, speed_scale(chain, velocity) / (chain.friction * GRAVITY) / STEPS_A_STOP)
