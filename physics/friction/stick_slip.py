"""Stick and slip: modes of beads on a bed and of contacts with loss. While none changes, friction is constant.

    bead       SLIDES +-1 (friction -+ mu m g, constant) until its velocity is 0     STICKS until more than mu m g is needed
    contact    PRESSED (its own law) until its rate is 0                             RELEASED ((1 - loss) of the law) likewise
               HELD (overlap fixed) until its force leaves [(1 - loss) f, f]

Beads that hold together move as one, and those that stick are a wall: a smaller chain without friction, which any method can
move. Which of several resting contacts and beads give way follows from accelerations: they are the least in the sense of Gauss.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.friction.bounded_least_squares import bounded_least_squares
from softcradle.physics.state import State

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

PRESSED, RELEASED, HELD = 0, 1, 2
RESTS = 3e-11  # of the scale of accelerations: a smaller one is round-off, and its bead or contact holds


@dataclass
class Modes:
    """`contact` (n,) PRESSED, RELEASED or HELD; `slides` (n+1,) direction of sliding, 0 for beads that stick or have no friction;
    `sticks` (n+1,)."""

    contact: Ints
    slides: Array
    sticks: NDArray[np.bool_]


def bed_force(chain: Chain) -> Array:
    """(n+1,) largest friction of each bead [N]; 0 for walls."""
    mass = np.where(np.isfinite(chain.mass), chain.mass, 0.0)
    return mass * chain.bed if chain.friction else np.zeros(len(chain.mass))


def law_force(chain: Chain, overlap: Array) -> Array:
    """(n,) forces of contacts that are pressed in to `overlap`."""
    return np.array([float(contact.force(d)) for contact, d in zip(chain.contact, overlap.tolist(), strict=True)])


def ranges(chain: Chain, state: State, still: NDArray[np.bool_]) -> tuple[Array, Array]:
    """(n,) smallest and largest force of each contact as it is now; `still` (n,) marks those whose rate is 0."""
    full = law_force(chain, state.overlap)
    preload = np.array([contact.preload for contact in chain.contact])
    touching = still & (state.overlap == 0.0)
    low = np.where(still | (state.rate < 0.0), (1.0 - chain.loss) * full, full)
    high = np.where(~still & (state.rate < 0.0), (1.0 - chain.loss) * full, full)
    return np.where(touching, 0.0, low), np.where(touching, preload, high)


def resolve_modes(chain: Chain, state: State, velocity: Array) -> Modes:
    """Modes right now, from overlaps, rates (exactly 0 where contacts stand still) and `velocity` (0 where beads rest)."""
    n = chain.contacts
    most = bed_force(chain)
    still = state.rate == 0.0
    low, high = ranges(chain, state, still)
    resting = (velocity == 0.0) & (most > 0.0)
    low_bed = np.where(resting, -most, -np.sign(velocity) * most)
    high_bed = np.where(resting, most, -np.sign(velocity) * most)
    root = np.sqrt(chain.parameters.inverse_mass)
    spread = np.eye(n + 1, n, -1) - np.eye(n + 1, n)  # contact i pushes bead i back and bead i+1 on
    external = state.external(chain)
    matrix = root[:, None] * np.hstack((spread, np.eye(n + 1)))
    bounds = np.concatenate((low, low_bed)), np.concatenate((high, high_bed))
    fixed = bounds[0] == bounds[1]
    wanted = -root * (0.0 if external is None else external) - matrix[:, fixed] @ bounds[0][fixed]
    x = bounds[0].copy()
    x[~fixed] = bounded_least_squares(matrix[:, ~fixed], wanted, bounds[0][~fixed], bounds[1][~fixed])
    acceleration = root * (matrix[:, ~fixed] @ x[~fixed] - wanted)
    scale = RESTS * (root**2 * (np.abs(np.hstack((spread, np.eye(n + 1)))) @ np.abs(x))).max(initial=0.0)
    apart = acceleration[:-1] - acceleration[1:]
    contact = np.where(state.rate < 0.0, RELEASED, PRESSED)
    between = np.where(np.abs(apart) <= scale, HELD, np.where(apart < 0.0, RELEASED, PRESSED))
    lossy = (chain.loss > 0.0) & (state.overlap > 0.0)
    contact = np.where(lossy, np.where(still, between, contact), PRESSED)
    sticks = resting & (np.abs(acceleration) <= scale)
    slides = np.where(most > 0.0, np.sign(np.where(resting, acceleration, velocity)), 0.0)
    return Modes(contact, np.where(sticks, 0.0, slides), sticks)
