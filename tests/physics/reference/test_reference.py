"""The reference itself: contact modes, located switches, pushes, and every other method compared with it."""

import math

import numpy as np
import pytest
import softcradle.physics.reference.scipy_runner
from softcradle.physics import (
    Chain,
    State,
    cluster_on_cluster,
    draft_gear,
    hertz,
    hooke,
    one_on,
    power_law,
    simulate,
)
from softcradle.physics.reference import stage_equations
from softcradle.physics.reference.one_thread import one_thread
from softcradle.physics.reference.phases import OPEN, Phase, System, switched_modes
from threadpoolctl import threadpool_info, threadpool_limits

from tests.helpers.relations import ADAPTIVE, FIXED_STEP, NAMES
from tests.helpers.truth import GEAR, GEARS

SOFT = [power_law(1.0, 0.5), power_law(2.0, 0.3), power_law(1.0, 0.4)]
CHAINS = {
    "Hertz cradle": (one_on(4, hertz(1.0)), [1, 0, 0, 0, 0], None),
    "soft": (Chain([1, 2, 1, 0.5], SOFT), [1, 0, 0, 0], None),
    "gaps": (Chain([1, 1, 2, 1], hertz(3.0), [0.5, 0.1, 0.0]), [2, 0, 0.5, -1], None),
    "Hooke interface": (Chain([1, 1, 1, 1], [hooke(1.0), hertz(4.0), power_law(1.0, 0.8)]), [1, 0, 0, 0], None),
    "three clusters": (Chain([1, 1, 1, 1, 1], hooke(2.0), [0.0, 0.3, 0.3, 0.0]), [1, 1, 0, -1, -1], None),
    "wall behind": (Chain([1, 2, 1, math.inf], hertz(2.0), 0.1), [1, 0, 0, 0], None),
    "between walls": (Chain([math.inf, 1, 2, math.inf], hooke(5.0), 0.2), [0, 1, -0.5, 0], 4.0),
    "one gear": (Chain([1, 2], draft_gear(3.0, 0.1)), [1, 0], None),
}
STEPS_A_SECOND = 4000


def system(chain, velocity, push=None):
    """A reference System of a chain, and its start as y."""
    start = State.at_start(chain, velocity)
    depth = np.ones(chain.contacts)
    return System(chain, push, 1.0, depth, 1e-8), np.concatenate((start.overlap, start.rate, start.anchor))


def modes(chain, velocity):
    built, y = system(chain, velocity)
    everywhere = np.ones(chain.contacts, dtype=bool)
    mode = switched_modes(built, y, np.full(chain.contacts, OPEN, dtype=np.int8), everywhere)
    return mode.tolist(), Phase.of(built, mode).force(y[: chain.contacts])


def test_an_alpha_of_a_thirtieth_is_no_hindrance():
    """Inner overlaps of 1e-29 count as touching, with a multiplier, until the tolerance distinguishes them from 0."""
    found = simulate(one_on(10, power_law(1.0, 1 / 30)), [1] + [0] * 10, method="scipy", tolerance=1e-7)
    finer = simulate(one_on(10, power_law(1.0, 1 / 30)), [1] + [0] * 10, method="scipy", tolerance=1e-8)
    assert found.final_velocity == pytest.approx(finer.final_velocity, abs=1e-6)
    assert found.evaluations < 50_000


@pytest.mark.slow
@pytest.mark.parametrize("case", CHAINS)
@pytest.mark.parametrize("method", FIXED_STEP, ids=lambda method: method.name)
def test_fixed_steps_agree_with_it(method, case):
    chain, velocity, duration = CHAINS[case]
    exact = simulate(chain, velocity, duration, "scipy", samples=33)
    found = simulate(chain, velocity, exact.time[-1], method.name, 1.0 / STEPS_A_SECOND, exact.time)
    onset = 1.0 if "gear" in case else 1.0 + min(contact.exponent for contact in chain.contact)
    bound = 10.0 * STEPS_A_SECOND ** -min(method.order, onset)  # forces and masses are near 1
    assert np.abs(found.velocity - exact.velocity).max() < bound
    assert np.abs(found.position - exact.position).max() < bound
    assert np.abs(found.final_velocity - exact.final_velocity).max() < bound


@pytest.mark.slow
@pytest.mark.parametrize("case", CHAINS)
def test_adaptive_methods_agree_with_it(case):
    """All of them beside one run of the reference, with samples also where each of them says that contacts switch."""
    chain, velocity, duration = CHAINS[case]
    speed = np.ptp(velocity)
    duration = duration or 1.1 * simulate(chain, velocity, None, "scipy", samples=2).time[-1]
    times = np.linspace(0.0, duration, 33)
    runs = [simulate(chain, velocity, duration, method.name, samples=times, tolerance=1e-7) for method in ADAPTIVE]
    switches = [switches_of(found) for found in runs]
    every = np.unique(np.concatenate((times, *([time for time, _ in those] for those in switches))))
    exact = simulate(chain, velocity, duration, "scipy", samples=every, tolerance=1e-10)
    rows = np.searchsorted(every, times)
    for found, those in zip(runs, switches, strict=True):
        assert np.abs(found.final_velocity - exact.final_velocity).max() < 1e-6 * speed
        # within a second or third collision a sample also has the error of when it began: displacement over closing speed
        assert np.abs(found.velocity - exact.velocity[rows]).max() < 3e-6 * speed
        assert np.abs(found.overlap - exact.overlap[rows]).max() < 1e-5
        assert [len(pairs) for pairs in found.contact_intervals] == [len(pairs) for pairs in exact.contact_intervals]
        # not by time: beads that part slowly, or push each other through others that do, touch at no sharp time
        for time, contact in those:
            overlap = exact.overlap[np.searchsorted(every, time), contact]
            assert abs(overlap) <= 1e-6 * speed * time + 1e-12


