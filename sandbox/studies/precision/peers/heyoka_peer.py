"""heyoka's Taylor series with terminal events where a contact opens or closes.

A series cannot start where an overlap is zero: `radau` computes the beginning, and its time counts. A contact counts as
open below a small overlap, which is scanned beside the tolerance.
"""

from __future__ import annotations

from functools import cache, partial
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.simulation import solve
from softcradle.sandbox.studies.precision.cases import Case, Start
from softcradle.sandbox.studies.precision.peers.peer_problem import MOST_STEPS, output_times, solution_of
from softcradle.sandbox.studies.precision.solvers import Solution, Solver, tolerances

Array = NDArray[np.float64]

MOST_CONTACTS = 5  # longer chains have deep contacts that are too stiff for an explicit series
SWITCH_TIMES = (1e-2, 1e-4)  # [s] after the first touch, when the series takes over
SMALLEST_OVERLAPS = (1e-8, 1e-14)  # [m] below which a contact counts as open
START_TOLERANCE = 1e-11  # finest tolerance of the beginning


def solvers(case: Case) -> list[Solver]:
    """One curve; none for preloads, walls, or contacts that are not all alike."""
    chain = case.chain
    soft = (
        all(law.preload == 0.0 and law.exponent < 1.0 for law in chain.power_laws) and len(set(chain.power_laws)) == 1
    )
    if chain.contacts > MOST_CONTACTS or not soft or set(chain.mass) != {1.0} or chain.drive or any(chain.gap):
        return []
    scanned = [(start, least) for start in SWITCH_TIMES for least in SMALLEST_OVERLAPS]
    return [
        Solver(
            "heyoka after radau",
            f"{start:g} s, {least:g} m",
            tolerances(1e-14)[::2],
            partial(_solve, case, start, least),
        )
        for start, least in scanned
    ]


@cache
def _taylor(n: int, exponent: float, stiffness: float, tolerance: float, least: float) -> Any:
    import heyoka as hy

    overlap = [hy.make_vars(f"d{i}") for i in range(n)]
    rate = [hy.make_vars(f"w{i}") for i in range(n)]
    # par[i] is 1 while contact i is closed; the base is 1 while it is open, so that no power meets a negative number
    force = [hy.par[i] * stiffness * (hy.par[i] * overlap[i] + 1.0 - hy.par[i]) ** exponent for i in range(n)]
    force_of = [hy.expression(0.0), *force, hy.expression(0.0)]
    system = [(overlap[i], rate[i]) for i in range(n)]
    system += [(rate[i], force_of[i] - 2.0 * force_of[i + 1] + force_of[i + 2]) for i in range(n)]

    def switched(i: int) -> Any:
        def callback(solver: Any, direction: int) -> bool:
            solver.pars[i] = 1.0 if direction > 0 else 0.0
            return True

        return hy.t_event(overlap[i] - least, callback=callback)

    return hy.taylor_adaptive(
        system, [1.0] * (2 * n), pars=[1.0] * n, tol=tolerance, t_events=[switched(i) for i in range(n)]
    )


def _solve(case: Case, start: float, least: float, tolerance: float, _start: Start, sample_times: Array) -> Solution:
    import heyoka as hy

    n, law = case.chain.contacts, case.chain.power_laws[0]
    solver = _taylor(n, law.exponent, law.stiffness, tolerance, least)
    early = sample_times[sample_times < start]
    first = solve(
        case.chain, case.velocity, start, "radau", None, np.append(early, start), max(tolerance, START_TOLERANCE)
    )
    state = np.hstack((first.overlap, first.rate))
    solver.time, solver.pars[:], solver.state[:] = start, (first.overlap[-1] > least).astype(float), state[-1]
    solver.reset_cooldowns()
    states, seconds = list(state[:-1]), first.seconds
    for time in output_times(case, sample_times)[early.size :]:
        began = perf_counter()
        outcome = solver.propagate_until(time, max_steps=MOST_STEPS)[0]
        seconds += perf_counter() - began
        if outcome != hy.taylor_outcome.time_limit:
            return Solution(None, seconds)
        states.append(solver.state.copy())
    return solution_of(case, np.array(states), sample_times, seconds, np.nan)
