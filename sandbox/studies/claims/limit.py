"""Claims about the limit alpha -> 0 and about the end of rigid-like behaviour, from Secs. IV and V."""

import math

import numpy as np
from softcradle.physics import Trajectory
from softcradle.physics.analysis.measures import depth_law, spread_variable, time_scale_separation
from softcradle.sandbox.scene_runs import TOLD
from softcradle.sandbox.studies.claims.claim import Claim, grid
from softcradle.sandbox.studies.paper import (
    FINER_SECOND,
    OWN,
    MethodFineness,
    Parameters,
    chain_of,
    detachment,
    later,
    local_rate,
    n_alpha,
    psi_limit,
    spread,
    start,
)

RIGID_LIKE = 0.5  # Largest spread of the target velocities that counts as rigid-like, relative to their mean.
# Sample times as fractions of the contact time.
BOUND_PARTS = (1e-9, 1e-6, 1e-4, 1e-3, 0.01, 0.03, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9)


def largest_psi(case: Parameters, solver: MethodFineness) -> float:
    """Return the largest psi of the full equations while the striker is in contact."""
    return float(_pushed(case, solver, 1.3, 1001).overlap[:, 1].max())


def _pushed(case: Parameters, solver: MethodFineness, part: float, samples: int) -> Trajectory:
    """Return the motion from the start to a fraction `part` of n/(n+1).

    This time n/(n+1) is half the limit of the contact time, 2n/(n+1).
    """
    chain, n = chain_of(case), case["n"]
    return solver.motion(chain, start(chain), part * n / (n + 1.0), samples)


def rate_of_psi(case: Parameters, solver: MethodFineness) -> float:
    """Return how far the slope of log(max psi) against 1/(n alpha) differs from the stated -1."""
    return abs(local_rate(case, largest_psi(case, solver), largest_psi(later(case), solver)) + 1.0)


def psi_off_law(case: Parameters, solver: MethodFineness) -> float:
    """Return the relative difference of max psi from n/(2(n+1)) ((n-1)/n)**(1/alpha)."""
    return abs(largest_psi(case, solver) / psi_limit(case["n"], 1.0 / case["1/alpha"]) - 1.0)


def rate_of_duration(case: Parameters, solver: MethodFineness) -> float:
    """Return how far a slope differs from the stated -1/2.

    The slope is that of the logarithm of sqrt(alpha) times the contact time, against 1/(n alpha).
    """
    low, high = (detachment(k, solver) / math.sqrt(k["1/alpha"]) for k in (case, later(case)))
    return abs(local_rate(case, low, high) + 0.5)


def bend_over_bound(case: Parameters, solver: MethodFineness) -> float:
    """Return the left side of Eq. (9) at i = 2, divided by its stated bound.

    The time is a fraction of the time at which Phi returns to zero.
    """
    chain, n, alpha = chain_of(case), round(case["n"]), 1.0 / case["1/alpha"]
    end = solver.model(chain, start(chain)).returns(0)
    times = tuple((end * np.array(BOUND_PARTS)).tolist())
    bend = solver.model(chain, start(chain), times[-1], times).acceleration[BOUND_PARTS.index(case["part"]), 1]
    return float(depth_law(n, alpha)[1] * abs(bend) / (alpha * math.exp(-1.0 / (n * alpha))))


def loss_of_rigidity(case: Parameters, solver: MethodFineness) -> float:
    """Return RIGID_LIKE divided by the spread of velocities. The result is above 1 if the cluster is still rigid-like."""
    return RIGID_LIKE / spread(case, solver)


def withn_alpha(n: tuple[int, ...], products: tuple[float, ...]) -> list[Parameters]:
    """Return the cases with the given n and products n alpha. Each case is described by n and 1/alpha."""
    return [{"n": float(k), "1/alpha": k / product} for k in n for product in products]


