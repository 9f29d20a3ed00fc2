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


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: Chain([], LAW), "at least 2 masses"),
        (lambda: Chain([1.0], LAW), "at least 2 masses"),
        (lambda: Chain([[1.0, 2.0]], LAW), "at least 2 masses"),
        (lambda: Chain([1.0, -1.0], LAW), r"every mass \(inf is a wall\) must be a finite number > 0, not -1"),
        (lambda: Chain([1.0, 0.0], LAW), r"every mass .* must be a finite number > 0"),
        (lambda: Chain([1.0, math.nan], LAW), r"every mass .* must be a finite number > 0"),
        (lambda: Chain([math.inf, math.inf], LAW), "two walls side by side"),
        (lambda: Chain([1.0, 1.0], [LAW, LAW]), "one contact for all or 1 contacts, not 2"),
        (lambda: Chain([1.0, 1.0], ["hertz"]), "every contact must be a Contact"),
        (lambda: Chain([1.0, 1.0], LAW, [0.1, 0.1]), "one gap for all or 1 gaps"),
        (lambda: Chain([1.0, 1.0], LAW, math.nan), "every gap must be a number up to 1e.30, not nan"),
        (lambda: one_on(0, LAW), "at least one bead, not 0"),
        (lambda: cluster_on_cluster(2, 2, LAW, [1.0]), "one mass for all or 4 masses, not .1.0."),
        (lambda: State.at_start(one_on(1, LAW), [1.0]), "2 beads need 2 velocities"),
        (lambda: State.at_start(one_on(1, LAW), [1.0, math.nan]), "every velocity must be finite"),
    ],
)
def test_bad_chains_are_refused_in_a_sentence(make, sentence):
    with pytest.raises(ValueError, match=sentence):
        make()


def test_the_start_has_the_gaps_of_the_chain():
    chain = Chain([1, 9, 3, 1], LAW, [0.5, 0.0, 0.25])
    state = State.at_start(chain, [1.0, 0.5, 0.25, -1.0])
    assert state.position(chain).tolist() == [0.0, 0.5, 0.5, 0.75]
    assert state.velocity(chain).tolist() == [1.0, 0.5, 0.25, -1.0]
    assert state.overlap.tolist() == [-0.5, 0.0, -0.25]
    assert state.time == 0.0
