"""Other people's integrators on the same collisions: each a small function, each left out where it is not installed.

All have what an expert would give them: overlaps as variables, compiled right-hand sides, absolute tolerances finer for
overlaps than for rates, a small first step (they would jump over the collision). None can stop when a collision is over,
so they run to its known end; none knows a contact that touches, so draft gears chatter for them.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from importlib.util import find_spec
from time import perf_counter
from typing import Any

import numba
import numpy as np
from numba import njit
from numpy.typing import NDArray

from benchmarks.cases import MARGIN, Case
from benchmarks.solvers import Solver, step_counts, tolerances
from physics import simulate
from physics.state import from_anchor

Array = NDArray[np.float64]

PACKAGES = ("CyRK", "numbalsoda", "heyoka")
CYRK_METHODS = ("DOP853", "LSODA", "RADAU")
FINER = (1e-2, 1e-6, 1e-10)  # absolute tolerance of overlaps, as part of that of rates
FIRST_STEP = 1e-6  # [s]
MOST_STEPS = 400_000
MOST_TAYLOR = 5  # contacts heyoka is tried with: deeper ones are too stiff for an explicit series


def missing() -> list[str]:
    """Names of the peers that are not installed."""
    return [name for name in PACKAGES if find_spec(name) is None]


def peers(case: Case) -> list[Solver]:
    """Every peer that is installed and can take the case."""
    makers: dict[str, Callable[[Case], list[Solver]]] = {"CyRK": cyrk, "numbalsoda": numbalsoda, "heyoka": heyoka}
    installed = [maker for name, maker in makers.items() if name not in missing()]
    return [verlet_by_hand(case), *(solver for maker in installed for solver in maker(case))]


def _start(case: Case) -> Array:
    """(2n,) overlaps and rates at the start."""
    return np.concatenate((np.zeros(case.chain.contacts), -np.diff(case.velocity)))


def _end(case: Case) -> float:
    return case.end * MARGIN if case.duration is None else case.duration


def _velocities(case: Case, rate: Array) -> Array:
    """(n+1,) velocities from rates (n,), the momentum kept."""
    mass = np.array(case.chain.mass)
    relative = from_anchor(rate, 0.0, 0)
    return relative + (mass @ case.velocity - mass @ relative) / mass.sum()


def _parameters(case: Case) -> Array:
    """(1 + 3n + n+1,) number of contacts, law of each, inverse masses: one array, as C-like right-hand sides take it."""
    law, inverse_mass = case.chain.parameters
    return np.concatenate(([case.chain.contacts], law.ravel(), inverse_mass))


@njit(error_model="numpy")
def contact_force(p: Any, i: int, overlap: float) -> float:
    """Force of contact i at `overlap` [N]."""
    if overlap <= 0.0:
        return 0.0
    exponent = p[1 + 3 * i + 2]
    if exponent == 1.0:
        power = overlap
    elif exponent == 1.5:
        power = overlap * np.sqrt(overlap)
    else:
        power = overlap**exponent
    return p[1 + 3 * i] + p[1 + 3 * i + 1] * power


@njit(error_model="numpy")
def slopes(y: Any, out: Any, p: Any) -> None:
    """d' = w, w' = -L f(d) by way of the bead accelerations; y and out (2n,)."""
    n = int(p[0])
    left, before = 0.0, 0.0
    for i in range(n + 1):
        force = contact_force(p, i, y[i]) if i < n else 0.0
        acceleration = (before - force) * p[1 + 3 * n + i]
        if i > 0:
            out[i - 1] = y[n + i - 1]
            out[n + i - 1] = left - acceleration
        left, before = acceleration, force


@njit(error_model="numpy")
def leapfrog(overlap: Any, rate: Any, stiffness: float, exponent: float, h: float, steps: int) -> None:
    """Verlet as one writes it for one cradle: equal unit masses, one power law, nothing else; in place."""
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


def verlet_by_hand(case: Case) -> Solver:
    """The loop that people write themselves. A preload is added to no force: such a case is left to the others."""
    return Solver("Verlet by hand", "", step_counts(4e6), partial(_by_hand, case))


def _by_hand(case: Case, steps: float) -> tuple[Array | None, float]:
    law = case.chain.contact[0]
    if law.preload > 0.0:
        return None, 0.0
    rate, overlap = -np.diff(case.velocity), np.zeros(case.chain.contacts)
    began = perf_counter()
    leapfrog(overlap, rate, law.stiffness, law.exponent, _end(case) / steps, int(steps))
    return _velocities(case, rate), perf_counter() - began


def cyrk(case: Case) -> list[Solver]:
    """CyRK's compiled loop called from compiled code, over its methods and ratios of the absolute tolerances."""
    return [
        Solver("CyRK", f"{method}, overlaps {finer:g}", tolerances(), partial(_cyrk, case, method, finer))
        for method in CYRK_METHODS
        for finer in FINER
    ]


