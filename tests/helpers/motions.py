"""Short motions that together contain every kind of step, mode change and rest. Tests check the properties of these
motions with every method.
"""

import math
from typing import NamedTuple

import numpy as np
from softcradle.physics import Chain, Coupler, OwnLaw, State, TimedForce, advance, one_on
from softcradle.physics.chain import GRAVITY
from softcradle.physics.contact import Contact, draft_gear, hertz, hooke, power_law, step_force
from softcradle.physics.methods import refusal_of

from tests.helpers.random_chains import random_collision, random_dissipative
from tests.helpers.relations import KERNELS, digits, fineness, simulate_quietly

METHODS = (*KERNELS, "conserving", "verlet", "yoshida4", "euler", "pymunk")
TOLERANCE = 1e-6
SAMPLES = 7


class Case(NamedTuple):
    """A motion to simulate: chain, start velocities, duration, step of fixed-step methods, and methods to leave out. If
    the duration is None, the run ends by itself.
    """

    chain: Chain
    velocity: list[float]
    duration: float | None
    step: float
    without: tuple[str, ...] = ()


def box(contact):
    """Return a chain of three beads between two walls. The beads touch each other and the walls."""
    return Chain([math.inf, 1.0, 2.0, 3.0, math.inf], contact)


# Exponential law with its stored energy.
TODA = OwnLaw(lambda d: 20.0 * math.expm1(d), lambda d: 20.0 * (math.expm1(d) - d))
HARDENING = OwnLaw(lambda d: 2.0 + 30.0 * d + 50.0 * d**3)
# Explicit methods. In these methods, stiff contacts chatter if the step is as long as for the other methods.
EXPLICIT = ("verlet", "yoshida4", "euler", "pymunk")
CASES = {
    "one on four": Case(one_on(4, power_law(1.0, 0.1)), [1.0, 0.0, 0.0, 0.0, 0.0], None, 0.01, ("dop853",)),
    "hertz with gaps": Case(Chain([1.0, 3.0, 1.0, 2.0], hertz(50.0), gap=[0.1, 0.2, 0.1]), [1.0, 0.0, 0.0, -0.5], None, 0.005),
    "gears on straws": Case(
        Chain([0.4] * 4, draft_gear(770.0, 0.0177, loss=0.122), gap=[0.02, 0.0, 0.0], friction=0.064),
        [0.5, 0.0, 0.0, 0.0], None, 1e-3,
    ),
    "step forces": Case(one_on(2, step_force(1.0)), [1.0, 0.0, 0.0], None, 0.01),
    "between walls": Case(
        Chain([math.inf, 1.0, 2.0, math.inf], [hertz(50.0), draft_gear(2.0, 0.1), hooke(30.0)], gap=[0.1, 0.2, 0.1]),
        [0.0, 1.0, 0.0, 0.0], 1.5, 0.005,
    ),
    "pushed from rest": Case(Chain([1.0, 1.0, 2.0], power_law(1.0, 0.5), drive=[1.0, 0.0, 0.0]), [0.0, 0.0, 0.0], 2.0, 0.005),
    "a stack under its weight": Case(
        Chain([1.0, 1.0, math.inf], draft_gear(20.0, 0.2), drive=[1.0, 1.0, 0.0]), [0.5, 0.0, 0.0], 0.8, 0.005, EXPLICIT
    ),
    "a ball that bounces to rest": Case(
        Chain([1.0, math.inf], hertz(100.0, loss=0.8), gap=0.01, drive=[1.0, 0.0]), [0.0, 0.0], 1.2, 1e-3
    ),
    "slides that meet and slides that do not": Case(
        Chain([1.0, 2.0, 1.0, 1.0], hertz(200.0), gap=[0.1, 0.3, 2.0], friction=0.1), [1.0, 0.2, -0.3, 0.0], None, 5e-3
    ),
    "one that is braked hits another before it rests": Case(
        Chain([1.0, 2.0, 1.0], hertz(100.0), gap=[0.5, 2.0], brakes=TimedForce(0, 0.0, 10.0)), [9.0, 1.0, 0.5], None, 2e-3
    ),
    "pushed past its friction": Case(
        Chain([1.0, 1.0, 1.0], draft_gear(20.0, 0.05), drive=[2.5, 0.0, -0.3], friction=0.1), [0.0] * 3, 0.5, 2e-3
    ),
    "held by friction": Case(Chain([1.0, 1.0, 1.0], hertz(20.0), drive=[0.5, 0.0, -0.3], friction=0.1), [0.0] * 3, 0.5, 0.01),
    "loss and friction in a mixed chain": Case(
        Chain(
            [1.0, 0.3, 2.0, 1.0], [hertz(50.0, loss=0.3), power_law(1.0, 0.3, loss=0.5), draft_gear(5.0, 0.2, loss=0.6)],
            gap=[0.0, 0.05, 0.0], friction=0.1,
        ),
        [1.0, 0.0, 0.0, -0.5], None, 5e-3, EXPLICIT,
    ),
    "a wagon train": Case(
        Chain([1.0] * 3, Coupler(hooke(50.0, loss=0.3), pull=hertz(80.0, loss=0.5), slack=0.1, travel=0.05, stop=1e3)),
        [1.0, 0.0, -0.5], 1.0, 2e-3,
    ),
    "spheres that springs hold together": Case(
        Chain([1.0] * 4, Coupler(hertz(50.0), pull=hooke(9.0), slack=0.05), gap=[0.013, 0.0, 0.021]),
        [1.0, 0.0, 0.0, 0.0], 1.0, 1e-3,
    ),
    "laws of one's own": Case(
        Chain([1.0, 2.0, 1.0, math.inf], [TODA, hertz(50.0), HARDENING], gap=[0.05, 0.0, 0.05]),
        [1.0, 0.0, 0.0, 0.0], 1.5, 3e-3,
    ),
    "laws of one's own with friction": Case(
        Chain([1.0, 2.0, 1.0], [HARDENING, TODA], friction=0.1), [1.0, 0.0, -0.5], 0.6, 3e-3, EXPLICIT
    ),
    "an exponential law to the end": Case(Chain([1.0, 2.0, 1.0], TODA), [1.0, 0.0, -0.5], None, 2e-3),
    "laws of one's own amid walls, drives, gaps and loss": Case(
        Chain(
            [1.0, 2.0, 1.0, 1.0, math.inf], [TODA, hertz(2.0, loss=0.4), draft_gear(3.0, 0.2), TODA],
            gap=[0.0, 0.1, -0.05, 0.0], drive=[0.5, 0.0, 0.0, 0.0, 0.0], friction=0.05,
        ),
        [1.0, 0.0, 0.0, 0.0, 0.0], 3.0, 3e-3, EXPLICIT,
    ),
    "laws of one's own beside loss and a coupler": Case(
        Chain(
            [1.0, 2.0, 1.0, 1.5], [HARDENING, hertz(50.0, 0.3), Coupler(draft_gear(100.0, 0.05, 0.2), hooke(30.0), slack=0.02)],
            friction=0.05,
        ),
        [1.0, 0.5, 0.0, 0.0], 0.4, 1e-3, EXPLICIT,
    ),
    "a box of gears that is struck from inside": Case(box(Contact(1.4, 3.0, 0.5)), [0.0, 1.0, 0.0, 0.0, 0.0], 1.0, 5e-3),
    "a box of spheres that is struck from inside": Case(box(hertz(5.0)), [0.0, 1.0, 0.0, 0.0, 0.0], 5.0, 5e-3),
    "a soft contact that needs no time to push a bead loose": Case(
        Chain(
            [1.0] * 3, [power_law(25.5324, 0.101981, loss=0.716), step_force(0.503251)], gap=[0.215607, 0.0], friction=0.00289438
        ),
        [1.0, 0.0, 0.0], 1.0, 1e-3, EXPLICIT,
    ),
    "a gear that stays pressed on its bed": Case(
        Chain([1.0, 1.0], hooke(50.0, loss=0.95), friction=0.8), [1.0, 0.0], 1.0, 1e-3, EXPLICIT
    ),
    "contacts that stay closed over a knot": Case(
        Chain([1.0, 1.0, math.inf], draft_gear(50.0, 0.1), forces=TimedForce(0, [0.0, 0.3, 0.3], [9.0, 9.0, 8.0])),
        [0.0] * 3, 0.6, 1e-3,
    ),
    "a coupler torn open from a touch, whose pull alone has a preload": Case(
        Chain([5.6, 0.2, 0.4], Coupler(Contact(0.0, 14.7, 0.89), Contact(3.95, 39.5, 1.0), coupled=True), gap=[0.274, 0.0]),
        [0.3, -1.0, -1.0], 1e-4, 1e-6,
    ),
    "friction holds a bead where it turns": Case(
        Chain([1.0, 1.0], hooke(10.0), drive=[1.2 * 0.2 * GRAVITY, 0.0], friction=0.2), [0.0, 0.0], 3.0, 5e-3, EXPLICIT
    ),
    **{
        f"thrown at a ceiling at {speed} m/s": Case(  # At 3.001 m/s, the bead would fly 0.3 mm beyond the ceiling.
            Chain([1.0, math.inf], hertz(1e6), gap=0.5 * 3.0**2 / 9.8, drive=[-9.8, 0.0]),
            [speed, 0.0], 2.0 * speed / 9.8, 1e-3, EXPLICIT,
        )
        for speed in (3.001, 3.1, 8.0)
    },
    **{
        # The beads of the last contact never meet. The stiffness of this contact must not influence the scales of the
        # other contacts.
        f"beside what never touches, of {stiffness:g} N/m": Case(
            Chain([100.0, 0.01, 1.0, 1.0], [hooke(1e4), hooke(1e4), hooke(stiffness)], [0.05, 0.05, 50.0], friction=0.3),
            [2.0, 2.0, 0.0, 0.0], 0.3, 1e-4, (*EXPLICIT, "conserving"),
        )
        for stiffness in (1e4, 1e-2, 1e-4)
    },
    "contacts that stiffen": Case(one_on(2, Contact(0.0, 1.0, 3.0)), [1.0, 0.0, 0.0], None, 5e-3),
    "flights between springs": Case(Chain([1.0] * 3, hooke(1e3), gap=[7.0, 0.3]), [1.0, 0.0, 0.0], None, 5e-4),
    "a push that ends": Case(
        Chain([1.0] * 4, power_law(1.0, 0.1), forces=TimedForce(0, [0.0, 0.6, 0.7], [0.3, 0.3, 0.0])),
        [1.0, 0.0, 0.0, 0.0], None, 5e-3, (*EXPLICIT, "dop853"),
    ),
    "a pressed row let go": Case(
        Chain([1.0, 2.0, 1.0, 0.5], [hertz(3.0), power_law(1.0, 0.5), hooke(2.0)], [-0.3, -0.1, 0.2]), [0.0] * 4, 6.0, 5e-3
    ),
    "a force that comes and goes": Case(
        Chain([1.0] * 3, hertz(50.0), forces=TimedForce([0, 2], [0.0, 0.2, 0.4, 0.4], [0.0, 3.0, 1.0, 0.0])),
        [0.0] * 3, 0.8, 4e-3,
    ),
    "a train without slack, pulled and braked": Case(
        Chain(
            [2.0, 1.0, 1.0], [Coupler(draft_gear(20.0, 0.05, loss=0.5), pull=hooke(30.0, loss=0.3), travel=0.04, stop=500.0)] * 2,
            forces=TimedForce(0, [0.0, 0.5, 0.5], [3.0, 3.0, -4.0]), brakes=TimedForce([1, 2], [0.6, 0.9], [0.0, 2.5]),
        ),
        [0.3, 0.0, 0.0], 1.5, 2e-3, EXPLICIT,
    ),
    "brakes that let go": Case(
        Chain(
            [1.0, 2.0, 1.0], [draft_gear(20.0, 0.05), hertz(50.0, loss=0.4)], gap=[0.01, 0.02], friction=0.02,
            forces=TimedForce([0, 2], [0.0, 0.4, 1.0], [2.0, -2.0, 1.0]), brakes=TimedForce([0, 1], [0.0, 0.5], [1.5, 0.2]),
        ),
        [0.0, 0.0, -0.4], 1.5, 2e-3, EXPLICIT,
    ),
}  # fmt: skip
RESTING = {
    "held by friction": CASES["held by friction"],
    **{
        f"a box of {n} beads": Case(
            Chain([math.inf, *np.linspace(1.0, 3.0, n), math.inf], Contact(1.4, 3.0, 0.5)), [0.0] * (n + 2), 9.64, 0.01, EXPLICIT
        )
        for n in (1, 2, 5)
    },
    "on both sides of a wall": Case(
        Chain([math.inf, 1.0, math.inf, 1.0], draft_gear(5.0, 0.2), drive=[0.0, 0.1, 0.0, -0.1]), [0.0] * 4, 0.5, 0.01, EXPLICIT
    ),
    "between a brake and a wall": Case(
        Chain([1.0, 1.0, math.inf, 1.0], draft_gear(5.0, 0.2), brakes=TimedForce(0, [0.0, 1.0], [0.0, 1.0])),
        [0.0] * 4, 0.5, 0.01, EXPLICIT,
    ),
    "a row under its press": Case(
        Chain([1.0] * 4, power_law(1.0, 0.1), -float(power_law(1.0, 0.1).overlap(0.75)), drive=[0.75, 0.0, 0.0, -0.75]),
        [0.0] * 4, 5.0, 0.01, EXPLICIT,
    ),
}  # fmt: skip
CASES |= RESTING
for make, duration, seeds in ((random_dissipative, 0.3, (1, 2, 5, 8)), (random_collision, 1.0, (0, 1, 2, 4, 5))):
    CASES |= {f"{make.__name__} {seed}": Case(*make(seed, 4), duration, 1e-3, EXPLICIT) for seed in seeds}


