"""The chain: what it accepts, what it refuses, and the start that it gives a State."""

import math
from dataclasses import FrozenInstanceError

import pytest
from softcradle.physics import Chain, State, cluster_on_cluster, one_on, power_law

LAW = power_law(1.0, 0.1)


def test_clusters():
    assert one_on(4, LAW, 2.0) == Chain([2.0] * 5, LAW)
    assert cluster_on_cluster(2, 3, LAW) == Chain([1.0] * 5, LAW)
    assert cluster_on_cluster(1, 1, [LAW], [1.0, 2.0]) == Chain([1.0, 2.0], LAW)


def test_a_wall_is_a_bead_of_infinite_mass_and_the_anchor():
    chain = Chain([1, 5, math.inf, 7], LAW)
    assert chain.walls == 1
    assert chain.anchor == 2
    assert chain.parameters.inverse_mass[2] == 0.0
    assert Chain([1, 5, 3], LAW).anchor == 1


def test_a_chain_cannot_be_changed():
    chain = one_on(2, LAW)
    with pytest.raises(FrozenInstanceError):
        chain.mass = (1.0,)
    with pytest.raises(ValueError, match="read-only"):
        chain.parameters.law[0, 0] = 1.0


def test_the_start_has_the_gaps_of_the_chain():
    chain = Chain([1, 9, 3, 1], LAW, [0.5, 0.0, 0.25])
    state = State.at_start(chain, [1.0, 0.5, 0.25, -1.0])
    assert state.position(chain).tolist() == [0.0, 0.5, 0.5, 0.75]
    assert state.velocity(chain).tolist() == [1.0, 0.5, 0.25, -1.0]
    assert state.overlap.tolist() == [-0.5, 0.0, -0.25]
    assert state.time == 0.0
