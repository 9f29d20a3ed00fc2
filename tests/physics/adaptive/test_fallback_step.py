"""Where radau does not converge, or events follow each other without end: a step of conserving, a rate that is taken."""

from __future__ import annotations

import math

import numpy as np
import pytest
from softcradle.physics import Chain, State, draft_gear, hertz, power_law
from softcradle.physics.adaptive.constants import SHRINK
from softcradle.physics.adaptive.fallback_step import fallback_step
from softcradle.physics.adaptive.step_records import empty_scratch, empty_trial
from softcradle.physics.adaptive.switching import stop_rate
from softcradle.physics.fixed_step import discrete_gradient
from softcradle.physics.kernel_records import empty_log
from softcradle.physics.numerics.contact_solve import BEAD_ROWS
from softcradle.physics.numerics.records import FALLBACK, LOADED, STEP, TOUCHING

from tests.helpers.plain_kernels import only_plain, records_of
from tests.helpers.relations import momentum, total_energy

pytestmark = only_plain


def fallen_back(law, wanted, h=0.2):
    chain = Chain([1.0, 2.0, 1.5], law)
    state = State.at_start(chain, [1.0, 0.2, -0.3])
    before = state.copy()
    data, _, motion = records_of(chain, state)
    motion.mode[:] = LOADED
    motion.held[:] = 1
    scratch, log = empty_scratch(chain.contacts), empty_log(chain.contacts, 0)
    taken = fallback_step(h, data, motion, wanted, empty_trial(chain.contacts), scratch, log)
    assert (motion.held == 0).all()
    assert (scratch.opening == -1.0).all()
    assert log.counter[STEP] == log.counter[FALLBACK] == 1
    return chain, before, state, taken


@pytest.mark.parametrize("law", [power_law(2.0, 0.1), hertz(20.0), draft_gear(5.0, 0.1)])
def test_it_keeps_energy_and_momentum_and_is_as_long_as_it_may_be(law):
    chain, before, state, taken = fallen_back(law, 1e3)
    assert taken == 0.2
    assert total_energy(chain, state) == pytest.approx(total_energy(chain, before), rel=1e-12)
    assert momentum(chain, state.velocity(chain)) == pytest.approx(momentum(chain, before.velocity(chain)), rel=1e-12)


def test_it_shrinks_until_whole_and_halves_agree():
    lengths = [fallen_back(hertz(20.0), wanted)[3] for wanted in (1e-2, 1e-4, 1e-8)]
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[0] > lengths[-1]
    for length in lengths:
        shrinks = math.log(length / 0.2) / math.log(SHRINK)
        assert shrinks == pytest.approx(round(shrinks), abs=1e-9)


@pytest.mark.parametrize("wanted", [1e3, 1e-12, 0.0])
def test_contacts_between_beads_that_stick_stay_as_they_are(wanted):
    """Their equations have no weight at all: rates that were no numbers agreed at no length, and the loop went on for ever."""
    chain = Chain([1.0, 2.0, 1.5, 1.0, 1.0], power_law(2.0, 0.1, loss=0.1), gap=[0.0, 0.01, -0.3, 0.0])
    state = State.at_start(chain, [1.0, 0.0, 0.0, 0.0, 0.0])
    before = state.copy()
    data, _, motion = records_of(chain, state)
    data.inverse_mass[2:] = 0.0  # as of beads that stick
    motion.mode[:] = LOADED
    taken = fallback_step(0.2, data, motion, wanted, empty_trial(4), empty_scratch(4), empty_log(4, 0))
    assert 0.0 <= taken <= 0.2
    np.testing.assert_array_equal(motion.overlap[2:], before.overlap[2:])
    np.testing.assert_array_equal(motion.rate[2:], before.rate[2:])
    assert np.isfinite(motion.overlap).all()
    assert np.isfinite(motion.force).all()


@pytest.mark.parametrize("i", [0, 1, 2])
@pytest.mark.parametrize("anchored", [0.0, math.inf])
def test_a_rate_that_is_taken_leaves_the_momentum(i, anchored):
    chain = Chain([1.0, 2.0, 0.5, anchored or 1.5], hertz(20.0))
    state = State.at_start(chain, [1.0, 0.2, -0.3, 0.0])
    before = state.velocity(chain)
    data, _, motion = records_of(chain, state)
    motion.mode[:] = LOADED
    stop_rate(i, data, motion)
    after = state.velocity(chain)
    assert after[i] == after[i + 1]
    others = [j for j in range(4) if j not in (i, i + 1)]
    assert after[others] == pytest.approx(before[others], abs=1e-15)
    if i < 2 or not anchored:
        assert momentum(chain, after) == pytest.approx(momentum(chain, before), rel=1e-14)


@pytest.mark.parametrize("modes", [[LOADED, LOADED], [LOADED, TOUCHING]])
def test_beside_soft_or_touching_contacts_the_rate_alone_is_taken(modes):
    laws = [hertz(20.0), power_law(2.0, 0.5) if modes[1] == LOADED else draft_gear(5.0, 0.1)]
    state = State.at_start(chain := Chain([1.0, 2.0, 0.5], laws), [1.0, 0.2, -0.3])
    data, _, motion = records_of(chain, state)
    motion.mode[:] = modes
    rate = motion.rate[1]
    stop_rate(0, data, motion)
    assert motion.rate.tolist() == [0.0, rate]


def test_a_contact_between_two_walls_has_no_centre_of_mass():
    chain = Chain([math.inf, 1.0], hertz(20.0))
    state = State.at_start(chain, [0.0, -1.0])
    data, _, motion = records_of(chain, state)
    data.inverse_mass[1] = 0.0  # a bead that sticks on its bed is a wall in the effective chain
    motion.mode[:] = LOADED
    stop_rate(0, data, motion)
    assert motion.rate[0] == 0.0
    assert np.isfinite(motion.anchor).all()


@pytest.mark.parametrize("contacts", [1, 4, 30])
def test_its_scratch_memory_has_the_rows_of_the_solver(contacts):
    """Compiled code checks no bounds: a row too few is written beyond the end."""
    rows, columns = empty_scratch(contacts).work.shape
    assert rows >= max(discrete_gradient.WORK_ROWS, BEAD_ROWS)
    assert columns >= contacts + 1