ROWS = [power_law(1.0 + 0.01 * k, 0.1 + 0.02 * k) for k in range(70)]
LONG_ROW = Case(Chain([1.0] * 71, ROWS, [-0.01 * (k % 7) for k in range(70)]), np.eye(1, 71)[0], 0.1, 2e-3)


def solved(case, method, samples=SAMPLES):
    finer = fineness(method, case.step, tolerance=TOLERANCE)
    return simulate_quietly(case.chain, case.velocity, case.duration, method, samples=samples, **finer)


def digits_of(case, method):
    """Return the results of several runs and of live frames as bytes. One run has samples only at its ends. The other
    runs have evenly spaced samples and samples at chosen times.
    """
    state, moved = State.at_start(case.chain, case.velocity), []
    for _ in range(5):
        advance(case.chain, state, 10.0 * case.step, method, **fineness(method, case.step))
        moved += [state.overlap.tobytes(), state.rate.tobytes()]
    samples = 2, 9, case.step * np.array([1.0, 1.1, 4.0])
    return moved, *(digits(solved(case, method, each)) for each in samples)


def runs(names, methods):
    """Return all pairs (name, method) of `names` and `methods`. Pairs that a motion excludes are left out."""
    pairs = ((name, one) for name in names for one in methods if one not in CASES[name].without)
    return [(name, one) for name, one in pairs if not refusal_of(one, CASES[name].chain)]
