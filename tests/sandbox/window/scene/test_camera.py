"""The camera: beads stay in sight, the wheel zooms about the pointer, a drag pans, and the clock stops at the end."""

import pygame
import pytest
from softcradle.sandbox.session.inputs import SetVelocity

from tests.helpers.windows import Driver


def in_sight(driver: Driver) -> bool:
    lane = driver.page.view.lanes[0]
    rect = lane.drawing.rect
    return bool((lane.edges >= rect.left).all() and (lane.edges + lane.drawing.bead <= rect.right + 1).all())


def test_beads_stay_in_sight_by_themselves(driver: Driver) -> None:
    driver.page.clock.end.toggle()
    driver.session.apply(SetVelocity(0, 0, 4.0))
    driver.key(pygame.K_SPACE)
    for _ in range(20):
        driver.frames(30)
        assert in_sight(driver)
    assert driver.session.time > 4.0


def test_wheel_and_drag_take_the_view_and_fit_gives_it_back(driver: Driver) -> None:
    rect = driver.page.view.lanes[0].drawing.rect
    point = (rect.left + rect.width // 4, rect.top + 30)
    driver.frames(2)
    place = driver.page.view.metres_at(point)
    slow = driver.session.slow
    for turn in (-1, -1, -1, 1):
        driver.wheel(point, turn)
        assert driver.page.view.metres_at(point) == pytest.approx(place, abs=1e-6)
    assert driver.session.slow == slow
    before = float(driver.page.view.lanes[0].edges[0])
    driver.pull(point, (point[0] + 2 * rect.width, point[1]))
    assert driver.page.view.lanes[0].edges[0] == pytest.approx(before + 2 * rect.width, abs=3)
    assert not in_sight(driver)
    driver.click(driver.page.time_controls.buttons["fit"].rect.center)
    assert in_sight(driver)


def test_the_clock_pauses_once_when_the_beads_are_apart_and_a_card_says_what_happened(driver: Driver) -> None:
    driver.play_to_the_end()
    state, length = driver.session.lanes[0].state, driver.session.scene.view.length
    assert (state.overlap < 0.0).all()
    assert state.overlap.min() <= -2.0 * length
    card = driver.page.outcome
    assert "Beads 2 to 4 go together to the right" in card.text
    assert list(card.buttons) == ["Why? The forces", "Now with steel balls", "Close"]
    assert not driver.messages
    stopped = driver.session.time
    driver.run(100)
    assert driver.session.playing
    assert driver.session.time > stopped
    assert not card.text


def test_the_card_goes_to_the_greatest_force_and_to_steel_balls(driver: Driver) -> None:
    driver.play_to_the_end()
    driver.click(driver.page.outcome.buttons["Why? The forces"].rect.center)
    assert "one rigid body" in driver.page.outcome.text
    assert driver.session.lanes[0].state.force.max() > 0.9
    driver.click(driver.page.outcome.buttons["Close"].rect.center)
    assert not driver.page.outcome.buttons
    driver.page.outcome.show_outcome()
    page = driver.page
    driver.key(pygame.K_ESCAPE)  # closes the card, not the page
    assert not page.outcome.text
    assert driver.app.page is page
    page.outcome.show_outcome()
    driver.frames(1)
    driver.click(driver.page.outcome.buttons["Now with steel balls"].rect.center)
    soft, steel = driver.session.lanes
    assert [law.exponent for law in steel.chain.contact] == [1.5] * 4
    assert driver.session.label(1) == "steel balls"
    assert soft.chain.contact[0].exponent == 0.1
    assert driver.session.playing
