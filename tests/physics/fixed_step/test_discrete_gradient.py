"""Tests of the method conserving.

Energy and momentum must be conserved up to round-off with any step in every scene. Contacts at overlap 0 must be exact.
The tests also check the resolvent, which solves the equation of a single contact.
"""

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from softcradle.physics import Chain, Coupler, State, advance, one_on, simulate
from softcradle.physics.analysis.closed_forms import critical_speed, rigid_stroke
from softcradle.physics.contact import Contact, power_law, step_force
from softcradle.physics.fixed_step import runner
from softcradle.physics.kernel_records import NO_FLAGS
from softcradle.physics.numerics.contact_solve import BEAD_ROWS, DIAGONAL, END, FREE, SOLVER_ROWS, solve_contacts
from softcradle.physics.numerics.law_kernels import energy
from softcradle.physics.numerics.plain_kernels import plain
from softcradle.physics.numerics.records import NO_GRAPHS, NOTHING, ChainData, Motion
from softcradle.physics.numerics.resolvent import resolvent
from softcradle.physics.problem import Problem
from softcradle.physics.scales import contact_scales
from softcradle.physics.status import Status

from softcradle import scenes
from tests.helpers.random_chains import random_collision
from tests.helpers.relations import assert_momentum, assert_sound, energy_error, kinetic_energy, struck, total_energy
from tests.helpers.truth import GEAR


# Steps [s]. The steps are chosen independently of the time scales of the scenes.
@pytest.mark.parametrize("step", [1e-4, 1e-3, 1e-2, 0.1, 1.0])
@pytest.mark.parametrize("name", scenes.names())
def test_energy_and_momentum_in_every_scene(name, step):
    # Even with the shortest step, this duration includes most collisions completely.
    duration = min(step * 20_000, 20.0)
    for lane in scenes.load(name).lanes:
        chain, velocity = lane.chain(), lane.velocity
        # Any warning makes this test fail.
        found = simulate(chain, velocity, duration, "conserving", step, samples=101)
        assert np.ptp(found.ledger) < 1e-11 * max(found.ledger[0], np.abs(found.driven).max())
        assert np.isnan(found.velocity_error).all()
        assert np.isnan(found.position_error).all()
        # Strings pull the beads back, so momentum is not conserved.
        if chain.walls == 0 and not chain.on_bed and not chain.strings:
            momentum = found.momentum - found.impulse
            scale = np.array(chain.mass) @ np.abs(found.velocity).max(axis=0)
            assert np.abs(momentum - momentum[0]).max() < 1e-12 * scale


@pytest.mark.parametrize("parts", [3, 7, 100, 1000])
@pytest.mark.parametrize("n", [2, 3, 10])
def test_touching_is_exact(parts, n):
    """Check collisions below the critical speed. The inner overlaps must be exactly 0, and the inner forces must be
    those of a rigid train.
    """
    chain, speed = one_on(n, GEAR), 0.9 * critical_speed(GEAR, np.ones(n + 1), 1)
    pulse = rigid_stroke(GEAR, chain.mass, 1, speed).contact_time
    found = simulate(chain, speed * struck(chain), 0.9 * pulse, "conserving", pulse / parts, samples=41)
    assert (found.overlap[:, 1:] == 0.0).all()
    assert np.abs(np.diff(found.velocity[:, 1:])).max() < 1e-14
    shares = np.arange(n - 1, 0, -1) / n
    pushed = found.force[:, 0] > 0.0
    assert pushed.sum() > 30
    assert found.force[pushed, 1:] == pytest.approx(found.force[pushed, :1] * shares, rel=1e-12)


def test_a_step_force_moves_as_a_rigid_cluster_at_any_step():
    for step in (1e-3, 0.02, 0.3, 5.0):
        found = simulate(one_on(4, step_force(1.0)), [1, 0, 0, 0, 0], 20.0, "conserving", step, samples=21)
        assert found.final_velocity == pytest.approx([-0.6, 0.4, 0.4, 0.4, 0.4], abs=1e-12)
        during = found.force[:, 0] > 0.0
        assert (found.overlap[during, 1:] == 0.0).all()
        assert np.abs(found.overlap[:, 1:]).max() < 1e-14  # After the collision the beads fly side by side.


