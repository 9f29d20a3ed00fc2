"""Records that all kernels share: constant data of a chain, its motion, samples, the log of contact switches, and codes.

A kernel that Python calls receives the fields as plain tuples, which are cheaper to pass, and builds the records from
them.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.int8]

# Typed integers: a literal among the arguments would make numba compile a kernel once more.
ZERO: Any = np.int64(0)
ONE: Any = np.int64(1)
NO_CONTACT: Any = np.int64(-1)
NO: Any = np.bool_(False)

# How a kernel ended; `physics.status` names these codes for all other modules.
DONE, SEPARATED, OUT_OF_STEPS, FAILED = 0, 1, 2, 3
PAUSED = 9  # The kernel returns now and then so that Python can be interrupted, and is then called again.

# Kinds of the graph of a contact.
POWER = 0  # one segment from overlap 0 on, a power law
TABLE = 1  # one segment from overlap 0 on, with tables of polynomials for force and energy
SEGMENTS = 2  # any other table of segments

# Columns of a segment, see `softcradle.physics.segments`.
SIDE, ORIGIN, PRELOAD, STIFFNESS, EXPONENT, LOSS, LENGTH, BEFORE, STOP = 0, 1, 2, 3, 4, 5, 6, 7, 8
# Columns for a table: displacement [m] from which on the table is used, and its force above the preload there [N].
FROM, FORCE_FROM = 9, 10

# Modes of a contact in an adaptive step.
OPEN = 0  # no force
TOUCHING = 1  # the overlap is held at 0, the force is a multiplier (Signorini condition)
LOADED = 2  # on the curve of its law
FROZEN = 3  # between two fixed beads: overlap and force are constant

# Entries of the counter array.
EVALUATION = 0  # evaluations of all contact forces
STEP = 1  # accepted steps
REJECTED = 2  # rejected steps
UNCONVERGED = 3  # steps accepted although the solver of the contact forces did not converge
SAMPLE = 5  # sample rows written
SWITCH = 6  # contact switches, including switches that did not fit into the log
FLIGHT = 7  # free flights
KEPT = 8  # stored steps, from which samples are taken (dense output)
COUNTERS = 9


class Extent(NamedTuple):
    """Time span and limits of a run."""

    start: float  # start time [s]
    end: float  # end time [s]; inf: until the motion ends
    stop: bool  # if True, the run ends when no contact can close again
    # Limit of the number of steps, including rejected ones. Steps of free flight that are done in one go do not count.
    most_steps: int


class Knots(NamedTuple):
    """Forces and brakes over time. They are linear between K breakpoints, 0 before the first and constant after the last.

    K is 0 without forces over time.
    """

    time: Array  # (K,) [s], ascending; two equal times make a step
    push: Array  # (K, n+1) forces on the beads [N]
    brake: Array  # (K, n+1) decelerations of sliding beads [m/s²]; (K, 0) without brakes
    drive: Array  # (n+1,) constant forces on the beads [N]
    friction: Array  # (n+1,) constant decelerations [m/s²]; (0,) without brakes
    push_slope: Array  # (n+1,) scratch: time derivatives of the forces [N/s]
    brake_slope: Array  # (n+1,) scratch: time derivatives of the decelerations [m/s³]; (0,) without brakes
    bend: Array  # (n+1,) scratch: time derivative of `ChainData.external` [m/s³]; (0,) without breakpoints


NO_KNOTS = Knots(*(np.zeros(shape) for shape in (0, (0, 0), (0, 0), 0, 0, 0, 0, 0)))


class Graphs(NamedTuple):
    """Graphs of all contacts as tables of segments. Empty if each contact is a single power law from overlap 0 on."""

    kind: Flags  # (n,) POWER, TABLE or SEGMENTS
    coupled: Flags  # (n,) zero: a coupler that has not coupled yet and does not pull; this array belongs to the State
    first: NDArray[np.int64]  # (n+1,) row of the first segment of each contact
    segment: Array  # (m, 11) columns as above, from left to right in each graph
    # (m, 4) first piece and the one after the last, first breakpoint and the one after the last
    table: NDArray[np.int64]
    edge: Array  # (p, 2) displacements [m] at which each piece of a table begins and ends
    force: Array  # (p, degree+1) polynomial coefficients of the force on each piece, see `law_table`
    energy: Array  # (p, degree+2) polynomial coefficients of the energy
    breakpoint: Array  # (b, 3) displacement [m], and the steps of the force [N] and of its slope [N/m] there


class Dissipation(NamedTuple):
    """Hysteretic loss of the contacts and friction of the bed."""

    # (n,) fraction of its energy that each contact dissipates; (0,) if nothing dissipates and no contact has segments
    loss: Array
    bed: Array  # (n+1,) deceleration of a sliding bead [m/s²]; (0,) without friction


NOTHING = np.zeros(0)
NO_FLAGS = np.zeros(0, dtype=np.int8)
_NO_ROWS = np.zeros(0, dtype=np.int64)
NO_GRAPHS = Graphs(
    NO_FLAGS, NO_FLAGS, _NO_ROWS, np.zeros((0, 11)), np.zeros((0, 4), dtype=np.int64), *(np.zeros((0, 0)),) * 4
)
NO_DISSIPATION = Dissipation(NOTHING, NOTHING)


class Strings(NamedTuple):
    """Strings on which all beads of a chain hang, see `softcradle.physics.numerics.swing`."""

    rest: Array  # (n+1,) overlaps at rest [m], then the position of the anchor bead at rest [m]; (0,) without strings
    square: float  # omega² = gravity / length [1/s²]; 0 without strings


NO_STRINGS = Strings(NOTHING, 0.0)


class ChainData(NamedTuple):
    """A chain and the forces on it as arrays: the data that do not change during a run."""

    # (n, 3) preload [N], stiffness [N/m**exponent] and exponent of each contact; for a table, of the power law it
    # begins with
    law: Array
    inverse_mass: Array  # (n+1,) [1/kg], 0 for a wall
    push: Array  # (n+1,) external force on each bead [N]; (0,) without forces
    # (n+1,) accelerations by the external forces, of the overlaps, then of the anchor bead [m/s²]; (0,) without forces
    external: Array
    anchor_bead: int  # index of the reference bead: its position and velocity are stored
    graph: Graphs = NO_GRAPHS
    # Forces over time. Their values at one time, or their means over a step, are written into `push` and `bed`.
    knots: Knots = NO_KNOTS
    dissipation: Dissipation = NO_DISSIPATION  # empty in the effective chain of the adaptive steps
    strings: Strings = NO_STRINGS


class Motion(NamedTuple):
    """The motion of a chain, updated in place."""

    overlap: Array  # (n,) [m]
    rate: Array  # (n,) [m/s]
    anchor: Array  # (2,) position [m] and velocity [m/s] of the anchor bead
    force: Array  # (n,) contact forces [N] of the last step
    # (4,) energy [J] dissipated by contacts and by the bed, work [J] of forces over time, and their impulse, which only
    # Python updates
    taken: Array
    mode: Flags  # (n,) OPEN, TOUCHING, LOADED or FROZEN; (0,) for fixed steps
    held: Flags  # (n,) nonzero: an event has just set this mode; (0,) for fixed steps


class Samples(NamedTuple):
    """Sample times (T,) [s], and a row of the motion for each of them."""

    time: Array
    overlap: Array  # (T, n)
    rate: Array  # (T, n)
    anchor: Array  # (T, 2)
    force: Array  # (T, n)
    taken: Array  # (T, 4)


class SwitchLog(NamedTuple):
    """Log of all changes of contacts between open and closed, as long as it has room, and the counters of the run."""

    contact: NDArray[np.int64]  # (S,) index of the contact
    time: Array  # (S,) time [s] of the change
    closed: Flags  # (n,) nonzero: the contact is closed now
    counter: NDArray[np.int64]  # (COUNTERS,)
