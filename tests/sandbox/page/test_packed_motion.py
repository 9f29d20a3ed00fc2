"""The packed motion: what the page plays is what was recorded."""

import re

import numpy as np
import pytest
from softcradle.physics.state import from_anchor
from softcradle.sandbox.page.data import LINE_ERROR, SAME_DEPTH, needed_rows, packed_lanes
from softcradle.sandbox.page.played_motion import played_motion
from softcradle.sandbox.page.shared_page import recorded
from softcradle.sandbox.page.svg_charts import ChartAxes, Curve, axis_range, line_chart
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.user_error import UserError
from softcradle.scenes.catalogue import parse

from softcradle import one_on, power_law, simulate
from tests.sandbox.page.conftest import unpacked

SCENES = ("one-on-four", "galilean", "draft-gear-two-on-two", "hertz-cradle", "mixed", "stiff-springs", "weak-contact")


def played(name):
    scene = load_scene(name)
    return played_motion(scene, recorded(scene))


@pytest.mark.parametrize("name", SCENES)
def test_lines_between_samples_follow_the_recorded_motion(name):
    motion = played(name)
    scales = motion.scales
    for found, packed in zip(motion.motions, packed_lanes(motion.motions, scales), strict=True):
        values = unpacked(packed, found.chain.contacts + 1, scales)
        position = from_anchor(values["overlap"], values["anchor"], found.chain.anchor)
        window, speeds = np.ptp(scales.window), np.ptp(scales.velocity)
        for read, true, error in (
            (position, found.position, LINE_ERROR * window),
            (values["velocity"], found.velocity, (LINE_ERROR + 2e-5) * speeds),
            (values["force"], found.force, (LINE_ERROR + 2e-5) * scales.force),
            (values["stored"][:, None], found.stored[:, None], LINE_ERROR * scales.energy),
        ):
            for k in range(true.shape[1]):
                apart = np.abs(np.interp(found.time, values["time"], read[:, k]) - true[:, k])
                # a jump lies between two times that are one as floats of the page
                near_jump = np.abs(found.time[:, None] - found.time[_jumps(true[:, k], error)]).min(axis=1, initial=1e9)
                assert apart[near_jump > 1e-6 * found.time[-1]].max() < 1.2 * error


def _jumps(values, error):
    return np.flatnonzero(np.abs(np.diff(values)) > 5 * error)


@pytest.mark.parametrize("name", SCENES[:4])
def test_deep_overlaps_keep_their_digits(name):
    motion = played(name)
    for found, packed in zip(motion.motions, packed_lanes(motion.motions, motion.scales), strict=True):
        values = unpacked(packed, found.chain.contacts + 1, motion.scales)
        smallest = 10.0 ** (motion.scales.decades[0] - 1)  # a decade below the axis of overlaps
        for k in range(found.chain.contacts):
            deep = found.overlap[:, k] > 1e-3 * found.overlap[:, k].max()
            lines = np.interp(found.time[deep], values["time"], values["overlap"][:, k])
            np.testing.assert_allclose(lines, found.overlap[deep, k], rtol=2 * SAME_DEPTH, atol=smallest)
        assert packed["rows"] < len(found.time) / 2


def test_free_flight_leads_to_the_start_and_follows_the_end():
    contact = 'contact = {law = "power", f0 = 1.0, alpha = 0.2}'
    scene = parse(f'title = "In touch"\n[[lanes]]\nbeads = [1, 2]\nvelocity = 1.0\n{contact}\n')
    (end,) = recorded(scene)
    (motion,) = played_motion(scene, [end]).motions
    assert motion.time[0] < 0.0
    assert (motion.velocity[0] == [1.0, 0.0, 0.0]).all()
    assert motion.time[-1] > end.time[-1]
    np.testing.assert_allclose(motion.velocity[-1], end.final_velocity, atol=1e-12)
    drift = motion.position[-1] - motion.position[-2] - motion.velocity[-1] * (motion.time[-1] - motion.time[-2])
    assert np.abs(drift).max() < 1e-12


def test_what_rests_is_at_rest():
    """A number that is 0 stays 0 however few digits are kept: no bead creeps."""
    motion = played("one-on-four")
    (packed,) = packed_lanes(motion.motions, motion.scales)
    values = unpacked(packed, 5, motion.scales)
    before = values["time"] < 0.99
    assert (values["velocity"][before, 1:] == 0.0).all()
    assert (values["force"][before] == 0.0).all()


def test_a_motion_that_needs_too_many_samples_gets_coarser_ones_or_is_refused(monkeypatch):
    motion = played("one-on-four")
    (fine,) = packed_lanes(motion.motions, motion.scales)
    monkeypatch.setattr("softcradle.sandbox.page.data.USUAL_BYTES", 8000)
    (coarse,) = packed_lanes(motion.motions, motion.scales)
    assert coarse["rows"] < fine["rows"]
    assert len(coarse["data"]) <= 8000 * 4 / 3 + 4
    monkeypatch.setattr("softcradle.sandbox.page.data.USUAL_BYTES", 400)
    monkeypatch.setattr("softcradle.sandbox.page.data.MOST_BYTES", 500)
    with pytest.raises(UserError, match="5 beads is too much for one page"):
        packed_lanes(motion.motions, motion.scales)


def test_a_trajectory_of_few_samples_is_played_as_it_is():
    scene = load_scene("one-on-four")
    found = simulate(one_on(4, power_law(1.0, 0.1)), [1, 0, 0, 0, 0], duration=1.0, samples=3)
    assert played_motion(scene, [found]).motions[0].time[-3:].tolist() == [0.0, 0.5, 1.0]


def test_thinned_curves_keep_their_jumps():
    x = np.linspace(0.0, 1.0, 20_001)
    y = np.where(x < 0.50003, 0.0, 1.0)
    axes = ChartAxes((0.0, 1.0), axis_range([y]), "x", "y")
    drawn = re.search(r'd="M([^"]+)"><title>one', line_chart("t", [Curve("one", x, y, "c0")], axes))[1]
    points = np.array([[float(v) for v in pair.split(",")] for pair in drawn.split("L")])
    assert len(points) < 600
    jump = np.flatnonzero(np.abs(np.diff(points[:, 1])) > 50.0)
    assert len(jump) == 1
    assert points[jump[0] + 1, 0] - points[jump[0], 0] < 0.2


def test_two_rows_at_one_time():
    """A force that jumps has a row before and a row after; times of both may be the same number."""
    time = np.array([0.0, 0.5, 0.5, 1.0])
    values = np.array([[0.0], [0.0], [1.0], [1.0]])
    assert needed_rows(time, values, np.full((4, 1), 1e-6)).tolist() == [0, 1, 2, 3]
