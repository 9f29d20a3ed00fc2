"""Claims about variants of the set-up, from Sec. V and App. A.

The variants are heterogeneous chains, a Hooke contact in the middle, prestress, and waves.
"""

import math

import numpy as np
from softcradle.physics import Chain, Coupler, hertz, hooke, one_on, power_law
from softcradle.physics.analysis.closed_forms import rigid_collision
from softcradle.physics.analysis.measures import rigidity
from softcradle.physics.analysis.ringing import turning_points
from softcradle.sandbox.scene_runs import KEEPING, TOLD
from softcradle.sandbox.studies.claims.claim import Claim, grid
from softcradle.sandbox.studies.paper import (
    SPRING_PRESTRESS,
    SWING,
    MethodFineness,
    N,
    NotSolvedError,
    Parameters,
    by_load,
    crest,
    first_opening,
    power_laws,
    pressed_cluster,
    random_beads,
    spread_by_mass,
    start,
)

SEED = 20100324
CHAINS = 100
TARGETS = 6
CRADLES = 30  # Number of random chains for each width of disorder.
SIDE_BY_SIDE = 12  # Number of random chains that are computed both as soft chains and as usual cradles.
HERTZ = 1.5
WIDTH = 2.0  # Masses and strengths lie between 1/WIDTH and WIDTH.
INVERSE = (30.0, 50.0)  # Range of 1/alpha in a random chain.
WAVE_BEADS = 60
SPRING_TIME = 6.0  # Duration of the simulation: three times the time for which the striker is in contact.
NUDGE = 1e-4  # Speed of the bead that starts a wave under prestress, relative to the speed that would open a contact.


def random_chain(case: Parameters) -> Chain:
    """Return a random chain in which one bead hits TARGETS beads, generated from the seed of the case.

    Masses, contact strengths and exponents are random. Seed 0 gives a homogeneous chain.
    """
    random = np.random.default_rng([SEED, round(case["seed"])])
    width = WIDTH if case["seed"] else 1.0
    mass, strength = random_beads(random, TARGETS, width)
    return Chain(mass, power_laws(strength, 1.0 / random.uniform(*INVERSE, TARGETS)))


def weighted_spread(case: Parameters, solver: MethodFineness) -> float:
    """Return `spread_by_mass` for the chain of the case."""
    chain = random_chain(case)
    return spread_by_mass(np.array(chain.mass)[1:], solver.motion(chain, start(chain)).final_velocity[1:])


def momentum_of_last(case: Parameters, solver: MethodFineness) -> float:
    """Return the mean share of the momentum that the last bead of the usual cradle receives.

    The mean is over random chains whose width of disorder is that of the case.
    """
    taken = []
    for seed in range(CRADLES):
        mass, strength = random_beads(np.random.default_rng([SEED, seed]), TARGETS, case["width"])
        chain = Chain(mass, [hertz(k) for k in strength])
        taken.append(chain.mass[-1] * solver.motion(chain, start(chain)).final_velocity[-1] / chain.mass[0])
    return float(np.mean(taken))


def misplaced(width: float, exponent: float, solver: MethodFineness) -> float:
    """Return the mean share of the momentum that disorder transfers to other beads.

    The mean is over random chains of width `width`. Without disorder, soft beads share the momentum as one rigid body.
    In the usual cradle, with an exponent above 1, the last bead then receives all of it.
    """
    parts = []
    for seed in range(SIDE_BY_SIDE):
        mass, strength = random_beads(np.random.default_rng([SEED, seed]), TARGETS, width)
        chain = Chain(mass, power_laws(strength, [exponent] * TARGETS))
        ideal = mass * rigid_collision(mass, 1) if exponent < 1.0 else np.append(np.zeros(TARGETS), mass[0])
        momentum = mass * solver.motion(chain, start(chain)).final_velocity
        parts.append(0.5 * np.abs(momentum - ideal).sum() / mass[0])
    return float(np.mean(parts))


def contrast(case: Parameters, solver: MethodFineness) -> float:
    """Return the misplaced momentum in soft chains, divided by the misplaced momentum in usual cradles.

    Both kinds of chain have the same random masses and strengths.
    """
    soft, usual = (
        misplaced(case["width"], exponent, solver) - misplaced(1.0, exponent, solver)
        for exponent in (1.0 / case["1/alpha"], HERTZ)
    )
    return soft / usual


def interface_load(case: Parameters) -> float:
    """Return the force that the first inner contact transmits if the cluster is rigid, in units of its f0."""
    n = case["n"]
    return (n - 1.0) / n * case["V"] * math.sqrt(case["k"] * n / (n + 1.0))


