"""diffrax's Tsit5, compiled by jax for each number of contacts: four seconds before the first run, which are not counted.

Its other solvers, tried on one on 4 at alpha = 1/10, take 20 (Dopri8) to 100 times (Kvaerno5) as long as Tsit5.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.studies.precision.chart_cases import Case, Start
from softcradle.sandbox.studies.precision.peers.peer_problem import (
    FIRST_STEP,
    MOST_STEPS,
    answer_of,
    start_of,
    times_of,
    tolerances_of,
)
from softcradle.sandbox.studies.precision.solvers import Answer, Solver, tolerances

Array = NDArray[np.float64]

FINER = (1e-2, 1e-6)  # absolute tolerance of overlaps, as part of that of rates
STAGES = 6  # evaluations a step: the first is the last of the step before


def solvers(case: Case) -> list[Solver]:
    """One curve; none for a driven chain."""
    if case.chain.drive:
        return []
    return [
        Solver("diffrax Tsit5", f"overlaps {finer:g}", tolerances(), partial(_solve, case, finer)) for finer in FINER
    ]


@cache
def _compiled() -> Callable[..., Any]:
    import diffrax
    import jax

    jax.config.update("jax_enable_x64", True)
    jnp = jax.numpy

    def slopes(_time: Any, y: Any, parameters: Any) -> Any:
        law, inverse_mass = parameters
        n = law.shape[0]
        overlap, pressed = y[:n], y[:n] > 0.0
        power = jnp.where(pressed, overlap, 1.0) ** law[:, 2]  # of 1 while open: a gradient of 0**a is none
        force = jnp.pad(jnp.where(pressed, law[:, 0] + law[:, 1] * power, 0.0), 1)
        acceleration = (force[:-1] - force[1:]) * inverse_mass
        return jnp.concatenate([y[n:], acceleration[:-1] - acceleration[1:]])

    @jax.jit
    def solve(start: Any, times: Any, parameters: Any, rtol: Any, atol: Any) -> Any:
        found = diffrax.diffeqsolve(
            diffrax.ODETerm(slopes), diffrax.Tsit5(), 0.0, times[-1], FIRST_STEP, start, parameters,
            stepsize_controller=diffrax.PIDController(rtol=rtol, atol=atol), max_steps=MOST_STEPS, throw=False,
            saveat=diffrax.SaveAt(ts=times),
        )  # fmt: skip
        return found.ys, found.stats["num_steps"]

    return solve


def _solve(case: Case, finer: float, tolerance: float, _start: Start, moments: Array) -> Answer:
    start, times, atols = start_of(case), times_of(case, moments), tolerances_of(case, finer, tolerance)
    began = perf_counter()
    states, steps = _compiled()(start, times, tuple(case.chain.parameters), tolerance, atols)
    states = np.asarray(states)
    return answer_of(case, states, moments, perf_counter() - began, STAGES * float(steps))
