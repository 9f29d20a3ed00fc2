"""What `simulate` returns and `advance` does: samples, durations, gaps, events, and no memory taken a step."""

import gc
import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from softcradle.physics import Chain, State, advance, hertz, hooke, one_on, power_law, simulate

from tests.helpers.relations import FIXED_STEP, LIVE, NAMES, fineness, separating

CRADLE = one_on(4, hertz(1.0))
START = [1.0, 0.0, 0.0, 0.0, 0.0]


@pytest.fixture(params=NAMES)
def method(request):
    return request.param


def test_samples_are_even_and_agree_with_each_other(method):
    found = simulate(CRADLE, START, 3.0, method, samples=50)
    assert found.time == pytest.approx(np.linspace(0.0, 3.0, 50), abs=1e-15)
    assert found.kinetic_energy.shape == found.contact_energy.shape == found.momentum.shape == (50,)
    assert found.position.shape == found.velocity.shape == (50, 5)
    assert found.overlap.shape == found.rate.shape == found.force.shape == (50, 4)
    assert found.anchor.shape == (50, 2)
    assert len(found.contact_intervals) == 4
    for intervals, pushes in zip(found.contact_intervals, found.force[-1] > 0.0, strict=True):
        assert (intervals[-1][1] == math.inf) == pushes
    assert found.method == method
    assert found.seconds > 0.0
    assert found.evaluations >= 1
    assert found.velocity[0].tolist() == START
    assert found.velocity[-1] == pytest.approx(found.final_velocity, abs=1e-12)
    assert found.overlap == pytest.approx(found.position[:, :-1] - found.position[:, 1:], abs=1e-12)
    assert found.rate == pytest.approx(found.velocity[:, :-1] - found.velocity[:, 1:], abs=1e-12)
    assert not ((found.overlap <= 0.0) & (found.force != 0.0)).any()
    assert found.kinetic_energy == pytest.approx(0.5 * found.velocity**2 @ np.array(CRADLE.mass))
    stored = np.array([[c.energy(d) for c, d in zip(CRADLE.contact, row, strict=True)] for row in found.overlap])
    assert found.contact_energy == pytest.approx(stored.sum(axis=1))


def test_given_sample_times_are_those(method):
    times = [0.0, 0.1, 0.1, 0.7123456, 1.5]
    found = simulate(CRADLE, START, 2.0, method, samples=times)
    assert found.time.tolist() == times
    assert found.position[1].tolist() == found.position[2].tolist()
    fine = simulate(CRADLE, START, 2.0, method, samples=2001)
    assert found.final_velocity.tolist() == fine.final_velocity.tolist()  # samples leave the path alone
    for k, time in enumerate(times):  # a sample lies on the path through its neighbours
        expected = [np.interp(time, fine.time, fine.position[:, i]) for i in range(5)]
        assert found.position[k] == pytest.approx(expected, abs=2e-5)


def test_without_a_duration_it_runs_until_all_are_apart(method):
    found = simulate(CRADLE, START, method=method)
    assert separating(found.final_velocity, 1e-9)
    assert (found.overlap[-1] <= 1e-9).all()
    end = found.time[-1]
    assert end == pytest.approx(max(intervals[-1][1] for intervals in found.contact_intervals), rel=5e-3)
    beyond = simulate(CRADLE, START, method=method, samples=[0.0, 2 * end, 3 * end])
    assert beyond.time[-1] == 3 * end
    for velocity in (*beyond.velocity[1:], beyond.final_velocity):
        assert velocity == pytest.approx(found.final_velocity, abs=1e-12)
    assert beyond.position[2] - beyond.position[1] == pytest.approx(end * found.final_velocity, abs=1e-9)
    longer = simulate(CRADLE, START, 3 * end, method, samples=2)
    assert longer.final_velocity == pytest.approx(found.final_velocity, abs=1e-12)


