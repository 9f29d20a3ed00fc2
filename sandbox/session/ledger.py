"""The ledger of a lane: its energy and momentum, and what hands, walls and edits have put in, booked on their own.

An error is what neither the start nor a booking explains: E - booked, relative to the largest energy there has been.
Columns: KINETIC, STORED [J], MOMENTUM [N s], ENERGY_BOOKED, MOMENTUM_BOOKED, ENERGY_SCALE, MOMENTUM_SCALE, SWITCHES.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physics.chain import Chain
from physics.state import State
from sandbox.session.history import (
    ENERGY_BOOKED,
    ENERGY_SCALE,
    KINETIC,
    LEDGER,
    MOMENTUM,
    MOMENTUM_BOOKED,
    MOMENTUM_SCALE,
    STORED,
)

Array = NDArray[np.float64]


def opened(chain: Chain, state: State) -> Array:
    """The ledger (8,) of a lane that begins now: all there is is booked."""
    ledger = np.zeros(LEDGER)
    read(chain, state, ledger)
    ledger[ENERGY_BOOKED] = ledger[KINETIC] + ledger[STORED]
    ledger[MOMENTUM_BOOKED] = ledger[MOMENTUM]
    return ledger


def read(chain: Chain, state: State, ledger: Array) -> None:
    """Put energies, momentum and their scales as they are now into `ledger`."""
    law, inverse_mass = chain.parameters
    mass = np.where(inverse_mass > 0.0, chain.mass, 0.0)
    parts = mass * state.velocity(chain)
    ledger[KINETIC] = 0.5 * float(parts @ state.velocity(chain))
    ledger[STORED] = float(stored_energy(law, state.overlap).sum())
    ledger[MOMENTUM] = parts.sum()
    ledger[ENERGY_SCALE] = max(ledger[ENERGY_SCALE], ledger[KINETIC] + ledger[STORED])
    ledger[MOMENTUM_SCALE] = max(ledger[MOMENTUM_SCALE], np.abs(parts).sum())


def stored_energy(law: Array, overlap: Array) -> Array:
    """(..., n) energy [J] in contacts with the law table (n, 3) at `overlap` (..., n)."""
    pressed = np.maximum(overlap, 0.0)
    energy: Array = (law[:, 0] + law[:, 1] * pressed ** law[:, 2] / (1.0 + law[:, 2])) * pressed
    return energy


def book_edit(before: Array, ledger: Array) -> None:
    """Book what an edit, not the motion, has changed from `before` to what `ledger` reads now."""
    ledger[ENERGY_BOOKED] += ledger[KINETIC] + ledger[STORED] - before[KINETIC] - before[STORED]
    ledger[MOMENTUM_BOOKED] += ledger[MOMENTUM] - before[MOMENTUM]


def book_frame(chain: Chain, ledger: Array, work: float, impulse: float) -> None:
    """Book a frame in which the hand did `work` [J] and gave `impulse` [N s].

    Walls give what momentum is missing; one that moves does work with it, which is known where all move alike.
    """
    ledger[ENERGY_BOOKED] += work
    ledger[MOMENTUM_BOOKED] += impulse
    if chain.walls:
        ledger[MOMENTUM_BOOKED] = ledger[MOMENTUM]


def book_walls(wall_velocity: Array, impulse: float, ledger: Array) -> None:
    """Book the work of walls that all move at the same velocity and together gave `impulse` [N s]."""
    if wall_velocity.size and np.ptp(wall_velocity) == 0.0:
        ledger[ENERGY_BOOKED] += float(wall_velocity[0]) * impulse


def energy_error(ledger: Array) -> float | Array:
    """Unexplained energy relative to the largest energy so far; `ledger` (8,) or (R, 8)."""
    excess = ledger[..., KINETIC] + ledger[..., STORED] - ledger[..., ENERGY_BOOKED]
    return _relative(excess, ledger[..., ENERGY_SCALE])


def momentum_error(ledger: Array) -> float | Array:
    """Unexplained momentum relative to the largest sum of abs(m v) so far."""
    return _relative(ledger[..., MOMENTUM] - ledger[..., MOMENTUM_BOOKED], ledger[..., MOMENTUM_SCALE])


def _relative(excess: Array, scale: Array) -> float | Array:
    error = np.abs(excess) / np.where(scale > 0.0, scale, 1.0)
    return float(error) if np.ndim(error) == 0 else error
