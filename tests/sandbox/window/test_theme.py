"""The themes: everything is drawn in the one that is chosen, and the next start has it too."""

import ctypes
import weakref
from unittest.mock import Mock

import numpy as np
import pygame
import pytest
from softcradle.sandbox.draw.palette import BEAD_COLOURS, DARK, THEMES, mix, text_on, use_theme
from softcradle.sandbox.window.keys import bindings
from softcradle.sandbox.window.settings import MOST_RECENT, Settings, settings_path
from softcradle.sandbox.window.theme import collect_garbage

from tests.helpers.drawn_text import contrast
from tests.helpers.windows import Driver


@pytest.mark.parametrize("name", THEMES)
def test_text_can_be_read_in_every_theme(name):
    tones = THEMES[name]
    for ground in (tones.background, tones.lane_background):
        assert contrast(tones.foreground, ground) > 7.0
        for level in ("muted", "good", "fair", "bad", "warning"):
            assert contrast(getattr(tones, level), ground) > 4.5, level
    assert contrast(tones.on_accent, tones.accent) > 4.0
    for colour in BEAD_COLOURS:
        bead = mix(colour, (255, 255, 255), tones.lift)
        assert contrast(text_on(bead), bead) > 3.0, colour


def mean_luminance(driver: Driver) -> float:
    return float(np.mean(pygame.surfarray.array3d(driver.app.surface)))


def test_the_theme_changes_every_page_and_is_kept():
    driver = Driver()
    assert driver.app.settings.theme == "light"
    for page in (None, "draft-gear-one-on-three", "hanging-cradle"):
        if page is not None:
            driver.app.open(page)
        driver.frames(2)
        assert mean_luminance(driver) > 190, page
        driver.key(pygame.K_F9)
        assert mean_luminance(driver) < 80, page
        driver.key(pygame.K_F9)
    driver.key(pygame.K_F9)
    driver.close()
    assert Settings.load().theme == "dark"
    again = Driver("one-on-four")
    assert mean_luminance(again) < 80
    lane = again.page.view.lanes[0].drawing.rect
    assert again.app.surface.get_at((lane.left + 3, lane.top + 60))[:3] == DARK.lane_background
    again.close()
    use_theme("light")


@pytest.mark.parametrize(
    "text", ["", "[]", '{"theme": "pink", "language": "tlh"}', '{"theme": 3}', '{"recent": 7}', "7"]
)
def test_settings_that_cannot_be_read_are_the_usual_ones(text: str) -> None:
    settings_path().parent.mkdir(parents=True)
    settings_path().write_text(text)
    assert Settings.load() == Settings()


def test_the_open_dialog_offers_the_files_of_before(driver: Driver, tmp_path):
    for k in range(MOST_RECENT + 2):
        driver.page.dialogs.save("save_scene", f"mine-{k}.toml")
    assert Settings.load().recent[0] == str((tmp_path / f"mine-{MOST_RECENT + 1}.toml").resolve())
    driver.key(pygame.K_o, pygame.KMOD_CTRL)
    dialog = driver.app.dialog
    assert len(dialog.rows) == MOST_RECENT
    driver.key(pygame.K_DOWN)
    driver.key(pygame.K_DOWN)
    assert dialog.entry.get_text() == Settings.load().recent[1]
    driver.click(dialog.rows[2].rect.center)
    assert not dialog.open
    assert driver.app.settings.recent[0].endswith(f"mine-{MOST_RECENT - 1}.toml")
    assert driver.session.scene.title == "One bead on four"


def test_no_widget_of_a_selection_that_is_gone_stays_behind_a_dialog(driver: Driver):
    driver.click(driver.bead(2))
    driver.frames(3)
    assert driver.page.inspector.controls
    keys = [binding.keys[0] for action in ("leave", "lesson") for binding in bindings() if binding.action == action]
    for key in keys:
        pygame.event.post(pygame.Event(pygame.KEYDOWN, key=key.code, mod=key.modifiers, unicode="", scancode=0))
    driver.frames(3)
    assert driver.page.editor.selection is None
    at_once = pygame.surfarray.array3d(driver.app.surface)
    driver.app.dialog.close()
    driver.frames(3)
    driver.app.act("lesson")
    driver.frames(3)
    assert (pygame.surfarray.array3d(driver.app.surface) == at_once).all()


@pytest.mark.parametrize("refusal", [None, OSError, AttributeError, TypeError])
def test_cycles_are_freed_also_where_the_system_cannot_trim_the_heap(refusal, monkeypatch):
    if refusal is not None:
        monkeypatch.setattr(ctypes, "CDLL", Mock(side_effect=refusal))
    one = Mock()
    one.container, left = one, weakref.ref(one)  # as widgets and containers refer to each other
    del one
    collect_garbage()
    assert left() is None
