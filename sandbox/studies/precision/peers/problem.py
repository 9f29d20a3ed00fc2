"""Code that the other integrators share.

This module contains the compiled right-hand side for overlaps and rates, and the conversion of these variables to a
Solution.
"""

from __future__ import annotations

from time import perf_counter
from typing import Any

import numpy as np
from numba import carray, njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray
from softcradle.physics.state import from_anchor
from softcradle.sandbox.studies.precision.cases import ChartCase
from softcradle.sandbox.studies.precision.measurement import Solution

Array = NDArray[np.float64]


class TimeLimitError(Exception):
    """Raised if a simulation takes longer than TIME_LIMIT."""


def timed_derivatives(parameters: Array, out: Array, y: Array, deadline: float) -> Array:
    """Fill `out` (2n,) with the derivatives and return it.

    Raise TimeLimitError if the time has passed `deadline` [s of perf_counter].
    """
    if perf_counter() > deadline:
        raise TimeLimitError
    derivatives(y, out, parameters)
    return out


def start_state(case: ChartCase) -> Array:
    """Return the (2n,) overlaps and rates at the start of the case."""
    return np.concatenate((0.0 - np.array(case.chain.gap), -np.diff(case.velocity)))


def output_times(case: ChartCase, sample_times: Array) -> Array:
    """Return the sample times, if there are any, followed by the end of the collision [s]."""
    return np.append(sample_times, case.run_duration)


def parameter_array(case: ChartCase, counter: Array) -> Array:
    """Return the (2 + 3n + n+1 + n+1,) parameters of the compiled right-hand side.

    The parameters are the number of contacts, the address of `counter` (1,), the contact laws, the inverse masses and
    the drive.
    """
    law, inverse_mass = case.chain.power_law_rows, case.chain.inverse_mass
    drive = np.zeros(inverse_mass.size) if case.chain.drive_force is None else case.chain.drive_force
    return np.concatenate(([case.chain.contacts, counter.ctypes.data], law.ravel(), inverse_mass, drive * inverse_mass))


def absolute_tolerances(case: ChartCase, ratio: float, tolerance: float) -> Array:
    """Return the (2n,) absolute tolerances. The tolerances of overlaps are `ratio` times the tolerances of rates."""
    return np.repeat((ratio * tolerance, tolerance), case.chain.contacts)


def solution_of(
    case: ChartCase, states: Array | None, sample_times: Array, seconds: float, evaluations: float
) -> Solution:
    """Return the Solution from states (T, 2n) at the sample times and at the end. The states are None if the solver
    gave up.
    """
    if states is None or len(states) != sample_times.size + 1 or not np.isfinite(states).all():
        return Solution(None, seconds, evaluations)
    n = case.chain.contacts
    velocity = _velocities(case, states[-1, n:])
    if not sample_times.size:
        return Solution(velocity, seconds, evaluations)
    overlap = states[:-1, :n]
    force = np.column_stack([law.force(d) for law, d in zip(case.chain.contact, overlap.T, strict=True)])
    return Solution(velocity, seconds, evaluations, overlap, force)


def _velocities(case: ChartCase, rate: Array) -> Array:
    """Return the (n+1,) velocities of the beads from the (n,) rates of the overlaps.

    The total momentum and the velocity of a wall provide the missing equation.
    """
    mass = np.array(case.chain.mass)
    relative = from_anchor(rate, 0.0, 0)
    if case.chain.walls:
        wall = int(np.flatnonzero(np.isinf(mass))[0])
        return relative - relative[wall] + case.velocity[wall]
    impulse = 0.0 if case.chain.drive_force is None else case.run_duration * case.chain.drive_force.sum()
    velocity: Array = relative + (mass @ case.velocity + impulse - mass @ relative) / mass.sum()
    return velocity


@intrinsic
def _pointer(typingctx: Any, address: Any) -> Any:
    """Return an address as a pointer to a double-precision number."""

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], context.get_value_type(signature.return_type))

    return types.CPointer(types.float64)(types.int64), codegen


@njit(error_model="numpy")
def contact_force(p: Any, i: int, overlap: float) -> float:
    """Return the force [N] of contact i at `overlap`."""
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
def derivatives(y: Any, out: Any, p: Any) -> None:
    """Compute the derivatives d' = w and w' = -L f(d) from the accelerations of the beads.

    The arrays y and out have the shape (2n,). The counter is increased by 1.
    """
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