def test_what_takes_no_time_is_the_start(method):
    """A duration of zero, beads that part, and a frame of zero."""
    found = simulate(CRADLE, START, 0.0, method, samples=2)
    assert found.velocity.tolist() == [START, START]
    assert found.final_velocity.tolist() == START
    parting = simulate(one_on(2, hertz(1.0)), [-1.0, 0.0, 2.0], method=method, samples=2)
    assert parting.time.tolist() == [0.0, 0.0]
    assert parting.contact_intervals == ((), ())
    state = State.at_start(CRADLE, START)
    advance(CRADLE, state, 0.0, method, **fineness(method, 1e-3))
    assert state.velocity(CRADLE).tolist() == START
    assert state.time == 0.0


def test_a_gap_is_flown_through_freely(method):
    chain = Chain([1.0, 1.0], hertz(1.0), 100.0)
    found = simulate(chain, [0.5, 0.0], method=method, samples=[0.0, 100.0, 199.0], duration=210.0)
    assert found.position[:, 0] == pytest.approx([0.0, 50.0, 99.5], abs=1e-9)
    closed, opened = found.contact_intervals[0][0]
    assert closed == pytest.approx(200.0, abs=1e-3)
    touching = simulate(Chain([1.0, 1.0], hertz(1.0)), [0.5, 0.0], method=method)
    assert opened - closed == pytest.approx(touching.contact_intervals[0][0][1], abs=0.02)
    assert found.final_velocity == pytest.approx(touching.final_velocity, abs=1e-4)


@pytest.mark.parametrize("method", [method.name for method in FIXED_STEP])
def test_free_flight_costs_no_steps_worth_mentioning(method):
    near = simulate(Chain([1.0, 1.0], hertz(1.0), 0.0), [1.0, 0.0], method=method, samples=2)
    far = simulate(Chain([1.0, 1.0], hertz(1.0), 1e4), [1.0, 0.0], method=method, samples=2)
    if method != "pymunk":  # which steps its Space through the gap
        assert far.evaluations < near.evaluations + 10
    assert far.final_velocity == pytest.approx(near.final_velocity, abs=1e-4)


def test_advance_is_simulate(method):
    chain = Chain([1.0, 2.0, 1.0, 0.5], [hertz(1.0), hooke(2.0), power_law(1.0, 0.5)], [0.0, 0.1, 0.0])
    start = [1.0, 0.0, 0.0, -0.5]
    state = State.at_start(chain, start)
    for _ in range(8):
        advance(chain, state, 0.25, method, **fineness(method, 2**-10))
    found = simulate(chain, start, 2.0, method, samples=2, **fineness(method, 2**-10))
    allowed = 1e-13 if method in [one.name for one in LIVE] else 1e-8
    assert state.time == 2.0
    assert state.velocity(chain) == pytest.approx(found.velocity[-1], abs=allowed)
    assert state.position(chain) == pytest.approx(found.position[-1], abs=allowed)
    assert state.force == pytest.approx(found.force[-1], abs=10.0 * allowed)


@pytest.mark.parametrize("method", [method.name for method in LIVE])
def test_advance_takes_no_memory_a_step(method):
    chain = one_on(50, hertz(1.0))
    state = State.at_start(chain, [1.0] + [0.0] * 50)
    advance(chain, state, 0.01, method, step=1e-3)  # compiles, and takes its scratch memory
    peaks = []
    for count in (10, 10_000):
        gc.collect()
        tracemalloc.start()
        advance(chain, state, count * 1e-4, method, step=1e-4)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] <= peaks[0] + 512  # a thousand times the steps


@given(st.floats(0.05, 3.0), st.floats(1e-3, 0.3), st.lists(st.floats(0.0, 1.0), min_size=1, max_size=8))
@settings(max_examples=25)
@pytest.mark.parametrize("method", [method.name for method in LIVE])
def test_any_step_duration_and_samples_go_together(method, duration, step, parts):
    times = np.sort(np.array(parts)) * duration
    found = simulate(CRADLE, START, duration, method, step, times)
    assert found.time.tolist() == times.tolist()
    assert found.steps <= duration / step + 2
    ended = simulate(CRADLE, START, duration, method, step, [duration])
    assert ended.velocity[-1] == pytest.approx(found.final_velocity, abs=1e-12)
