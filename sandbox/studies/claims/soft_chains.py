"""The homogeneous chains of the claims, one on n, by n and 1/alpha; and what several claims read of their motion."""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics import Chain, Trajectory, one_on, power_law
from softcradle.physics.analysis.measures import rigidity
from softcradle.sandbox.studies.claims.claim import Parameters
from softcradle.sandbox.studies.claims.solver import NotSolvedError, Samples, Solver

OWN = {"n": 4.0, "1/alpha": 10.0}  # the paper's own case: Figs. 1b, 1c and 2
SOFTER = 14.0  # 1/alpha of Fig. 1d
LATER = 1.25  # ratio of neighbouring 1/alpha between which a local rate is taken


def n_alpha(case: Parameters) -> float:
    """n times alpha, by which most claims are ordered."""
    return case["n"] / case["1/alpha"]


def soft_chain(case: Parameters) -> Chain:
    """One on n with that 1/alpha; unit masses and strengths."""
    return one_on(round(case["n"]), power_law(1.0, 1.0 / case["1/alpha"]))


def start(chain: Chain, strikers: int = 1, speed: float = 1.0) -> tuple[float, ...]:
    """Start velocities: `speed` for the strikers, rest for all others."""
    return (speed,) * strikers + (0.0,) * (chain.contacts + 1 - strikers)


def outcome(case: Parameters, solver: Solver) -> np.ndarray:
    """(n+1,) velocities when every contact is open."""
    chain = soft_chain(case)
    return solver.motion(chain, start(chain)).final_velocity


def spread(case: Parameters, solver: Solver) -> float:
    """Largest less smallest target velocity over their mean, when every contact is open."""
    return float(rigidity(outcome(case, solver)[1:]))


def detachment(case: Parameters, solver: Solver) -> float:
    """Time at which the striker's contact opens for the first time."""
    chain = soft_chain(case)
    return first_opening(solver.motion(chain, start(chain)))


def first_opening(found: Trajectory, contact: int = 0) -> float:
    """Time at which `contact` opens for the first time; NotSolvedError where it never closes and opens again."""
    spans = found.contact_intervals[contact]
    if not spans or not np.isfinite(spans[0][1]):
        raise NotSolvedError(f"contact {contact} does not open")
    return spans[0][1]


def while_struck(case: Parameters, solver: Solver, samples: int, part: float = 1.0) -> Trajectory:
    """The motion from the touch of the striker to the first opening of either of the first two contacts, or a part of it."""
    chain = soft_chain(case)
    whole = solver.motion(chain, start(chain))
    end = part * min(first_opening(whole, 0), first_opening(whole, 1))
    return solver.motion(chain, start(chain), end, samples)


def at_fractions(case: Parameters, solver: Solver, fractions: tuple[float, ...]) -> Trajectory:
    """The motion at those parts of the striker's contact time."""
    return at_times(soft_chain(case), solver, tuple(detachment(case, solver) * part for part in fractions))


def at_times(chain: Chain, solver: Solver, times: Samples) -> Trajectory:
    """The motion at those times."""
    end = times[-1] if isinstance(times, tuple) else None
    return solver.motion(chain, start(chain), end, times)


def local_rate(case: Parameters, low: float, high: float) -> float:
    """Slope of the logarithm of a quantity against 1/(n alpha), from its values at 1/alpha and LATER times that."""
    return math.log(high / low) * case["n"] / ((LATER - 1.0) * case["1/alpha"])


def later(case: Parameters) -> Parameters:
    """The same case at LATER times 1/alpha."""
    return {**case, "1/alpha": LATER * case["1/alpha"]}
