"""What adaptive kernels share beside the records of all kernels: kinds of step, a step tried, scratch memory."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.numerics.records import Graphs

Array = NDArray[np.float64]

RADAU, DOP853 = 0, 1  # kinds of step; tables below are indexed by them
EITHER = 2  # in place of a kind, for a method that takes whichever is cheaper
ALLOWED = {"radau": RADAU, "dop853": DOP853, "accurate": EITHER}  # kinds of step that a method takes
# in place of a kind among the steps that are kept: a free flight, and a time in which nothing moves
FLOWN, RESTED = 2, 3
ERROR_EXPONENT = (0.2, 0.125)  # by kind: one over the order of the error estimate, for the next step size
TRY_EVALUATIONS = (0, 15)  # by kind: evaluations of all contacts in one try; radau counts its iterations itself

# entries of the control array of step sizes
NEXT = 0  # longest next step [s]; inf: not known
RADAU_NEXT = 1  # longest next step of radau [s]
LAST = 2  # length of the step before [s]; 0: there is none to predict from
ERROR = 3  # its error [m/s]
LEFT = 4  # time left to an opening at its start [s]
UNLIMITED = 5  # next step had no event or opening come near [s]
REACH = 6  # longest step of dop853, beyond which a soft contact is stiff [s]
AT_ONCE = 7  # events one after another without a step between them
LOCAL_SQUARE = 8  # sum of the squares of the errors of all steps
GROWTH = 9  # by what factor, beside 1, bounces have made errors grow
START = 10  # when the run began [s]
UNSEEN_SQUARE = 11  # the part of LOCAL_SQUARE that finer runs make alike
CONTINUES = 12  # nonzero if the error estimate of the frame before goes on, see `begin_estimate`
CARRIED_SQUARE = 13  # what LOCAL_SQUARE begins with if it does not
ENDING = 14  # growth of errors by the bounces within which the run ends
IMPACTS = 15  # number of contacts that closed at full speed
CONTROLS = 16

STAGES = 12  # of dop853
WORK_ROWS = 12  # rows of scratch memory that steps of radau, corners and what is decided at them name


class Accuracy(NamedTuple):
    """What is asked for."""

    allowed: int  # a kind of step, or EITHER
    tolerance: float  # of the scale
    scale: float  # [m/s]


class Bounds(NamedTuple):
    """The velocities [m/s] that follow from the tolerance."""

    wanted: float  # the largest error of a step
    slow: float  # a rate at a corner, or the velocity of a bead, that counts as none
    negligible: float  # a push, or a rate of closing, that counts as none where nothing else pushes
    full: float  # a contact that closes faster closes at full speed


class Trial(NamedTuple):
    """A step tried: the motion at its three output nodes, the last of which is its end."""

    overlap: Array  # (3, n)
    rate: Array  # (3, n)
    force: Array  # (3, n)
    anchor: Array  # (2,) at the end


class Steps(NamedTuple):
    """Steps and flights of a run, each with the motion and the chain at its start, so that samples in it can be taken later."""

    time: Array  # (R,) start [s]
    length: Array  # (R,) [s]
    kind: NDArray[np.int8]  # (R,) RADAU, DOP853, FLOWN or RESTED
    values: Array  # (R, K) what `keep_step` puts there
    flags: NDArray[np.int8]  # (R, F) modes, then directions of sliding and easing


class Regime(NamedTuple):
    """What the effective chain of the steps is made from: the chain itself, friction, loss, and which modes these are in.

    A bead that sticks is a wall, friction of one that slides a steady force, and a contact that eases has a weaker law: steps
    see a chain without dissipation, and only switches change it.
    """

    law: Array  # (n, 3), or (n, 6) if contacts have several segments: see `row_graphs`
    inverse_mass: Array  # (n+1,)
    loss: Array  # (n,) part of its energy that each contact loses; (0,) without any
    bed: Array  # (n+1,) deceleration of a sliding bead [m/s²]; (0,) without friction
    slide: NDArray[np.int8]  # (n+1,) direction in which each bead slides, 0 for one that sticks; (0,) without friction
    easing: NDArray[np.int8]  # (n,) nonzero where a contact with loss comes out; (0,) without any
    segment: NDArray[np.int8]  # (n,) the segment that each contact is on; (0,) if none has several
    graph: Graphs  # that of the chain


class Scratch(NamedTuple):
    """Memory of the steps between one call and the next, and within a step."""

    control: Array  # (CONTROLS,) of the step sizes
    opening: Array  # (n,) when within the step a contact opens [s], -1 where it does not
    bounced: Array  # (n,) when the last bounce of each contact began or ended [s]; inf where none has
    pressed: Array  # (n,) since when a contact pushes, or a neighbour presses it [s]; inf or AT_REST where neither does
    segment: Array  # (n,) the segment of a coupler that this was on; -1 where it was open
    lateness: Array  # (n,) of each closed contact, how much later it closed per velocity error before: flight over speed [s²/m]
    grown: Array  # (n,) growth of errors by the present bounce of each contact
    most_grown: Array  # (n,) what that can be at the most: a mistimed bounce changes velocities by twice its speed
    parting: Array  # (n,) the rate [m/s] that was taken from a contact which nothing has pushed since, at d = 0; else 0
    parted: Array  # (n,) since when [s]
    course: Array  # (n,) the fastest rate of each loaded contact since it turned, if above the tolerance; 0 where there is none
    turns: Array  # (n,) how often a loaded contact that came out was pushed in again before it opened
    along: Array  # (3, n)
    across: Array  # (3, n)
    correction: Array  # (3, n)
    block: Array  # (n, 9)
    acceleration: Array  # (STAGES, n)
    anchor_acceleration: Array  # (STAGES,)
    work: Array  # (WORK_ROWS, n+1)
    bounds: Array  # (2, n+1) of `yield_or_slip`
    knots: Array  # (2, 4n+8) of `yield_or_slip`


def empty_trial(contacts: int) -> Trial:
    """Memory of one step tried."""
    return Trial(np.zeros((3, contacts)), np.zeros((3, contacts)), np.zeros((3, contacts)), np.zeros(2))


def empty_steps(rows: int, contacts: int, dissipative: bool) -> Steps:
    """Memory of `rows` steps."""
    values, flags = 3 * contacts + 6, contacts
    if dissipative:
        values, flags = values + 8 * contacts + 2, flags + 3 * contacts + 1
    time, length, kind = np.empty(rows), np.empty(rows), np.empty(rows, dtype=np.int8)
    return Steps(time, length, kind, np.empty((rows, values)), np.empty((rows, flags), dtype=np.int8))


def empty_scratch(contacts: int) -> Scratch:
    """Scratch memory of a chain with `contacts`."""
    n, each = contacts, [np.zeros(contacts) for _ in range(11)]  # from `opening` to `turns`
    shapes = (3, n), (3, n), (3, n), (n, 9), (STAGES, n), STAGES, (WORK_ROWS, n + 1), (2, n + 1), (2, 4 * n + 8)
    return Scratch(np.zeros(CONTROLS), *each, *(np.zeros(shape) for shape in shapes))
