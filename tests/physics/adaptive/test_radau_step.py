"""Tests of one step of the method radau. The tests compare the step with the collocation equations that define it, and
its error estimate with an independent implementation.
"""

import math
from unittest.mock import Mock

import numpy as np
import pytest
from softcradle.physics import Chain, Contact, OwnLaw, State, draft_gear, hertz, hooke, power_law
from softcradle.physics.adaptive import radau
from softcradle.physics.adaptive.constants import FORCE_PRECISION, KINK, MOST_TRIES, NEWTON_PART, RATIO, ROUND_OFF
from softcradle.physics.adaptive.dop853 import error_of_range
from softcradle.physics.adaptive.radau import (
    compliance,
    embedded_error,
    euler_change,
    euler_stages,
    radau_step,
    stage_rates,
)
from softcradle.physics.adaptive.step_records import FIFTH_RATE, WORK_ROWS, empty_scratch, empty_trial
from softcradle.physics.numerics.law_curve import NODES, care
from softcradle.physics.numerics.records import FROZEN, LOADED, NO_GRAPHS, OPEN, SEGMENTS, TOUCHING, ChainData, Motion

from tests.helpers.plain_kernels import only_plain, pressed, records_of, row_matrix, signed_force

pytestmark = only_plain
_POWERS = np.vander(NODES, 3, increasing=True)
# Quadrature weights that are exact for parabolas.
TABLEAU = (NODES[:, None] ** np.arange(1, 4) / np.arange(1, 4)) @ np.linalg.inv(_POWERS)
INVERSE, SQUARE = np.linalg.inv(TABLEAU), TABLEAU @ TABLEAU
GAMMA = 1.0 / (3.0 + 9.0 ** (1 / 3) - 3.0 ** (1 / 3))
# Quadrature formulas in terms of the differences of the stages. EMBEDDED is the difference between the method and a
# formula that uses the start (weight gamma) and the stages. This formula is exact for parabolas. COARSE is the
# difference between the method and a formula that uses the last two stages.
EMBEDDED = (np.linalg.solve(_POWERS.T, [1.0 - GAMMA, 1.0 / 2.0, 1.0 / 3.0]) - TABLEAU[2]) @ INVERSE
COARSE = (TABLEAU[2] - np.append(0.0, np.linalg.solve(_POWERS[1:, :2].T, [1.0, 0.5]))) @ INVERSE
LAWS = (hooke(3.0), hertz(5.0), power_law(1.0, 0.1), power_law(2.0, 0.5), draft_gear(2.0, 0.4), Contact(0.5, 2.0, 0.3))


def random_motion(seed):
    """Return a random chain during a collision, and a step size. The mode of each contact is consistent with its
    overlap.
    """
    draw = np.random.default_rng(seed)
    n = int(draw.integers(1, 6))
    mass = 10.0 ** draw.uniform(-0.5, 0.5, n + 1)
    if draw.random() < 0.3:
        mass[0] = math.inf
    laws = [LAWS[draw.integers(len(LAWS))] for _ in range(n)]
    drive = np.where(np.isfinite(mass), draw.normal(size=n + 1), 0.0) if draw.random() < 0.4 else None
    chain = Chain(mass, laws, drive=drive)
    state = State.at_start(chain, np.where(np.isfinite(mass), 0.3 * draw.normal(size=n + 1), 0.0))
    mode = draw.choice([OPEN, TOUCHING, LOADED, LOADED, LOADED, FROZEN], n)
    for i, law in enumerate(laws):
        if mode[i] == TOUCHING and law.preload == 0.0:
            mode[i] = LOADED
        state.overlap[i] = {OPEN: -2.0, TOUCHING: 0.0}.get(int(mode[i]), draw.uniform(0.3, 0.6))
        state.force[i] = 0.5 * law.preload if mode[i] == TOUCHING else law.force(state.overlap[i])
    state.rate[np.isin(mode, (TOUCHING, FROZEN))] = 0.0
    data, motion = records_of(chain, state)
    motion.mode[:] = mode
    return chain, data, motion, draw.uniform(0.005, 0.03)


