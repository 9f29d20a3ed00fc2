"""Ledger of chains with friction and loss: all energies add up, what is absorbed grows, and methods agree through stops."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from softcradle.physics import Chain, draft_gear, hertz, simulate
from softcradle.physics.chain import GRAVITY
from softcradle.physics.default_step import default_step
from softcradle.physics.scales import contact_scales

from tests.helpers.random_chains import random_dissipative
from tests.helpers.relations import PROMISE, ledger_error, simulate_quietly

# stops, reversals, a gear that is held, a bead that sticks and is torn loose
CHAIN = Chain([1.0, 2.0, 1.5, 1.0], draft_gear(300.0, 0.01, 0.6), gap=[0.005, 0.0, 0.002], friction=0.25)
START = [1.0, 0.0, 0.0, -0.5]


def longest_time(chain, velocity):
    """The longest contact time, or the time in which friction stops a bead where that is shorter [s]."""
    longest = float(contact_scales(chain, velocity)[1].max())
    return min(longest, np.ptp(velocity) / (chain.friction * GRAVITY))


@given(st.integers(0, 2**32 - 1), st.sampled_from([5, 60, 1000]))
def test_the_ledger_of_conserving_closes_to_round_off(seed, parts):
    chain, velocity = random_dissipative(seed)
    longest = longest_time(chain, velocity)
    found = simulate(chain, velocity, longest * min(20, 2000 / parts), "conserving", longest / parts, samples=41)
    assume(found.warnings == ())  # one in some hundred chains has a step that does not converge, and a warning
    assert ledger_error(found) < 1e-10


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(15))
def test_the_ledger_of_radau_closes_with_the_tolerance(seed):
    """Within ten tolerances (measured: 0.4), and better at a finer one."""
    chain, velocity = random_dissipative(seed, 4)
    errors = []
    for tolerance in (1e-6, 1e-9, 1e-11):
        found = simulate_quietly(
            chain, velocity, 2.0 * longest_time(chain, velocity), "radau", samples=21, tolerance=tolerance
        )
        errors.append(ledger_error(found))
        assert errors[-1] < PROMISE * tolerance
    assert errors[1] < max(0.1 * errors[0], 1e-11)


def test_the_ledger_of_radau_closes_on_a_bed_with_a_very_soft_contact():
    """Exponent 0.05 with loss 0.95, until all beads rest."""
    chain, velocity = random_dissipative(3, 4)
    found = simulate_quietly(chain, velocity, 2.0 * longest_time(chain, velocity), "radau", samples=21, tolerance=1e-8)
    assert ledger_error(found) < PROMISE * 1e-8


@pytest.mark.parametrize("method", ["radau", "accurate", "scipy"])
def test_adaptive_methods_and_conserving_agree(method):
    """Two ways that share no step."""
    found = simulate(CHAIN, START, 0.2, method, tolerance=1e-11)
    other = simulate(CHAIN, START, 0.2, "conserving", 1e-6)
    assert np.abs(found.position - other.position).max() < 2e-7
    assert np.abs(found.velocity - other.velocity).max() < 1e-5
    assert np.abs(found.absorbed_by_bed - other.absorbed_by_bed).max() < 1e-6
    assert np.abs(found.absorbed_by_contacts - other.absorbed_by_contacts).max() < 1e-6
    assert ledger_error(found) < 1e-10
    assert found.warnings == ()


@pytest.mark.parametrize("method", ["euler", "verlet", "pymunk"])
def test_the_ledger_of_explicit_methods_closes_as_the_step_shrinks(method):
    chain = Chain([1.0, 2.0, 1.5], hertz(1000.0, 0.5), gap=0.01, friction=0.1)
    step = default_step(chain, [1, 0, 0])
    errors = [ledger_error(simulate(chain, [1, 0, 0], 0.4, method, factor * step)) for factor in (10.0, 2.5)]
    assert errors[1] < 0.5 * errors[0] < 0.05


def test_conserving_is_of_second_order_through_stops_and_reversals():
    fine = simulate(CHAIN, START, 0.2, "conserving", 1e-6, samples=2)
    errors = [
        np.abs(simulate(CHAIN, START, 0.2, "conserving", step, samples=2).position[-1] - fine.position[-1]).max()
        for step in (1.6e-3, 4e-4, 1e-4)
    ]
    assert errors[0] < 1e-4
    assert errors[2] < errors[0] / 40


def test_absorbed_energy_never_falls():
    chain = Chain([1.0] * 5, draft_gear(300.0, 0.01, 0.8), friction=0.1)
    found = simulate(chain, [1.0, 0, 0, 0, 0], method="conserving")
    assert np.diff(found.absorbed_by_contacts).min() > -1e-14
    assert np.diff(found.absorbed_by_bed).min() >= 0.0
