"""Claims that compare the mode-coupling model with the full equations, from Secs. III and IV, Fig. 2 and App. A."""

import numpy as np
from softcradle.physics import Chain, cluster_on_cluster, one_on, power_law
from softcradle.physics.analysis.measures import depth_law
from softcradle.physics.analysis.ringing import turning_points
from softcradle.sandbox.scene_runs import KEEPING, TOLD
from softcradle.sandbox.studies.claims.claim import Claim, grid
from softcradle.sandbox.studies.paper import (
    FINER_SECOND,
    FINEST_SECOND,
    OWN,
    SWING,
    MethodFineness,
    NotSolvedError,
    Parameters,
    by_load,
    chain_of,
    first_opening,
    power_laws,
    random_beads,
    start,
    while_struck,
)

# Times as fractions of the time at which a force ends.
EDGES = 1e-6, 1e-4, 0.01, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.97, 0.98, 0.99, 0.995, 1.0
SAMPLES_A_BIN = 60
RANDOM_CHAINS = 24
SEED = 20211105
RISE_DECADES = tuple(range(-16, 0))  # Decimal exponents of the times in Fig. 2d.
# This tolerance is small compared with the overlaps of all contacts at the time 1e-16.
AT_THE_TOUCH = MethodFineness(TOLD, tolerance=1e-14)
RISE_END = 1.0  # End of Fig. 2d, and of the simulation from which slopes are measured, in units of time.
# Number of slopes for each decade of time. With this number, a jump of a force by a fraction of a percent would change
# a slope by ten percent.
SLOPES = 8


def discrepancy(case: Parameters, solver: MethodFineness) -> float:
    """Return the largest relative discrepancy of a force, (full - model) / full.

    Only a fraction of the time for which the force acts is considered.
    """
    chain, contact = chain_of(case), round(case["contact"])
    end = first_opening(solver.motion(chain, start(chain)), contact)
    upper = case["until"]
    times = tuple((end * np.linspace(EDGES[EDGES.index(upper) - 1], upper, SAMPLES_A_BIN, endpoint=False)).tolist())
    full = solver.motion(chain, start(chain), end, times).force[:, contact]
    model = solver.model(chain, start(chain), end, times).trajectory.force[:, contact]
    return float(np.abs(1.0 - model / full).max())


def delay_of_phi(case: Parameters, solver: MethodFineness) -> float:
    """Return the time at which Phi returns to zero minus the time at which psi returns to zero.

    The difference is below 0 if Phi returns first.
    """
    chain = chain_of(case)
    found = solver.model(chain, start(chain))
    return found.returns(0) - found.returns(1)


def turns_of_inner_force(case: Parameters, solver: MethodFineness) -> float:
    """Return the number of turning points of f12 while the first two contacts are closed."""
    force = while_struck(case, solver, 20001).force[:, 1]
    return float(turning_points(force, SWING).size)


def rising_power(contact: int, alpha: float) -> float:
    """Return the power p of the time t with which the force of `contact` rises initially.

    The force f01 rises with the power alpha. If a contact has the power p, the next contact has alpha (2 + p). The
    reason is that the overlap of a contact is the force of the previous one, integrated twice over time. For example,
    f12 ~ t**(alpha (2 + alpha)).
    """
    return alpha if contact == 0 else alpha * (2.0 + rising_power(contact - 1, alpha))


def slope_error(case: Parameters, solver: MethodFineness) -> float:
    """Return the largest relative difference between the logarithmic slope of a force and the stated power of t.

    The slope is measured between t and 10 t. The full equations start when the beads touch, as in Fig. 2d. A fixed step
    must be small compared with t. The time is therefore scaled: the same motion runs from 1 to 10 if the contact
    strengths are multiplied by t**(1 + alpha).
    """
    alpha, contact = 1.0 / case["1/alpha"], round(case["contact"])
    unit = case["t"] if solver.step else 1.0
    chain = one_on(round(case["n"]), power_law(unit ** (1.0 + alpha), alpha))
    times = tuple((case["t"] / unit * np.logspace(0.0, 1.0, SLOPES + 1)).tolist())
    force = solver.motion(chain, start(chain), times[-1] if solver.step else RISE_END, times).force[:, contact]
    if not force[0] > 0.0:
        raise NotSolvedError("no force at the first sample")
    slopes = np.diff(np.log10(force)) * SLOPES
    return float(np.abs(slopes / rising_power(contact, alpha) - 1.0).max())


