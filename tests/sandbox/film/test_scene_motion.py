"""The motion of a scene for a film: how often it is computed, and its rows."""

from __future__ import annotations

import numpy as np
import pytest
from softcradle.physics.simulation import solve
from softcradle.sandbox.film import scene_motion
from softcradle.sandbox.film.kymograph import render_kymograph
from softcradle.sandbox.film.scene_motion import AFTER, LEAD, motion_end, scene_motions
from softcradle.sandbox.page.recorded_scene import recorded
from softcradle.scenes import Scene, parse

LANES = """
[[lanes]]
beads = [1, 3]
contact = {law = "power_law", f0 = 1.0, alpha = 0.25}
velocity = 1.0
[[lanes]]
beads = [1, 3]
contact = {law = "hertz", stiffness = 30.0}
velocity = 1.0
"""
ENDLESS = parse(f'title = "Two lanes"\n{LANES}')
TIMED = parse(f'title = "Two lanes"\nduration = 2.0\n{LANES}')


@pytest.fixture
def runs(monkeypatch):
    """The settings of every lane that is computed."""
    found = []

    def counted(*arguments, **settings):
        found.append(settings)
        return solve(*arguments, **settings)

    monkeypatch.setattr(scene_motion, "solve", counted)
    return found


def test_lanes_with_a_duration_are_computed_once(runs):
    scene_motions(TIMED, 20.0)
    assert len(runs) == 2


def test_the_end_of_a_motion_is_looked_for_once(runs, tmp_path):
    render_kymograph(ENDLESS, str(tmp_path / "x.kymograph.png"), (320, 180))
    assert [settings.get("duration") is None for settings in runs] == [True, True, False, False]


def test_an_end_that_is_known_gives_the_same_rows():
    for one, other in zip(
        scene_motions(ENDLESS, 20.0), scene_motions(ENDLESS, 20.0, end=motion_end(ENDLESS)), strict=True
    ):
        assert (one.time == other.time).all()
        assert (one.overlap == other.overlap).all()


@pytest.mark.parametrize("scene", [ENDLESS, TIMED], ids=["endless", "timed"])
def test_rows_cover_the_motion_and_free_flight(scene: Scene):
    end = motion_end(scene)
    first, second = scene_motions(scene, 20.0)
    assert (first.time == second.time).all()
    assert np.diff(first.time) == pytest.approx(0.05)
    assert 0.0 in first.time
    after = AFTER * end if scene.duration is None else 0.0
    assert first.time[0] == pytest.approx(-LEAD * end, abs=0.05)
    assert first.time[-1] == pytest.approx(end + after, abs=0.05)


def test_a_film_ends_before_a_pause_that_no_one_waits_for():
    """Remnants of a collision by explicit steps approach each other a million times slower than the beads that collided."""
    scene = parse(
        'title = "Remnants"\n[[lanes]]\nmass = [1, 1, 1]\ngap = [0.7, 0.3]\nvelocity = [1, 0, 0]\n'
        'contact = {law = "hooke", stiffness = 1e3}'
    )
    with pytest.warns(RuntimeWarning, match=r"shown up to t = .* slow beads would meet again at t = .*e\+0"):
        end = motion_end(scene, "verlet", 1 / 500)
    usual = motion_end(scene)
    assert 0.5 * usual < end < 2.0 * usual
    with pytest.warns(RuntimeWarning, match="slow beads would meet again"):
        (page,) = recorded(scene, method="verlet", step=1 / 500)
    assert page.time[-1] == end


def test_beads_that_are_far_apart_have_all_the_time_that_they_need():
    far = parse(
        'title = "Far apart"\n[[lanes]]\nmass = [1, 1, 1]\ngap = [0, 50]\nvelocity = [1, 0, 0]\n'
        'contact = {law = "hertz", stiffness = 1e6}'
    )
    end = motion_end(far)
    assert end > 50.0
    assert scene_motions(far, 1.0)[0].time[-1] > 50.0
