"""What the peers share: the compiled right-hand side in overlaps and rates, and the way from those to an Answer."""

from __future__ import annotations

from time import perf_counter
from typing import Any

import numba
import numpy as np
from numba import carray, njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray
from softcradle.physics.state import from_anchor
from softcradle.sandbox.studies.precision.chart_cases import Case
from softcradle.sandbox.studies.precision.solvers import Answer

Array = NDArray[np.float64]

FINER = (1e-2, 1e-6, 1e-10)  # absolute tolerance of overlaps, as part of that of rates
FIRST_STEP = 1e-6  # [s]
MOST_STEPS = 100_000
LONGEST = 1.0  # [s] a run that calls back into Python is given up after
COMPILED = not numba.config.DISABLE_JIT


class LateError(Exception):
    """A run has gone on for too long."""


def slopes_in_time(parameters: Array, out: Array, y: Array, deadline: float) -> Array:
    """`out` (2n,), filled; LateError after the deadline [s of perf_counter]."""
    if perf_counter() > deadline:
        raise LateError
    slopes(y, out, parameters)
    return out


def start_of(case: Case) -> Array:
    """(2n,) overlaps and rates at the start."""
    return np.concatenate((0.0 - np.array(case.chain.gap), -np.diff(case.velocity)))


def times_of(case: Case, moments: Array) -> Array:
    """The moments, if any, and the end [s]."""
    return np.append(moments, case.span)


def parameters_of(case: Case, counter: Array) -> Array:
    """(2 + 3n + n+1 + n+1,) contacts, laws, inverse masses, drive, where `counter` (1,) is: one array, as C takes it."""
    law, inverse_mass = case.chain.parameters
    drive = np.zeros(inverse_mass.size) if case.chain.drive_force is None else case.chain.drive_force
    return np.concatenate(([case.chain.contacts, counter.ctypes.data], law.ravel(), inverse_mass, drive * inverse_mass))


def tolerances_of(case: Case, finer: float, tolerance: float) -> Array:
    """(2n,) absolute tolerances."""
    return np.repeat((finer * tolerance, tolerance), case.chain.contacts)


def answer_of(case: Case, states: Array | None, moments: Array, seconds: float, evaluations: float) -> Answer:
    """The Answer from states (T, 2n) at the moments and at the end; None: gave up."""
    if states is None or len(states) != moments.size + 1 or not np.isfinite(states).all():
        return Answer(None, seconds, evaluations)
    n = case.chain.contacts
    velocity = _velocities(case, states[-1, n:])
    if not moments.size:
        return Answer(velocity, seconds, evaluations)
    overlap = states[:-1, :n]
    force = np.column_stack([law.force(d) for law, d in zip(case.chain.contact, overlap.T, strict=True)])
    return Answer(velocity, seconds, evaluations, overlap, force)


def _velocities(case: Case, rate: Array) -> Array:
    """(n+1,) velocities from rates (n,): the momentum is kept, a wall keeps its velocity."""
    mass = np.array(case.chain.mass)
    relative = from_anchor(rate, 0.0, 0)
    if case.chain.walls:
        wall = int(np.flatnonzero(np.isinf(mass))[0])
        return relative - relative[wall] + case.velocity[wall]
    pushed = 0.0 if case.chain.drive_force is None else case.span * case.chain.drive_force.sum()
    moved: Array = relative + (mass @ case.velocity + pushed - mass @ relative) / mass.sum()
    return moved


@intrinsic
def _pointer(typingctx: Any, address: Any) -> Any:
    """An address as a pointer to a double."""

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], context.get_value_type(signature.return_type))

    return types.CPointer(types.float64)(types.int64), codegen


@njit(error_model="numpy")
def contact_force(p: Any, i: int, overlap: float) -> float:
    """Force of contact i at `overlap` [N]."""
    if overlap <= 0.0:
        return 0.0
    exponent = p[2 + 3 * i + 2]
    if exponent == 1.0:
        power = overlap
    elif exponent == 1.5:
        power = overlap * np.sqrt(overlap)
    else:
        power = overlap**exponent
    return p[2 + 3 * i] + p[2 + 3 * i + 1] * power


@njit(error_model="numpy")
def slopes(y: Any, out: Any, p: Any) -> None:
    """d' = w, w' = -L f(d) by way of the bead accelerations; y and out (2n,); counts itself."""
    carray(_pointer(np.int64(p[1])), 1)[0] += 1.0
    n = int(p[0])
    left, before = 0.0, 0.0
    for i in range(n + 1):
        force = contact_force(p, i, y[i]) if i < n else 0.0
        acceleration = (before - force) * p[2 + 3 * n + i] + p[2 + 4 * n + 1 + i]
        if i > 0:
            out[i - 1] = y[n + i - 1]
            out[n + i - 1] = left - acceleration
        left, before = acceleration, force