def switches_of(found):
    """(time, contact) of every closing and opening."""
    each = ((time, i) for i, pairs in enumerate(found.contact_intervals) for pair in pairs for time in pair)
    return sorted(switch for switch in each if switch[0] < math.inf)


def test_touching_contacts_carry_a_multiplier():
    """One on three gears below the critical speed: inner overlaps exactly 0, forces those of a rigid cluster."""
    truth = GEARS[0]
    found = simulate(truth.chain, truth.start, method="scipy", samples=truth.time)
    assert (found.overlap[:, 1:] == 0.0).all()
    assert (found.rate[:, 1:] == 0.0).all()
    assert found.force[:, 1:] == pytest.approx(found.force[:, :1] * [2 / 3, 1 / 3], rel=1e-12)
    assert found.contact_intervals[1:] == (found.contact_intervals[0],) * 2  # they push exactly as long as it does


def test_beads_at_rest_stay_at_rest():
    found = simulate(Chain([1, 1, 1, 1], GEAR, [0, 0.5, 0]), [0, 0, 0, 0], 1.0, "scipy", samples=3)
    assert not found.velocity.any()
    assert found.contact_intervals == ((), (), ())


def test_running_out_of_phases_is_a_value(monkeypatch):
    monkeypatch.setattr(softcradle.physics.reference.scipy_runner, "MOST_PHASES", 3)
    with pytest.warns(RuntimeWarning, match=r"scipy gave up at t = .* 3 changes of contacts"):
        found = simulate(cluster_on_cluster(2, 3, hertz(1.0)), [1, 1, 0, 0, 0], method="scipy")
    assert len(found.warnings) == 1
    assert np.isfinite(found.velocity).all()


def test_running_out_of_evaluations_is_a_value(monkeypatch):
    monkeypatch.setattr("softcradle.physics.reference.phases.MOST_EVALUATIONS", 100)
    with pytest.warns(RuntimeWarning, match=r"scipy gave up at t = 6\..*e-15 s after 101 evaluations"):
        found = simulate(one_on(2, hertz(1.0)), [1, 0, 0], method="scipy")
    assert found.final_velocity == pytest.approx([1, 0, 0], abs=1e-12)


def test_two_walls_hold_a_bead_between_them():
    """Statically indeterminate: the bead stays, whatever the two multipliers."""
    chain = Chain([math.inf, 1.0, math.inf], draft_gear(1.0, 1.0))
    found = simulate(chain, [0, 0, 0], 1.0, "scipy", samples=3)
    assert not found.velocity.any()


@pytest.mark.parametrize("method", NAMES)
def test_scales_of_length_and_time_do_not_matter(method):
    """Grains of micrometres that touch for microseconds move as their image in metres and seconds."""
    length, time = 1e-6, 1e-7
    large = simulate(one_on(3, hertz(1.0)), [1, 0, 0, 0], 4.0, method, samples=5)
    stiffness = 1.0 / (time**2 * math.sqrt(length))
    small = simulate(one_on(3, hertz(stiffness)), [length / time, 0, 0, 0], 4.0 * time, method, samples=5)
    assert small.velocity * time / length == pytest.approx(large.velocity, abs=1e-8)
    assert small.overlap / length == pytest.approx(large.overlap, abs=1e-8)


def threads() -> set[int]:
    """Of all copies of BLAS in this process."""
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


def test_dense_solves_run_on_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: set[int] = set()
    solved = stage_equations.solved

    def watched(*arguments: object) -> object:
        seen.update(threads())
        return solved(*arguments)

    monkeypatch.setattr(stage_equations, "solved", watched)
    with threadpool_limits(limits=2, user_api="blas"):
        before = threads()
        found = simulate(
            Chain([1.0] * 3, hertz(1.0, loss=0.1)), [1.0, 0.0, 0.0], method="scipy", tolerance=1e-4, samples=2
        )
        assert threads() == before
    assert seen == {1}
    assert np.isfinite(found.final_velocity).all()


def test_threads_come_back_when_the_last_run_is_over() -> None:
    """Runs of an ensemble overlap: the first to end gave threads back to the others, and their last digits changed."""
    with threadpool_limits(limits=2, user_api="blas"):
        before = threads()
        first, second = one_thread(), one_thread()
        first.__enter__()
        second.__enter__()
        first.__exit__(None, None, None)
        assert threads() == {1}
        second.__exit__(None, None, None)
        assert threads() == before
