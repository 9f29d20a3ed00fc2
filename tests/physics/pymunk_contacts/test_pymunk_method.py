"""Method `pymunk`: the digits, steps and switches of `euler`, from bodies in a Space."""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, State, advance, draft_gear, hertz, hooke, one_on, power_law, simulate
from softcradle.physics.pymunk_contacts.runner import _row
from softcradle.physics.simulation import solve
from softcradle.physics.status import Status

MIXED = [hertz(10.0), hooke(30.0), power_law(2.0, 1.2)]
CASES = {
    "hertz": (one_on(4, hertz(1.0)), [1, 0, 0, 0, 0]),
    "hooke": (one_on(9, hooke(1e4)), [1] + [0] * 9),
    "square root": (one_on(4, power_law(1.0, 0.5)), [1, 0, 0, 0, 0]),
    "alpha 1/5": (one_on(4, power_law(1.0, 0.2)), [1, 0, 0, 0, 0]),
    "alpha 1/7": (one_on(3, power_law(1.0, 1 / 7)), [1, 0, 0, 0]),
    "mixed, with gaps": (Chain([1, 2, 0.5, 3], MIXED, [0, 0.1, 0.03]), [1, 0, 0, -0.5]),
    "wall at rest": (Chain([1, 2, 0.5, math.inf], MIXED, [0, 0.1, 0.03]), [1, 0, 0, 0]),
    "moving wall": (Chain([math.inf, 2, 0.5, 1], MIXED), [0.5, 0, 0, 0]),
}


def both(chain, velocity, **options):
    return [simulate(chain, velocity, method=method, **options) for method in ("euler", "pymunk")]


@pytest.mark.parametrize("case", CASES)
def test_digits_steps_and_switches_are_those_of_euler(case):
    chain, velocity = CASES[case]
    euler, pymunk = both(chain, velocity, step=2e-3, samples=57)
    assert pymunk.time == pytest.approx(euler.time)
    for name in ("overlap", "rate", "anchor", "position", "velocity"):
        np.testing.assert_allclose(getattr(pymunk, name), getattr(euler, name), rtol=0, atol=1e-12, err_msg=name)
    np.testing.assert_allclose(pymunk.force, euler.force, rtol=0, atol=1e-10 * euler.force.max())
    assert np.abs(euler.velocity[-1] - velocity).max() > 0.1
    assert (pymunk.steps, pymunk.evaluations) == (euler.steps, euler.evaluations)
    assert [len(each) for each in pymunk.contact_intervals] == [len(each) for each in euler.contact_intervals]
    for ours, theirs in zip(pymunk.contact_intervals, euler.contact_intervals, strict=True):
        np.testing.assert_allclose(ours, theirs, atol=0.05)  # a contact that closes at speed 0 has no sharp time
        np.testing.assert_allclose([end for _, end in ours], [end for _, end in theirs], atol=1e-6)


def test_softer_clusters_agree_until_they_come_apart():
    """alpha = 1/10: the rates of the deepest contacts drown in the round-off of bead velocities, and no step is stable."""
    chain, velocity = one_on(4, power_law(1.0, 0.1)), [1, 0, 0, 0, 0]
    euler, pymunk = both(chain, velocity, duration=0.75, step=1e-3)
    np.testing.assert_allclose(pymunk.velocity, euler.velocity, rtol=0, atol=1e-12)
    whole = both(chain, velocity, step=1e-3)
    np.testing.assert_allclose(whole[1].final_velocity, whole[0].final_velocity, rtol=0, atol=1e-6)


def test_momentum_to_round_off_with_a_draft_gear():
    chain = Chain([0.3945, 0.3980, 0.3967, 0.3938], draft_gear(770.0, 0.0177))
    trajectory = simulate(chain, [0.3, 0, 0, 0], method="pymunk")
    np.testing.assert_allclose(trajectory.momentum, 0.3945 * 0.3, rtol=1e-13)


