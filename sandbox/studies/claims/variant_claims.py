"""Claims on variants of the set-up: heterogeneous chains, a Hooke interface, prestress and waves. Sec. V, App. A."""

from __future__ import annotations

import math

import numpy as np
from softcradle.physics import Chain, Contact, hertz, hooke, one_on, power_law
from softcradle.physics.analysis.measures import loads, rigidity
from softcradle.physics.analysis.ringing import turning_points
from softcradle.sandbox.studies.claims.claim import Claim, Parameters, grid
from softcradle.sandbox.studies.claims.soft_chains import start
from softcradle.sandbox.studies.claims.solver import NotSolvedError, Solver

SEED = 20100324
CHAINS = 100
TARGETS = 6
CRADLES = 30  # random chains of a width
WIDTH = 2.0  # masses and strengths lie between 1/WIDTH and WIDTH
INVERSE = (30.0, 50.0)  # range of 1/alpha in a random chain
WAVE_BEADS = 60
NUDGE = 1e-4  # speed of the bead that starts a wave under prestress, as a part of what would open a contact


def random_chain(case: Parameters) -> Chain:
    """One on TARGETS with random masses, strengths and exponents by the seed of the case; 0 is homogeneous."""
    random = np.random.default_rng([SEED, round(case["seed"])])
    width = WIDTH if case["seed"] else 1.0
    mass, strength = (width ** random.uniform(-1.0, 1.0, count) for count in (TARGETS + 1, TARGETS))
    inverse = random.uniform(*INVERSE, TARGETS)
    return Chain(mass, [Contact(0.0, f0, 1.0 / k) for f0, k in zip(strength, inverse, strict=True)])


def weighted_spread(case: Parameters, solver: Solver) -> float:
    """Root mean square of the targets' velocities about their mean, by mass, as a part of that mean."""
    chain = random_chain(case)
    mass, velocity = np.array(chain.mass)[1:], solver.motion(chain, start(chain)).final_velocity[1:]
    mean = np.average(velocity, weights=mass)
    return float(np.sqrt(np.average((velocity - mean) ** 2, weights=mass)) / mean)


def random_cases() -> list[Parameters]:
    """The homogeneous chain and the random ones, with the greatest load of their inner contacts."""
    cases = grid(seed=range(CHAINS + 1))
    return [{**case, "load": float(loads(random_chain(case))[1:].max())} for case in cases]


def momentum_of_last(case: Parameters, solver: Solver) -> float:
    """Part of the momentum that the last bead of the usual cradle takes, in the mean over random chains of that width."""
    taken = []
    for seed in range(CRADLES):
        random = np.random.default_rng([SEED, seed])
        mass, strength = (case["width"] ** random.uniform(-1.0, 1.0, count) for count in (TARGETS + 1, TARGETS))
        chain = Chain(mass, [hertz(k) for k in strength])
        taken.append(chain.mass[-1] * solver.motion(chain, start(chain)).final_velocity[-1] / chain.mass[0])
    return float(np.mean(taken))


def interface_load(case: Parameters) -> float:
    """Force that the first inner contact has to pass on if the cluster is rigid, in units of its f0."""
    n = case["n"]
    return (n - 1.0) / n * case["V"] * math.sqrt(case["k"] * n / (n + 1.0))


def interface_spread(case: Parameters, solver: Solver) -> float:
    """Spread of the targets behind a truncated Hooke spring, over their mean."""
    n = round(case["n"])
    chain = one_on(n, (hooke(case["k"]), *(power_law(1.0, 1.0 / case["1/alpha"]),) * (n - 1)))
    velocity = solver.motion(chain, start(chain, speed=case["V"])).final_velocity[1:]
    return float(rigidity(velocity))


def interface_cases() -> list[Parameters]:
    """A grid of stiffness, speed and 1/alpha, ordered by the load of the inner contact."""
    return grid(n=4, k=(0.25, 0.5, 1, 1.5, 3, 10), V=(0.5, 1, 2), **{"1/alpha": (10, 14)})


def last_bead(case: Parameters, solver: Solver) -> float:
    """How much of the striker's velocity the last bead of the usual cradle does not take."""
    n = round(case["n"])
    chain = one_on(n, hertz(1.0))
    return 1.0 - float(solver.motion(chain, start(chain)).final_velocity[-1])


def pressed_chain(beads: int, alpha: float, prestress: float) -> Chain:
    """A row of unit beads whose ends are pressed together by a steady force, at rest under it."""
    law = power_law(1.0, alpha)
    drive = [prestress, *[0.0] * (beads - 2), -prestress]
    return Chain([1.0] * beads, law, [-float(law.overlap(prestress))] * (beads - 1), drive)


def wave_speed(case: Parameters, solver: Solver) -> float:
    """Beads a unit of time at which a small pulse runs along a row under prestress, between its 15th and 45th contact."""
    alpha, prestress = 1.0 / case["1/alpha"], case["prestress"]
    chain = pressed_chain(WAVE_BEADS, alpha, prestress)
    expected = _linear_speed(alpha, prestress)
    velocity = [0.0] * WAVE_BEADS
    velocity[0] = NUDGE * expected * abs(chain.gap[0])
    end = 0.95 * WAVE_BEADS / expected
    found = solver.motion(chain, tuple(velocity), end, 1201)
    arrival = [float(found.time[int(np.argmax(found.force[:, k]))]) for k in (15, 45)]
    return 30.0 / (arrival[1] - arrival[0])