def interface_spread(case: Parameters, solver: MethodFineness) -> float:
    """Return the spread of the velocities of the targets behind a truncated Hooke spring, divided by their mean."""
    n = round(case["n"])
    chain = one_on(n, (hooke(case["k"]), *(power_law(1.0, 1.0 / case["1/alpha"]),) * (n - 1)))
    velocity = solver.motion(chain, start(chain, speed=case["V"])).final_velocity[1:]
    return float(rigidity(velocity))


def last_bead(case: Parameters, solver: MethodFineness) -> float:
    """Return the share of the striker's velocity that the last bead of the usual cradle does not receive."""
    n = round(case["n"])
    chain = one_on(n, hertz(1.0))
    return 1.0 - float(solver.motion(chain, start(chain)).final_velocity[-1])


def pressed_chain(beads: int, alpha: float, prestress: float) -> Chain:
    """Return a chain of unit beads at rest, whose ends are pressed together by a steady force."""
    law = power_law(1.0, alpha)
    drive = [prestress, *[0.0] * (beads - 2), -prestress]
    return Chain([1.0] * beads, law, [-float(law.overlap(prestress))] * (beads - 1), drive)


def wave_speed(case: Parameters, solver: MethodFineness) -> float:
    """Return the speed of a small pulse along a chain under prestress, measured between the contacts 15 and 45.

    The unit is beads per unit of time. Another prestress only changes the units of length and time. Uniform sample
    times, up to a power of two, do not scale with these units. The arrival times are therefore a measurement and not an
    identity.
    """
    alpha, prestress = 1.0 / case["1/alpha"], case["prestress"]
    chain = pressed_chain(WAVE_BEADS, alpha, prestress)
    expected = _linear_speed(alpha, prestress)
    velocity = [0.0] * WAVE_BEADS
    velocity[0] = NUDGE * expected * abs(chain.gap[0])
    end = 2.0 ** math.ceil(math.log2(0.9 * WAVE_BEADS / expected))
    found = solver.motion(chain, tuple(velocity), end, 2401)
    arrival = [crest(found.time, found.force[:, k])[0] for k in (15, 45)]
    return 30.0 / (arrival[1] - arrival[0])


def _linear_speed(alpha: float, prestress: float) -> float:
    """Return the speed ``sqrt(f'(d) / m)`` of linear waves under a prestress.

    This speed equals prestress**((alpha-1)/(2 alpha)) sqrt(alpha).
    """
    return math.sqrt(alpha) * prestress ** ((alpha - 1.0) / (2.0 * alpha))


def fall_with_prestress(case: Parameters, solver: MethodFineness) -> float:
    """Return the logarithm of the ratio of the wave speeds at two values of the prestress.

    The two values are the prestress of the case and nine tenths of it. The result is below 0 if the wave is faster with
    less prestress.
    """
    less = {**case, "prestress": 0.9 * case["prestress"]}
    return math.log(wave_speed(case, solver) / wave_speed(less, solver))


def sprung_cluster(case: Parameters) -> Chain:
    """Return a chain in which one bead hits n beads that are joined by springs of stiffness k.

    The prestress of the springs is so large that they never lose it.
    """
    return pressed_cluster(round(case["n"]), hooke(case["k"]), SPRING_PRESTRESS)


def vibration(case: Parameters, solver: MethodFineness) -> float:
    """Return the root mean square deviation of the targets' velocities from their mean, relative to that mean.

    The deviation is measured after the striker has left.
    """
    chain = sprung_cluster(case)
    found = solver.motion(chain, start(chain), SPRING_TIME, 4001)
    velocity = found.velocity[found.time > first_opening(found), 1:]
    return float(np.sqrt(velocity.var(axis=1).mean()) / velocity.mean())


def few_passages(case: Parameters, solver: MethodFineness) -> float:
    """Return 3 divided by the number of turning points of the force in the last spring while the striker is in contact."""
    chain = sprung_cluster(case)
    found = solver.motion(chain, start(chain), SPRING_TIME, 4001)
    force = found.force[found.time < first_opening(found), -1]
    return 3.0 / max(turning_points(force, SWING).size, 1)


