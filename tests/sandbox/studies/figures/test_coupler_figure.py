"""What the figures of couplers show: force beyond the stop, stiffness of wagons, run-out of slack; by a second method, too."""

import numpy as np
import pytest
from softcradle.sandbox.studies.data_table import rows_where
from softcradle.sandbox.studies.figures import coupler

from softcradle import scenes, simulate

FULL = 2.54  # [m/s] at which one wagon on ten presses the first gear in by its whole travel


@pytest.fixture(scope="module")
def stops():
    table = coupler.stops()
    return {name: rows_where(table, train=number) for number, name in enumerate(coupler.TRAINS)}


def test_the_stop_multiplies_the_force_beyond_the_speed_at_which_the_gear_is_full(stops):
    endless, rigid, _ = stops.values()
    below = endless["speed"] < FULL
    np.testing.assert_allclose(rigid["force"][below], endless["force"][below], rtol=1e-6)
    slope = np.diff(rigid["force"]) / np.diff(rigid["speed"])
    assert rigid["force"][-1] > 2.3 * endless["force"][-1]
    assert slope[~below[:-1]].min() > 3.0 * slope[below[1:]].max()  # [kN] more for each m/s


def test_stiffness_of_wagons_matters_where_gears_are_solid(stops):
    """A twentieth of the force below, a sixth above: the figure says so, and so do the docs."""
    _, rigid, elastic = stops.values()
    less = 1.0 - elastic["force"] / rigid["force"]
    below = rigid["speed"] < FULL
    assert less[below].min() > 0.03
    assert less[below].max() < 0.07
    assert less[~below].min() > 0.16
    assert less[~below].max() < 0.19


def test_the_reference_finds_the_same_force_in_the_stop():
    lane = scenes.load("train-solid").lanes[0]
    chain = lane.chain()
    few = type(chain)(chain.mass[:3], chain.contact[:2], friction=chain.friction)
    times = np.linspace(0.0, 0.15, 301)
    truth = simulate(few, lane.velocity[:3], 0.15, "scipy", samples=times, tolerance=1e-7)
    found = simulate(few, lane.velocity[:3], 0.15, "conserving", samples=times, step=2e-5)
    assert truth.force.max() > 8e6
    assert np.abs(found.velocity - truth.velocity).max() < 1e-3
    assert found.force.max() == pytest.approx(truth.force.max(), rel=1e-3)


def test_wagons_start_one_after_another():
    table = coupler.starting()
    wagons = [name for name in table if name not in ("t", "locomotive")]
    starts = [table["t"][np.argmax(table[name] > 0.01)] for name in wagons]
    gaps = np.diff(starts)
    assert (gaps > 0.1).all()
    assert (gaps < 0.25).all()
    assert np.ptp([table[name][-1] for name in table if name != "t"]) < 1e-3  # in the end all have one velocity
