"""The cards of the lanes: the menu of methods, and the badge."""

from __future__ import annotations

import pygame
from softcradle.sandbox.draw.palette import mix, tones
from softcradle.sandbox.session.inputs import SetMass, SetMethod, SetStep
from softcradle.sandbox.session.lane_setup import setup_of

from softcradle import scenes
from tests.helpers.sessions import opened
from tests.helpers.windows import Driver

CTRL = pygame.KMOD_CTRL


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
    driver.key(pygame.K_m, pygame.KMOD_SHIFT)
    for _ in range(3):
        driver.key(pygame.K_PLUS)
    driver.session.apply(SetStep(None, 0.01))
    driver.key(pygame.K_SPACE)
    driver.frames(60)
    health = driver.page.cards.health[0]
    assert driver.session.lanes[0].setup.method == "euler"
    assert health.level == "bad"
    card = driver.page.cards.rects[0]
    assert driver.app.surface.get_at((card.centerx, card.top))[:3] == mix(tones.background, tones.bad, 0.12)


def chosen(driver: Driver) -> str:
    return driver.page.cards.menus[0].selected_option[0]


def test_the_menu_of_methods_follows_keys_undo_and_redo(driver: Driver) -> None:
    driver.key(pygame.K_m, pygame.KMOD_SHIFT)
    driver.key(pygame.K_m, pygame.KMOD_SHIFT)
    assert chosen(driver) == "verlet"
    for modifiers, name in ((CTRL, "euler"), (CTRL, "auto"), (CTRL | pygame.KMOD_SHIFT, "euler")):
        driver.key(pygame.K_z, modifiers)
        driver.frames(2)
        assert chosen(driver) == name


def test_no_badge_advises_the_method_that_failed() -> None:
    for method, advice in (("conserving", "take more slow motion"), ("euler", "take conserving or a smaller step")):
        setup = setup_of(scenes.load("one-on-four")).lanes[0].with_method(method)
        assert setup.remedy == advice
    session = opened()
    session.apply(SetMethod(None, "conserving"))
    session.apply(SetMass(0, 1, 1e-30))
    session.step_frames(400)
    assert "take conserving" not in session.health(0).sentence
