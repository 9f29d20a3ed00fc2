"""The arrows below beads: what they may show, each relative to the greatest that its scale has room for."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from softcradle.sandbox.draw.shared_scales import Scales
from softcradle.sandbox.languages import N_
from softcradle.sandbox.motion import Array, Motion

Shares = Callable[[Motion, int, Scales], Array]


def _velocity(motion: Motion, row: int, scales: Scales) -> Array:
    return motion.velocity[row] / max(map(abs, scales.velocity))


def _momentum(motion: Motion, row: int, scales: Scales) -> Array:
    mass = motion.chain.finite_mass
    shares: Array = mass * motion.velocity[row] / (mass.max() * max(map(abs, scales.velocity)) or 1.0)
    return shares


def _force(motion: Motion, row: int, scales: Scales) -> Array:
    """The force of both contacts of each bead together."""
    force = np.concatenate(([0.0], motion.force[row], [0.0]))
    shares: Array = np.clip(-np.diff(force) / scales.force, -1.0, 1.0)
    return shares


def _none(motion: Motion, row: int, scales: Scales) -> Array:
    return np.zeros(len(motion.chain.mass))


ARROWS: dict[str, Shares] = {
    N_("velocity"): _velocity,
    N_("momentum"): _momentum,
    N_("net force"): _force,
    N_("none"): _none,
}
