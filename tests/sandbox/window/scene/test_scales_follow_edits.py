"""What is shown follows edits: labels, axes and loupes, the badge with an accurate run behind, the size of the window."""

import warnings
from dataclasses import replace

import numpy as np
import pygame
import pytest
from softcradle.sandbox.film.scene_motion import scene_motions, scene_motions_quietly
from softcradle.sandbox.session.inputs import SetContact, SetVelocity
from softcradle.sandbox.user_error import GaveUpError
from softcradle.sandbox.window.plots.scales import MOST_AT_ONCE, MOST_BEHIND, motions_ahead
from softcradle.sandbox.window.scene.editor import Pick

from softcradle import scenes
from tests.helpers.sessions import EVERY_SCENE
from tests.helpers.windows import Driver


def test_axes_and_loupes_follow_another_exponent(driver: Driver) -> None:
    before = driver.page.view.scales.scales
    law = driver.session.lanes[0].chain.contact[0]
    driver.session.apply(SetContact(0, None, replace(law, exponent=0.02)))
    driver.until(lambda: driver.page.view.scales.scales.decades != before.decades)
    after = driver.page.view.scales.scales
    assert after.decades[0] < before.decades[0] - 10
    assert after.deepest[0][3] < 1e-6 * before.deepest[0][3]
    assert driver.page.view.lanes[0].drawing.label == "alpha = 1/50"


def test_the_badge_tells_the_error_of_velocities(driver: Driver) -> None:
    assert driver.page.cards.health[0].velocity_error is None
    driver.play(330)
    driver.until(lambda: driver.page.cards.health[0].velocity_error is not None)
    assert driver.page.cards.health[0].velocity_error < 1e-3


def test_the_badge_goes_to_the_fault_of_the_run() -> None:
    driver = Driver("draft-gear-one-on-three")
    for _ in range(2):
        driver.key(pygame.K_m, pygame.KMOD_SHIFT)
    driver.run(900)
    button = driver.page.cards.verdicts[0]
    assert "chattered" in button.text
    driver.click(button.rect.center)
    assert driver.session.scrubbed
    assert driver.session.frame == driver.session.findings(0)[0].first


def test_scales_of_an_edit_that_is_undone_go_with_it(driver: Driver) -> None:
    before = driver.page.view.scales.scales
    driver.play(300)
    driver.key(pygame.K_r)
    driver.page.editor.apply(SetVelocity(0, 0, -8.0))
    driver.frames(30)
    driver.until(lambda: not driver.page.view.follower.pending)
    assert driver.page.view.scales.scales.velocity[0] < -7.0
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    driver.until(lambda: driver.page.view.scales.scales == before)


def test_scales_of_a_throw_that_is_undone_go_with_it(driver: Driver) -> None:
    driver.run(240)
    before = driver.page.view.scales.scales
    centre = driver.bead(4)
    driver.drag(centre, (centre[0] - 400, centre[1]), steps=4)
    driver.frames(20)
    driver.release(centre)
    driver.frames(60)
    assert driver.page.view.scales.scales.energy > 2.0 * before.energy
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    driver.key(pygame.K_r)
    driver.until(lambda: driver.page.view.scales.scales == before)


def test_the_smallest_overlap_stays_on_its_axis_after_beads_were_removed_and_brought_back(driver: Driver) -> None:
    before = driver.page.view.scales.scales.decades
    driver.page.editor.selection = Pick(0, "bead", 4)
    driver.drag(driver.bead(4), (driver.bead(4)[0] - 120, driver.bead(4)[1]))
    driver.key(pygame.K_DELETE)
    driver.release(driver.bead(3))
    driver.page.editor.selection = Pick(0, "bead", 3)
    driver.key(pygame.K_DELETE)
    driver.frames(40)
    while driver.session.undo_stack.done:
        driver.key(pygame.K_z, pygame.KMOD_CTRL)
    driver.until(lambda: driver.page.view.scales.scales.decades == before)


def test_the_look_ahead_does_not_touch_the_warning_filters(monkeypatch):
    """It runs on a thread, and the filters are those of all threads. A film still warns of the same motion."""
    scene = scenes.load("one-on-four").model_copy(update={"method": "euler", "step": 1e-3})
    with pytest.warns(RuntimeWarning):
        of_film = scene_motions(scene, 2000.0)

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a thread used the warnings")

    for name in ("catch_warnings", "simplefilter", "filterwarnings", "warn"):
        monkeypatch.setattr(warnings, name, refuse)
    motions, sentences = scene_motions_quietly(scene, 2000.0)
    assert sentences
    assert np.array_equal(motions[0].position, of_film[0].position)
    assert motions_ahead(scene)


@pytest.mark.parametrize("name", EVERY_SCENE)
def test_the_window_sees_every_shipped_scene_ahead_at_once(name):
    assert motions_ahead(scenes.load(name), MOST_AT_ONCE)


@pytest.mark.parametrize("method", ["pymunk", "scipy", "euler"])
def test_a_run_ahead_is_none_of_a_method_in_python(method):
    """A comparison by pymunk held the window up for more than ten minutes."""
    motions = motions_ahead(scenes.load("one-on-four").model_copy(update={"method": method}), MOST_AT_ONCE)
    assert motions[0].method.split(",")[0] == ("conserving" if method in ("pymunk", "scipy") else method)


def test_a_run_ahead_that_takes_long_does_not_hold_up_the_window(driver):
    """Its scales are estimated, and follow from a thread, which gives up as well where a step was mistyped."""
    scene = scenes.load("one-on-four").model_copy(update={"method": "conserving", "step": 1e-9})
    for most in (MOST_AT_ONCE, MOST_BEHIND):
        with pytest.raises(GaveUpError):
            motions_ahead(scene, most)
    driver.page.show_scene(scene)
    assert driver.page.view.follower.pending
    slower = scenes.load("one-on-four").model_copy(update={"method": "conserving", "step": 2e-6})
    driver.page.show_scene(slower)
    assert driver.page.view.follower.pending
    driver.until(lambda: not driver.page.view.follower.pending)
    assert driver.page.view.scales.scales
