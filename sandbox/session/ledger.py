"""Ledger: the energy and momentum balance of a lane. It books the input from pointer, drive, walls and edits.

An error is the part of the energy or momentum that neither the start nor a booked input explains. It is E - booked,
relative to the largest energy so far. The start of another method counts as a start. Energy that is absorbed by
contacts or by the bed is booked as an output, so it is not an error.

The columns are KINETIC, STORED [J], MOMENTUM [N s], ENERGY_BOOKED, MOMENTUM_BOOKED, ENERGY_SCALE, MOMENTUM_SCALE,
SWITCHES, BY_CONTACTS, BY_BED [J], WORK_GIVEN [J], IMPULSE_GIVEN [N s] and VELOCITY_ERROR [m/s]. BY_CONTACTS and BY_BED
are the energies absorbed since the lane began. WORK_GIVEN and IMPULSE_GIVEN count pointer, forces over time and edits,
but not drive and walls. VELOCITY_ERROR is the estimate of the method, or negative if the method has no estimate.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.state import State, hanging_energy
from softcradle.physics.trajectory import work_of_walls

Array = NDArray[np.float64]

KINETIC, STORED, MOMENTUM, ENERGY_BOOKED, MOMENTUM_BOOKED, ENERGY_SCALE, MOMENTUM_SCALE, SWITCHES = range(8)
BY_CONTACTS, BY_BED, WORK_GIVEN, IMPULSE_GIVEN, VELOCITY_ERROR = 8, 9, 10, 11, 12
LEDGER_COLUMNS = 13


def new_ledger(chain: Chain, state: State) -> Array:
    """Return the ledger (13,) of a lane that begins now. Its energy and momentum are booked."""
    ledger = np.zeros(LEDGER_COLUMNS)
    measure(chain, state, ledger)
    book_all(ledger)
    return ledger


def book_all(ledger: Array) -> None:
    """Book the present energy and momentum, so that the errors are 0."""
    ledger[ENERGY_BOOKED], ledger[MOMENTUM_BOOKED] = ledger[KINETIC] + ledger[STORED], ledger[MOMENTUM]


def measure(chain: Chain, state: State, ledger: Array) -> None:
    """Write the energies and the momentum of `state` into `ledger`. Increase the scales of both if necessary."""
    mass = np.where(np.isfinite(chain.mass), chain.mass, 0.0)
    momenta = mass * state.velocity(chain)
    ledger[KINETIC] = 0.5 * float(momenta @ state.velocity(chain))
    ledger[STORED] = float(chain.stored_energy(state.overlap, force=state.force).sum())
    if chain.swing:
        ledger[STORED] += float(hanging_energy(chain, state.overlap, state.anchor[0]))
    ledger[MOMENTUM] = momenta.sum()
    ledger[ENERGY_SCALE] = max(ledger[ENERGY_SCALE], ledger[KINETIC] + ledger[STORED])
    ledger[MOMENTUM_SCALE] = max(ledger[MOMENTUM_SCALE], np.abs(momenta).sum())


def book_edit(before: Array, ledger: Array, by_drive: float) -> None:
    """Book the change of energy and momentum by an edit: the difference between `before` and `ledger`.

    `by_drive` [J] is the work of the drive along the displacement of the beads by the edit.
    """
    work = ledger[KINETIC] + ledger[STORED] - before[KINETIC] - before[STORED]
    impulse = ledger[MOMENTUM] - before[MOMENTUM]
    ledger[ENERGY_BOOKED] += work
    ledger[MOMENTUM_BOOKED] += impulse
    ledger[[WORK_GIVEN, IMPULSE_GIVEN]] += work - by_drive, impulse


class External(NamedTuple):
    """External input during one frame.

    Attributes:
        work, impulse: work [J] and impulse [N s] of the drive.
        given: (2,) work and impulse of the pointer spring and of forces over time.
        velocity: (n+1,) velocities [m/s] after the frame; walls keep their velocity.
        absorbed: (2,) energy [J] that contacts and the bed absorbed.
    """

    work: float
    impulse: float
    given: Array
    velocity: Array
    absorbed: Array


def book_frame(chain: Chain, before: Array, ledger: Array, external: External) -> None:
    """Book the input during a frame. `before` and `ledger` contain the balance before and after the frame.

    Missing momentum is attributed to walls, strings and a bed with friction. If the work of the walls does not follow
    from this momentum, the energy after the frame is booked completely. See `work_of_walls`.
    """
    ledger[[BY_CONTACTS, BY_BED]] += external.absorbed
    ledger[[WORK_GIVEN, IMPULSE_GIVEN]] += external.given
    work, impulse = external.work + external.given[0], external.impulse + external.given[1]
    ledger[ENERGY_BOOKED] += work - external.absorbed.sum()
    ledger[MOMENTUM_BOOKED] += impulse
    if chain.walls:
        own = np.array([before[MOMENTUM], ledger[MOMENTUM] - impulse])
        by_walls = float(work_of_walls(chain, np.array([external.velocity] * 2), own)[-1])
        unknown = math.isnan(by_walls)
        ledger[ENERGY_BOOKED] = ledger[KINETIC] + ledger[STORED] if unknown else ledger[ENERGY_BOOKED] + by_walls
    if chain.walls or chain.takes_momentum:
        ledger[MOMENTUM_BOOKED] = ledger[MOMENTUM]


def energy_error(ledger: Array) -> float | Array:
    """Return the unexplained energy relative to the largest energy so far. `ledger` has the shape (13,) or (R, 13)."""
    excess = ledger[..., KINETIC] + ledger[..., STORED] - ledger[..., ENERGY_BOOKED]
    return _relative(excess, ledger[..., ENERGY_SCALE])


def momentum_error(ledger: Array) -> float | Array:
    """Return the unexplained momentum relative to the largest sum of abs(m v) so far. `ledger` has the shape (13,) or
    (R, 13).
    """
    return _relative(ledger[..., MOMENTUM] - ledger[..., MOMENTUM_BOOKED], ledger[..., MOMENTUM_SCALE])


def _relative(excess: Array, scale: Array) -> float | Array:
    error = np.abs(excess) / np.where(scale > 0.0, scale, 1.0)
    return float(error) if np.ndim(error) == 0 else error