def echo(case: Parameters, solver: MethodFineness) -> float:
    """Return the change of the first bead's velocity by a pulse that may have returned from the free end of the
    springs.

    The change is relative to the bead's initial velocity. The springs push with unit stiffness, so the pulse advances
    by one bead in a unit of time. The springs pull with the stiffness `pull`.
    """
    beads = round(case["beads"])
    spring = Coupler(hooke(1.0), pull=hooke(case["pull"])) if case["pull"] else hooke(1.0)
    chain = Chain([1.0] * beads, [spring] * (beads - 1))
    found = solver.motion(chain, (1.0,) + (0.0,) * (beads - 1), 2.8 * beads, 2001)
    late = found.velocity[found.time > 1.5 * beads, 0]
    return float(np.abs(late - late[0]).max())


def few_turns(case: Parameters, solver: MethodFineness) -> float:
    """Return 3 divided by the number of turning points of the force in the middle of a struck cluster under prestress."""
    alpha, prestress = 1.0 / case["1/alpha"], case["prestress"]
    chain = pressed_cluster(N, power_law(1.0, alpha), prestress)
    period = 2.0 * math.pi / math.sqrt(2.0 * _linear_speed(alpha, prestress) ** 2)
    found = solver.motion(chain, start(chain, speed=case["V"]), 8.0 * period, 2001)
    turns = turning_points(found.force[:, 2]).size
    if turns == 0:
        raise NotSolvedError("the force does not turn")
    return 3.0 / turns


