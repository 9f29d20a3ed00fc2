"""The ledger of a lane: its energy and momentum, and what hands, walls and edits have put in, booked on their own.

An error is what neither the start nor a booking explains: E - booked, relative to the largest energy there has been.
What contacts with loss and a bed that rubs absorb is booked as taken away, so it is no error.
Columns: KINETIC, STORED [J], MOMENTUM [N s], ENERGY_BOOKED, MOMENTUM_BOOKED, ENERGY_SCALE, MOMENTUM_SCALE, SWITCHES,
BY_CONTACTS, BY_BED [J] (absorbed since the lane began).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.state import State
from softcradle.sandbox.motion import stored_energy
from softcradle.sandbox.session.history import (
    BY_BED,
    BY_CONTACTS,
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
    """The ledger (10,) of a lane that begins now: all there is is booked."""
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


def book_edit(before: Array, ledger: Array) -> None:
    """Book what an edit, not the motion, has changed from `before` to what `ledger` reads now."""
    ledger[ENERGY_BOOKED] += ledger[KINETIC] + ledger[STORED] - before[KINETIC] - before[STORED]
    ledger[MOMENTUM_BOOKED] += ledger[MOMENTUM] - before[MOMENTUM]


class Outside(NamedTuple):
    """What came from outside in a frame: `work` [J] and `impulse` [N s] of hand and drive; velocities of the walls;
    energy `absorbed` (2,) [J] by contacts and bed."""

    work: float
    impulse: float
    wall_velocity: Array
    absorbed: Array


def book_frame(chain: Chain, before: Array, ledger: Array, outside: Outside) -> None:
    """Book a frame: `before` and `ledger` are what was read before and after it.

    Walls and a bed that rubs give what momentum is missing; the work of walls with it is known where all of them move
    alike, and rest where a bed takes momentum too. Where they do not, what the energy has become is taken as booked.
    """
    ledger[[BY_CONTACTS, BY_BED]] += outside.absorbed
    ledger[ENERGY_BOOKED] += outside.work - outside.absorbed.sum()
    ledger[MOMENTUM_BOOKED] += outside.impulse
    if chain.friction and not outside.wall_velocity.any():
        ledger[MOMENTUM_BOOKED] = ledger[MOMENTUM]
        return
    if not chain.walls:
        return
    by_walls = ledger[MOMENTUM] - before[MOMENTUM] - outside.impulse
    if np.ptp(outside.wall_velocity) == 0.0 and not chain.friction:
        ledger[ENERGY_BOOKED] += float(outside.wall_velocity[0]) * by_walls
    else:
        ledger[ENERGY_BOOKED] = ledger[KINETIC] + ledger[STORED]
    ledger[MOMENTUM_BOOKED] = ledger[MOMENTUM]


def energy_error(ledger: Array) -> float | Array:
    """Unexplained energy relative to the largest energy so far; `ledger` (10,) or (R, 10)."""
    excess = ledger[..., KINETIC] + ledger[..., STORED] - ledger[..., ENERGY_BOOKED]
    return _relative(excess, ledger[..., ENERGY_SCALE])


def momentum_error(ledger: Array) -> float | Array:
    """Unexplained momentum relative to the largest sum of abs(m v) so far."""
    return _relative(ledger[..., MOMENTUM] - ledger[..., MOMENTUM_BOOKED], ledger[..., MOMENTUM_SCALE])


def _relative(excess: Array, scale: Array) -> float | Array:
    error = np.abs(excess) / np.where(scale > 0.0, scale, 1.0)
    return float(error) if np.ndim(error) == 0 else error
