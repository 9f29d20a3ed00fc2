"""What holds for any motion of any chain, whatever the method: energies, momenta, order of the beads."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics import METHODS, Chain, State
from softcradle.physics.methods import Family

Array = NDArray[np.float64]

NAMES = tuple(method.name for method in METHODS)
FIXED_STEP = tuple(method for method in METHODS if not method.adaptive)
ADAPTIVE = tuple(method for method in METHODS if method.adaptive)
SET_VALUED = tuple(method for method in METHODS if method.set_valued)
LIVE = tuple(method for method in FIXED_STEP if method.family is Family.FIXED_STEP)

EPSILON = float(np.finfo(float).eps)


def finite(chain: Chain) -> NDArray[np.bool_]:
    """Which beads are no walls."""
    return np.isfinite(chain.mass)


def momentum(chain: Chain, velocity: ArrayLike) -> float:
    """Momentum of the beads, walls left out."""
    bead = finite(chain)
    return float(np.array(chain.mass)[bead] @ np.asarray(velocity)[bead])


def momentum_scale(chain: Chain, velocity: ArrayLike) -> float:
    """Sum of the beads' momenta without their signs: what round-off is measured against."""
    bead = finite(chain)
    return float(np.array(chain.mass)[bead] @ np.abs(np.asarray(velocity)[bead])) or 1.0


def kinetic_energy(chain: Chain, velocity: ArrayLike) -> float:
    """Kinetic energy of the beads, walls left out."""
    bead = finite(chain)
    return 0.5 * float(np.array(chain.mass)[bead] @ np.asarray(velocity)[bead] ** 2)


def total_energy(chain: Chain, state: State) -> float:
    """Kinetic energy and what the contacts store."""
    stored = sum(float(c.energy(d)) for c, d in zip(chain.contact, state.overlap, strict=True))
    return kinetic_energy(chain, state.velocity(chain)) + stored


def separating(velocity: ArrayLike, tolerance: float) -> bool:
    """Whether no bead runs into the next, as must be when all contacts are open for good."""
    return bool((np.diff(np.asarray(velocity)) >= -tolerance).all())
