"""Short motions through every kind of step, switch and rest: what must hold of each by any method, compiled or not."""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from softcradle.physics import Chain, Coupler, OwnLaw, State, TimedForce, advance, cluster_on_cluster, one_on, simulate
from softcradle.physics.chain import GRAVITY
from softcradle.physics.contact import Contact, draft_gear, hertz, hooke, power_law, step_force
from softcradle.physics.methods import refusal_of
from softcradle.physics.status import Status

from tests.helpers import relations
from tests.helpers.random_chains import random_collision, random_dissipative
from tests.helpers.relations import KERNELS, assert_momentum, assert_sound, fineness, ledger_error, simulate_quietly

METHODS = (*KERNELS, "conserving", "verlet", "yoshida4", "euler", "pymunk")
TOLERANCE = 1e-6
SAMPLES = 7


class Case(NamedTuple):
    """A motion: a chain, its start, how long (None: to its end), the step of fixed-step methods, what is left out."""

    chain: Chain
    velocity: list[float]
    duration: float | None
    step: float
    without: tuple[str, ...] = ()


def box(contact):
    """Three beads side by side between two walls."""
    return Chain([math.inf, 1.0, 2.0, 3.0, math.inf], contact)


TODA = OwnLaw(lambda d: 20.0 * math.expm1(d), lambda d: 20.0 * (math.expm1(d) - d))  # exponential, with its energy
HARDENING = OwnLaw(lambda d: 2.0 + 30.0 * d + 50.0 * d**3)
EXPLICIT = ("verlet", "yoshida4", "euler", "pymunk")  # which chatter, at the step of the others, on what is stiff
CASES = {
    "one on four": Case(one_on(4, power_law(1.0, 0.1)), [1.0, 0.0, 0.0, 0.0, 0.0], None, 0.01, ("dop853",)),
    "hertz with gaps": Case(Chain([1.0, 3.0, 1.0, 2.0], hertz(50.0), gap=[0.1, 0.2, 0.1]), [1.0, 0.0, 0.0, -0.5], None, 0.005),
    "two gears on two": Case(cluster_on_cluster(2, 2, draft_gear(770.0, 0.0177), 0.396), [0.5, 0.5, 0.0, 0.0], None, 1e-3),
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
        Chain([5.6, 0.2, 0.4], Coupler(Contact(0.0, 14.7, 0.89), Contact(3.95, 39.5, 1.0)), gap=[0.274, 0.0]),
        [0.3, -1.0, -1.0], 1e-4, 1e-6,
    ),
    "clusters that meet": Case(Chain([1.0] * 5, hooke(2.0), [0.0, 0.3, 0.0, 0.0]), [1.0, 1.0, 0.0, 0.0, 0.0], None, 5e-3),
    "friction holds a bead where it turns": Case(
        Chain([1.0, 1.0], hooke(10.0), drive=[1.2 * 0.2 * GRAVITY, 0.0], friction=0.2), [0.0, 0.0], 3.0, 5e-3, EXPLICIT
    ),
    **{
        f"thrown at a ceiling at {speed} m/s": Case(  # the first reaches a third of a millimetre beyond it
            Chain([1.0, math.inf], hertz(1e6), gap=0.5 * 3.0**2 / 9.8, drive=[-9.8, 0.0]),
            [speed, 0.0], 2.0 * speed / 9.8, 1e-3, EXPLICIT,
        )
        for speed in (3.001, 3.1, 8.0)
    },
    **{
        f"beside what never touches, of {stiffness:g} N/m": Case(  # which sets no scale for the others
            Chain([100.0, 0.01, 1.0, 1.0], [hooke(1e4), hooke(1e4), hooke(stiffness)], [0.05, 0.05, 50.0], friction=0.3),
            [2.0, 2.0, 0.0, 0.0], 0.3, 1e-4, (*EXPLICIT, "conserving"),
        )
        for stiffness in (1e4, 1e-2, 1e-4)
    },
    "contacts that stiffen": Case(one_on(2, Contact(0.0, 1.0, 2.5)), [1.0, 0.0, 0.0], None, 5e-3),
    "contacts that stiffen more": Case(one_on(2, Contact(0.0, 1.0, 3.0)), [1.0, 0.0, 0.0], None, 5e-3),
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
MOVED_LIVE = (
    "hertz with gaps", "gears on straws", "between walls", "loss and friction in a mixed chain", "a ball that bounces to rest",
    "laws of one's own", "a wagon train", "a force that comes and goes",
)  # fmt: skip
for make, duration, seeds in ((random_dissipative, 0.3, (1, 2, 5, 8)), (random_collision, 1.0, (0, 1, 2, 4, 5))):
    CASES |= {f"{make.__name__} {seed}": Case(*make(seed, 4), duration, 1e-3, EXPLICIT) for seed in seeds}