@cache
def _cyrk_parts() -> tuple[int, Callable[..., Any]]:
    from CyRK import nb_diffeq_addr, nbsolve2_ivp

    def right_hand_side(out, t, y, p):
        slopes(y, out, p)

    @njit
    def solve(address, end, start, method, parameters, rtol, atols, first, most):
        found = nbsolve2_ivp(
            address, (0.0, end), start, method=method, t_eval=np.array([end]), args=parameters, rtol=rtol, atols=atols,
            first_step=first, max_num_steps=most,
        )  # fmt: skip
        ok = found.success and found.size > 0
        last = found.y[:, -1].copy() if ok else start
        found.free()
        return ok, last

    return nb_diffeq_addr(right_hand_side), solve


def _cyrk(case: Case, method: str, finer: float, tolerance: float) -> tuple[Array | None, float]:
    n = case.chain.contacts
    address, solve = _cyrk_parts()
    atols = np.repeat((finer * tolerance, tolerance), n)
    start, parameters = _start(case), _parameters(case)
    began = perf_counter()
    ok, last = solve(address, _end(case), start, method, parameters, tolerance, atols, FIRST_STEP, MOST_STEPS)
    seconds = perf_counter() - began
    return (_velocities(case, last[n:]) if ok else None), seconds


def numbalsoda(case: Case) -> list[Solver]:
    """numbalsoda's LSODA; it has one absolute tolerance for all, so overlaps are held as absolute parts of `tolerance`."""
    return [
        Solver("numbalsoda", f"LSODA, absolute {finer:g}", tolerances(), partial(_numbalsoda, case, finer))
        for finer in (1.0, *FINER)
    ]


@cache
def _numbalsoda_parts() -> tuple[Any, Callable[..., Any]]:
    from numbalsoda import lsoda, lsoda_sig

    @numba.cfunc(lsoda_sig)
    def right_hand_side(t, y, out, p):
        slopes(y, out, p)

    return right_hand_side, lsoda


def _numbalsoda(case: Case, finer: float, tolerance: float) -> tuple[Array | None, float]:
    n = case.chain.contacts
    right_hand_side, lsoda = _numbalsoda_parts()
    start, parameters, times = _start(case), _parameters(case), np.array([0.0, _end(case)])
    address = right_hand_side.address
    began = perf_counter()
    found, ok = lsoda(
        address, start, times, data=parameters, rtol=tolerance, atol=finer * tolerance, mxstep=MOST_STEPS
    )  # fmt: skip
    seconds = perf_counter() - began
    return (_velocities(case, found[-1, n:]) if ok else None), seconds


def heyoka(case: Case) -> list[Solver]:
    """heyoka's Taylor series with terminal events where a contact opens or closes.

    A series has no start where an overlap is zero: `radau` takes it through the first moment, and that time counts. A
    contact counts as open below a small overlap, scanned beside the tolerance.
    """
    soft = all(law.preload == 0.0 and law.exponent < 1.0 for law in case.chain.contact)
    if case.chain.contacts > MOST_TAYLOR or not soft:
        return []
    scanned = [(start, least) for start in HANDED_OVER for least in (1e-8, 1e-11, 1e-14)]
    return [
        Solver(
            "heyoka after radau", f"{start:g} s, {least:g} m", tolerances(1e-14), partial(_heyoka, case, start, least)
        )
        for start, least in scanned
    ]


HANDED_OVER = (1e-2, 1e-4)  # [s] after the first touch
START_TOLERANCE = 1e-11  # finest that the start is computed to


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


def _heyoka(case: Case, start: float, least: float, tolerance: float) -> tuple[Array | None, float]:
    import heyoka as hy

    n, law = case.chain.contacts, case.chain.contact[0]
    solver = _taylor(n, law.exponent, law.stiffness, tolerance, least)
    first = simulate(
        case.chain, case.velocity, start, method="radau", tolerance=max(tolerance, START_TOLERANCE), samples=2
    )  # fmt: skip
    solver.time, solver.pars[:] = start, (first.overlap[-1] > least).astype(float)
    solver.state[:] = np.concatenate((first.overlap[-1], first.rate[-1]))
    solver.reset_cooldowns()
    began = perf_counter()
    outcome = solver.propagate_until(_end(case), max_steps=MOST_STEPS)[0]
    seconds = perf_counter() - began + first.seconds
    arrived = outcome == hy.taylor_outcome.time_limit
    return (_velocities(case, solver.state[n:].copy()) if arrived else None), seconds