CLAIMS = (
    Claim(
        name="robust", place="Secs. III, V",
        statement="rigid-like behaviour is robust against heterogeneity, as long as all exponents are sufficiently small",
        quantity="spread of the targets' velocities, by mass, over their mean", measure=weighted_spread,
        cases=by_load(grid(seed=range(CHAINS + 1)), random_chain), own={"load": 5.0 / 6.0},
        variable="greatest load of an inner contact", order=lambda case: case["load"], allowed=0.05,
        how=f"{CHAINS} random chains of {TARGETS} targets, seed {SEED}, and the homogeneous one: masses and strengths "
        f"of 1/2 to 2, exponents of 1/50 to 1/30; rigid-like: a spread of at most 5 %",
        remark="the load is the force that a contact has to pass on over its f0; near 1 the exponent needed is ever smaller",
        first=MethodFineness(TOLD, tolerance=1e-6), refer=False,
    ),
    Claim(
        name="cradle-perturbed", place="Sec. V",
        statement="in the usual cradle the pulse is highly perturbed by the inhomogeneity",
        quantity="part of the momentum that the last bead takes", measure=momentum_of_last,
        cases=grid(width=(1.05, 1.1, 1.2, 1.35, 1.5, 1.75, 2.0, 3.0)), own={"width": WIDTH},
        variable="1/width", order=lambda case: 1.0 / case["width"], allowed=0.9,
        how=f"mean of {CRADLES} random chains of {TARGETS} targets, seed {SEED}: masses and stiffnesses of 1/width to "
        f"width, Hertz; the homogeneous chain passes on 98 %",
        refer=False,
    ),
    Claim(
        name="in-contrast", place="Sec. V",
        statement="the robustness against heterogeneity is in marked contrast to the usual cradle",
        quantity="momentum that disorder misplaces in soft chains over that in the usual cradle", measure=contrast,
        cases=grid(width=(1.05, 1.1, 1.2, 1.5, 2.0, 3.0), **{"1/alpha": (10, 20, 40)}), own={"width": 1.2, "1/alpha": 10.0},
        variable="width", order=lambda case: case["width"], allowed=0.5,
        how=f"mean of {SIDE_BY_SIDE} chains of {TARGETS} targets, seed {SEED}, soft and Hertz side by side: masses and strengths "
        "of 1/width to width; marked: half as much, or less",
        remark="misplaced: not shared as by one rigid body, or not on the last bead, less what is so without disorder",
        refer=False,
    ),
    Claim(
        name="kicked-out", place="App. C",
        statement="without the pistons the furthest particle is dominantly kicked out",
        quantity="part of the striker's velocity that the last bead does not take", measure=last_bead,
        cases=grid(n=(2, 3, 4, 6, 8, 12, 16, 24)), own={"n": 3.0},
        variable="n", order=lambda case: case["n"], allowed=0.1,
        how="one on n, Hertz contacts, no friction",
    ),
    Claim(
        name="hooke-interface", place="App. A (iii), data not shown",
        statement="a truncated Hooke spring between striker and cluster works as well",
        quantity="spread of the targets' velocities over their mean", measure=interface_spread,
        cases=grid(n=4, k=(0.25, 0.5, 1, 1.5, 3, 10), V=(0.5, 1, 2), **{"1/alpha": (10, 14)}),
        own={"1/alpha": 10.0, "k": 1.0, "V": 1.0},
        variable="inner force over f0", order=interface_load, allowed=0.1,
        how="one on four, stiffness 0.25 to 10, speed 0.5 to 2, inner 1/alpha of 10 and 14; works: a spread of at most 10 %",
        remark="the stiffness and the speed count by the force that the inner contact has to pass on",
        second=MethodFineness(KEEPING, 5e-5),
    ),
    Claim(
        name="waves-diverge", place="Sec. IV, Sec. V",
        statement="linear wave velocities diverge at vanishing prestress, as alpha < 1",
        quantity="rise of the logarithm of the wave speed as the prestress grows by a tenth", measure=fall_with_prestress,
        cases=grid(prestress=(0.2, 0.5, 1.0), **{"1/alpha": (2 / 3, 1, 1.5, 3, 6, 10)}),
        own={"1/alpha": 10.0, "prestress": 0.5},
        variable="alpha", order=lambda case: 1.0 / case["1/alpha"], allowed=-0.01,
        how="a small pulse along 60 beads under prestress, crests of the force, between samples, at two contacts 30 beads apart; "
        "0.01 a tenth is taken for no change",
        remark="the speed is sqrt(alpha) prestress**((alpha-1)/(2 alpha)) beads a unit of time",
        second=MethodFineness(KEEPING, 1e-4), refer=False, chosen=False,
    ),
    Claim(
        name="stiff-springs", place="Secs. I, V",
        statement="masses joined by extremely hard springs are a rigid body",
        quantity="vibration of the targets' velocities about their mean, over the mean", measure=vibration,
        cases=grid(n=(2, 3, 4, 6, 8), k=(100, 400, 1600, 6400, 25600)), own={"n": 4.0, "k": 400.0},
        variable="n / sqrt(k)", order=lambda case: case["n"] / math.sqrt(case["k"]), allowed=0.05,
        how="one on n, springs that pull, too, by a prestress of 20; root mean square after the striker has left, whose contact "
        "has alpha = 1/30; rigid-like: 5 %, as for `robust`",
        remark="it falls as n/sqrt(k), the time of a passage, up and down with the phase at which the striker leaves",
        second=MethodFineness(KEEPING, 5e-5), refer=False,
    ),
    Claim(
        name="to-and-fro", place="Secs. I, V",
        statement="in stiff springs waves that run to and fro distribute the momentum, not an evanescent mode",
        quantity="3 over the turning points of the last force while the striker pushes", measure=few_passages,
        cases=grid(n=(2, 3, 4, 6, 8), k=(1, 4, 25, 100, 400, 1600, 6400)), own={"n": 4.0, "k": 400.0},
        variable="n / sqrt(k)", order=lambda case: case["n"] / math.sqrt(case["k"]), allowed=1.0,
        how="as stiff-springs; a force that oscillates turns at least 3 times, one that an evanescent mode carries turns once",
        remark="their number grows as sqrt(k): the time of a passage is that of the lowest mode",
        second=MethodFineness(KEEPING, 5e-5), refer=False,
    ),
    Claim(
        name="free-end", place="Sec. I",
        statement="waves need attractive forces to be reflected at a free end",
        quantity="change of the first bead's velocity when the pulse may be back, over its start", measure=echo,
        cases=grid(beads=(10, 20, 40), pull=(0, 0.01, 0.03, 0.1, 0.3, 1)), own={"beads": 20.0, "pull": 0.0},
        variable="stiffness of pulling over that of pushing", order=lambda case: case["pull"], allowed=0.05,
        how="a row of beads and springs that push, and pull with a part of that stiffness; no reflection: at most 5 %",
        remark="without a pull the last beads fly off, and the first one feels nothing",
        first=MethodFineness(KEEPING, 1e-3), second=MethodFineness(KEEPING, 2e-3), refer=False,
    ),
    Claim(
        name="prestress-oscillates", place="Sec. V",
        statement="oscillatory modes are present under finite prestress",
        quantity="3 over the turning points of the force in the middle", measure=few_turns,
        cases=grid(prestress=(0.4, 0.55, 0.75, 1.0), V=(0.01, 0.03, 0.1, 0.3), **{"1/alpha": (5, 10)}),
        own={"1/alpha": 10.0, "prestress": 0.75, "V": 0.1},
        variable="V", order=lambda case: case["V"], allowed=1.0,
        how="one on four, the cluster under prestress, over eight local periods; a force that oscillates turns at least 3 times",
        refer=False,
    ),
)  # fmt: skip
