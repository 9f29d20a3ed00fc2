"""Tests of the hanging cradle: its energy, its motion, its texts and its page."""

import pygame
import pytest
from softcradle.sandbox.draw.palette import bead_colours
from softcradle.sandbox.window.hanging.cradle import FRAME, LAWS, RATES, HangingModel
from softcradle.sandbox.window.hanging.page import to_screen

from tests.helpers.windows import Driver


def advance(model: HangingModel, seconds: float) -> None:
    for _ in range(round(seconds / FRAME)):
        model.advance()


def test_soft_balls_swing_off_nearly_as_one_body():
    """Check the velocities after the first impact: four soft balls move together. With steel balls, only the last one
    moves.
    """
    spreads = {}
    for law in LAWS:
        model = HangingModel(law)
        (cradle, _), before = model.cradles, model.cradles[0].energy()
        advance(model, 0.95)
        speeds = [ball.velocity.x for ball in cradle.balls[1:]]
        spreads[law] = max(speeds) - min(speeds)
        advance(model, 5.05)
        assert 0.9 * before < cradle.energy() < 1.02 * before, law
    assert spreads["soft, alpha 1/14"] < 0.5 * spreads["steel balls (Hertz)"]


def test_the_hanging_page_works_by_mouse_menus_and_keys():
    driver = Driver("hanging-cradle")
    page, pixels = driver.app.page, pygame.surfarray.array3d(driver.app.surface).astype(int)
    for number, (place, colour) in enumerate(zip(page.model.cradles[0].places(), bead_colours(5), strict=True)):
        x, y = map(round, to_screen(page.pictures[0], place))
        # The number on a bead is light on dark or dark on light, so some pixels differ from the colour of the bead.
        assert (abs(pixels[x - 7 : x + 7, y - 7 : y + 7] - colour).sum(axis=2) > 150).any(), number
    driver.run(30)
    assert page.model.time > 0.4
    ball = to_screen(page.pictures[1], page.model.cradles[1].places()[4])
    driver.drag(ball, (ball[0] + 60, ball[1] - 40), steps=10)
    driver.frames(20)
    assert page.model.cradles[1].places()[4][0] > 0.9
    driver.release(ball)
    driver.key(pygame.K_MINUS)
    assert page.time_controls.slow == 2.0
    driver.key(pygame.K_F7)  # This menu has no items on this page.
    assert driver.app.dialog is None
    driver.key(pygame.K_PERIOD)
    assert not page.playing
    driver.key(pygame.K_r)
    assert page.model.time < 0.1
    for field, text in (("rate", "960"), ("lifted", "2"), ("law", "draft gear")):
        driver.choose(page.menus[field], text)
    assert (page.model.rate, page.model.lifted, page.model.law) == (960, 2, "draft gear")
    driver.key(pygame.K_ESCAPE)
    assert driver.app.page is driver.app.gallery


def test_the_verdict_of_the_cradle_follows_its_energy():
    kept, lost = HangingModel("steel balls (Hertz)"), HangingModel("steel balls (Hertz)", rate=60)
    for model in (kept, lost):
        advance(model, 4.0)
    found, other = kept.cradles[0].verdict(), lost.cradles[0].verdict()
    assert found.level == "good"
    assert f"{100 * abs(found.change):.2g} %" in found.sentence
    assert abs(other.change) > abs(found.change)
    assert other.level != "good"
    assert "more steps" in other.sentence


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("law", LAWS)
def test_the_first_choice_of_steps_resolves_blows_and_the_verdict_reports_longer_steps(law: str) -> None:
    resolved, coarse = HangingModel(law), HangingModel(law, rate=60)
    for model in (resolved, coarse):
        advance(model, 2.0)
    assert resolved.cradles[0].verdict().level == "good"
    needed = coarse.cradles[0].missing_rate()
    assert needed > 60
    finer = HangingModel(law, rate=next(rate for rate in RATES if rate >= needed))
    advance(finer, 2.0)
    assert not finer.cradles[0].missing_rate()


def test_balls_that_passed_each_other_are_a_fault():
    model = HangingModel("soft, alpha 1/14")
    advance(model, 0.1)
    assert model.cradles[0].verdict().level == "good"
    for _ in range(60):
        model.hold(0, 4, (-0.6, -0.5))
        model.advance()
    copied = model.copy()
    model.release()
    model = model.copy()  # The copy starts without the memory of the joints, like the other copy.
    for one in (model, copied):
        advance(one, 0.5)
    assert state(copied) == state(model)
    assert model.cradles[0].verdict().level == "bad"
    assert "passed through each other" in model.cradles[0].verdict().sentence
    model.restart()
    assert model.cradles[0].verdict().level == "good"


def state(model: HangingModel) -> list[object]:
    moving = [[(*ball.position, *ball.velocity) for ball in cradle.balls] for cradle in model.cradles]
    return [model.time, model.law, moving, [cradle.energy() for cradle in model.cradles]]


def test_actions_on_the_hanging_page_are_undone_exactly():
    driver = Driver("hanging-cradle")
    page = driver.app.page
    driver.play(70)
    before, expected = state(page.model), page.model.copy()
    advance(expected, 0.5)
    ball = to_screen(page.pictures[0], page.model.cradles[0].places()[4])
    driver.click(ball)  # The click moves nothing, so it is not an undo step.
    driver.pull(ball, (ball[0] + 60, ball[1] - 40), steps=5)
    driver.frames(20)
    driver.key(pygame.K_SPACE)
    driver.key(pygame.K_r, times=2)  # The second press changes nothing, so it is not an undo step.
    driver.choose(page.menus["law"], "draft gear")
    for _ in range(3):
        assert state(page.model) != before
        driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert state(page.model) == before
    advance(page.model, 0.5)
    assert state(page.model) == state(expected)
    assert page.menus["law"].selected_option[0] == "steel balls (Hertz)"
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert driver.messages == ["nothing to undo"]


def test_the_fastest_motion_stays_within_the_frame_budget():
    driver = Driver("hanging-cradle")
    page = driver.app.page
    advance = page.model.advance

    def slow_frame() -> bool:
        driver.time += 0.004
        return advance()

    page.model.advance = slow_frame
    page.time_controls.set_slow(0.01)
    driver.run(0)
    before = page.model.time
    driver.frames(10)
    assert round((page.model.time - before) / FRAME) == 10 * 2, "a third one does not fit into the budget"
    assert any(one.text.startswith("slower than shown:") for one in driver.texts())