def solved(case, method):
    finer = fineness(method, case.step, tolerance=TOLERANCE)
    return simulate_quietly(case.chain, case.velocity, case.duration, method, samples=SAMPLES, **finer)


def runs(names, methods):
    """(name, method) for all cases and methods that go together."""
    pairs = ((name, one) for name in names for one in methods if one not in CASES[name].without)
    return [(name, one) for name, one in pairs if not refusal_of(one, CASES[name].chain)]


@pytest.mark.parametrize(("name", "method"), runs(CASES, METHODS))
def test_what_holds_of_every_motion(name, method):
    case = CASES[name]
    found = solved(case, method)
    assert found.status in (Status.DONE, Status.SEPARATED)
    if not case.chain.pulls:
        assert_sound(found)
    if np.abs(found.velocity).max() > 0.0:
        assert ledger_error(found) < (100.0 * TOLERANCE if method in KERNELS else 0.3 if method in EXPLICIT else 1e-11)
    if not case.chain.on_bed:
        assert_momentum(found, case.velocity, TOLERANCE)
    if found.status is Status.SEPARATED and not case.chain.on_bed:
        assert relations.separating(found.final_velocity, 1e-6)


@cache
def by_scipy(name):
    """As long as `accurate` finds that it takes: on a bed `scipy` goes on until all beads rest."""
    case = CASES[name]
    duration = case.duration or float(solved(case, "accurate").time[-1])
    return simulate_quietly(case.chain, case.velocity, duration, "scipy", samples=SAMPLES, tolerance=1e-9)


MOVING = [name for name in CASES if name != "held by friction"]


@pytest.mark.parametrize(("name", "method"), runs(MOVING, (*KERNELS, "conserving")))
def test_every_corner_is_passed_as_the_reference_does(name, method):
    """It shares no kernel with them: between located switches SciPy integrates the equations of beads."""
    case = CASES[name]
    found, other = solved(case, method), by_scipy(name)
    fastest, allowed = np.abs(other.velocity).max(), 30.0 * TOLERANCE if method in KERNELS else 3e-3
    assert ledger_error(other) < 1e-9
    assert found.final_velocity == pytest.approx(other.final_velocity, abs=allowed * fastest)
    if case.duration:
        assert found.overlap == pytest.approx(other.overlap, abs=allowed * fastest)
    if method == "conserving":
        assert list(map(len, found.contact_intervals)) == list(map(len, other.contact_intervals))
        return
    if case.duration:
        assert found.absorbed_by_contacts == pytest.approx(other.absorbed_by_contacts, abs=1e-4)
        assert found.absorbed_by_bed == pytest.approx(other.absorbed_by_bed, abs=1e-4)
    for one, those in zip(found.contact_intervals, other.contact_intervals, strict=True):
        ends = [min(end, other.time[-1]) for _, end in those]
        assert [min(end, found.time[-1]) for _, end in one] == pytest.approx(ends, abs=1e-3)
        if not (case.chain.on_bed or case.chain.pulls):  # there a contact may begin to push when forces grow
            assert [begin for begin, _ in one] == pytest.approx([begin for begin, _ in those], abs=2e-3)


# where round-off decides what touches, or none is evaluated
UNLIKE_EULER = ("gears on straws", "step forces", "a ball that bounces to rest", "held by friction")


