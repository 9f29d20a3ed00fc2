"""Claims about a cluster of beads that a steady external force pushes.

They are from Sec. V, and from Sec. IV (ii) for the period of the inner contact.
"""

import math

import numpy as np
from softcradle.physics import Chain
from softcradle.physics.analysis.ringing import returns
from softcradle.sandbox.scene_runs import KEEPING
from softcradle.sandbox.studies.claims.claim import Claim, grid
from softcradle.sandbox.studies.paper import (
    OWN,
    MethodFineness,
    NotSolvedError,
    Parameters,
    driven_chain,
    driven_period,
    later,
    local_rate,
    n_alpha,
)

RETURNS = 5
SAMPLES_A_PERIOD = 400
# Positions of the samples around a minimum of psi, in units of the previous distance between samples.
ABOUT = np.linspace(-1.0, 1.0, 41)
# Number of refinements. At the end the samples are 1e-8 of a period apart, and the minimum of psi has an error of
# 1e-15.
CLOSER = 4


def driven(case: Parameters) -> Chain:
    """Return a chain of n unit beads that just touch, with a unit force on the first bead."""
    return driven_chain(round(case["n"]), 1.0 / case["1/alpha"])


def driven_returns(case: Parameters, solver: MethodFineness) -> tuple[list[float], list[float], float]:
    """Return the times of the minima of psi, the values of psi at these times, and the maximum of psi.

    Each minimum is called a return of psi. A minimum is located with samples that become denser around it. The second
    derivative of psi jumps when the contact opens. A smooth curve through samples on both sides of the jump therefore
    does not represent psi.
    """
    chain, n = driven(case), round(case["n"])
    end = (RETURNS + 0.9) * driven_period(n, 1.0 / case["1/alpha"])
    found = solver.motion(chain, (0.0,) * n, end, SAMPLES_A_PERIOD * (RETURNS + 1))
    times = returns(found, 0)[0][:RETURNS]
    if times.size < RETURNS:
        raise NotSolvedError(f"psi returns {times.size} times, not {RETURNS}")
    apart = end / (found.time.size - 1)
    for _ in range(CLOSER):
        about = times[:, None] + apart * ABOUT
        psi = solver.motion(chain, (0.0,) * n, end, tuple(about.ravel().tolist())).overlap[:, 0].reshape(about.shape)
        least = np.argmin(psi, axis=1)
        times, apart = about[np.arange(RETURNS), least], 2.0 * apart / (ABOUT.size - 1)
    return times.tolist(), psi.min(axis=1).tolist(), float(found.overlap[:, 0].max())


def psi_at_return(case: Parameters, solver: MethodFineness) -> float:
    """Return the value of psi at one of its minima, divided by the largest value of psi."""
    _, least, largest = driven_returns(case, solver)
    return abs(least[round(case["return"]) - 1]) / largest


def rate_of_inner_period(case: Parameters, solver: MethodFineness) -> float:
    """Return how far a slope differs from -1/2.

    The slope is that of the logarithm of sqrt(alpha) times the period of the driven mode, against 1/(n alpha).
    """
    low, high = (driven_returns(k, solver)[0][-1] / RETURNS / math.sqrt(k["1/alpha"]) for k in (case, later(case)))
    return abs(local_rate(case, low, high) + 0.5)


CLAIMS = (
    Claim(
        name="inner-period", place="ours, for Sec. IV (ii)",
        statement="our reading of Sec. IV (ii): the period of the inner contact decreases as exp(-1/(2 n alpha)) / sqrt(alpha)",
        quantity="distance of the slope of log(sqrt(alpha) T) against 1/(n alpha) from -1/2", measure=rate_of_inner_period,
        cases=grid(n=(2, 3, 4, 5), **{"1/alpha": (8, 10)}), own=OWN,
        variable="1/n", order=lambda case: 1.0 / case["n"], allowed=0.1,
        how="period of the driven cluster, from the times of five returns of psi",
        remark="as for the amplitude: exact for many beads only",
        second=MethodFineness(KEEPING, 2e-5), refer=False,
    ),
    Claim(
        name="driven-periodic", place="Sec. V, data not shown",
        statement="a steady force on the first bead excites a time-periodic evanescent mode on top of a uniform acceleration",
        quantity="psi at its return, over its largest value", measure=psi_at_return,
        cases=grid(n=(2, 3, 4, 5, 6), **{"1/alpha": (5, 7, 10, 14)}, **{"return": (1, 3, 5)}), own={**OWN, "return": 5.0},
        variable="n alpha", order=n_alpha, allowed=1e-3,
        how="full equations; at a return psi is least, located to 1e-8 of a period",
        remark="the true period is not that of the model, by 0.6 % in the paper's case: psi is to be read at its own returns",
        refer=False,
    ),
)  # fmt: skip