# Collisions of up to 40 contacts, each with a step for which an earlier solver failed. The solver cycled, overflowed,
# or reported a failure because of round-off.
HARD = {
    3: (6, 9, 33),
    30: (146, 169),
    0: (594,),
    1000: (136, 1879, 169, 146),
}  # The keys are the numbers of steps in one contact time.


@pytest.mark.parametrize(("seed", "parts"), [(seed, parts) for parts, seeds in HARD.items() for seed in seeds])
def test_collisions_that_were_hard(seed, parts):
    chain, velocity = random_collision(seed, 40)
    longest, shortest = (float(f(contact_scales(chain, velocity)[1])) for f in (np.max, np.min))
    step = longest / parts if parts else shortest / 1000
    found = simulate(chain, velocity, 3000 * step if not parts else 3 * parts * step, "conserving", step, samples=31)
    assert_sound(found)
    assert_momentum(found, velocity)
    assert energy_error(found, velocity) < 1e-11


@pytest.mark.parametrize("step", [1e-3, 5e-3, 0.02, 0.1])
@pytest.mark.parametrize(("preload", "target"), [(1e2, 1.0), (1e3, 2.0), (1e4, 0.5)])
def test_a_collision_shorter_than_a_step_has_its_restitution(preload, target, step):
    """Check the restitution of beads that touch from the start. The square of the restitution must be 1 - loss."""
    found = simulate(Chain([1, target], Contact(preload, 1e3, 1.0, loss=0.75)), [1, 0], 0.2, "conserving", step, 2)
    rigid = 1.0 / (1.0 + target)
    assert found.final_velocity == pytest.approx([rigid - 0.5 * (1.0 - rigid), 1.5 * rigid], abs=0.02)
    assert np.ptp(found.ledger) < 1e-15


@pytest.mark.parametrize("step", [1e-4, 1e-3, 0.01])
@pytest.mark.parametrize(("mass", "friction", "drive"), [
    ([1.0, math.inf], 0.0, [100.0, 0.0]),
    ([1.0, 2.0, 0.5, math.inf], 0.0, [60.0, 20.0, 10.0, 0.0]),
    ([1.0, 2.0, 0.5, 1e3], 0.1, [60.0, 20.0, 10.0, 0.0]),
])  # fmt: skip
def test_pressed_beads_with_loss_come_to_rest(mass, friction, drive, step):
    """Check that bounces within one step lose as much energy as bounces that take many steps. Otherwise the beads would
    reverse at each step forever.
    """
    n = len(mass) - 1
    for loss in (0.3, 0.75):
        chain = Chain(mass, Contact(1e3, 1e5, 1.0, loss), friction=friction, drive=drive)
        found = simulate(chain, [1.0, *[0.0] * n], 3.0, "conserving", step, 101)
        assert np.abs(found.velocity[-20:]).max() < 1e-6
        assert np.ptp(found.ledger) < 1e-11 * np.abs(found.ledger).max()


def test_a_pull_that_rests_at_the_end_of_the_slack_comes_to_rest():
    gear = Contact(1e5, 1e7, 1.0, loss=0.5)
    chain = Chain([2e4, 2e4], Coupler(gear, pull=gear, slack=0.05), drive=[0.0, 3e4])
    found = simulate(chain, [0.0, 0.0], 4.0, "conserving", 0.01, 101)
    assert np.abs(found.rate[-20:]).max() < 1e-12
    assert (found.overlap[-20:] == -0.05).all()
    assert found.force[-20:] == pytest.approx(-1.5e4, rel=1e-9)


def test_a_step_on_which_newton_cycles_keeps_the_energy():
    """Check that a step conserves energy although Newton's method does not converge. The 129 iterations of this step
    form a cycle.
    """
    chain, velocity = random_collision(9, 40)
    step = float(contact_scales(chain, velocity)[1].max()) / 3
    state = State.at_start(chain, velocity)
    moving = kinetic_energy(chain, velocity)
    for part in (1.0, 0.8, 1.0, 0.3, 1.0, 0.6):
        advance(chain, state, part * step, "conserving", part * step)
        assert total_energy(chain, state) == pytest.approx(moving, rel=1e-11)


LAWS = [*product((0.0, 0.3, 4.0), (1e-3, 1.0, 50.0), (1 / 50, 0.1, 0.5, 1.0, 1.5, 3.0))]
LAWS += 18 * [(4.0, 0.0, 1.0)]  # A quarter of the laws have a constant force.


