"""Tests of the results of `simulate` and `advance`: samples, durations, gaps, events, and constant memory."""

import gc
import math
import tracemalloc
from unittest.mock import Mock

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from softcradle.physics import Chain, State, advance, draft_gear, hooke, one_on, simulate
from softcradle.physics.adaptive import kept_steps, runner
from softcradle.physics.contact import hertz
from softcradle.physics.fixed_step import runner as fixed_step
from softcradle.physics.problem import Problem
from softcradle.physics.pymunk_contacts import runner as pymunk_contacts
from softcradle.physics.simulation import solve

from tests.helpers.motions import CASES, runs
from tests.helpers.relations import FIXED_STEP, LIVE, NAMES, fineness, simulate_quietly, struck

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
    # The choice of samples does not change the motion.
    assert found.final_velocity.tolist() == fine.final_velocity.tolist()
    for k, time in enumerate(times):  # Each sample lies on the curve through the neighbouring samples.
        expected = [np.interp(time, fine.time, fine.position[:, i]) for i in range(5)]
        assert found.position[k] == pytest.approx(expected, abs=2e-5)


def test_without_a_duration_it_runs_until_all_are_apart(method):
    found = simulate(CRADLE, START, method=method)
    assert np.diff(found.final_velocity).min() >= -1e-9
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


def test_a_run_without_duration_is_the_start(method):
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


@pytest.mark.parametrize("duration", [None, 4.0])
@pytest.mark.parametrize("name", sorted({*NAMES} - {"scipy"}))  # The method `scipy` repeats the last state and warns.
def test_a_run_that_gives_up_has_samples_as_far_as_it_got(name, duration):
    found = solve(CRADLE, START, duration, name, samples=50, most_steps=30)
    assert found.status.gave_up
    assert found.time[-1] < 4.0
    rows = np.column_stack((found.overlap, found.anchor))
    assert len(np.unique(rows, axis=0)) == len(rows), "no state is repeated"


def test_a_gap_is_flown_through_freely(method):
    chain = Chain([1.0, 1.0], hertz(1.0), 100.0)
    found = simulate(chain, [0.5, 0.0], method=method, samples=[0.0, 100.0, 199.0], duration=210.0)
    assert found.position[:, 0] == pytest.approx([0.0, 50.0, 99.5], abs=1e-9)
    closed, opened = found.contact_intervals[0][0]
    assert closed == pytest.approx(200.0, abs=1e-3)
    touching = simulate(Chain([1.0, 1.0], hertz(1.0)), [0.5, 0.0], method=method)
    assert opened - closed == pytest.approx(touching.contact_intervals[0][0][1], abs=0.02)
    assert found.final_velocity == pytest.approx(touching.final_velocity, abs=1e-4)
    assert found.evaluations < 1.5 * touching.evaluations  # The free flight needs almost no evaluations.


@pytest.mark.parametrize("method", [method.name for method in LIVE])
def test_advance_takes_no_memory_a_step(method):
    chain = one_on(50, hertz(1.0))
    state = State.at_start(chain, [1.0] + [0.0] * 50)
    advance(chain, state, 0.01, method, step=1e-3)  # This call compiles kernels and allocates work memory.
    peaks = []
    gc.collect()
    for count in (10, 10_000):
        tracemalloc.start()
        advance(chain, state, count * 1e-4, method, step=1e-4)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] <= peaks[0] + 512  # The second call takes a thousand times as many steps.


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


# Motions of runs without a duration. The samples of such a run must equal the samples of the same motion with a given
# duration. All methods except pymunk compute samples from stored steps.
ENDED = {name: (case.chain, case.velocity) for name, case in CASES.items() if case.duration is None}
ENDED["over at once"] = Chain([1.0, 1.0, 1.0], hooke(1.0), gap=0.1), [-1.0, 0.0, 0.0]
ADAPTIVE = [name for name, _ in runs([name for name in CASES if name in ENDED], ("accurate",))]
for name, chain in (("gears in a row", one_on(10, draft_gear(1.0, 0.1))), ("spheres in a row", one_on(20, hertz(1.0)))):
    ENDED[name] = chain, struck(chain)
    ADAPTIVE.append(name)
# Allowed difference between a run without a duration and a run with a given duration. The steps of the two runs differ.
APART = {"accurate": 5e-9, "scipy": 1.5e-8}
SAMPLED = [*runs([name for name in CASES if name in ENDED], [one.name for one in FIXED_STEP])]
SAMPLED += [*(("over at once", one.name) for one in FIXED_STEP), *((name, "accurate") for name in ADAPTIVE)]
SAMPLED += [pytest.param("gears on straws", "scipy", marks=pytest.mark.slow), ("a push that ends", "scipy")]
ROWS = ("overlap", "velocity", "anchor", "absorbed_by_contacts", "absorbed_by_bed", "given")


