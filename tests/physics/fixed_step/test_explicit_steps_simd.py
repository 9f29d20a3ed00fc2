"""Long chains in vector code: the steps of the scalar kernel, whatever the length, the method and the push."""

from __future__ import annotations

import numpy as np
import pytest
from softcradle.physics import Chain, hooke, one_on, power_law, simulate
from softcradle.physics.fixed_step.explicit_steps import split_steps
from softcradle.physics.fixed_step.explicit_steps_simd import BLOCK, LONG, simd_split_steps
from softcradle.physics.fixed_step.runner import DRIFTS_AND_KICKS
from softcradle.physics.numerics.records import ChainData, Motion

LENGTHS = (1, 2, 63, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK + 5)


def both(chain, method, push, most, h=1e-3):
    """Steps taken and state after the scalar and after the vector kernel, from one random state."""
    n = chain.contacts
    draw = np.random.default_rng(n)
    overlap, rate = draw.uniform(-0.3, 1.0, n), 0.1 * draw.normal(size=n)
    outside = draw.normal(size=n + 1) if push else np.zeros(0)
    data = ChainData(*chain.parameters, outside, outside, chain.anchor)
    found = []
    for vector in (False, True):
        closed = (overlap > 0.0).astype(np.int8)
        state = overlap.copy(), rate.copy(), np.array([0.5, -0.25]), np.zeros(n)
        motion = Motion(*state, np.zeros(2), closed[:0], closed[:0])
        if vector:
            taken = simd_split_steps(most, h, *DRIFTS_AND_KICKS[method], data, motion, closed)
        else:
            taken = split_steps(most, h, *DRIFTS_AND_KICKS[method], data, None, motion, closed, np.zeros((2, 0)))
        found.append((taken, *state))
    return found


def mixed(n, exponents):
    """A chain of unlike beads with a wall at its end."""
    draw = np.random.default_rng(1)
    contacts = [power_law(float(f), float(draw.choice(exponents))) for f in draw.uniform(0.5, 2.0, n)]
    return Chain([*draw.uniform(0.5, 2.0, n), np.inf], contacts)


@pytest.mark.parametrize("n", LENGTHS)
@pytest.mark.parametrize("method", ["euler", "verlet", "yoshida4"])
@pytest.mark.parametrize("push", [False, True])
def test_same_digits_where_no_power_is_taken(n, method, push):
    scalar, vector = both(mixed(n, [1.0]), method, push, 20)
    assert scalar[0] == vector[0]
    for a, b in zip(scalar[1:], vector[1:], strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("n", LENGTHS)
@pytest.mark.parametrize("method", ["euler", "verlet", "yoshida4"])
def test_same_to_rounding_with_powers(n, method):
    scalar, vector = both(mixed(n, [0.1, 0.5, 1.0, 1.5]), method, True, 20)
    assert scalar[0] == vector[0]
    for a, b in zip(scalar[1:], vector[1:], strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-13)


def test_stops_in_the_step_in_which_a_contact_switches():
    chain = Chain(np.ones(2 * BLOCK + 1), hooke(1.0))
    n = chain.contacts
    for contact in (0, BLOCK - 1, BLOCK, n - 1):
        overlap = np.full(n, -1.0)
        rate = np.zeros(n)
        overlap[contact], rate[contact] = -0.0105, 1.0
        closed = np.zeros(n, dtype=np.int8)
        data = ChainData(*chain.parameters, np.zeros(0), np.zeros(0), chain.anchor)
        motion = Motion(overlap, rate, np.zeros(2), np.zeros(n), np.zeros(2), closed[:0], closed[:0])
        taken = simd_split_steps(100, 1e-3, *DRIFTS_AND_KICKS["verlet"], data, motion, closed)
        assert taken == 11


@pytest.mark.parametrize("contacts", [LONG - 1, LONG] if LONG < 1000 else [64])
def test_a_collision_of_many_against_conserving(contacts):
    chain = one_on(contacts, power_law(1.0, 1.5))
    velocity = np.eye(1, contacts + 1)[0]
    found = simulate(chain, velocity, duration=20.0, method="verlet", step=1e-3)
    truth = simulate(chain, velocity, duration=20.0, method="accurate", tolerance=1e-10)
    np.testing.assert_allclose(found.final_velocity, truth.final_velocity, atol=1e-5)
    assert found.momentum[-1] == pytest.approx(1.0, abs=1e-12)