def test_samples_do_not_change_the_motion():
    chain, velocity = CASES["hertz"]
    few, many = (simulate(chain, velocity, 5.0, "pymunk", 0.01, samples) for samples in (2, 777))
    assert (few.final_velocity == many.final_velocity).all()
    assert few.steps == many.steps == 500


@pytest.mark.parametrize("speed", [1e-3, 1.0, 1e3])
def test_touching_distance_fits_the_speed(speed):
    """Overlaps of 1e3 m or 1e-3 m: the anchors are always further apart, never so far that digits are lost."""
    chain = one_on(2, hertz(1.0))
    euler, pymunk = both(chain, [speed, 0, 0])
    np.testing.assert_allclose(pymunk.velocity, euler.velocity, rtol=0, atol=1e-12 * speed)


def test_anchors_move_apart_under_deep_overlaps():
    """Two walls approach: overlaps grow to a hundred times those of the start."""
    chain = Chain([math.inf, 1.0, math.inf], hertz(100.0))
    euler, pymunk = both(chain, [1.0, 0.0, -1.0], duration=30.0, step=1e-3)
    assert euler.overlap[-1].max() > 25.0
    np.testing.assert_allclose(pymunk.overlap, euler.overlap, rtol=0, atol=1e-8)
    np.testing.assert_allclose(pymunk.overlap[:60], euler.overlap[:60], rtol=0, atol=1e-12)


def test_advance_agrees_with_euler_under_a_push():
    chain, velocity = CASES["mixed, with gaps"]
    states = [State.at_start(chain, velocity) for _ in range(2)]
    for frame in range(60):
        for state, method in zip(states, ("euler", "pymunk"), strict=True):
            state.push = np.array([math.sin(0.1 * frame), 0.0, 0.3, -1.0])
            advance(chain, state, 1.0 / 60.0 + 1e-4 * frame, method, step=1e-3)
    euler, pymunk = states
    assert pymunk.time == euler.time
    for name in ("overlap", "rate", "anchor"):
        np.testing.assert_allclose(getattr(pymunk, name), getattr(euler, name), rtol=0, atol=1e-12, err_msg=name)
    assert abs(euler.rate).max() > 0.1


def test_advance_keeps_its_space_until_the_chain_is_replaced():
    chain, velocity = CASES["hertz"]
    state = State.at_start(chain, velocity)
    advance(chain, state, 0.1, "pymunk", step=1e-3)
    row = state.work["pymunk"]
    advance(chain, state, 0.1, "pymunk", step=1e-3)
    assert state.work["pymunk"] is row
    advance(one_on(4, hooke(1.0)), state, 0.1, "pymunk", step=1e-3)
    assert state.work["pymunk"] is not row


def test_advance_stops_at_the_same_time_as_simulate():
    chain, velocity = CASES["hooke"]
    state = State.at_start(chain, velocity)
    advance(chain, state, 0.0405, "pymunk", step=1e-3)
    trajectory = simulate(chain, velocity, 0.0405, "pymunk", step=1e-3)
    np.testing.assert_allclose(state.velocity(chain), trajectory.final_velocity, rtol=0, atol=1e-14)


def test_bodies_do_not_turn_and_walls_are_kinematic():
    chain, velocity = CASES["wall at rest"]
    row = _row(chain, State.at_start(chain, velocity), 1e-3)
    assert [body.moment for body in row.bodies] == [math.inf] * 4
    assert row.bodies[3].body_type == row.bodies[3].KINEMATIC


def test_it_gives_up_after_the_steps_that_it_may_take():
    found = solve(one_on(3, hertz(1.0)), [1.0, 0.0, 0.0, 0.0], None, "pymunk", step=1e-3, most_steps=50)
    assert found.status is Status.OUT_OF_STEPS
    assert found.steps == 50
    assert "pymunk gave up after 50 steps" in str(found.warnings[0])
