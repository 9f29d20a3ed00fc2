"""The application: help, sizes and scales, the end of the loop."""

from __future__ import annotations

import ast
from pathlib import Path

import pygame
import pytest
from softcradle.sandbox.window.display import SMALLEST
from softcradle.sandbox.window.keys import bindings
from softcradle.sandbox.window.plots.plot_kinds import PLOT_KINDS
from softcradle.sandbox.window.scene.toolbar import MENUS

from softcradle import scenes
from tests.helpers.paths import ROOT
from tests.helpers.windows import Driver

CTRL = pygame.KMOD_CTRL
WINDOW = ROOT / "sandbox" / "window"
SMALL = [WINDOW / "app.py", ROOT / "sandbox" / "cli" / "commands" / "play.py", *sorted(WINDOW.rglob("*_page.py"))]
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


@pytest.mark.parametrize("path", SMALL, ids=lambda path: path.name)
def test_the_window_does_not_grow_by_special_cases(path: Path) -> None:
    """Pages, tools and plots are entries of tables: neither the application nor a page knows a scene or a plot by name."""
    source = path.read_text(encoding="utf-8")
    assert len(source.splitlines()) <= 500
    tree = ast.parse(source)
    lengths = [(node.end_lineno or 0) - node.lineno for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    assert max(lengths) < 60
    words = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    assert not words & {*scenes.names(), *PLOT_KINDS}


def test_pages_plots_and_tools_are_tables() -> None:
    assert {name for names in MENUS.values() for name in names} <= {binding.action for binding in bindings()}
    assert len(PLOT_KINDS) >= 8
    assert len(SMALL) >= 5
