"""Records that all kernels share: what does not move, what moves, samples, the log of contact switches, codes and counters.

A kernel that Python calls takes their fields as plain tuples, which cost less to pass, and makes records of them at once.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.int8]

# whole numbers with a type: kernels would be compiled once more for a literal among their arguments
ZERO: Any = np.int64(0)
ONE: Any = np.int64(1)
NO_CONTACT: Any = np.int64(-1)
NO: Any = np.bool_(False)

# how a kernel ended; physics.status gives them names for everybody else
DONE, SEPARATED, OUT_OF_STEPS, FAILED = 0, 1, 2, 3
PAUSED = 9  # a kernel hands back now and then, so that Python can be interrupted; it is called again

# kinds of graph of a contact
POWER = 0  # one segment from overlap 0 on, a power law
TABLE = 1  # one segment from overlap 0 on, whose force and energy are a table of polynomials
SEGMENTS = 2  # any other table of segments

# columns of a segment, see `softcradle.physics.segments`
SIDE, ORIGIN, PRELOAD, STIFFNESS, EXPONENT, LOSS, LENGTH, BEFORE, STOP = 0, 1, 2, 3, 4, 5, 6, 7, 8
FROM, FORCE_FROM = (
    9,
    10,
)  # of a table: the displacement [m] from which on it counts, and its force above the preload there [N]

# modes of a contact in an adaptive step
OPEN = 0  # no force
TOUCHING = 1  # the overlap is held, the force is a multiplier
LOADED = 2  # on the curve of its law
FROZEN = 3  # between two beads that do not move: overlap and force are held

# entries of the counter array
EVALUATION = 0  # evaluations of all contact forces
STEP = 1  # steps taken
REJECTED = 2  # steps tried and rejected
UNCONVERGED = 3  # steps taken although the solver of the contact forces did not converge
SAMPLE = 5  # sample rows filled
SWITCH = 6  # contact switches, those beyond the end of the log included
FLIGHT = 7  # free flights
KEPT = 8  # rows of steps kept for samples
COUNTERS = 9


class Extent(NamedTuple):
    """How far a run goes."""

    start: float  # [s]
    end: float  # [s]; inf: as far as the motion goes
    stop: bool  # whether it ends where no contact can close again
    most_steps: int  # rejected ones included, those of free flight that are taken at once not


class Knots(NamedTuple):
    """Forces and brakes over time, linear between K knots, 0 before the first and kept after the last; K = 0 without any."""

    time: Array  # (K,) [s], ascending; two alike make a jump
    push: Array  # (K, n+1) forces on the beads [N]
    brake: Array  # (K, n+1) decelerations of sliding beads [m/s²]; (K, 0) without brakes
    drive: Array  # (n+1,) steady forces on the beads [N]
    friction: Array  # (n+1,) steady decelerations [m/s²]; (0,) without brakes
    push_slope: Array  # (n+1,) scratch: by how much forces change [N/s]
    brake_slope: Array  # (n+1,) scratch: the same of decelerations [m/s³]; (0,) without brakes
    bend: Array  # (n+1,) scratch: by how much `ChainData.external` changes [m/s³]; (0,) without knots


NO_KNOTS = Knots(*(np.zeros(shape) for shape in (0, (0, 0), (0, 0), 0, 0, 0, 0, 0)))


class Graphs(NamedTuple):
    """The graphs of all contacts as tables of segments; without rows if each contact is one power law from overlap 0 on."""

    kind: Flags  # (n,) POWER, TABLE or SEGMENTS
    coupled: Flags  # (n,) zero: a coupler that has not coupled yet, which does not pull; the array of the State
    first: NDArray[np.int64]  # (n+1,) row of the first segment of each contact
    segment: Array  # (m, 11) columns below, from left to right in each graph
    table: NDArray[
        np.int64
    ]  # (m, 4) first piece and the one after the last, first breakpoint and the one after the last
    edge: Array  # (p, 2) displacements [m] between which each piece of a table lies
    force: Array  # (p, degree+1) coefficients of the force on each piece, see `law_table`
    energy: Array  # (p, degree+2) those of the energy
    breakpoint: Array  # (b, 3) displacement [m], and by how much the force [N] and its slope [N/m] jump there


class Dissipation(NamedTuple):
    """What takes energy."""

    loss: Array  # (n,) part of its energy that each contact dissipates; (0,) if nothing dissipates and no contact has segments
    bed: Array  # (n+1,) deceleration of a sliding bead [m/s²]; (0,) without friction


NOTHING = np.zeros(0)
NO_FLAGS = np.zeros(0, dtype=np.int8)
_NO_ROWS = np.zeros(0, dtype=np.int64)
NO_GRAPHS = Graphs(
    NO_FLAGS, NO_FLAGS, _NO_ROWS, np.zeros((0, 11)), np.zeros((0, 4), dtype=np.int64), *(np.zeros((0, 0)),) * 4
)
NO_DISSIPATION = Dissipation(NOTHING, NOTHING)


class ChainData(NamedTuple):
    """A chain as arrays, and the forces on it: what does not move in a run."""

    # (n, 3) preload [N], stiffness [N/m**exponent] and exponent of each contact, of a table those that it begins with
    law: Array
    inverse_mass: Array  # (n+1,) [1/kg], 0 for a wall
    push: Array  # (n+1,) external force on each bead [N]; (0,) without any
    external: Array  # (n+1,) accelerations by it of the overlaps, then of the anchor [m/s²]; (0,) without any
    anchor_bead: int  # index of the bead whose position and velocity are kept
    graph: Graphs = NO_GRAPHS
    knots: Knots = NO_KNOTS  # forces at one time, or in the mean of a step, are put into the push and the bed
    dissipation: Dissipation = NO_DISSIPATION  # the effective chain of adaptive steps has none


class Motion(NamedTuple):
    """What moves, in place."""

    overlap: Array  # (n,) [m]
    rate: Array  # (n,) [m/s]
    anchor: Array  # (2,) position [m] and velocity [m/s] of the anchor bead
    force: Array  # (n,) contact forces [N] of the last step
    taken: Array  # (4,) energy [J] absorbed by contacts, by the bed, work [J] of forces over time; their impulse Python knows
    mode: Flags  # (n,) OPEN, TOUCHING, LOADED or FROZEN; (0,) for fixed steps
    held: Flags  # (n,) nonzero: this mode has just been set by an event; (0,) for fixed steps


class Samples(NamedTuple):
    """Times (T,) at which samples are wanted, and one row of the motion for each."""

    time: Array
    overlap: Array  # (T, n)
    rate: Array  # (T, n)
    anchor: Array  # (T, 2)
    force: Array  # (T, n)
    taken: Array  # (T, 4)


class SwitchLog(NamedTuple):
    """Every change of a contact between open and closed, up to the size of the log, and the counters of the run."""

    contact: NDArray[np.int64]  # (S,) which contact
    time: Array  # (S,) when [s]
    closed: Flags  # (n,) nonzero: closed now
    counter: NDArray[np.int64]  # (COUNTERS,)