def driven(data, seed, h):
    """Return the records with random external forces and the (3, n+1) accelerations at the nodes. The forces change
    linearly in the step and can be absent.
    """
    if not data.external.size:
        return data, np.zeros((3, data.inverse_mass.size))
    bend = np.random.default_rng(seed).normal(size=data.inverse_mass.size) / h
    return data._replace(knots=data.knots._replace(bend=bend)), data.external + h * np.outer(NODES, bend)


def memory(contacts):
    """Return trial and scratch memory filled with NaN. The contents of the memory before a step must not matter."""
    trial, scratch = empty_trial(contacts), empty_scratch(contacts)
    for rows in (*trial, scratch.along, scratch.across, scratch.correction, scratch.block, scratch.work):
        rows.fill(math.nan)
    return trial, scratch


def stepped(data, motion, h, precision=1e-12):
    trial, scratch = memory(motion.rate.size)
    return radau_step(h, data, motion, precision, trial, scratch)[0], trial


@pytest.mark.parametrize("seed", range(60))
def test_a_step_solves_the_collocation_equations(seed):
    chain, data, motion, h = random_motion(seed)
    data, drive = driven(data, seed, h)
    used, trial = stepped(data, motion, h)
    assert 0 < used <= 8
    push = trial.force @ row_matrix(chain) - drive[:, :-1]  # Array of shape (3, n): minus the derivative of the rates.
    rate = motion.rate - h * TABLEAU @ push
    for i in range(chain.contacts):
        if motion.mode[i] in (OPEN, LOADED, TOUCHING):
            assert trial.rate[:, i] == pytest.approx(rate[:, i], abs=1e-9), i
            wanted = motion.overlap[i] + h * NODES * motion.rate[i] - h * h * (SQUARE @ push)[:, i]
            assert trial.overlap[:, i] == pytest.approx(wanted, abs=1e-11), i
        if motion.mode[i] == LOADED:
            law = chain.contact[i]
            force = [signed_force(law.preload, law.stiffness, law.exponent, d) for d in trial.overlap[:, i]]
            assert trial.force[:, i] == pytest.approx(force, rel=1e-9), i
        elif motion.mode[i] in (OPEN, FROZEN):
            assert (trial.force[:, i] == motion.force[i]).all()
        else:
            assert (trial.overlap[:, i] == 0.0).all()
    # No forces act on the ends of the chain from outside.
    bead, pushes = data.anchor_bead, np.pad(trial.force, [(0, 0), (1, 1)])
    acceleration = (pushes[:, bead] - pushes[:, bead + 1]) * data.inverse_mass[bead] + drive[:, -1]
    position, velocity = motion.anchor
    assert trial.anchor[1] == pytest.approx(velocity + h * TABLEAU[2] @ acceleration, abs=1e-14)
    moved = h * velocity + h * h * SQUARE[2] @ acceleration
    assert trial.anchor[0] == pytest.approx(position + moved, abs=1e-14)


@pytest.mark.parametrize("seed", range(30))
def test_a_step_is_the_same_in_other_units(seed):
    """Check that a step does not depend on the units. The test includes the error estimate and the implicit Euler steps
    with which a step can begin.
    """
    chain, data, motion, h = random_motion(seed)
    ends, units = [], 10.0 ** np.random.default_rng(seed).uniform(-5.0, 5.0, 3)
    for meter, second, kilogram in ((1.0, 1.0, 1.0), units):
        speed, newton, (preload, stiffness, exponent) = meter / second, kilogram * meter / second**2, data.law.T
        law = np.column_stack([preload * newton, stiffness * newton / meter**exponent, exponent])
        moves = motion.overlap * meter, motion.rate * speed, motion.anchor * [meter, speed], motion.force * newton
        row = data._replace(law=law, inverse_mass=data.inverse_mass / kilogram, external=data.external * speed / second)
        (trial, scratch), moves = memory(chain.contacts), Motion(*moves, *motion[4:])
        euler_stages(h * second, row, moves, trial, scratch)
        ends.append([trial.overlap / meter, trial.force / newton])
        ends[-1] += radau_step(h * second, row, moves, (1e-5, 1e3)[seed % 2] * speed, trial, scratch)
        ends[-1] += [trial.overlap / meter, trial.rate / speed, trial.force / newton, trial.anchor / [meter, speed]]
        ends[-1] += [embedded_error(h * second, row, moves, trial, scratch.work) / speed]
    for one, same in zip(*ends, strict=True):
        assert same == pytest.approx(one, rel=1e-8, abs=1e-12)


