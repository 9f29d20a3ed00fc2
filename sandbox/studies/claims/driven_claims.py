"""Claims on a cluster that a steady force drives: Sec. V, and the period of the inner contact in Sec. IV (ii)."""

from __future__ import annotations

import math

from softcradle.physics import Chain
from softcradle.physics.analysis.ringing import returns
from softcradle.sandbox.studies.claims.claim import Claim, Parameters, grid
from softcradle.sandbox.studies.claims.soft_chains import OWN, later, local_rate, n_alpha
from softcradle.sandbox.studies.claims.solver import NotSolvedError, Solver
from softcradle.sandbox.studies.driven_cluster import driven_chain, period

RETURNS = 5
SAMPLES_A_PERIOD = 400


def driven(case: Parameters) -> Chain:
    """n unit beads that just touch, a unit force on the first."""
    return driven_chain(round(case["n"]), 1.0 / case["1/alpha"])


def driven_returns(case: Parameters, solver: Solver) -> tuple[list[float], list[float], float]:
    """Times of the returns of psi, the events at which its rate turns from falling to rising, psi there, and its maximum."""
    chain, n = driven(case), round(case["n"])
    end = (RETURNS + 0.9) * period(n, 1.0 / case["1/alpha"])
    found = solver.motion(chain, (0.0,) * n, end, SAMPLES_A_PERIOD * (RETURNS + 1))
    times, least = returns(found, 0)
    if times.size < RETURNS:
        raise NotSolvedError(f"psi returns {times.size} times, not {RETURNS}")
    return times[:RETURNS].tolist(), least[:RETURNS].tolist(), float(found.overlap[:, 0].max())


def psi_at_return(case: Parameters, solver: Solver) -> float:
    """psi at that return, over its largest value."""
    _, least, largest = driven_returns(case, solver)
    return abs(least[round(case["return"]) - 1]) / largest


def rate_of_inner_period(case: Parameters, solver: Solver) -> float:
    """Distance of the rate of sqrt(alpha) times the driven mode's period from -1/2."""
    low, high = (driven_returns(k, solver)[0][-1] / RETURNS / math.sqrt(k["1/alpha"]) for k in (case, later(case)))
    return abs(local_rate(case, low, high) + 0.5)


CLAIMS = (
    Claim(
        "inner-period",
        "our reading of Sec. IV (ii): the period of the inner contact decreases as exp(-1/(2 n alpha)) / sqrt(alpha)",
        "ours, for Sec. IV (ii)",
        "distance of the slope of log(sqrt(alpha) T) against 1/(n alpha) from -1/2",
        rate_of_inner_period,
        grid(n=(2, 3, 4, 5), **{"1/alpha": (8, 10)}),
        OWN,
        "1/n",
        lambda case: 1.0 / case["n"],
        0.1,
        "period of the driven cluster, from the times of five returns of psi",
        "as for the amplitude: exact for many beads only",
        Solver("conserving", 2e-5),
        refer=False,
    ),
    Claim(
        "driven-periodic",
        "a steady force on the first bead excites a time-periodic evanescent mode on top of a uniform acceleration",
        "Sec. V, data not shown",
        "psi at its return, over its largest value",
        psi_at_return,
        grid(n=(2, 3, 4, 5, 6), **{"1/alpha": (5, 7, 10, 14)}, **{"return": (1, 3, 5)}),
        {**OWN, "return": 5.0},
        "n alpha",
        n_alpha,
        1e-3,
        "full equations; the returns are the events at which psi turns from falling to rising",
        "the true period is not that of the model, by 0.6 % in the paper's case: psi is to be read at its own returns",
        refer=False,
    ),
)
