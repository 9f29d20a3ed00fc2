"""Functions that return the solvers of each other integrator for a case, and the code that they share."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from time import perf_counter
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray
from softcradle.physics.simulation import solve
from softcradle.sandbox.studies.precision.cases import ChartCase, Start
from softcradle.sandbox.studies.precision.measurement import Solution, Solver, step_counts, tolerances
from softcradle.sandbox.studies.precision.peers.problem import (
    TimeLimitError,
    absolute_tolerances,
    derivatives,
    output_times,
    parameter_array,
    solution_of,
    start_state,
    timed_derivatives,
)

Array = NDArray[np.float64]

FIRST_STEP = 1e-6  # Length of the first step [s].
MOST_STEPS = 100_000
TIME_LIMIT = 1.0  # Longest simulation [s] of an integrator that calls its right-hand side from Python.

# Ratios of the absolute tolerance of overlaps to the absolute tolerance of rates.
COMPILED_RATIOS = (1e-2, 1e-6, 1e-10)
RATIOS = (1e-2, 1e-6)
SCIPY_RATIO = 1e-6

CYRK_METHODS = ("RK45", "DOP853", "LSODA", "RADAU")
SCIPY_METHODS = ("DOP853", "LSODA", "Radau")
SUNDAE_METHODS = ("Adams", "BDF")

# Largest number of contacts. The deep contacts of longer chains are too stiff for an explicit series.
HEYOKA_CONTACTS = 5
HEYOKA_SWITCH_TIMES = (1e-2, 1e-4)  # Times [s] after the first touch at which the Taylor series takes over.
HEYOKA_OVERLAPS = (1e-8, 1e-14)  # Overlaps [m] below which a contact counts as open.
HEYOKA_START = 1e-11  # Smallest tolerance of the simulation of the start.
TSIT5_STAGES = 6  # Number of evaluations in a step. The first evaluation is the last one of the previous step.


# Verlet: the usual hand-written loop for one cradle, compiled.


@numba.njit(error_model="numpy")
def leapfrog(overlap: Any, rate: Any, stiffness: float, exponent: float, h: float, steps: int) -> None:
    """Advance a chain of unit masses by `steps` steps, in place. All contacts have the same power law."""
    n = overlap.size
    for _ in range(steps):
        left, before = 0.0, 0.0
        for i in range(n):
            overlap[i] += 0.5 * h * rate[i]
            force = stiffness * overlap[i] ** exponent if overlap[i] > 0.0 else 0.0
            if i > 0:
                rate[i - 1] += h * (left - before + force)
            left, before = before - force, force
        rate[n - 1] += h * (left - before)
        for i in range(n):
            overlap[i] += 0.5 * h * rate[i]


def verlet_by_hand(case: ChartCase) -> list[Solver]:
    """Return a hand-written Verlet solver.

    The list is empty if the masses are not 1, or if the contacts are not one power law without preload.
    """
    chain = case.chain
    simple = set(chain.mass) == {1.0} and len(set(chain.power_laws)) == 1 and chain.power_laws[0].preload == 0.0
    if not simple or chain.drive:
        return []
    return [Solver("Verlet by hand", "", step_counts(), partial(_by_hand, case), steps=True)]


def _by_hand(case: ChartCase, steps: float, start: Start, sample_times: Array) -> Solution:
    law = case.chain.power_laws[0]
    overlap, rate = 0.0 - np.array(start.chain.gap), -np.diff(start.velocity)
    step, count, times = case.run_duration / steps, 0, np.append(sample_times, case.run_duration) + start.early
    states, seconds = [], 0.0
    for time in times:
        more = max(round(time / step) - count, 0)
        began = perf_counter()
        leapfrog(overlap, rate, law.stiffness, law.exponent, step, more)
        seconds += perf_counter() - began
        count += more
        # The remaining time is less than half a step. The motion in it is approximated by a straight line.
        late = time - count * step
        states.append(np.concatenate((overlap + late * rate, rate)))
    return solution_of(case, np.array(states), sample_times, seconds, count)


# CyRK: its compiled loop is called from compiled code.


def cyrk(case: ChartCase) -> list[Solver]:
    """Return one curve for each method. The points of a curve scan ratios of the absolute tolerances."""
    return [
        Solver(f"CyRK {method}", f"overlaps {ratio:g}", tolerances(), partial(_cyrk, case, method, ratio))
        for method in CYRK_METHODS
        for ratio in COMPILED_RATIOS
    ]


@cache
def _cyrk_parts() -> tuple[int, Callable[..., Any]]:
    from CyRK import nb_diffeq_addr, nbsolve2_ivp

    def right_hand_side(out, t, y, p):
        derivatives(y, out, p)

    @numba.njit
    def solve(address, times, start, method, parameters, rtol, absolute, first, most):
        found = nbsolve2_ivp(
            address, (0.0, times[-1]), start, method=method, t_eval=times, args=parameters, rtol=rtol, atols=absolute,
            first_step=first, max_num_steps=most,
        )  # fmt: skip
        ok = found.success and found.size > 0
        last = found.y.copy() if ok else start.reshape(-1, 1)
        found.free()
        return ok, last

    return nb_diffeq_addr(right_hand_side), solve


def _cyrk(case: ChartCase, method: str, ratio: float, tolerance: float, _start: Start, sample_times: Array) -> Solution:
    address, solve = _cyrk_parts()
    counter, start, times = np.zeros(1), start_state(case), output_times(case, sample_times)
    absolute, parameters = absolute_tolerances(case, ratio, tolerance), parameter_array(case, counter)
    began = perf_counter()
    ok, states = solve(address, times, start, method, parameters, tolerance, absolute, FIRST_STEP, MOST_STEPS)
    seconds = perf_counter() - began
    return solution_of(case, states.T if ok else None, sample_times, seconds, counter[0])


# numbalsoda: all variables have the same absolute tolerance. Several fractions of the relative tolerance are tried for
# it.


def numbalsoda(case: ChartCase) -> list[Solver]:
    """Return the single curve of numbalsoda."""
    return [
        Solver("numbalsoda", f"LSODA, absolute {ratio:g}", tolerances(), partial(_numbalsoda, case, ratio))
        for ratio in (1.0, *COMPILED_RATIOS)
    ]


@cache
def _numbalsoda_parts() -> tuple[Any, Callable[..., Any]]:
    from numbalsoda import lsoda, lsoda_sig

    @numba.cfunc(lsoda_sig)
    def right_hand_side(t, y, out, p):
        derivatives(y, out, p)

    return right_hand_side, lsoda


def _numbalsoda(case: ChartCase, ratio: float, tolerance: float, _start: Start, sample_times: Array) -> Solution:
    right_hand_side, lsoda = _numbalsoda_parts()
    counter, start, times = np.zeros(1), start_state(case), np.append(0.0, output_times(case, sample_times))
    parameters, address = parameter_array(case, counter), right_hand_side.address
    began = perf_counter()
    found, ok = lsoda(address, start, times, data=parameters, rtol=tolerance, atol=ratio * tolerance, mxstep=MOST_STEPS)
    seconds = perf_counter() - began
    return solution_of(case, found[1:] if ok else None, sample_times, seconds, counter[0])


# heyoka: a Taylor series with terminal events at which a contact opens or closes. A series cannot start at zero
# overlap. The start is therefore computed by `radau`, and its time counts. A contact counts as open below a small
# overlap, which is scanned as well.


def heyoka(case: ChartCase) -> list[Solver]:
    """Return the single curve of heyoka. The list is empty if the chain has preloads, walls or different contacts."""
    chain, law = case.chain, case.chain.power_laws[0]
    soft = set(chain.power_laws) == {law} and law.preload == 0.0 and law.exponent < 1.0
    if chain.contacts > HEYOKA_CONTACTS or not soft or set(chain.mass) != {1.0} or chain.drive or any(chain.gap):
        return []
    return [
        Solver("heyoka after radau", f"{start:g} s, {least:g} m", tolerances(1e-14)[::2],
               partial(_heyoka, case, start, least))
        for start in HEYOKA_SWITCH_TIMES for least in HEYOKA_OVERLAPS
    ]  # fmt: skip


@cache
def _taylor(n: int, exponent: float, stiffness: float, tolerance: float, least: float) -> Any:
    import heyoka as hy

    overlap = [hy.make_vars(f"d{i}") for i in range(n)]
    rate = [hy.make_vars(f"w{i}") for i in range(n)]
    # par[i] is 1 while contact i is closed. The base is 1 while the contact is open, which avoids powers of negative
    # numbers.
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


def _heyoka(
    case: ChartCase, start: float, least: float, tolerance: float, _start: Start, sample_times: Array
) -> Solution:
    import heyoka as hy

    n, law = case.chain.contacts, case.chain.power_laws[0]
    solver = _taylor(n, law.exponent, law.stiffness, tolerance, least)
    early = sample_times[sample_times < start]
    first = solve(
        case.chain, case.velocity, start, "radau", None, np.append(early, start), max(tolerance, HEYOKA_START)
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


# SciPy: solve_ivp with a compiled right-hand side that is called from its Python loop.


def scipy(case: ChartCase) -> list[Solver]:
    """Return one curve for each method of SciPy."""
    return [Solver(f"SciPy {method}", "", tolerances(), partial(_scipy, case, method)) for method in SCIPY_METHODS]


def _scipy(case: ChartCase, method: str, tolerance: float, _start: Start, sample_times: Array) -> Solution:
    from scipy.integrate import solve_ivp

    counter, start, times = np.zeros(1), start_state(case), output_times(case, sample_times)
    parameters, out = parameter_array(case, counter), np.empty(start.size)
    options: dict[str, Any] = {"rtol": tolerance, "atol": absolute_tolerances(case, SCIPY_RATIO, tolerance)}

    def right_hand_side(_time: float, y: Array) -> Array:
        return timed_derivatives(parameters, out, y, began + TIME_LIMIT).copy()

    began = perf_counter()
    try:
        found = solve_ivp(
            right_hand_side, (0.0, case.run_duration), start, method, times, first_step=FIRST_STEP, **options
        )
    except TimeLimitError:
        return Solution(None, perf_counter() - began, counter[0])
    seconds = perf_counter() - began
    # The time is checked here because a compiled caller drops a TimeLimitError and returns a partial result.
    if seconds > TIME_LIMIT:
        return Solution(None, seconds, counter[0])
    return solution_of(case, found.y.T if found.success else None, sample_times, seconds, counter[0])


# SUNDIALS: CVODE through scikit-sundae, with a compiled right-hand side and its banded solver.


def sundae(case: ChartCase) -> list[Solver]:
    """Return one curve for each method of SUNDIALS."""
    return [
        Solver(f"CVODE {method}", f"overlaps {ratio:g}", tolerances(), partial(_sundae, case, method, ratio))
        for method in SUNDAE_METHODS
        for ratio in RATIOS
    ]


def _sundae(
    case: ChartCase, method: str, ratio: float, tolerance: float, _start: Start, sample_times: Array
) -> Solution:
    from sksundae.cvode import CVODE

    counter, start, times = np.zeros(1), start_state(case), np.append(0.0, output_times(case, sample_times))
    parameters = parameter_array(case, counter)

    def right_hand_side(_time: float, y: Array, out: Array) -> None:
        timed_derivatives(parameters, out, y, began + TIME_LIMIT)

    options: dict[str, Any] = {"rtol": tolerance, "atol": absolute_tolerances(case, ratio, tolerance)}
    began = perf_counter()
    solver = CVODE(right_hand_side, method=method, first_step=FIRST_STEP, max_num_steps=MOST_STEPS, **options)
    try:
        found = solver.solve(times if times.size > 2 else np.append(times, times[-1] * (1.0 + 1e-12)), start)
    except TimeLimitError:
        return Solution(None, perf_counter() - began, counter[0])
    seconds = perf_counter() - began
    # The time is checked here because a compiled caller drops a TimeLimitError and returns a partial result.
    if seconds > TIME_LIMIT:
        return Solution(None, seconds, counter[0])
    states = found.y[1 : times.size] if found.success else None
    return solution_of(case, states, sample_times, seconds, counter[0])


# diffrax: jax compiles it for each number of contacts. The compilation takes four seconds, which do not count. The
# other solvers of diffrax were tried on one on 4 at alpha = 1/10. The other solvers take 20 times (Dopri8) to 100 times
# (Kvaerno5) as long as Tsit5.


def diffrax(case: ChartCase) -> list[Solver]:
    """Return the single curve of diffrax. The list is empty for a driven chain."""
    if case.chain.drive:
        return []
    return [
        Solver("diffrax Tsit5", f"overlaps {ratio:g}", tolerances(), partial(_diffrax, case, ratio)) for ratio in RATIOS
    ]


@cache
def _tsit5() -> Callable[..., Any]:
    import diffrax
    import jax

    jax.config.update("jax_enable_x64", True)
    jnp = jax.numpy

    def derivatives(_time: Any, y: Any, parameters: Any) -> Any:
        law, inverse_mass = parameters
        n = law.shape[0]
        overlap, pressed = y[:n], y[:n] > 0.0
        # The base is 1 while the contact is open, because 0**a is not differentiable.
        power = jnp.where(pressed, overlap, 1.0) ** law[:, 2]
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


def _diffrax(case: ChartCase, ratio: float, tolerance: float, _start: Start, sample_times: Array) -> Solution:
    start, times = start_state(case), output_times(case, sample_times)
    absolute = absolute_tolerances(case, ratio, tolerance)
    began = perf_counter()
    states, steps = _tsit5()(start, times, (case.chain.power_law_rows, case.chain.inverse_mass), tolerance, absolute)
    states = np.asarray(states)
    return solution_of(case, states, sample_times, perf_counter() - began, TSIT5_STAGES * float(steps))
