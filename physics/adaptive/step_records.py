"""Records and constants of the adaptive kernels: kinds of step, attempted steps, stored steps and scratch memory."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.adaptive.constants import FULL_SPEED, NEWTON_PART, ROUND_OFF, TOLERANCE_PART
from softcradle.physics.numerics.jit import inlined
from softcradle.physics.numerics.records import ChainData, Graphs, Motion, SwitchLog

Array = NDArray[np.float64]

RADAU, DOP853 = 0, 1  # Kinds of step. The tables below are indexed by them.
EITHER = 2  # Kind of a method that uses the cheaper of both
ALLOWED = {"radau": RADAU, "dop853": DOP853, "accurate": EITHER}  # Kind of step of each method
# Kinds of stored intervals that are not integration steps: a free flight, and a time in which no bead moves
FLOWN, RESTED = 2, 3
# By kind of step: 1 / order of the error estimate, to choose the next step length
ERROR_EXPONENT = (0.2, 0.125)
# By kind of step: force evaluations of all contacts in one attempt. Zero for radau, because its iterations are counted.
TRY_EVALUATIONS = (0, 15)

# Entries of the array `control` of the step size controller
NEXT = 0  # Longest next step [s]; inf if it is unknown
RADAU_NEXT = 1  # Longest next step of radau [s]
LAST = 2  # Length of the previous step [s]; 0 if it predicts nothing
ERROR = 3  # Error of the previous step [m/s]
LEFT = 4  # Time from the start of the previous step to the next opening of a soft contact [s]
UNLIMITED = 5  # Next step if no event or opening shortened the previous one [s]
REACH = 6  # Longest step of dop853 [s], beyond which a soft contact is stiff
AT_ONCE = 7  # Number of consecutive events without a step between them
LOCAL_SQUARE = 8  # Sum of the squared errors of all steps [m²/s²]
GROWTH = 9  # Error amplification by all completed bounces, minus 1
START = 10  # Start time of the run [s]
CONTINUES = 11  # Nonzero if the error estimate of the previous frame continues, see `begin_estimate`
CARRIED_SQUARE = 12  # Initial value of LOCAL_SQUARE if the estimate does not continue
ENDING = 13  # Error amplification by the bounces in progress at the end of the run
IMPACTS = 14  # Number of contacts that closed at full speed
MASS = 15  # Total mass [kg]; 0 if a wall, a bed or strings exert a force on the beads
CENTRE = 16  # Velocity of the centre of mass [m/s]
# Number of entries
CONTROLS = 17

STAGES = 12  # Number of stages of dop853
# Rows (n+1,) of `Scratch.work`. Each row has one use, so none of them can be overwritten by another part of a step.
VELOCITY = 0  # velocities of the beads [m/s], for a single function
# Error of a step of radau: force errors by both estimates, eliminated upper diagonal, and compliance of each contact
FINE_ERROR, COARSE_ERROR, UPPER, COMPLIANCE = range(1, 5)
# Error of a step of dop853: embedded errors of orders 5 and 3 of the rates and overlaps at the end; the error of each
# contact [m/s], and its local frequency squared [1/s²]
FIFTH_RATE, THIRD_RATE, FIFTH_OVERLAP, THIRD_OVERLAP, CONTACT_ERROR, SQUARE_FREQUENCY = range(5, 11)
# Velocities of the beads [m/s] at the start and at the end of a step
VELOCITY_BEFORE, VELOCITY_AFTER = 11, 12
# Mode transition: known forces on the beads, and static friction of beads at rest; bounds of the contact forces;
# accelerations and forces that solve the complementarity problem; 1 for contacts that may be held
LOAD, STATIC_FRICTION, LOW, HIGH, ACCELERATION, CARRIED, CANDIDATE = range(13, 20)
# Which contacts push (PUSHES in `switch_log`), or touch and are pressed by a pushing neighbour (IS_PUSHED)
PRESSED = 20
# Energy balance of a step: displacements of the beads, and changes of the overlaps [m]
DISPLACEMENT, OVERLAP_CHANGE = 21, 22
# Energy of beads on strings under forces over time: their displacements from rest at both ends of a step.
PLACE_BEFORE, PLACE_AFTER = range(23, 25)
WORK_ROWS = 25  # number of rows


class Accuracy(NamedTuple):
    """Allowed kinds of step, and the accuracy of a run."""

    allowed: int  # RADAU, DOP853 or EITHER
    tolerance: float  # wanted error, relative to the scale
    scale: float  # speed that the tolerance is relative to [m/s]


class Bounds(NamedTuple):
    """Limits of velocities [m/s] that follow from the tolerance, see `bounds_of`."""

    wanted: float  # largest error of one step
    slow: float  # largest rate at an event, or velocity of a bead, that counts as zero
    # largest rate of a closing contact, and velocity change by a contact in a step, that can be ignored
    inactive: float
    negligible: float  # largest velocity change or closing rate that counts as zero if no other contact pushes
    full: float  # least closing speed of an impact at full speed
    round_off: float  # round-off of the fastest velocities


@inlined
def bounds_of(wanted, scale):
    """Return the Bounds for the error bound `wanted` [m/s] of a step and the speed `scale` [m/s] of the motion."""
    inactive = TOLERANCE_PART * wanted
    round_off = ROUND_OFF * scale
    return Bounds(wanted, NEWTON_PART * wanted, inactive, max(inactive, round_off), FULL_SPEED * scale, round_off)


class Trial(NamedTuple):
    """Result of an attempted step: the motion at its three output nodes. The last node is the end of the step."""

    overlap: Array  # (3, n)
    rate: Array  # (3, n)
    force: Array  # (3, n)
    anchor: Array  # (2,) position and velocity of the anchor bead at the end


class Steps(NamedTuple):
    """Stored steps and flights of a run (dense output): each row contains the motion and the effective chain at its
    start.
    """

    time: Array  # (R,) start time [s]
    length: Array  # (R,) length [s]
    kind: NDArray[np.int8]  # (R,) RADAU, DOP853, FLOWN or RESTED
    values: Array  # (R, K) numbers at the start, in the order of `sampling.carry_step`
    flags: NDArray[np.int8]  # (R, F) contact modes, then directions of sliding, of unloading, and segments


class Regime(NamedTuple):
    """Contact modes of dissipative contacts and beads, and the chain from which the effective chain of the steps is
    made.

    In the effective chain a sticking bead is a wall, the friction of a sliding bead is a steady force, and an unloading
    contact with hysteretic loss has a weaker law. So every step integrates a chain without dissipation; only events
    change the effective chain.

    Python passes the fields without `graph`, which kernels take from the chain: each array costs time in a call.
    """

    law: Array  # (n, 3) power laws, or (n, 6) if contacts have several segments: see `row_graphs`
    inverse_mass: Array  # (n+1,) [1/kg], 0 for a wall
    loss: Array  # (n,) hysteretic loss of each contact, as a fraction of the stored energy; (0,) without loss
    bed: Array  # (n+1,) deceleration of a sliding bead [m/s²]; (0,) without friction
    slide: NDArray[np.int8]  # (n+1,) direction in which each bead slides, 0 for a sticking bead; (0,) without friction
    easing: NDArray[np.int8]  # (n,) nonzero if a contact with loss is unloading; (0,) without loss
    segment: NDArray[np.int8]  # (n,) segment of each contact; (0,) if no contact has several segments
    graph: Graphs  # graphs of the contacts, those of the chain


class Scratch(NamedTuple):
    """Memory that the steps keep between calls, and temporary arrays of a single step."""

    control: Array  # (CONTROLS,) state of the step size controller
    opening: Array  # (n,) time from the start of the step to the opening of a contact [s]; -1 if it does not open
    bounced: Array  # (n,) time at which the last bounce of each contact began or ended [s]; inf before the first bounce
    pressed: Array  # (n,) time since which a contact pushes or is pressed by a neighbour [s]; otherwise inf or AT_REST
    segment: Array  # (n,) segment on which the last bounce of the contact began; -1 after the contact opened
    # (n,) delay of the last closing per velocity error before the flight: flight time over closing speed [s²/m]
    lateness: Array
    grown: Array  # (n,) error amplification by the present bounce of each contact
    most_grown: Array  # (n,) upper limit of `grown`: a mistimed bounce changes velocities by at most twice its speed
    # (n,) rate [m/s] that was set to 0 when a contact was put to rest at d = 0; 0 if it has been pushed since
    parting: Array
    parted: Array  # (n,) time at which that happened [s]
    # (n,) fastest rate of each loaded contact since its last turning point [m/s], if above the tolerance, else 0
    course: Array
    turns: Array  # (n,) number of times that a loaded contact turned from unloading to loading without opening
    along: Array  # (3, n) change of overlap along the curve of a contact, per unit of `correction`
    across: Array  # (3, n) change of force along the curve of a contact, per unit of `correction`
    correction: Array  # (3, n) Newton corrections of the stages
    block: Array  # (n, 9) inverse diagonal blocks of the elimination
    acceleration: Array  # (STAGES, n) overlap accelerations at the stages of dop853
    anchor_acceleration: Array  # (STAGES,) accelerations of the anchor bead at these stages
    work: Array  # (WORK_ROWS, n+1) temporary rows
    bounds: Array  # (2, n+1) bounds of accelerations in `yield_or_slip`
    knots: Array  # (2, 4n+8) breakpoints of a piecewise linear function in `yield_or_slip`


class Event(NamedTuple):
    """First event in an attempted step, and how far the step ends from the event at which it should end."""

    row: int  # contact, or number of contacts plus bead; -1 without an event
    side: int  # side of the branch on which it is left
    part: float  # fraction of the step
    miss: float  # time [s] by which the step ends too early; NaN if the step should not end at an event, or it has gone
    near: (
        float  # fraction of the step at which a guard comes so close to 0 that its polynomial may be wrong; 1: nowhere
    )


class Target(NamedTuple):
    """Event at which the next attempted step should end, and the progress of the search for its time."""

    row: int  # as in `Event`
    side: int
    tries: int  # number of attempts that were made to end at an event
    ceiling: float  # length [s] of the step that was found to contain the event


class StepContext(NamedTuple):
    """All records of an adaptive run: the chain, its modes and motion, the attempted step, limits, memory and logs."""

    chain: ChainData  # effective chain, without dissipation
    regime: Regime
    motion: Motion  # at the start of the step
    trial: Trial  # the attempted step
    look: Trial  # memory for probe steps
    bounds: Bounds
    scratch: Scratch
    log: SwitchLog
    steps: Steps


def empty_trial(contacts: int) -> Trial:
    """Return the memory of one attempted step."""
    return Trial(np.zeros((3, contacts)), np.zeros((3, contacts)), np.zeros((3, contacts)), np.zeros(2))


def empty_steps(rows: int, contacts: int, dissipative: bool) -> Steps:
    """Return the memory of `rows` stored steps."""
    values, flags = 3 * contacts + 6, contacts
    if dissipative:
        values, flags = values + 8 * contacts + 2, flags + 3 * contacts + 1
    time, length, kind = np.empty(rows), np.empty(rows), np.empty(rows, dtype=np.int8)
    return Steps(time, length, kind, np.empty((rows, values)), np.empty((rows, flags), dtype=np.int8))


def empty_scratch(contacts: int) -> Scratch:
    """Return the scratch memory of a chain with `contacts`."""
    n, each = contacts, [np.zeros(contacts) for _ in range(11)]  # from `opening` to `turns`
    shapes = (3, n), (3, n), (3, n), (n, 9), (STAGES, n), STAGES, (WORK_ROWS, n + 1), (2, n + 1), (2, 4 * n + 8)
    return Scratch(np.zeros(CONTROLS), *each, *(np.zeros(shape) for shape in shapes))