def separation(case: Parameters, solver: MethodFineness) -> float:
    """Return the largest (tau_i / tau_dur)**2 of Eq. (10) among all contacts behind the first inner contact."""
    chain = chain_of(case)
    found = solver.motion(chain, start(chain), detachment(case, solver) * (1.0 + 1e-6), 801)
    return float(time_scale_separation(found)[2:].max())


def energy_inside(case: Parameters, solver: MethodFineness) -> float:
    """Return the largest energy stored in the inner contacts, relative to the initial energy of the striker."""
    found = _pushed(case, solver, 1.5, 2001)
    return float(found.chain.stored_energy(found.overlap)[:, 1:].sum(axis=1).max() / 0.5)


def rise_of_energy(case: Parameters, solver: MethodFineness) -> float:
    """Return the logarithm of the ratio of the energies in the inner contacts at 1/alpha and at LATER times 1/alpha.

    The logarithm is below 0 if the energy falls.
    """
    return math.log(energy_inside(later(case), solver) / energy_inside(case, solver))


def inner_force(case: Parameters, solver: MethodFineness) -> float:
    """Return the relative difference between the largest f12 and its limit (n-1)/n."""
    n, found = case["n"], _pushed(case, solver, 1.5, 2001)
    return abs(float(found.force[:, 1].max()) * n / (n - 1.0) - 1.0)


