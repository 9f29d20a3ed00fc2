"""The cards of the lanes: the menu of methods, and the badge."""

from __future__ import annotations

import pygame
import pytest
from softcradle.sandbox.draw.palette import tones
from softcradle.sandbox.session.inputs import SetStep

from tests.helpers.windows import Driver

pytestmark = pytest.mark.usefixtures("own_folder")


def test_the_menu_switches_the_method_while_running(driver: Driver) -> None:
    menu = driver.page.cards.menus[0]
    driver.key(pygame.K_SPACE)
    driver.click(menu.rect.center)
    driver.frames(3)
    options = menu.menu_states["expanded"].options_selection_list
    item = next(one for one in options.item_list_container.elements if one.text == "euler")
    driver.click(item.rect.center)
    driver.frames(5)
    assert driver.session.lanes[0].setup.method == "euler"


def test_the_badge_is_red_when_the_method_is_past_its_limit() -> None:
    driver = Driver("draft-gear-one-on-three")
    for key in (pygame.K_m, pygame.K_EQUALS, pygame.K_EQUALS, pygame.K_EQUALS):
        driver.key(key)
    driver.session.apply(SetStep(None, 0.01))
    driver.key(pygame.K_SPACE)
    driver.frames(60)
    health = driver.page.cards.health[0]
    assert driver.session.lanes[0].setup.method == "euler"
    assert health.level == "bad"
    card = driver.page.cards.rects[0]
    assert driver.app.surface.get_at((card.centerx, card.top))[:3] == tones.bad
    driver.close()
