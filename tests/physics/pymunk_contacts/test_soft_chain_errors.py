"""SoftChain: errors and bad arguments."""

import math

import pymunk
import pytest
from softcradle.physics import SoftChain, hertz
from softcradle.physics.pymunk_contacts import soft_chain

from tests.helpers.spaces import FRAME, chain_row, run, total_energy


def test_an_error_in_the_solver_reaches_the_caller_once(monkeypatch):
    space, bodies, _ = chain_row(hertz(1e4), gap=0.01)

    def failing(*arguments):
        raise FloatingPointError("no forces")

    monkeypatch.setattr(soft_chain, "solve_chain_step", failing)
    with pytest.raises(FloatingPointError, match="no forces") as caught:
        space.step(FRAME)
    assert not hasattr(caught.value, "__notes__")
    monkeypatch.undo()
    run(space, FRAME, 120)
    assert bodies[4].velocity.x > 0.1


def test_a_solver_that_does_not_converge_says_so(monkeypatch):
    space, _, _ = chain_row(hertz(1e4), gap=0.01)
    monkeypatch.setattr(soft_chain, "solve_chain_step", lambda *arguments: False)
    with pytest.raises(RuntimeWarning, match="did not converge"):
        space.step(FRAME)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"bodies": 1}, "at least 2 different bodies"),
        ({"contacts": [hertz(1.0)]}, "one Contact for all or 2"),
        ({"contacts": 3.0}, "one Contact for all or 2"),
        ({"touching_distances": [1.0]}, "one or 2 finite numbers"),
        ({"touching_distances": 0.0}, "finite numbers > 0"),
        ({"touching_distances": math.nan}, "finite numbers > 0"),
        ({"method": "euler"}, "one of conserving, not 'euler'"),
    ],
)
def test_bad_arguments(arguments, message):
    bodies = [pymunk.Body(1, 1) for _ in range(arguments.pop("bodies", 3))]
    good = {"bodies": bodies, "contacts": hertz(1.0), "touching_distances": 1.0}
    with pytest.raises(ValueError, match=message):
        SoftChain(**{**good, **arguments})


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("max_force", 0.1),
        ("force_func", lambda spring, distance: 0.0),
        ("stiffness", 1.0),
        ("damping", 1.0),
        ("rest_length", 2.0),
        ("anchor_a", (0.1, 0.0)),
        ("anchor_b", (0.1, 0.0)),
    ],
)
def test_a_link_takes_no_force_of_its_own(name, value):
    """What pymunk lets a spring have would break the ledger of the chain, or be of no effect."""
    space, bodies, chain = chain_row(hertz(1e4), gap=0.1)
    for link in chain:
        with pytest.raises(AttributeError, match=f"takes no {name}: its force is the chain's"):
            setattr(link, name, value)
    for _ in range(60):
        space.step(FRAME)
        assert total_energy(bodies, chain) == pytest.approx(0.5, rel=1e-10)
    assert [link.max_force for link in chain] == [math.inf] * 4


@pytest.mark.parametrize(("name", "value"), [("velocity", (math.nan, 0.0)), ("force", (math.inf, 0.0))])
def test_a_body_that_is_nowhere_is_named_after_the_step(name, value):
    space, bodies, chain = chain_row(hertz(1e4), gap=0.1)
    run(space, FRAME, 3)
    state = chain.state
    setattr(bodies[1], name, value)
    with pytest.raises(ValueError, match=f"body 1 of a SoftChain has the {name} Vec2d"):
        space.step(FRAME)
    chain.restore(state)
    run(space, FRAME, 60)
    assert total_energy(bodies, chain) == pytest.approx(0.5, rel=1e-10)
    assert bodies[4].velocity.x > 0.1


def test_a_state_of_another_row():
    chain, other = chain_row(hertz(1e4))[2], chain_row(hertz(1e4), beads=3)[2]
    with pytest.raises(ValueError, match="a state of 3 bodies is none of a SoftChain of 5"):
        chain.restore(other.state)
    with pytest.raises(ValueError, match="state must be a SoftChainState, not 7"):
        chain.restore(7)