def consistency(case: Parameters, solver: MethodFineness) -> float:
    """Return the largest left side of Eq. (9) at i = 2 in a fraction of the time until psi has returned to zero."""
    chain = chain_of(case)
    end = solver.model(chain, start(chain)).returns(1)
    upper = case["until"]
    times = tuple((end * np.linspace(upper - 0.05, upper, SAMPLES_A_BIN, endpoint=False)).tolist())
    bend = solver.model(chain, start(chain), end, times).acceleration[:, 1]
    return float(depth_law(chain.contacts, 1.0 / case["1/alpha"])[1] * np.abs(bend).max())


def random_chain(case: Parameters) -> Chain:
    """Return a random chain of beads, generated from the seed of the case. Seed 0 gives a homogeneous chain.

    Masses and contact strengths are between 1/2 and 2. Exponents are between 1/40 and 1/20.
    """
    n = round(case["n"])
    if not case["seed"]:
        return one_on(n, power_law(1.0, 1.0 / 30.0))
    random = np.random.default_rng([SEED, round(case["seed"])])
    mass, strength = random_beads(random, n, 2.0)
    return Chain(mass, power_laws(strength, 1.0 / random.uniform(20.0, 40.0, n)))


def force_error(chain: Chain, solver: MethodFineness, strikers: int = 1) -> float:
    """Return the largest |full - model| of a force, divided by the peak of the full force.

    Only the middle 80 % of the time in which the struck contact is closed is considered.
    """
    struck, velocity = strikers - 1, start(chain, strikers)
    end = first_opening(solver.motion(chain, velocity), struck)
    times = tuple((end * np.linspace(0.1, 0.9, 161)).tolist())
    full = solver.motion(chain, velocity, end, times).force
    model = solver.model(chain, velocity, end, times).trajectory.force
    return float((np.abs(full - model) / full.max(axis=0)).max())


def clusters(case: Parameters) -> Chain:
    """Return a homogeneous chain in which m beads hit n beads."""
    return cluster_on_cluster(round(case["m"]), round(case["n"]), power_law(1.0, 1.0 / case["1/alpha"]))