@pytest.mark.parametrize("name", [name for name, _ in runs(CASES, ("pymunk",)) if name not in UNLIKE_EULER])
def test_digits_steps_and_switches_of_pymunk_are_those_of_euler(name):
    euler, pymunk = (solved(CASES[name], method) for method in ("euler", "pymunk"))
    assert pymunk.time == pytest.approx(euler.time)
    for row in ("overlap", "rate", "anchor", "position", "velocity"):
        np.testing.assert_allclose(getattr(pymunk, row), getattr(euler, row), rtol=0, atol=1e-12, err_msg=row)
    np.testing.assert_allclose(pymunk.force, euler.force, rtol=0, atol=1e-10 * euler.force.max())
    assert (pymunk.steps, pymunk.evaluations) == (euler.steps, euler.evaluations)
    for ours, theirs in zip(pymunk.contact_intervals, euler.contact_intervals, strict=True):
        np.testing.assert_allclose(ours, theirs, atol=0.05)  # a contact that closes at speed 0 has no sharp time
        np.testing.assert_allclose([end for _, end in ours], [end for _, end in theirs], atol=1e-6)


# by the reference too, but where what just touches opens and closes from frame to frame
LIVE = runs(MOVED_LIVE, METHODS) + [
    (name, "scipy") for name in MOVED_LIVE if name not in ("gears on straws", "between walls")
]


@pytest.mark.parametrize(("name", "method"), LIVE)
def test_frames_go_where_the_whole_run_goes_and_hand_out_its_switches(name, method):
    """Live use moves a state by a fortieth of a second at a time: 25 fixed steps, which are those of the whole run."""
    case, finer = CASES[name], fineness(method, 1e-3, tolerance=TOLERANCE)
    state, found = State.at_start(case.chain, case.velocity), [[] for _ in case.chain.contact]
    for _ in range(40):
        before = state.closed
        advance(case.chain, state, 0.025, method, **finer)
        for contact, time in zip(*state.switched, strict=True):
            found[contact].append(time)
            assert state.time - 0.025 - 1e-12 <= time <= state.time
        assert ((np.bincount(state.switched.contact, minlength=len(found)) % 2 == 1) == (before != state.closed)).all()
    whole = simulate_quietly(case.chain, case.velocity, 1.0, method, samples=2, **finer)
    assert state.time == pytest.approx(1.0)
    # a contact of "between walls" closes at an end of a frame: within a step of a Space, by round-off
    allowed = {"pymunk": 1e-3, "scipy": 1e-9}.get(method, 1e-13 if "step" in finer else TOLERANCE)
    assert state.velocity(case.chain) == pytest.approx(whole.velocity[-1], abs=allowed)
    assert state.position(case.chain) == pytest.approx(whole.position[-1], abs=allowed)
    assert state.force == pytest.approx(whole.force[-1], abs=1e3 * allowed)
    absorbed = whole.absorbed_by_contacts[-1], whole.absorbed_by_bed[-1]
    assert state.absorbed == pytest.approx(absorbed, rel=1e-6 if "step" in finer else 1e-4, abs=1e-6)
    assert state.copy().absorbed.tolist() == state.absorbed.tolist()
    if case.chain.timed:
        assert state.given == pytest.approx(whole.given[-1], rel=1e-3, abs=1e-9)
    expected = [[time for span in spans for time in span if time < np.inf] for spans in whole.contact_intervals]
    assert state.switches == sum(map(len, expected))
    sharp = (
        0.06 if case.chain.pulls else 2e-3 if "step" in finer else 1e-6
    )  # a coupler at its slack touches at no sharp time
    for times, known in zip(found, expected, strict=True):
        assert times == pytest.approx(known, abs=sharp)


def test_deep_forces_grow_smoothly_from_the_first_moment():
    """Those between the third and fourth bead had a step of 0.76 % at 2.5e-13 s: a local slope of 0.08 among some of 0.216."""
    times = np.geomspace(1e-15, 1e-9, 241)
    found = simulate(one_on(4, power_law(1.0, 0.1)), [1, 0, 0, 0, 0], 1e-8, samples=times)
    slope = np.diff(np.log(found.force), axis=0) / np.diff(np.log(times))[:, None]
    assert (np.ptp(slope[:, 1:], axis=0) < 0.006).all()


def test_an_open_contact_has_no_force_in_samples_of_conserving():
    """A step that a contact opens in has a mean force, which is not that of its end."""
    found = simulate(one_on(4, power_law(1.0, 0.1)), [1, 0, 0, 0, 0], method="conserving", step=1e-3, samples=20001)
    assert not ((found.force > 0.0) & (found.overlap < 0.0)).any()