CLAIMS = (
    Claim(
        name="time-scales", place="Sec. IV, Eq. (10)",
        statement="the consistency condition is the separation of time scales, (tau_i / tau_dur)**2 << 1, fulfilled as "
        "alpha -> 0",
        quantity="largest (tau_i / tau_dur)**2 of the contacts i >= 2", measure=separation,
        cases=grid(n=(3, 4, 5, 6, 8, 10), **{"1/alpha": (6, 8, 10, 12, 14, 17, 20, 24)}), own=OWN,
        variable="n alpha", order=n_alpha, allowed=0.1,
        how="full equations, response times at the largest overlap while the striker pushes; << 1 is read as at most 0.1",
        refer=False,
    ),
    Claim(
        name="amplitude", place="Sec. IV (i)",
        statement="for alpha -> 0 the maximum of psi decreases as exp(-1/(n alpha))",
        quantity="distance of the slope of log(max psi) against 1/(n alpha) from -1", measure=rate_of_psi,
        cases=withn_alpha((2, 3, 4, 5, 6, 8, 10, 12, 16), (0.1, 0.07)), own={"n": 4.0, "1/alpha": 57.0},
        variable="1/n", order=lambda case: 1.0 / case["n"], allowed=0.06,
        how="full equations, n alpha from 0.056 to 0.1",
        remark="the rate is n log((n-1)/n), -1 for many beads only: max psi ~ n/(2(n+1)) ((n-1)/n)**(1/alpha) (amplitude-law)",
        first=MethodFineness(TOLD, tolerance=1e-6), refer=False,
    ),
    Claim(
        name="amplitude-law", place="ours, for Sec. IV (i)",
        statement="our law for Sec. IV (i): max psi tends to n/(2(n+1)) ((n-1)/n)**(1/alpha)",
        quantity="relative distance of max psi from the law", measure=psi_off_law,
        cases=grid(n=(2, 3, 4, 5, 6, 8, 10), **{"1/alpha": (20, 30, 50, 70, 100, 140, 200)}), own={"n": 4.0, "1/alpha": 200.0},
        variable="n alpha", order=n_alpha, allowed=0.1,
        how="full equations",
        remark="Phi reaches n/(2(n+1)) at a force of 1, of which f12 is (n-1)/n",
        refer=False,
    ),
    Claim(
        name="contact-duration", place="Sec. IV (ii)",
        statement="the duration of contact of the striker decreases as exp(-1/(2 n alpha)) / sqrt(alpha)",
        quantity="distance of the slope of log(sqrt(alpha) tau_dur) against 1/(n alpha) from -1/2", measure=rate_of_duration,
        cases=grid(n=(2, 3, 4, 5, 6, 8), **{"1/alpha": (8, 10, 12, 14, 16)}), own=OWN,
        variable="n alpha", order=n_alpha, allowed=0.05,
        how="full equations, 1/alpha from 8 to 20",
        remark="the contact time tends to 2n/(n+1); what decreases so is the period of the inner contact (inner-period)",
    ),
    Claim(
        name="bound-on-consistency", place="Sec. IV, after (ii)",
        statement="the left side of Eq. (9) is bounded by alpha exp(-(i-1)/(n alpha)) for i >= 2",
        quantity="left side of Eq. (9) at i = 2 over the bound", measure=bend_over_bound,
        cases=grid(n=(3, 4, 6, 8, 12, 16), **{"1/alpha": (10, 20, 40)}, part=BOUND_PARTS), own={**OWN, "part": 0.5},
        variable="n", order=lambda case: case["n"], allowed=1.0,
        how="mode-coupling model, at parts of the time until Phi returns",
        remark="at the very start psi'' passes (n-1)/(4n) whatever alpha: for many beads it exceeds the bound",
        second=FINER_SECOND, refer=False, chosen=False,
    ),
    Claim(
        name="below-1/n", place="Sec. IV",
        statement="Eq. (9) holds as a good approximation, and the cluster is rigid-like, for alpha << 1/n",
        quantity="spread of the targets' velocities over their mean", measure=spread,
        cases=withn_alpha((3, 4, 5, 6, 8, 11, 16, 23, 32), (0.15, 0.2, 0.25, 0.3, 0.4)), own=OWN,
        variable="(n+1) exp(-1/(2 n alpha))", order=lambda case: spread_variable(round(case["n"]), 1.0 / case["1/alpha"]),
        allowed=RIGID_LIKE,
        how="velocities when every contact is open, n alpha from 0.15 to 0.4; rigid-like: a spread of at most 50 %",
        remark="at fixed n alpha the spread grows with n: the threshold of n alpha falls like 1/(2 ln(0.9 (n+1))) "
        "(figure collapse)",
        first=MethodFineness(TOLD, tolerance=1e-6),
    ),
    Claim(
        name="above-1/n", place="Sec. IV",
        statement="for alpha > 1/n there is no rigid-like behaviour, even with alpha << 1",
        quantity="0.5 over the spread of the targets' velocities", measure=loss_of_rigidity,
        cases=withn_alpha((2, 3, 4, 6, 8, 12, 16, 24, 32), (1.01, 1.3, 1.7, 2.2, 3.0)), own={"n": 16.0, "1/alpha": 10.0},
        variable="1/(n alpha)", order=lambda case: case["1/alpha"] / case["n"], allowed=1.0,
        how="velocities when every contact is open, n alpha from 1.01 to 3; rigid-like: a spread of at most 50 %",
        refer=False,
    ),
    Claim(
        name="no-energy-inside", place="Sec. IV",
        statement="the energy that the cluster stores during the collision vanishes as alpha -> +0",
        quantity="rise of its logarithm from 1/alpha to 1.25 / alpha", measure=rise_of_energy,
        cases=grid(n=(2, 3, 4, 5, 6, 8), **{"1/alpha": (6, 8, 10, 14, 20, 30, 50, 80)}), own=OWN,
        variable="n alpha", order=n_alpha, allowed=-0.1,
        how="full equations, largest energy of the inner contacts while the striker pushes",
    ),
    Claim(
        name="forces-remain-finite", place="Sec. IV",
        statement="the forces inside remain finite as alpha -> +0",
        quantity="distance of the largest f12 from (n-1)/n, as a part of it", measure=inner_force,
        cases=grid(n=(2, 3, 4, 5, 6, 8), **{"1/alpha": (10, 14, 20, 30, 50, 80)}), own={"n": 4.0, "1/alpha": 20.0},
        variable="n alpha", order=n_alpha, allowed=0.15,
        how="full equations, while the striker pushes",
        refer=False,
    ),
)  # fmt: skip