@pytest.mark.parametrize("rows", [None, 6], ids=["", "thinned many times"])
@pytest.mark.parametrize(("name", "method"), SAMPLED)
def test_a_run_to_its_end_has_the_samples_of_one_with_this_duration(name, method, rows, monkeypatch):
    if rows:
        monkeypatch.setattr(fixed_step, "MOST_ROWS", rows)
    chain, velocity = ENDED[name]
    found = simulate_quietly(chain, velocity, method=method, samples=37)
    known = simulate_quietly(chain, velocity, found.time[-1], method=method, samples=37)
    assert found.time == pytest.approx(known.time, rel=1e-15, abs=0.0)
    for row in ROWS:
        scale = 1.0 + np.abs(getattr(known, row)).max()
        assert getattr(found, row) == pytest.approx(getattr(known, row), abs=APART.get(method, 1e-12) * scale)
    if method == "accurate":  # At the end of the run, the last contact has just opened or is about to open.
        assert found.force[:-1] == pytest.approx(known.force[:-1], rel=1e-6, abs=1e-6)


def test_samples_cost_no_second_run(monkeypatch):
    chain, velocity = ENDED["gears on straws"]
    # The first run of a process also spends time on loading kernels.
    simulate_quietly(chain, velocity, method="verlet", samples=50)
    counted = Mock(wraps=fixed_step._pass)
    monkeypatch.setattr(fixed_step, "_pass", counted)
    assert len(simulate_quietly(chain, velocity, method="verlet", samples=50).time) == 50
    assert counted.call_count == 1


@pytest.mark.parametrize(("module", "method"), [(fixed_step, "verlet"), (pymunk_contacts, "pymunk")])
def test_the_clock_of_a_run_counts_its_samples_too(module, method):
    chain, velocity = ENDED["gears on straws"]
    record = module.run(Problem(chain, State.at_start(chain, velocity), method, None, 0.01, samples=50))
    # For pymunk, `simulate` measures the time, because the clock inside the run counts only the samples.
    assert (record.seconds == 0.0) == (method == "pymunk")


def test_a_run_that_waits_for_kernels_does_not_count_that_as_its_cost(monkeypatch):
    clock, kernels = [0.0], runner.KERNELS
    kernels.load_made()
    monkeypatch.setattr(runner, "perf_counter", lambda: clock[0])
    monkeypatch.setattr(kernels, "of", lambda kernel, work=0.0: clock.append(clock.pop() + 60.0) or kernel)
    assert runner.one_run(Problem(CRADLE, State.at_start(CRADLE, START), "accurate", 3.0, 0.0, 1e-6)).seconds == 0.0
    assert clock[0] > 0.0


@pytest.mark.parametrize("name", ADAPTIVE)
def test_samples_cost_no_second_run_of_an_adaptive_method(name, monkeypatch):
    kernels, counted, begun = runner.KERNELS, Mock(wraps=runner.integrate), []
    kernels.load_made()  # Each kernel is called once when it is loaded.
    monkeypatch.setattr(runner, "integrate", counted)
    monkeypatch.setattr(kernels, "of", lambda kernel, work=0.0: kernel)
    for samples in (2, 50):
        counted.reset_mock()
        simulate_quietly(*ENDED[name], samples=samples, tolerance=1e-4)
        begun.append(sum(not resumed for _, (resumed, *_), *_ in [call.args for call in counted.call_args_list]))
    assert begun[0] == begun[1] > 0


@pytest.mark.parametrize(("limit", "rows", "allowed"), [("MOST_ROWS", 3, 0.0), ("MOST_KEPT", 1, 1e-8)])
@pytest.mark.parametrize("name", ADAPTIVE)
def test_samples_do_not_depend_on_the_blocks_of_stored_steps(name, limit, rows, allowed, monkeypatch):
    whole = simulate_quietly(*ENDED[name], samples=23)
    monkeypatch.setattr(kept_steps, limit, rows)
    monkeypatch.setattr(runner, "_last_run", runner._LastRun())
    found = simulate_quietly(*ENDED[name], samples=23)
    for row in ("time", *ROWS):
        np.testing.assert_allclose(getattr(found, row), getattr(whole, row), rtol=0.0, atol=allowed)
    if not allowed:
        np.testing.assert_array_equal(found.force, whole.force)


def test_energies_of_a_motion_that_has_blown_up_are_no_warnings():
    found = simulate_quietly(one_on(4, hertz(1e6)), START, 20.0, "verlet", step=0.05)
    assert not np.isfinite(found.kinetic_energy + found.contact_energy).all()
