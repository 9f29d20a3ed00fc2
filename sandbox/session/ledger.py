"""Ledger (energy and momentum balance) of a lane: its energy and momentum, and the input of pointer, drive, walls and
edits.

External input is booked. An error is the part that neither the start (or the start of another method) nor a booking
explains: E - booked, relative to the largest energy so far. Energy absorbed by contacts with loss and by the bed is
booked as taken out, so it is not an error. Columns: KINETIC, STORED [J], MOMENTUM [N s], ENERGY_BOOKED,
MOMENTUM_BOOKED, ENERGY_SCALE, MOMENTUM_SCALE, SWITCHES, BY_CONTACTS, BY_BED [J] (absorbed since the lane began),
WORK_GIVEN [J], IMPULSE_GIVEN [N s] (of the pointer, of forces over time and of edits since then, without drive and
walls), VELOCITY_ERROR [m/s] (the estimate of the method; negative if the method has none).
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
    """Return the ledger (13,) of a lane that begins now, with its energy and momentum booked."""
    ledger = np.zeros(LEDGER_COLUMNS)
    measure(chain, state, ledger)
    book_all(ledger)
    return ledger


def book_all(ledger: Array) -> None:
    """Book the present energy and momentum; errors count from here."""
    ledger[ENERGY_BOOKED], ledger[MOMENTUM_BOOKED] = ledger[KINETIC] + ledger[STORED], ledger[MOMENTUM]


def measure(chain: Chain, state: State, ledger: Array) -> None:
    """Write the energies and the momentum of `state` into `ledger`, and increase their scales."""
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
    """Book the change by an edit: the difference between `before` and `ledger`.

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
        work, impulse: of the drive [J], [N s].
        given: (2,) of the pointer spring and of forces over time.
        velocity: (n+1,) [m/s] after it; walls keep theirs.
        absorbed: (2,) energy [J] that contacts and the bed absorbed.
    """

    work: float
    impulse: float
    given: Array
    velocity: Array
    absorbed: Array


def book_frame(chain: Chain, before: Array, ledger: Array, external: External) -> None:
    """Book a frame: `before` and `ledger` are the measurements before and after it.

    Walls, strings and a bed with friction account for the missing momentum. If the work of the walls does not follow from it,
    see `work_of_walls`, the energy after the frame is booked as it is.
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
    """Return the unexplained energy relative to the largest energy so far; `ledger` (13,) or (R, 13)."""
    excess = ledger[..., KINETIC] + ledger[..., STORED] - ledger[..., ENERGY_BOOKED]
    return _relative(excess, ledger[..., ENERGY_SCALE])


def momentum_error(ledger: Array) -> float | Array:
    """Return the unexplained momentum relative to the largest sum of abs(m v) so far; `ledger` (13,) or (R, 13)."""
    return _relative(ledger[..., MOMENTUM] - ledger[..., MOMENTUM_BOOKED], ledger[..., MOMENTUM_SCALE])


def _relative(excess: Array, scale: Array) -> float | Array:
    error = np.abs(excess) / np.where(scale > 0.0, scale, 1.0)
    return float(error) if np.ndim(error) == 0 else error
