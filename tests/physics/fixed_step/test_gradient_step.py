"""Tests of one step of the method conserving. The step is compared with its equations for contacts, loss, friction,
external forces and absorbed energy.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from softcradle.physics import Chain, Contact, Coupler, OwnLaw, State, draft_gear, hertz, hooke, power_law, step_force
from softcradle.physics.chain import GRAVITY
from softcradle.physics.fixed_step import discrete_gradient
from softcradle.physics.fixed_step.discrete_gradient import WORK_ROWS, gradient_step, gradient_steps, single_step
from softcradle.physics.numerics.contact_solve import BEAD_ROWS, UNKNOWN, row_residual, slide, sweep
from softcradle.physics.numerics.records import COUNTERS, EVALUATION, UNCONVERGED
from softcradle.physics.simulation import solve

from tests.helpers.plain_kernels import only_plain, records_of
from tests.helpers.random_chains import random_collision, random_dissipative

pytestmark = only_plain


def random_laws(draw, count, loss):
    kinds = (
        lambda: hooke(10.0 ** draw.uniform(-1, 2)),
        lambda: hertz(10.0 ** draw.uniform(-1, 2)),
        lambda: power_law(10.0 ** draw.uniform(-1, 1), draw.choice([1 / 14, 0.1, 0.5])),
        lambda: draft_gear(10.0 ** draw.uniform(0, 1), 0.1),
        lambda: step_force(draw.uniform(0.2, 2.0)),
    )
    laws = [kinds[draw.integers(len(kinds))]() for _ in range(count)]
    return [replace(law, loss=float(draw.choice([0.0, 0.3, 0.8]))) for law in laws] if loss else laws


def random_chain(seed, dissipative):
    chain, velocity = (random_dissipative if dissipative else random_collision)(seed, 5)
    draw, n = np.random.default_rng(seed), chain.contacts
    if draw.random() < 0.5:
        chain = replace(chain, drive=np.where(np.isfinite(chain.mass), draw.normal(size=n + 1), 0.0))
    state = State.at_start(chain, velocity)
    state.overlap[:] = np.where(draw.random(n) < 0.4, 0.0, draw.normal(scale=0.2, size=n))
    return chain, state, 10.0 ** draw.uniform(-2.0, 0.0)


def hard_chain(seed):
    """Return a chain for which Newton's method fails without a fallback. The masses cover four orders of magnitude, and
    the friction coefficients are up to 50. Some chains have walls or couplers.
    """
    draw = np.random.default_rng(seed)
    n = int(draw.integers(2, 9))
    mass = 10.0 ** draw.uniform(-2, 2, n + 1)
    for end in (0, n):
        if draw.random() < 0.4:
            mass[end] = math.inf
    laws = random_laws(draw, n, draw.random() < 0.7)
    if seed % 3 == 0:
        laws[0] = Coupler(hooke(5.0, loss=0.3), pull=hertz(2.0, loss=0.5), slack=0.1, travel=0.2, stop=100.0)
    chain = Chain(mass, laws, friction=draw.choice([0.0, 0.1, 2.0, 50.0]))
    velocity = np.where(np.isfinite(mass), draw.normal(size=n + 1) * 10.0 ** draw.uniform(-1, 1), 0.0)
    state = State.at_start(chain, velocity)
    state.overlap[:] = np.where(draw.random(n) < 0.5, 0.0, np.abs(draw.normal(scale=0.3, size=n)))
    return chain, state, 10.0 ** draw.uniform(-1.0, 1.0)


def records(chain, state):
    """Return the arguments of a kernel: the chain, a Motion that shares the arrays of `state`, and work memory."""
    data, motion = records_of(chain, state)
    return data, motion, np.zeros((BEAD_ROWS, chain.contacts + 1)), np.zeros((WORK_ROWS, chain.contacts))


def step(chain, state, h):
    """Take one undivided step in place. Return the number of iterations of the solver."""
    return single_step(h, *records(chain, state), True, True)[0]


def taken(chain, state, h):
    """Take one step in place. The method divides the step at events if necessary."""
    return gradient_step(h, *records(chain, state))


@pytest.mark.parametrize("dissipative", [False, True])
@pytest.mark.parametrize("first", range(0, 120, 20))
def test_a_step_solves_its_equations(first, dissipative):
    for seed in range(first, first + 20):
        check_step(*random_chain(seed, dissipative), seed)


def test_hard_steps_solve_their_equations():
    iterations = [check_step(*hard_chain(seed), seed) for seed in range(200)]
    assert sum(iterations) < 3900  # The steps take 3530 iterations in total.


def check_step(chain, state, h, seed):
    """Check one step against its equations. Return the number of iterations of the solver."""
    before = state.copy()
    v0, push = before.velocity(chain), state.external(chain)
    used = step(chain, state, h)
    assert used > 0, seed
    v1, force, inverse_mass = state.velocity(chain), state.force, chain.inverse_mass
    by_contacts = np.append(0.0, force) - np.append(force, 0.0) + (0.0 if push is None else push)
    u = v0 + h * by_contacts * inverse_mass
    scale = 1.0 + np.abs(u).max() + h * (np.abs(by_contacts) * inverse_mass).max()
    braked = np.sign(u) * np.maximum(np.abs(u) - h * chain.bed, 0.0) if chain.on_bed else u
    # For a coupler, the state contains the force at the end of the step instead of the mean force.
    known = np.ones(chain.contacts + 1, dtype=bool)
    for i, _ in chain.couplers:
        known[i : i + 2] = False
    assert v1[known] == pytest.approx(braked[known], abs=1e-10 * scale), seed
    moved = before.overlap + 0.5 * h * (before.rate + state.rate)
    assert state.overlap == pytest.approx(moved, abs=1e-11 * scale * max(h, 1.0)), seed
    anchored = before.anchor[0] + 0.5 * h * (before.anchor[1] + state.anchor[1])
    assert state.anchor[0] == pytest.approx(anchored, abs=1e-11 * scale * max(h, 1.0)), seed
    for i in range(chain.contacts):
        if isinstance(chain.contact[i], Contact):
            check_contact(chain, i, before, state, h, seed)
    # Check the energy balance. The bed absorbs the work of friction.
    work = 0.0 if push is None else 0.5 * h * float(push @ (v0 + v1))
    change, scale = state.energy(chain) - before.energy(chain), 1.0 + before.energy(chain) + abs(work)
    assert change + state.absorbed.sum() == pytest.approx(work, abs=1e-10 * scale), seed
    if chain.on_bed and not chain.couplers:
        mass = np.array(chain.finite_mass)
        braked = np.where(mass > 0.0, mass * (v1 - v0) - h * by_contacts, 0.0)
        assert state.absorbed[1] == pytest.approx(-0.5 * float(braked @ (v0 + v1)), abs=1e-10 * scale), seed
    return used


def check_contact(chain, i, before, state, h, seed):
    """Check that the contact force is the mean force of the step. During unloading, the loss reduces the force."""
    d0, d1, force, energy = before.overlap[i], state.overlap[i], state.force[i], chain.contact[i].energy
    fall, size = energy(d1) - energy(d0), energy(d0) + energy(d1)
    kept = 1.0 - chain.contact[i].loss
    ends = 2.0 * (d1 - d0) / h - before.rate[i]
    loses = kept < 1.0 and (d0 > 0.0 or (d0 == 0.0 and before.rate[i] > 0.0))
    if max(d0, d1) <= 0.0 and d0 != d1:
        assert force == 0.0, (seed, i)
    elif d1 == d0 <= 0.0:
        assert -1e-12 <= force <= chain.contact[i].preload * (1.0 + 1e-12), (seed, i)
    else:
        work = force * (d1 - d0)
        least, most = sorted((fall, kept * fall))
        if not loses or abs(ends) > 1e-9:
            presses = ends > 0.0 and d0 + 0.5 * h * before.rate[i] > 0.0
            wanted = fall if presses or not loses else kept * fall
            assert work == pytest.approx(wanted, rel=1e-7, abs=1e-10 * size), (seed, i)
        else:
            assert least - 1e-10 * size <= work <= most + 1e-10 * size, (seed, i)


@pytest.mark.parametrize("h", [0.3, 0.6, 1.0])
def test_a_step_is_divided_when_a_bead_stops(h):
    chain, brake = Chain([2.0, 1.0], hooke(1.0), gap=10.0, friction=0.1), 0.1 * GRAVITY
    state = State.at_start(chain, [0.2 * brake, -0.1 * brake])
    given = records(chain, state)
    used, part = single_step(h, *given, False, False)
    assert used > 0
    assert part == pytest.approx(0.1 / h)
    assert state.rate[0] == 0.2 * brake - -0.1 * brake, "the motion stays as it was"
    assert discrete_gradient.first_event(h, *given) == pytest.approx(0.1 / h)
    taken(chain, state, h)
    assert state.velocity(chain).tolist() == [0.0, 0.0]
    assert state.position(chain) == pytest.approx([0.02 * brake, 10.0 - 0.005 * brake], rel=1e-13)
    assert state.absorbed[1] == pytest.approx(0.04 * brake**2 + 0.005 * brake**2, rel=1e-12)


def test_a_step_is_divided_when_a_contact_reverses():
    chain = Chain([1.0, math.inf], step_force(2.0, loss=0.75))
    state = State.at_start(chain, [1.0, 0.0])
    state.overlap[0] = 1.0
    used, part = single_step(0.6, *records(chain, state), False, False)
    assert used > 0
    assert part == pytest.approx(0.5 / 0.6)
    taken(chain, state, 0.6)
    # The contact loads for 0.5 s. Then the contact unloads with a quarter of the force.
    assert state.velocity(chain)[0] == pytest.approx(-0.5 * 0.1, rel=1e-12)
    assert state.overlap[0] == pytest.approx(1.25 - 0.25 * 0.01, rel=1e-12)
    assert state.absorbed[0] == pytest.approx(0.75 * 2.0 * 0.0025, rel=1e-10)


def test_round_off_and_small_overlaps_are_distinguished():
    """Check two draft gears with small overlaps. A gear that is pressed on a wall by less than its preload stays at
    rest. A gear without an external force returns the small energy that it stores.
    """
    gear = draft_gear(2.0, 0.4)
    pressed = Chain([1.0, math.inf], gear, drive=[0.1, 0.0], friction=1e-9)
    for round_off in (1e-17, -1e-17):
        state = State.at_start(pressed, [0.0, 0.0])
        state.overlap[0] = round_off
        taken(pressed, state, 0.1)
        assert (state.overlap[0], state.rate[0]) == (0.0, 0.0)
        assert state.force[0] == pytest.approx(0.1, rel=1e-6)
    alone = Chain([1.0, math.inf], gear, friction=1e-9)
    state = State.at_start(alone, [0.0, 0.0])
    state.overlap[0] = 1e-15
    taken(alone, state, 1e-3)
    assert state.rate[0] == pytest.approx(-math.sqrt(2.0 * gear.energy(1e-15)), rel=1e-3)


@pytest.mark.parametrize("loss", [0.0, 0.3])
@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_a_chain_at_rest_under_a_push_is_found_so_at_once(friction, loss):
    """Check that the solver needs no iteration if it starts from the forces of the chain at rest. The masses must not
    matter.
    """
    law = hertz(50.0, loss=loss)
    chain = Chain([3.0, 0.2, math.inf], law, drive=[1.0, 2.0, 0.0], friction=friction)
    state = State.at_start(chain, [0.0, 0.0, 0.0])
    state.force[:] = 1.0, 3.0
    state.overlap[:] = law.overlap(state.force)
    before = state.copy()
    assert step(chain, state, 0.05) == 1
    assert state.overlap == pytest.approx(before.overlap, rel=1e-12)
    assert state.force == pytest.approx(before.force, rel=1e-9)


def test_a_step_that_is_cut_goes_on_from_the_forces_before_it():
    """Check a step that is divided at an event. The step consists of one attempt, the part until the last bead stops,
    and the rest. The solver starts each part from the best known forces.
    """
    chain = Chain([3.0, 0.2, 1.0, 1.0], power_law(50.0, 0.1), gap=[0.0, 0.0, 1.0], friction=0.1)
    one, other = (State.at_start(chain, [1.0, 1.0, 1.0, 0.05]) for _ in range(2))
    for state in (one, other):
        state.overlap[:2], state.force[:2] = 1e-9, 50.0 * 1e-9**0.1
    given, h = records(chain, one), 0.1
    used, part = single_step(h, *given, False, False)
    assert 0.02 < part < 0.98
    one.force[:] = other.force
    for length in (part * h, h - part * h):
        used += single_step(length, *given, False, True)[0]
    assert taken(chain, other, h) == used
    assert other.overlap == pytest.approx(one.overlap, rel=1e-12)


@pytest.mark.parametrize("seed", range(80))
def test_a_step_in_parts_keeps_the_ledger(seed):
    """Check the energy balance of long steps that are divided at every event. The chains have friction and loss."""
    chain, state, h = random_chain(seed, True)
    energy = state.energy(chain)
    for _ in range(3):
        assert 0 < taken(chain, state, h) < 200  # The measured largest number of iterations is 163.
    if chain.drive_force is None:
        assert state.energy(chain) + state.absorbed.sum() == pytest.approx(energy, abs=1e-10 * (1.0 + energy))


@pytest.mark.parametrize(("friction", "most", "wanted"), [(0.0, 100, 8), (0.0, 5, 5), (0.01, 100, 8), (0.2, 100, 6)])
def test_steps_end_where_a_contact_switches_or_all_beads_rest(friction, most, wanted):
    """Check two events that end a step.

    A bead moves at 1 m/s over a distance of 0.75 m with steps of 0.1 s. The contact of the bead closes in the eighth
    step. If a brake decelerates the bead by 0.2 g, the bead stops in the sixth step.
    """
    chain = Chain([1.0, math.inf], hertz(5.0), gap=0.75, friction=friction)
    state = State.at_start(chain, [1.0, 0.0])
    data, motion, *memory = records(chain, state)
    counter, closed = np.zeros(COUNTERS, dtype=np.int64), np.zeros(1, dtype=np.int8)
    steps = gradient_steps(most, 0.0, 0.1, data, motion, closed, *memory, counter)
    assert steps == wanted
    assert counter[EVALUATION] >= steps
    assert counter[UNCONVERGED] == 0
    assert (state.overlap[0] > 0.0) == (steps == 8)
    assert (state.rate[0] == 0.0) == (friction == 0.2)


@pytest.mark.parametrize("off", [-3.0, -0.01, 0.01, 3.0])
def test_a_sweep_solves_each_row_alone_from_either_side(off, monkeypatch):
    """Check a sweep over the constraints of beads on a friction bed. The sweep visits the first constraint last, so the
    residual of the first constraint must be 0.
    """
    solve, seen = discrete_gradient.solve_contacts, []

    def swept(*given):
        h, data, motion, beads, work = given
        solve(*given)
        work[UNKNOWN] += off
        sweep(*given)
        for j in range(2):
            slide(h, j, data, motion.force, beads)
        lacks, terms = row_residual(h, 0, data, motion, beads, work)
        seen.append(abs(lacks) / terms)
        return solve(*given)

    monkeypatch.setattr(discrete_gradient, "solve_contacts", swept)
    for seed in range(60):
        chain, state, h = hard_chain(seed)
        if chain.friction:
            step(chain, state, h)
    assert len(seen) > 30
    assert max(seen) <= 1e-12


@pytest.mark.parametrize("method", ["euler", "verlet", "conserving"])
def test_a_user_defined_law_writes_no_flag_of_a_coupler(method):
    """Check that a user-defined law does not write coupler flags. The array of these flags is empty in a chain without
    couplers, and compiled code would write beyond its end.
    """
    own, built_in = (
        solve(Chain([1.0] * 3, law), [1.0, 0.0, 0.0], duration=0.5, method=method, step=0.05)
        for law in (OwnLaw(lambda overlap: 10.0 * overlap), hooke(10.0))
    )
    assert own.final_velocity == pytest.approx(built_in.final_velocity, rel=1e-9, abs=1e-12)