CLAIMS = (
    Claim(
        name="within-1e-3", place="Sec. IV, Fig. 2c",
        statement="the mode-coupling model reproduces f01 and f12 within 1e-3 over the entire time domain of the collision",
        quantity="largest relative discrepancy of the force up to that part of its time, from the part before",
        measure=discrepancy,
        cases=grid(**OWN, contact=(0, 1), until=EDGES[1:]), own={"until": 0.5, "contact": 1.0},
        variable="part of the time for which the force acts", order=lambda case: case["until"], allowed=1e-3,
        how="full equations and model, each force from 1e-6 of its own time to its own end",
        remark="at their ends the relative discrepancies grow without bound: model and full force end at different times",
        second=FINER_SECOND, refer=False, chosen=False,
    ),
    Claim(
        name="inner-forces", place="Sec. IV, Fig. 2b",
        statement="the reproduction of the inter-particle forces by the mode-coupling model is quite satisfactory",
        quantity="largest relative discrepancy of f23 and f34 up to that part of their time, from the part before",
        measure=discrepancy,
        cases=grid(**OWN, contact=(2, 3), until=EDGES[1:]), own={"until": 0.5, "contact": 2.0},
        variable="part of the time for which the force acts", order=lambda case: case["until"], allowed=0.05,
        how="full equations and model; 5 % is what the eye sees in Fig. 2b",
        second=FINER_SECOND, refer=False,
    ),
    Claim(
        name="phi-first", place="Sec. IV, Fig. 2a",
        statement="Phi returns to zero before psi does",
        quantity="time of Phi's return less that of psi's", measure=delay_of_phi,
        cases=grid(n=(2, 3, 4, 5, 6, 8), **{"1/alpha": (6, 8, 10, 12, 14, 16, 18, 20, 24, 30)}), own=OWN,
        variable="1/(n alpha)", order=lambda case: case["1/alpha"] / case["n"], allowed=0.0,
        how="mode-coupling model; above 0 psi is first",
        second=FINER_SECOND, chosen=False,
    ),
    Claim(
        name="no-oscillation", place="Sec. IV, Fig. 2c",
        statement="there is no sign of fine oscillations: the inner force rises once and falls once",
        quantity="turning points of f12 while the striker pushes", measure=turns_of_inner_force,
        cases=grid(n=(2, 3, 4, 5), **{"1/alpha": (6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 27, 30)}), own=OWN,
        variable="1/alpha", order=lambda case: case["1/alpha"], allowed=1.0,
        how="20001 samples while the first two contacts are closed; a swing below 1e-5, a hundredth of what Fig. 2c shows, is "
        "none",
        remark="smaller exponents ring: more often, faster and less; the period is that of the inner contact about its branch "
        "(figure ringing)",
        second=FINEST_SECOND, chosen=False,
    ),
    Claim(
        name="slopes", place="caption of Fig. 2d",
        statement="initially f01 ~ t**alpha and f12 ~ t**(alpha (2 + alpha))",
        quantity="largest relative distance of the logarithmic slope from the stated power, in a decade", measure=slope_error,
        cases=grid(n=(4,), **{"1/alpha": (7, 10, 14)}, contact=(0, 1), t=[10.0**power for power in RISE_DECADES]),
        own={"1/alpha": 10.0, "contact": 1.0, "t": 1e-16},
        variable="t", order=lambda case: case["t"], allowed=0.01,
        how="full equations, one run from the touch on; 8 slopes in each decade that Fig. 2d shows",
        remark="the correction to f12 is of relative order t**(alpha (1 + alpha)) and decays slowly",
        first=AT_THE_TOUCH, refer=False,
    ),
    Claim(
        name="deeper-slopes", place="ours, for Fig. 2d",
        statement="our continuation of Fig. 2d: a force deeper inside rises as t**(alpha (2 + p)), p the power of the one before",
        quantity="largest relative distance of the logarithmic slope from that power, in a decade", measure=slope_error,
        cases=grid(n=(4,), **{"1/alpha": (7, 10, 14)}, contact=(2, 3), t=[10.0**power for power in RISE_DECADES]),
        own={"1/alpha": 10.0, "contact": 2.0, "t": 1e-16},
        variable="t", order=lambda case: case["t"], allowed=0.05,
        how="as slopes",
        remark="corrections decay the more slowly the deeper a contact is",
        first=AT_THE_TOUCH, refer=False,
    ),
    Claim(
        name="consistency-example", place="Sec. IV, after Eq. (9)",
        statement="for n = 4, alpha = 1/10 the left side of Eq. (9) is at most about 1e-3, since psi'' is about 0.1",
        quantity="largest left side of Eq. (9) at i = 2", measure=consistency,
        cases=grid(**OWN, until=np.arange(0.05, 1.001, 0.05).round(2)), own={"until": 0.5},
        variable="part of the time until psi returns", order=lambda case: case["until"], allowed=2e-3,
        how="mode-coupling model, in 20 parts of the collision; about 1e-3 is read as at most 2e-3",
        remark="psi'' is largest at the very start",
        second=FINER_SECOND,
    ),
    Claim(
        name="inhomogeneous-model", place="App. A",
        statement="equations (A3) are the core of the motion for heterogeneous masses, strengths and exponents that are small",
        quantity="largest |full - model| over the peak of the force, all contacts",
        measure=lambda case, solver: force_error(random_chain(case), solver),
        cases=by_load(grid(n=4, seed=range(RANDOM_CHAINS + 1)), random_chain), own={"load": 0.75},
        variable="greatest load of an inner contact", order=lambda case: case["load"], allowed=0.05,
        how=f"{RANDOM_CHAINS} random chains, seed {SEED}: masses and strengths of 1/2 to 2, exponents of 1/40 to 1/20; "
        f"middle 80 % of the striker's contact",
        remark="where an inner contact has to pass on more than its f0 no exponent is small enough",
        second=MethodFineness(KEEPING, 5e-5), refer=False,
    ),
    Claim(
        name="second-mode", place="App. A (ii)",
        statement="cluster on cluster needs but one more evanescent mode, for the hitting cluster",
        quantity="largest |full - model| over the peak of the force, all contacts",
        measure=lambda case, solver: force_error(clusters(case), solver, round(case["m"])),
        cases=grid(m=(2, 3, 4), n=(3, 5, 7), **{"1/alpha": (8, 14, 24)}), own={"m": 3.0, "n": 5.0, "1/alpha": 14.0},
        variable="n alpha", order=lambda case: max(case["n"], case["m"]) / case["1/alpha"], allowed=0.05,
        how="m on n homogeneous beads; middle 80 % of the contact of the two clusters; n alpha of the larger one",
    ),
)  # fmt: skip