@pytest.mark.parametrize("law", [hooke(3.0), hertz(5.0), draft_gear(200.0, 0.4)], ids=str)
def test_stages_converge_as_far_as_round_off_lets_them(law):
    """Request a precision below round-off. The round-off of a Newton correction must then not count as an error."""
    for d in (0.31, 0.47, 0.59):
        used, trial = stepped(*pressed(Chain([1.0, 0.7, 1.3], law), [0.3, 0.0, -0.2], [d, 0.9 * d]), 0.01, 1e-17)
        assert 0 < used <= 4
        force = [[signed_force(law.preload, law.stiffness, law.exponent, x) for x in row] for row in trial.overlap]
        assert trial.force == pytest.approx(np.array(force), rel=1e-12)


def test_on_springs_the_first_iteration_of_newton_is_exact():
    """Check that one iteration solves the equations of linear springs. The equations are linear, so the second
    iteration finds nothing to correct.
    """
    for gear in (hooke(3.0), draft_gear(2.0, 0.4)):
        chain = Chain([1.0, 3.0, 0.5, 2.0, 1.5, 1.0], gear, drive=[1.0, 0.0, -2.0, 0.0, 0.5, 0.0])
        data, motion = pressed(chain, [0.5, -0.2, 0.3, 0.1, 0.0, -0.4], [0.5, 0.3, 0.6, 0.4, 0.5])
        assert stepped(data, motion, 0.3)[0] == 2
        trial, scratch = empty_trial(5), empty_scratch(5)
        trial.overlap[0] = 0.4, 0.2, 0.3, 0.5, 0.1
        trial.force[0] = gear.force(trial.overlap[0])
        euler_change(0, 0.7, data, motion, trial, scratch)
        overlap = trial.overlap[0] + scratch.along[0] * scratch.correction[0]
        force = trial.force[0] + scratch.across[0] * scratch.correction[0]
        pull = row_matrix(chain) @ force - data.external[:-1]
        assert overlap == pytest.approx(motion.overlap + 0.7 * motion.rate - 0.49 * pull, rel=1e-12)


@pytest.mark.parametrize("seed", range(30))
def test_a_correction_is_that_of_a_dense_solve(seed):
    """Compare two solutions of the linear equations of all stages: by elimination and with a dense matrix. The
    equations belong to a whole chain or to a part of a chain with fixed ends.
    """
    chain, data, motion, h = random_motion(seed)
    draw, n, matrix = np.random.default_rng(seed), chain.contacts, row_matrix(chain)
    first = int(draw.integers(0, n))
    last = int(draw.integers(first + 1, n + 1))
    trial, scratch = empty_trial(n), empty_scratch(n)
    for i, law in enumerate(chain.contact):
        trial.overlap[:, i] = 0.0 if motion.mode[i] == TOUCHING else draw.uniform(0.2, 0.7, 3)
        trial.force[:, i] = draw.uniform(0.1, 0.3, 3) if motion.mode[i] == TOUCHING else law.force(trial.overlap[:, i])
    radau.directions(h, first, last, data, motion.mode, trial, scratch)
    weight = h * h * np.diag(matrix)
    assert (scratch.along + weight * scratch.across)[:, first:last] == pytest.approx(1.0, rel=1e-12)
    radau.eliminate(h, first, last, data, motion, trial, scratch)
    square, drive = np.linalg.inv(SQUARE), data.external[:-1] if data.external.size else 0.0
    moved = trial.overlap - motion.overlap - h * np.outer(NODES, motion.rate)
    found = np.zeros((3, n))
    found[:, first:last] = scratch.correction[:, first:last]
    by_overlap, by_force = scratch.along * found, scratch.across * found
    left = square @ (moved + by_overlap) + h * h * ((trial.force + by_force) @ matrix - drive)
    largest = np.abs(square @ moved) + h * h * np.abs(trial.force) @ np.abs(matrix)
    assert (np.abs(left) <= 1e-10 * (largest + 1e-6))[:, first:last].all()


