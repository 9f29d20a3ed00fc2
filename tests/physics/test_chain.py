"""Tests of the class Chain. The tests check which arguments the class accepts or rejects, and the start values of a
State.
"""

import math
import pickle
from contextlib import nullcontext
from dataclasses import FrozenInstanceError, fields

import numpy as np
import pytest
from softcradle.physics import Chain, State, draft_gear, hooke, one_on, power_law, scales, simulate
from softcradle.physics.advice.unusual_numbers import unusual_warnings
from softcradle.physics.contact import Contact
from softcradle.physics.scales import LEAST_DEPTH, MOST_DEPTH, contact_scales, require_computable

LAW = power_law(1.0, 0.1)


def test_a_wall_is_a_bead_of_infinite_mass_and_the_anchor():
    chain = Chain([1, 5, math.inf, 7], LAW)
    assert chain.walls == 1
    assert chain.anchor == 2
    assert chain.inverse_mass[2] == 0.0
    assert Chain([1, 5, 3], LAW).anchor == 1


def test_a_chain_cannot_be_changed():
    chain = one_on(2, LAW)
    for part, name in ((chain, "mass"), (LAW, "stiffness")):
        with pytest.raises(FrozenInstanceError):
            setattr(part, name, 1.0)
    with pytest.raises(ValueError, match="read-only"):
        chain.law_rows[0, 0] = 1.0


def test_every_start_is_one_of_its_own_with_the_gaps_of_the_chain():
    chain = Chain([1, 9, 3, 1], LAW, [0.5, 0.0, 0.25])
    state = State.at_start(chain, [1.0, 0.5, 0.25, -1.0])
    assert state.position(chain).tolist() == [0.0, 0.5, 0.5, 0.75]
    assert state.velocity(chain).tolist() == [1.0, 0.5, 0.25, -1.0]
    assert state.overlap.tolist() == [-0.5, 0.0, -0.25]
    assert state.time == 0.0
    pressed = Chain([1, 1], hooke(5.0), gap=-0.1)
    moved = State.at_start(pressed, [0, 0])
    moved.overlap += 1.0
    moved.force += 1.0
    fresh = State.at_start(pressed, [0, 0])
    assert fresh.overlap.tolist() == [0.1]
    assert fresh.force.tolist() == [0.5]


@pytest.mark.parametrize("seed", range(40))
def test_chains_are_rejected_by_their_overlaps(seed):
    """Check speeds just inside and just outside the allowed range of each chain. A run must be rejected if and only if
    an overlap would be out of range.
    """
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 6))
    preload = rng.choice([0.0, 1.0], n) * 10 ** rng.uniform(-3, 3, n)
    exponent = rng.choice([1.0, 1.5, rng.uniform(0.01, 3.0)], n)
    chain = Chain(10 ** rng.uniform(-3, 3, n + 1), list(map(Contact, preload, 10 ** rng.uniform(-6, 8, n), exponent)))
    preload, stiffness, exponent = chain.law_rows.T
    depths = np.array([[LEAST_DEPTH], [MOST_DEPTH]])
    energy = np.maximum(preload * depths, stiffness * depths ** (1.0 + exponent) / (1.0 + exponent))
    borders = np.append(np.sqrt(2.0 * energy * chain.inverse_reduced_mass), scales._computable_speeds(chain))
    for speed in np.clip(np.outer(borders, [0.5, 1.0 - 1e-9, 1.0 + 1e-9, 2.0]).ravel(), 1e-30, 1e30):
        velocity = [speed, *[0.0] * n]
        depth = contact_scales(chain, velocity)[0]
        within = ((depth >= LEAST_DEPTH) & (depth <= MOST_DEPTH)).all()
        with nullcontext() if within else pytest.raises(ValueError, match="would be pressed by about"):
            require_computable(chain, velocity)


@pytest.mark.parametrize("factor", [0.5, 1.0 - 1e-6, 1.0 + 1e-6, 2.0])
def test_a_gear_that_yields_too_little_is_told_of(factor):
    """Check the warning about a draft gear that hardly yields.

    At the tested speed the gear yields by a thousandth of its precompression. For two beads of 1 kg this speed follows
    from v**2 / 4 = preload * yield.
    """
    border = math.sqrt(4.0 * 6.0 * 2e-3)
    assert bool(unusual_warnings(Chain([1, 1], draft_gear(3.0, 2.0)), [factor * border, 0.0], 1e-8)) == (factor < 1.0)


def test_a_used_chain_can_be_pickled():
    chain = Chain([1, 1, 2], [hooke(5.0), power_law(1.0, 0.1)], gap=[-0.1, 0.2], drive=[0.0, 0.0, -1.0])
    first = simulate(chain, [1, 0, 0], 0.5)
    again = pickle.loads(pickle.dumps(chain))
    assert again == chain
    # A pickle does not contain values that the chain has cached.
    assert vars(again).keys() == {field.name for field in fields(Chain)}
    np.testing.assert_array_equal(simulate(again, [1, 0, 0], 0.5).final_velocity, first.final_velocity)
