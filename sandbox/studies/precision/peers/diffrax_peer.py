"""diffrax's Tsit5, compiled by jax for each number of contacts: the four seconds that this takes do not count.

Its other solvers, tried on one on 4 at alpha = 1/10, take 20 (Dopri8) to 100 times (Kvaerno5) as long as Tsit5.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.studies.precision.cases import Case, Start
from softcradle.sandbox.studies.precision.peers.peer_problem import (
    FIRST_STEP,
    MOST_STEPS,
    absolute_tolerances,
    output_times,
    solution_of,
    start_state,
)
from softcradle.sandbox.studies.precision.solvers import Solution, Solver, tolerances

Array = NDArray[np.float64]

RATIOS = (1e-2, 1e-6)  # absolute tolerance of overlaps over that of rates
STAGES = 6  # evaluations a step: the first is the last of the step before


def solvers(case: Case) -> list[Solver]:
    """One curve; none for a driven chain."""
    if case.chain.drive:
        return []
    return [
        Solver("diffrax Tsit5", f"overlaps {ratio:g}", tolerances(), partial(_solve, case, ratio)) for ratio in RATIOS
    ]


@cache
def _compiled() -> Callable[..., Any]:
    import diffrax
    import jax

    jax.config.update("jax_enable_x64", True)
    jnp = jax.numpy

    def derivatives(_time: Any, y: Any, parameters: Any) -> Any:
        law, inverse_mass = parameters
        n = law.shape[0]
        overlap, pressed = y[:n], y[:n] > 0.0
        power = jnp.where(pressed, overlap, 1.0) ** law[:, 2]  # of 1 while open: 0**a has no gradient
        force = jnp.pad(jnp.where(pressed, law[:, 0] + law[:, 1] * power, 0.0), 1)
        acceleration = (force[:-1] - force[1:]) * inverse_mass
        return jnp.concatenate([y[n:], acceleration[:-1] - acceleration[1:]])

    @jax.jit
    def solve(start: Any, times: Any, parameters: Any, rtol: Any, atol: Any) -> Any:
        found = diffrax.diffeqsolve(
            diffrax.ODETerm(derivatives), diffrax.Tsit5(), 0.0, times[-1], FIRST_STEP, start, parameters,
            stepsize_controller=diffrax.PIDController(rtol=rtol, atol=atol), max_steps=MOST_STEPS, throw=False,
            saveat=diffrax.SaveAt(ts=times),
        )  # fmt: skip
        return found.ys, found.stats["num_steps"]

    return solve


def _solve(case: Case, ratio: float, tolerance: float, _start: Start, sample_times: Array) -> Solution:
    start, times = start_state(case), output_times(case, sample_times)
    absolute = absolute_tolerances(case, ratio, tolerance)
    began = perf_counter()
    states, steps = _compiled()(start, times, tuple(case.chain.parameters), tolerance, absolute)
    states = np.asarray(states)
    return solution_of(case, states, sample_times, perf_counter() - began, STAGES * float(steps))