def test_a_move_says_how_far_it_went_and_what_it_missed():
    """Check the results of a move along the curve of a contact law. One result is the larger of the requested and the
    actual change. The other result is the difference of the two changes if it exceeds round-off.
    """
    draw, trial, scratch = np.random.default_rng(0), empty_trial(1), empty_scratch(1)
    rows = [[law.preload, law.stiffness, law.exponent] for law in LAWS]
    rows += [
        [0.5, 2.0, 1.5, 0.1, 3.0, -1.0],
        [0.5, 2.0, 0.5, 0.0, 0.0, 1.0],
        [0.5, 2.0, 1.0, 0.0, 3.0, 1.0],
    ]  # These contacts have several segments.
    for case in range(720):
        row, kind = rows[case % 9], np.array([SEGMENTS], dtype=np.int8)
        graph = NO_GRAPHS._replace(kind=kind) if len(row) > 3 else NO_GRAPHS
        data = ChainData(np.array([row]), np.array([1.0, 0.5]), np.zeros(0), np.zeros(0), 0, graph)
        mode, start = np.full(1, case // 9 % 4), draw.uniform(0.2, 0.4)
        start = np.array([start, radau.curve_force(data.law, data.graph, 0, start)])
        trial.overlap[1], trial.force[1] = start
        ways = np.array(radau.direction(0, data, mode[0], 0.3, *start))
        scratch.along[1], scratch.across[1] = ways
        change = draw.normal() * 10.0 ** draw.choice([-16.0, -6.0, -1.0, 0.5])
        found = radau.move_stage(1, 0, 0.3, change, data, mode, trial, scratch)
        end = np.array([trial.overlap[1, 0], trial.force[1, 0]])
        asked, went, loaded = ways * change, end - start, mode[0] == LOADED
        missed = np.maximum(np.abs(went - asked) - ROUND_OFF * np.abs(end), 0.0)
        longer = np.maximum(np.abs(asked), loaded * np.abs(went))
        assert found == pytest.approx([*longer, *(loaded * missed)], rel=1e-12, abs=1e-18)
        if loaded:
            assert end[1] == pytest.approx(radau.curve_force(data.law, data.graph, 0, end[0]), rel=1e-12, abs=1e-15)
            assert data.law[0, 2] < 1.0 or end[0] == start[0] + asked[0]
        else:
            assert went == pytest.approx(asked, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize("precision", [1e-2, 1e-4, 1e-6, 1e-9])
def test_newton_iterates_only_relevant_contacts(precision, monkeypatch):
    """Compare Newton's iteration with an independent implementation of its rules, based on the results of its moves."""
    iterations, directions, move_stage = [], radau.directions, radau.move_stage

    def begun(h, first, last, *others):
        iterations.append(((first, last), []))
        directions(h, first, last, *others)

    def moved(k, i, reach, *others):
        found = move_stage(k, i, reach, *others)
        iterations[-1][1].append((i, reach, *found, abs(others[-2].force[k, i])))
        return found

    for name, value in (("MARGIN", 1), ("directions", begun), ("move_stage", moved)):
        monkeypatch.setattr(radau, name, value)
    for seed in range(60):
        chain, data, motion, h = random_motion(seed)
        h, n, all_weights = h * 10.0 ** (seed % 3), chain.contacts, np.diag(row_matrix(chain))
        trial, scratch = memory(n)
        iterations.clear()
        radau.first_guess(h, data, motion, trial)
        used = radau.solve_stages(h, data, motion, precision, trial, scratch)
        before, strongest, expected, ended = math.inf, np.abs(motion.force).max(), (0, n), False
        for number, (span, rows) in enumerate(iterations):
            assert span == expected, (seed, number)
            assert not ended
            i, reach, dd, df, missed_d, missed_f, force = np.reshape(rows, (-1, 3, 7)).transpose(2, 0, 1)
            i, weight = np.arange(*span), all_weights[span[0] : span[1], None]
            assert reach == pytest.approx(h * h * weight + 0.0 * reach)
            own = np.maximum(h * weight * df, np.sqrt(weight * dd * df)).max(axis=1)
            missed = np.maximum(h * weight * missed_f, np.sqrt(weight * missed_d * missed_f)).max()
            so_far, (preload, _, exponent) = np.maximum.accumulate([strongest, *force.max(axis=1)]), data.law[i].T
            least = np.maximum(np.abs(motion.force[i]), FORCE_PRECISION * so_far[:-1])
            largest = np.where((preload == 0.0) & (exponent < 1.0), np.maximum(least, force.max(axis=1)), so_far[1:])
            rests, size, strongest = df.max(axis=1) <= FORCE_PRECISION * largest, own.max(), so_far[-1]
            shrinks = number > 0 and size <= 1e-2 * before and size**2 <= precision * before
            ended, before = rests.all() and (size <= precision or (shrinks and missed <= precision)), size
            on = i[~rests | (own > NEWTON_PART * precision)]
            expected = (max(on.min() - 1, 0), min(on.max() + 2, n)) if on.size else (0, n)
            if on.size and ((on.min() == span[0] > 0) or (on.max() + 1 == span[1] < n)):
                expected = 0, n
        assert ended == (used > 0)


@pytest.mark.parametrize("mass", [0.3, 0.7, 1.1, 2.9])
@pytest.mark.parametrize("h", [0.01, 30.0])
def test_a_force_from_wall_to_wall_stays_as_it_is(mass, h):
    """Check a bead between two walls with both contacts at overlap 0. A force that acts through both contacts does not
    move the bead. The equations therefore do not determine this force.
    """
    data, motion = pressed(Chain([math.inf, mass, math.inf], draft_gear(2.0, 0.4)), [0.0] * 3, 0.0)
    motion.mode[:], motion.force[:] = TOUCHING, 0.5
    used, trial = stepped(data, motion, h)
    assert used > 0
    assert trial.force == pytest.approx(0.5, abs=1e-12)
    assert trial.overlap == pytest.approx(0.0, abs=1e-12)
    assert embedded_error(h, data, motion, trial, np.ones((WORK_ROWS, 3))) < 1e-11


@pytest.mark.parametrize("seed", range(20))
def test_rates_follow_from_overlaps_for_oscillating_contacts(seed):
    """Check when rates are computed from overlaps, with arbitrary stages. All overlaps must be smaller than the largest
    change that the forces above the preload cause.
    """
    draw, (chain, data, motion, h) = np.random.default_rng(seed), random_motion(seed)
    data, drive = driven(data, seed, h)
    data.law[:, 0] += 10.0
    trial, weight, preload = empty_trial(chain.contacts), np.diag(row_matrix(chain)), data.law[:, 0]
    for _ in range(10):
        excess, depth = 10.0 ** draw.uniform(-2, 2, (2, 4, chain.contacts)) * draw.choice(
            [-1, 1], (2, 4, chain.contacts)
        )
        motion.overlap[:], *trial.overlap[:] = depth * h * h * weight
        trial.force[:] = preload + excess[1:]
        stage_rates(h, data, motion, trial)
        by_overlaps = INVERSE @ (trial.overlap - motion.overlap) / h
        by_forces = motion.rate - h * TABLEAU @ (trial.force @ row_matrix(chain) - drive[:, :-1])
        fine = (np.abs(depth).max(axis=0) < np.abs(excess[1:]).max(axis=0)) | (motion.mode == TOUCHING)
        assert trial.rate == pytest.approx(np.where(fine, by_overlaps, by_forces), rel=1e-9, abs=1e-12)


def test_stages_that_do_not_converge_are_said():
    for rate in (math.nan, 1e250, -1e250):
        data, motion = pressed(Chain([1.0, 1.0], hooke(3.0)), [0.0, 0.0], 0.1)
        motion.mode[:], motion.rate[:] = OPEN, rate
        assert radau_step(0.1, data, motion, 1e-12, *memory(1)) == (0, 2 * MOST_TRIES)


@pytest.mark.parametrize("seed", range(10))
def test_newton_restarts_from_implicit_euler_steps(seed, monkeypatch):
    """Check that Newton's iteration restarts from implicit Euler steps if it fails. The values of the failed stages
    must not matter.
    """
    _, data, motion, h = random_motion(seed)
    _, wanted = stepped(data, motion, h)
    monkeypatch.setattr(radau, "first_guess", lambda h, chain, motion, trial: [rows.fill(math.nan) for rows in trial])
    trial, scratch = memory(motion.rate.size)
    used, tried = radau_step(h, data, motion, 1e-12, trial, scratch)
    assert 0 < used == tried - MOST_TRIES
    for found, rows in zip(trial, wanted, strict=True):
        assert found == pytest.approx(rows, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("seed", range(40))
def test_the_error_is_that_of_two_quadratures_filtered(seed):
    """Compare the error estimate with a dense solution of (C + (h gamma)² L) phi = e_d + h gamma e_w. The kernel solves
    the same equation by elimination along the chain.
    """
    chain, data, motion, h = random_motion(seed)
    data, _ = driven(data, seed, h)
    used, trial = stepped(data, motion, h)
    assert used > 0
    n, matrix, reach = chain.contacts, row_matrix(chain), h * GAMMA
    drive = data.external[:-1] if data.external.size else np.zeros(n)
    by_rate, by_overlap = trial.rate - motion.rate, trial.overlap - motion.overlap
    fine_w = reach * (drive - matrix @ motion.force) + EMBEDDED @ by_rate
    fine_d = reach * motion.rate + EMBEDDED @ by_overlap
    coarse_w, coarse_d = COARSE @ by_rate, COARSE @ by_overlap
    give = [compliance(data, motion.mode, i, trial.overlap[2, i], trial.force[2, i]) for i in range(n)]
    rows = [i for i in range(n) if give[i] >= 0.0]
    phi = np.zeros((2, n))
    if rows:
        square = np.diag(give)[np.ix_(rows, rows)] + reach**2 * matrix[np.ix_(rows, rows)]
        phi[0, rows] = np.linalg.solve(square, (fine_d + reach * fine_w)[rows])
        phi[1, rows] = np.linalg.solve(square, (coarse_d + reach * coarse_w)[rows])
    by_fine, by_coarse = np.abs(fine_w - reach * matrix @ phi[0]), np.abs(coarse_w - reach * matrix @ phi[1])
    weight, worst = np.diag(matrix), 0.0
    slowest = min((weight[i] / give[i] for i in range(n) if give[i] > 0.0), default=math.inf)
    for i in range(n):
        times = 1.0
        if give[i] > 0.0:
            by_fine[i] = max(by_fine[i], math.sqrt(weight[i] * give[i]) * abs(phi[0, i]))
            by_coarse[i] = max(by_coarse[i], math.sqrt(weight[i] * give[i]) * abs(phi[1, i]))
            stiff = weight[i] / give[i]
            times = care(data.law[i, 2], h * h * stiff, stiff / slowest)
        worst = max(worst, times * by_fine[i] * min(1.0, RATIO * by_fine[i] / max(by_coarse[i], 1e-300)))
    end = [rows[-1].copy() for rows in trial[:3]]
    found = embedded_error(h, data, motion, trial, np.full((WORK_ROWS, n + 1), math.nan))
    assert found == pytest.approx(worst, rel=1e-6, abs=1e-14)
    assert all((rows[-1] == same).all() for rows, same in zip(trial, end, strict=False))


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(("mode", "part"), [(LOADED, KINK), (OPEN, 0.0)])
def test_a_bend_of_a_law_that_is_passed_counts_as_an_error(mode, part, sign):
    """Check that passing a breakpoint of a contact law counts as an error. The quadratures integrate this flight
    exactly.

    The error is a fraction of the impulse beyond the breakpoint. Only loaded contacts contribute to this error.
    """
    law, h, rate, trial = OwnLaw(lambda d: d + 40.0 * max(d - 0.1, 0.0)), 0.03, 0.5 * sign, empty_trial(2)
    data, motion = pressed(Chain([3.0, 2.0, 0.5], [hooke(1.0), law]), [2.0 * rate, rate, 0.0], 0.1 - 0.3 * h * rate)
    motion.force[:], motion.mode[:] = 0.0, (OPEN, mode)
    trial.overlap[:], trial.rate[:] = motion.overlap + h * rate * NODES[:, None], rate
    found = embedded_error(h, data, motion, trial, np.zeros((WORK_ROWS, 3)))
    assert found == pytest.approx(part * h * (0.5 + 2.0) * 40.0 * 0.7 * h * 0.5, rel=1e-3, abs=1e-15)


def test_compliance():
    law = np.array([[0.0, 2.0, 0.5], [0.5, 2.0, 1.0], [0.0, 2.0, 1.5]])
    data = ChainData(law, np.ones(2), np.zeros(0), np.zeros(0), 0)
    modes = np.array([LOADED, LOADED, LOADED])
    assert compliance(data, modes, 0, 0.25, 1.0) == pytest.approx(0.5)  # Expected compliance of the law f = 2 sqrt(d).
    assert compliance(data, modes, 1, 0.25, 1.0) == 0.5
    assert compliance(data, modes, 2, -0.1, 0.0) == -1.0
    assert compliance(data, modes, 0, 0.0, 0.0) == 0.0
    for mode, wanted in ((OPEN, -1.0), (FROZEN, -1.0), (TOUCHING, 0.0)):
        assert compliance(data, np.array([mode]), 0, 0.25, 1.0) == wanted


@pytest.mark.parametrize("seed", range(8))
def test_first_stages_are_implicit_euler_steps_to_each_node(seed, monkeypatch):
    """Check that the first stages satisfy d = d0 + t w0 - t² (L f - e). The forces of the stages must obey the contact
    laws. The initial overlaps are small or large, and the slopes cover many orders of magnitude.
    """
    chain, data, motion, h = random_motion(seed)
    move_stage = Mock(wraps=radau.move_stage)
    monkeypatch.setattr(radau, "move_stage", move_stage)
    for start in (motion.overlap.copy(), np.where(motion.mode == LOADED, 1e-12, motion.overlap)):
        motion.overlap[:] = start
        for i in np.flatnonzero(motion.mode == LOADED):
            motion.force[i] = chain.contact[i].force(start[i])
        trial, scratch = memory(start.size)
        euler_stages(h, data, motion, trial, scratch)
        assert move_stage.call_count <= 100 * chain.contacts
        for k, i, reach in (call.args[:3] for call in move_stage.call_args_list):
            assert reach == pytest.approx((h * NODES[k]) ** 2 * row_matrix(chain)[i, i])
        drive = data.external[:-1] if data.external.size else 0.0
        for k, time in enumerate(h * NODES):
            pull = row_matrix(chain) @ trial.force[k]
            moved = trial.overlap[k] - motion.overlap - time * motion.rate - time**2 * (drive - pull)
            free = motion.mode != FROZEN
            largest = time**2 * np.abs(row_matrix(chain)) @ np.abs(trial.force[k]) + np.abs(motion.overlap)
            assert (np.abs(moved) <= 5e-3 * (largest + time * np.abs(motion.rate)))[free].all()
            for i, law in enumerate(chain.contact):
                if motion.mode[i] == LOADED and trial.overlap[k, i] > 0.0:
                    assert trial.force[k, i] == pytest.approx(law.force(trial.overlap[k, i]), rel=1e-9)


@pytest.mark.parametrize("row", [0, 1, 2])
def test_an_error_that_is_no_number_is_none_of_0(row):
    """Check that the error is NaN if a value is NaN. ``max(0, nan)`` is 0, so otherwise a step with a NaN would count
    as exact.
    """
    data, motion = pressed(Chain([1.0] * 4, [hooke(3.0), hertz(5.0), power_law(1.0, 0.5)]), [1.0, 0.5, 0.0, -0.5], 0.4)
    trial = stepped(data, motion, 0.01)[1]
    trial.rate[:, row] = math.nan
    assert math.isnan(embedded_error(0.01, data, motion, trial, np.zeros((WORK_ROWS, 4))))
    trial.rate[:, row], errors = 0.4, np.zeros((WORK_ROWS, 4))
    errors[FIFTH_RATE, row] = math.nan
    assert math.isnan(error_of_range(0.01, 0, 3, data, motion, trial, np.zeros(3), errors))