def _linear_speed(alpha: float, prestress: float) -> float:
    """``sqrt(f'(d) / m)`` at the prestress: prestress**((alpha-1)/(2 alpha)) sqrt(alpha)."""
    return math.sqrt(alpha) * prestress ** ((alpha - 1.0) / (2.0 * alpha))


def fall_with_prestress(case: Parameters, solver: Solver) -> float:
    """Logarithm of the ratio of the wave speeds at this prestress and at a tenth less: below 0 where less is faster."""
    less = {**case, "prestress": 0.9 * case["prestress"]}
    return math.log(wave_speed(case, solver) / wave_speed(less, solver))


def few_turns(case: Parameters, solver: Solver) -> float:
    """3 over the turning points of the force in the middle of a cluster under prestress that is struck."""
    n, alpha, prestress = 4, 1.0 / case["1/alpha"], case["prestress"]
    law = power_law(1.0, alpha)
    overlap = -float(law.overlap(prestress))
    drive = [0.0, prestress, *[0.0] * (n - 2), -prestress]
    chain = Chain([1.0] * (n + 1), (power_law(1.0, 1.0 / 30.0), *(law,) * (n - 1)), [0.0, *[overlap] * (n - 1)], drive)
    period = 2.0 * math.pi / math.sqrt(2.0 * _linear_speed(alpha, prestress) ** 2)
    found = solver.motion(chain, start(chain, speed=case["V"]), 8.0 * period, 2001)
    turns = turning_points(found.force[:, 2]).size
    if turns == 0:
        raise NotSolvedError("the force does not turn")
    return 3.0 / turns


CLAIMS = (
    Claim(
        "robust",
        "rigid-like behaviour is robust against heterogeneity, as long as all exponents are sufficiently small",
        "Secs. III, V",
        "spread of the targets' velocities, by mass, over their mean",
        weighted_spread,
        random_cases(),
        {"load": 5.0 / 6.0},
        "greatest load of an inner contact",
        lambda case: case["load"],
        0.05,
        f"{CHAINS} random chains of {TARGETS} targets, seed {SEED}, and the homogeneous one: masses and strengths of 1/2 to 2, "
        "exponents of 1/50 to 1/30; rigid-like: a spread of at most 5 %",
        "the load is the force that a contact has to pass on over its f0; near 1 the exponent needed is ever smaller",
        first=Solver("accurate", tolerance=1e-6),
        refer=False,
    ),
    Claim(
        "cradle-perturbed",
        "in the usual cradle the pulse is highly perturbed by the inhomogeneity",
        "Sec. V",
        "part of the momentum that the last bead takes",
        momentum_of_last,
        grid(width=(1.05, 1.1, 1.2, 1.35, 1.5, 1.75, 2.0, 3.0)),
        {"width": WIDTH},
        "1/width",
        lambda case: 1.0 / case["width"],
        0.9,
        f"mean of {CRADLES} random chains of {TARGETS} targets, seed {SEED}: masses and stiffnesses of 1/width to width, Hertz; "
        "the homogeneous chain passes on 98 %",
        refer=False,
    ),
    Claim(
        "kicked-out",
        "without the pistons the furthest particle is dominantly kicked out",
        "App. C",
        "part of the striker's velocity that the last bead does not take",
        last_bead,
        grid(n=(2, 3, 4, 6, 8, 12, 16, 24)),
        {"n": 3.0},
        "n",
        lambda case: case["n"],
        0.1,
        "one on n, Hertz contacts, no friction",
    ),
    Claim(
        "hooke-interface",
        "a truncated Hooke spring between striker and cluster works as well",
        "App. A (iii), data not shown",
        "spread of the targets' velocities over their mean",
        interface_spread,
        interface_cases(),
        {"1/alpha": 10.0, "k": 1.0, "V": 1.0},
        "inner force over f0",
        interface_load,
        0.1,
        "one on four, stiffness 0.25 to 10, speed 0.5 to 2, inner 1/alpha of 10 and 14; works: a spread of at most 10 %",
        "the stiffness and the speed count by the force that the inner contact has to pass on",
        Solver("conserving", 5e-5),
    ),
    Claim(
        "waves-diverge",
        "linear wave velocities diverge at vanishing prestress",
        "Sec. IV, Sec. V",
        "rise of the logarithm of the wave speed as the prestress grows by a tenth",
        fall_with_prestress,
        grid(prestress=(0.2, 0.35, 0.5, 0.7, 1.0), **{"1/alpha": (3, 6, 10)}),
        {"1/alpha": 10.0, "prestress": 0.5},
        "prestress",
        lambda case: case["prestress"],
        -0.05,
        "a small pulse along 60 beads under prestress, crests of the force at two contacts 30 beads apart",
        "the speed is sqrt(alpha) prestress**((alpha-1)/(2 alpha)) beads a unit of time",
        Solver("conserving", 1e-4),
        refer=False,
    ),
    Claim(
        "prestress-oscillates",
        "oscillatory modes are present under finite prestress",
        "Sec. V",
        "3 over the turning points of the force in the middle",
        few_turns,
        grid(prestress=(0.4, 0.55, 0.75, 1.0), V=(0.01, 0.03, 0.1, 0.3), **{"1/alpha": (5, 10)}),
        {"1/alpha": 10.0, "prestress": 0.75, "V": 0.1},
        "V",
        lambda case: case["V"],
        1.0,
        "one on four, the cluster under prestress, over eight local periods; a force that oscillates turns at least 3 times",
        refer=False,
    ),
)
