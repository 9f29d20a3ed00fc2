"""Tests of the table of hits. The table is compared with closed forms, with conservation laws and with other methods."""

import numpy as np
import pytest
from softcradle.physics.analysis.closed_forms import one_on_one
from softcradle.physics.analysis.hits import hits

from benchmarks import hits as benchmark
from softcradle import Chain, Coupler, TimedForce, draft_gear, hertz, hooke, one_on, power_law, simulate

LAWS = [power_law(2.0, 0.1), hertz(50.0, loss=0.36), hooke(3.0), draft_gear(4.0, 0.3, loss=0.5)]


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_one_hit_has_the_closed_form(law):
    mass, speed = (1.5, 0.7), 1.3
    reduced = mass[0] * mass[1] / sum(mass)
    stroke = one_on_one(law, reduced, speed)
    (row,) = hits(simulate(Chain(mass, law, gap=0.2), [speed, 0.0], samples=5))
    restitution = np.sqrt(1.0 - law.loss)
    assert row["contact"] == 0
    assert row["begin"] == pytest.approx(0.2 / speed, rel=1e-7)
    assert row["end"] - row["begin"] == pytest.approx(stroke.contact_time, rel=1e-6)
    assert row["closing_speed"] == pytest.approx(speed, rel=1e-7)
    assert row["largest_force"] == pytest.approx(stroke.peak_force, rel=1e-7)
    assert row["impulse"] == pytest.approx(reduced * speed * (1.0 + restitution), rel=1e-6)
    assert row["energy_lost"] == pytest.approx(0.5 * reduced * speed**2 * law.loss, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("method", ["accurate", "radau", "conserving", "verlet"])
def test_impulses_change_the_momentum_of_each_bead(method):
    chain = Chain([1.0, 0.5, 2.0, 1.0], [hertz(30.0), hooke(20.0), hertz(10.0, loss=0.3)], gap=[0.1, 0.05, 0.2])
    run = simulate(chain, [1.0, 0.0, 0.0, -0.3], method=method, samples=3)
    table = hits(run)
    passed = np.bincount(table["contact"], table["impulse"], minlength=3)
    gained = np.asarray(chain.mass) * (run.final_velocity - [1.0, 0.0, 0.0, -0.3])
    assert np.append(0.0, passed) - np.append(passed, 0.0) == pytest.approx(
        gained, abs=2e-4 if method == "verlet" else 1e-6
    )
    assert table["energy_lost"].sum() == pytest.approx(run.absorbed_by_contacts[-1], rel=1e-3)
    assert np.all(np.diff(table["begin"]) >= 0.0)


def test_the_largest_force_does_not_depend_on_the_samples():
    chain, start = one_on(4, power_law(1.0, 0.1)), [1, 0, 0, 0, 0]
    coarse, fine = (hits(simulate(chain, start, samples=count)) for count in (2, 501))
    dense = simulate(chain, start, samples=20001).force.max(axis=0)
    assert coarse["largest_force"] == pytest.approx(fine["largest_force"], rel=1e-12)
    assert coarse["largest_force"][np.argsort(coarse["contact"])] == pytest.approx(dense, rel=1e-7)


def test_the_largest_force_of_a_trajectory_is_exact():
    """Compare the largest force with the closed form. The maximum of 201 samples of the force is too small by more than
    1e-5.
    """
    law = hertz(50.0, loss=0.36)
    run = simulate(Chain([1.5, 0.7, 1.0], law, gap=[0.2, 50.0]), [1.3, 0.0, 0.0], 2.0)
    exact = one_on_one(law, 1.5 * 0.7 / 2.2, 1.3).peak_force
    assert run.largest_force == pytest.approx([exact, 0.0], rel=1e-7)
    assert run.force.max() < (1.0 - 1e-5) * exact
    gear = draft_gear(100.0, 0.01)
    pulled = simulate(Chain([1.0, 1.0], Coupler(gear, pull=gear, slack=0.02), gap=0.01), [0.0, 1.0], 0.3)
    assert pulled.largest_force[0] == pytest.approx(pulled.force.min(), rel=1e-2)
    assert pulled.largest_force[0] < 0.0


def test_random_chains_have_the_hits_of_the_reference():
    compared = [one for one in map(benchmark.compare, range(6)) if one is not None]
    report = benchmark.summary(compared)
    assert report.data["chains"] >= 5
    assert report.data["held"] == report.data["same"] == report.data["chains"]


def test_a_force_over_time_and_a_wall_are_in_the_balance():
    chain = Chain(
        [1.0, 1.0, np.inf], hooke(50.0), gap=[0.1, 0.2], forces=TimedForce(1, [0.0, 0.5, 1.0], [0.0, 2.0, 0.0])
    )
    run = simulate(chain, [1.0, 0.0, 0.0], 1.5, samples=3)
    table = hits(run)
    passed = np.bincount(table["contact"], table["impulse"], minlength=2)
    assert run.velocity[-1, 0] - 1.0 == pytest.approx(-passed[0], abs=1e-7)
    assert run.velocity[-1, 1] == pytest.approx(passed[0] - passed[1] + 1.0, abs=1e-6)


def test_a_pulling_coupler_and_a_bed():
    gear = draft_gear(100.0, 0.01)
    coupler = Chain([1.0, 1.0], Coupler(gear, pull=gear, slack=0.02), gap=0.01)
    pulled = hits(simulate(coupler, [0.0, 1.0], 0.3, samples=3))
    assert pulled["largest_force"].min() < 0.0
    bed = hits(simulate(Chain([1.0, 1.0], hertz(100.0), gap=0.1, friction=0.1), [1.0, 0.0], samples=3))
    assert bed["impulse"] == pytest.approx(np.sqrt(1.0 - 2.0 * 0.1 * 9.81 * 0.1), rel=0.05)


def test_what_cannot_be_repeated_is_refused():
    chain = one_on(2, hooke(1.0))
    with pytest.raises(ValueError, match="begin at t = 0"):
        hits(simulate(chain, [1, 0, 0], 5.0, samples=[1.0, 2.0]))
    assert len(hits(simulate(chain, [0, 0, 1], 1.0, samples=2))) == 0