def sizes(low, high):
    return st.floats(low, high).map(lambda x: 10.0**x)


def of_either_sign(numbers):
    return st.one_of(st.just(0.0), numbers, numbers.map(lambda x: -x))


# Initial overlaps, including the small overlaps that round-off leaves after a step.
START = of_either_sign(st.one_of(sizes(-12, 1), sizes(-300, -12)))
WEIGHT, SUM = sizes(-10, 3), of_either_sign(sizes(-12, 2))
NO_ENERGY = 1e-260  # The resolvent treats energies below this value as 0.


@given(st.sampled_from(LAWS), START, WEIGHT, SUM, st.floats(0, 1))
def test_the_resolvent_solves_its_equation(law, start, weight, s, guess):
    """Check that the force is the mean force (E(d1) - E(d0)) / (d1 - d0). The work then equals the change of energy, up
    to the round-off of the larger energy.
    """
    start_power = start ** law[2] if start > 0.0 else 0.0
    end, force, slope = plain(resolvent)(NO_GRAPHS, -1, *law, start, start_power, weight, s, guess * s)
    round_off = 1e-12 * (abs(start) + abs(s) + weight * force) + 1e-300
    assert end + weight * force == pytest.approx(s, rel=1e-12, abs=round_off)
    assert force >= 0.0
    assert 0.0 <= slope * weight <= 1.0 + 1e-12
    before, after = energy(*law, start), energy(*law, end)
    assert force * (end - start) == pytest.approx(after - before, rel=1e-11, abs=1e-13 * max(before, after) + NO_ENERGY)


def test_a_failure_to_converge_is_returned():
    """Check that `solve_contacts` returns a negative count if the equations cannot be solved. The matrix in this test
    does not belong to any chain.
    """
    n = 2
    chain = ChainData(np.array([[0.0, 1.0, 3.0]] * n), np.full(n + 1, 1e3), NOTHING, NOTHING, 0)
    motion = Motion(np.zeros(n), np.zeros(n), np.zeros(2), np.zeros(n), np.zeros(4), NO_FLAGS, NO_FLAGS)
    work = np.zeros((SOLVER_ROWS, n))
    work[[FREE, DIAGONAL, END]] = 1.0
    assert solve_contacts(1.0, chain, motion, np.zeros((BEAD_ROWS, n + 1)), work) < 0


def test_a_soft_cluster_keeps_its_depth():
    """Check a soft cluster with the overlaps ((n-i)/(n-1))**30. The smallest overlaps are far below the round-off of
    positions, but their forces still decrease linearly.
    """
    found = simulate(one_on(10, power_law(1.0, 1 / 30)), [1] + [0] * 10, 0.3, "conserving", 1e-3, samples=[0.2, 0.3])
    assert 0.0 < found.overlap[-1, -1] < 1e-25
    assert found.force[-1] == pytest.approx(found.force[-1, 0] * np.arange(10, 0, -1) / 10, rel=0.05)


@pytest.mark.parametrize("part", [1.0, 0.83, 0.61, 0.5])
def test_contacts_that_push_no_more_end_a_run(part):
    """Check that the run of a cluster of soft contacts ends. In an earlier version, beads almost at rest pressed on
    each other with 1e-24 N. The steps doubled until the time was 1e21 s.
    """
    chain = one_on(23, power_law(1.0, 0.006365575522831995))
    state = State.at_start(chain, np.zeros(24))
    state.anchor[:] = 0.07670204, -0.91665623
    state.overlap[:8] = (
        -0.004191335301931757, 6.675828519511752e-09, 1.6348565457391703e-11, 5.208317002327975e-13,
        1.7099451195008116e-16, 5.89541786636609e-18, 4.657920823489565e-19, -3.0468881577652276e-20,
    )  # fmt: skip
    state.rate[:8] = (
        -0.995521032108915, -0.004675952919923563, 4.889672115806466e-06, 1.286820299751061e-07,
        4.614006087277963e-09, -1.4882406697296725e-09, -9.276858235356626e-10, -5.540936353237231e-11,
    )  # fmt: skip
    step = part * 0.0012914996776155548
    found = runner.run(Problem(chain, state, "conserving", None, step, samples=2, most_steps=20_000))
    assert found.status == Status.SEPARATED
    assert found.steps < 3000
