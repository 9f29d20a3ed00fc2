"""The application: help, sizes and scales, the end of the loop."""

from __future__ import annotations

import pygame
import pytest
from softcradle.sandbox.window.display import SMALLEST

from tests.helpers.windows import Driver

CTRL = pygame.KMOD_CTRL
pytestmark = pytest.mark.usefixtures("own_folder")


def test_help_covers_the_page_and_is_closed_by_a_key(driver: Driver) -> None:
    driver.key(pygame.K_F1)
    assert driver.app.help
    driver.key(pygame.K_SPACE)
    assert not driver.session.playing
    driver.key(pygame.K_ESCAPE)
    assert not driver.app.help


def test_the_window_is_resized_and_scaled_and_its_panel_hidden(driver: Driver) -> None:
    for size in ((1000, 600), (1920, 1080), (800, 480), (1280, 720)):
        pygame.display.set_mode(size, pygame.RESIZABLE)
        pygame.event.post(pygame.Event(pygame.VIDEORESIZE, size=size, w=size[0], h=size[1]))
        driver.frames(3)
        assert driver.app.size == size
    pygame.display.set_mode((300, 200), pygame.RESIZABLE)
    pygame.event.post(pygame.Event(pygame.VIDEORESIZE, size=(300, 200), w=300, h=200))
    driver.frames(3)
    assert driver.app.size == SMALLEST
    for key in (pygame.K_EQUALS, pygame.K_EQUALS, pygame.K_MINUS, pygame.K_0):
        driver.key(key, CTRL)
    assert driver.app.scale == 1.0
    wide = driver.page.view.places.lanes[0].width
    driver.key(pygame.K_i)
    assert driver.page.view.places.lanes[0].width > wide


def test_quitting_ends_the_loop(driver: Driver) -> None:
    pygame.event.post(pygame.Event(pygame.QUIT))
    driver.app.run()
    assert not driver.app.running


def test_a_message_takes_the_place_of_one_on_the_same_subject(driver):
    for _ in range(3):
        driver.key(pygame.K_EQUALS, CTRL)
    assert driver.messages == ["scale 144 %: there is no room for more in this window"]
    driver.key(pygame.K_0, CTRL)
    assert driver.messages == ["scale 100 %"]
