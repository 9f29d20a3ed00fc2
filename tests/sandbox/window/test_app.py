"""Tests of the application: its help, window sizes, text scales, messages, colour themes and settings.

The tests also check how the main loop ends.
"""

import io
import locale
import os
import textwrap
from functools import partial
from unittest.mock import Mock, patch

import pygame
import pytest
from pygame_gui.core.utility import translate
from pygame_gui.elements import UITooltip
from softcradle.sandbox.draw import text
from softcradle.sandbox.draw.palette import BEAD_COLOURS, DARK, THEMES, mix, text_on, use_theme
from softcradle.sandbox.session.export import shared_text
from softcradle.sandbox.session.inputs import SetMethod
from softcradle.sandbox.window.display import SMALLEST, usable_size
from softcradle.sandbox.window.messages import DONE, HINT
from softcradle.sandbox.window.settings import MOST_RECENT, Settings, settings_path

from softcradle import scenes
from tests.helpers.drawn_text import contrast
from tests.helpers.windows import FRAME, Driver, pressed

CTRL = pygame.KMOD_CTRL


def test_the_help_is_shown_scrolled_and_closed(driver: Driver) -> None:
    def shown() -> dict[str, pygame.Rect]:
        return {one.text: one.rect for one in driver.texts()}

    driver.key(pygame.K_F1)
    driver.key(pygame.K_SPACE)
    assert not driver.session.playing
    high = shown()["Keys and mouse"].height
    driver.app.scale = 1.3
    driver.app.rebuild()
    assert shown()["Keys and mouse"].height > 1.2 * high
    assert max(rect.bottom for rect in shown().values()) > driver.app.size[1]
    driver.key(pygame.K_DOWN, times=40)
    assert max(rect.bottom for rect in shown().values()) < driver.app.size[1]
    assert shown()["Keys and mouse"].bottom < 0
    driver.key(pygame.K_PAGEUP, times=40)
    assert shown()["Keys and mouse"].top > 0
    driver.key(pygame.K_ESCAPE)
    assert not driver.app.help
    pygame.event.post(pygame.Event(pygame.QUIT))
    driver.app.run()
    assert not driver.app.running


def test_a_tip_goes_when_a_menu_opens_or_its_button_is_pressed(driver: Driver) -> None:
    def tips() -> list[UITooltip]:
        return [one for one in driver.app.manager.get_root_container().elements if isinstance(one, UITooltip)]

    driver.move(driver.page.toolbar.buttons["tools"].rect.center)
    driver.frames(90)
    assert tips()
    driver.key(pygame.K_F10)
    assert driver.app.dialog.open
    assert not tips()
    driver.key(pygame.K_ESCAPE)
    driver.click(driver.page.time_controls.buttons["play_pause"].rect.center)
    # Building the widgets again imitates what happens when the outcome is shown at the end of the motion.
    driver.app.rebuild()
    driver.frames(120)
    assert not tips()


def test_the_window_is_resized_and_scaled_and_its_panel_hidden(driver: Driver) -> None:
    for size in ((800, 480), (1280, 720)):
        driver.resize(size)
        assert driver.app.size == size
    driver.key(pygame.K_F11, times=2)  # The key F11 switches to full screen and back.
    assert driver.app.size == (1280, 720)
    driver.resize((300, 200))
    assert driver.app.size == SMALLEST
    for key in (pygame.K_EQUALS, pygame.K_EQUALS, pygame.K_MINUS, pygame.K_0):
        driver.key(key, CTRL)
    assert driver.app.scale == 1.0
    assert driver.messages == ["scale 100 %"]  # A message about the scale replaces the previous one.
    wide = driver.page.view.places.lanes[0].width
    driver.key(pygame.K_i)
    assert driver.page.view.places.lanes[0].width > wide
    driver.resize((1280, 720))
    driver.key(pygame.K_EQUALS, CTRL, times=3)
    assert driver.messages == ["scale 144 %: this window is too small for a larger scale"]
    driver.close()
    assert Driver("one-on-four").app.scale == 1.5  # The settings file stores the scale.


@pytest.mark.parametrize("form", ["text", "toml", "shared", "dropped"])
def test_a_scene_is_read_from_every_source(form, monkeypatch):
    scene = scenes.load("galilean")
    text = scene.to_toml() if form == "toml" else "\n ".join(textwrap.wrap(shared_text(scene)))
    assert len(text) < 2000
    monkeypatch.setattr("sys.stdin", io.StringIO(text))
    driver = Driver(text if form == "text" else None if form == "dropped" else "-")
    if form == "dropped":
        pygame.event.post(pygame.Event(pygame.DROPTEXT, text=text))
        driver.frames(2)
    assert driver.session.scene == scene


def test_the_file_dialog_opens_without_an_installed_locale(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LC_ALL", "xx_YY")
    used = locale.setlocale(locale.LC_ALL)
    driver = Driver()
    driver.app.settings.language = "en"
    driver.app.next_language()
    driver.key(pygame.K_o, CTRL)
    driver.click(driver.app.dialog.buttons["Datei wählen ..."].rect.center)
    assert driver.app.dialog.window.cancel_button.text == "pygame-gui.Cancel"
    assert translate("pygame-gui.Cancel") == "Abbrechen"
    assert (locale.setlocale(locale.LC_ALL), os.environ["LC_ALL"]) == (used, "xx_YY")


@pytest.mark.parametrize("start", ["one-on-four", "cradle"])
@pytest.mark.parametrize(("scale", "text"), [(1.0, "short"), (1.0, "word " * 60), (2.0, "word " * 12)])
def test_messages_lie_on_neither_plots_nor_beads_nor_controls(start: str, scale: float, text: str) -> None:
    driver = Driver(start)
    driver.app.scale = scale
    for number in range(3):
        driver.app.messages.show(f"{number} {text}")
    driver.frames(2)
    page = driver.app.page
    footer = page.view.places.footer
    places = driver.app.messages._places
    assert "2 " in places[0][1].text
    for rect, _message in places[: 1 if len(text) > 100 else None]:
        assert footer.top - 60 * driver.app.unit * (len(text) > 100) <= rect.top
        assert rect.bottom <= footer.bottom
        assert not any(rect.colliderect(one.rect) for one in page.time_controls.buttons.values())


@pytest.mark.parametrize(
    ("size", "letters"), [(SMALLEST, "x"), (SMALLEST, "x "), ((850, 500), "x"), ((641, 1400), "x "), ((1280, 720), "x")]
)
def test_a_message_about_a_long_name_fits_the_window(size, letters: str) -> None:
    driver = Driver("one-on-four", size)
    driver.app.open(letters * 10_000)  # The argument imitates a pasted text that is not a scene.
    with patch.object(text, "width", Mock(wraps=text.width)) as measured:
        driver.frames(2)
    assert measured.call_count < 5000
    assert driver.messages[0].startswith("unknown scene 'x")
    ((rect, _message),) = driver.app.messages._places
    assert pygame.Rect((0, 0), size).contains(rect)


def test_widgets_and_plots_are_rebuilt_only_after_a_change(driver: Driver) -> None:
    view, session = driver.page.view, driver.session

    def made() -> tuple[int, int]:
        """Return two counters: how often the widgets were built, and how often the beads and plots were built."""
        return driver.app.widgets.version, view.drawn.version

    driver.play_to_the_end()
    driver.key(pygame.K_ESCAPE)
    begin = made()
    driver.frames(30)
    driver.click(driver.bead(2))
    session.scrub_frame(20)
    driver.frames(2)
    assert made() == begin
    for change, widgets, beads in (
        # Without the panel, the beads and plots are wider and must be built again.
        (partial(setattr, view, "panel_shown", False), 1, 1),
        (view.fit, 0, 1),
        # The edit changes the menu of methods and drops the frames after the current one.
        (partial(driver.page.editor.apply, SetMethod(0, "verlet")), 1, 1),
        (partial(setattr, view, "arrows", "momentum"), 0, 1),
        (partial(setattr, driver.app, "scale", 0.8), 1, 1),
        (partial(session.scrub_frame, 5), 1, 0),  # Frame 5 is earlier than the change of the method.
    ):
        before = made()
        change()
        driver.frames(3)
        assert made() == (before[0] + widgets, before[1] + beads), change


def test_the_page_below_a_dialog_is_dimmed(driver: Driver) -> None:
    def times() -> int:
        return sum(one.text.startswith("t = ") for one in driver.texts())

    def button() -> bytes:
        return pygame.image.tobytes(driver.page.toolbar.buttons["undo"].image, "RGB")

    driver.session.step_frames(60)
    driver.move(driver.page.board.plots[0].area.center)
    driver.frames(3)
    disabled, bright = button(), brightness(driver)
    assert times() == 2  # One time is shown at the pointer, and the other one is the clock.
    driver.key(pygame.K_w)
    assert times() == 1
    assert brightness(driver) < 0.75 * bright
    driver.app.rebuild()
    driver.frames(3)
    assert button() == disabled


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


def brightness(driver: Driver) -> float:
    return pygame.surfarray.array3d(driver.app.surface).mean()


def test_the_theme_changes_every_page_and_is_kept():
    driver = Driver()
    scenes_too = [partial(driver.app.open, name) for name in ("draft-gear-one-on-three", "cradle")]
    for show in (driver.app.show_gallery, *scenes_too):
        show()
        driver.frames(2)
        assert brightness(driver) > 190, show
        driver.key(pygame.K_F9)
        assert brightness(driver) < 80, show
        driver.key(pygame.K_F9)
    driver.key(pygame.K_F9)
    driver.close()
    assert Settings.load().theme == "dark"
    again = Driver("one-on-four")
    lane = again.page.view.lanes[0].drawing.rect
    assert again.app.surface.get_at((lane.left + 3, lane.top + 60))[:3] == DARK.lane_background
    use_theme("light")


@pytest.mark.parametrize(
    "text", ["", "[]", '{"theme": "pink", "language": "tlh"}', '{"theme": 3}', '{"recent": 7}', "7"]
)
def test_settings_that_cannot_be_read_are_the_usual_ones(text: str) -> None:
    settings_path().parent.mkdir(parents=True)
    settings_path().write_text(text)
    assert Settings.load() == Settings()


def test_a_window_saves_only_its_changed_settings(tmp_path):
    files = [tmp_path / name for name in ("one.toml", "other.toml")]
    windows = Settings.load(), Settings.load()
    windows[0].keep(theme="dark")
    for file, window in zip(files, windows, strict=True):
        file.touch()
        window.remember(file)
    assert Settings.load() == Settings(theme="dark", recent=[str(file.resolve()) for file in reversed(files)])
    assert [window.theme for window in windows] == ["dark", "light"]


def test_the_open_dialog_offers_the_files_of_before(driver: Driver, tmp_path):
    for k in range(MOST_RECENT + 2):
        driver.page.dialogs.save("save_scene", f"mine-{k}.toml")
    assert Settings.load().recent[0] == str((tmp_path / f"mine-{MOST_RECENT + 1}.toml").resolve())
    driver.key(pygame.K_o, CTRL)
    dialog = driver.app.dialog
    assert len(dialog.rows) == MOST_RECENT
    driver.key(pygame.K_DOWN, times=2)
    assert dialog.entry.get_text() == Settings.load().recent[1]
    driver.click(dialog.rows[2].rect.center)
    assert not dialog.open
    assert driver.app.settings.recent[0].endswith(f"mine-{MOST_RECENT - 1}.toml")


def test_no_widget_of_a_selection_that_is_gone_stays_behind_a_dialog(driver: Driver):
    driver.click(driver.bead(2))
    assert driver.page.inspector.controls
    # These keys clear the selection and open the dialog with the files.
    driver.app.frame(FRAME, [*pressed(pygame.K_ESCAPE), *pressed(pygame.K_o, CTRL)])
    driver.frames(2)
    assert driver.page.editor.selection is None
    at_once = pygame.surfarray.array3d(driver.app.surface)
    driver.app.dialog.close()
    driver.frames(3)
    driver.key(pygame.K_o, CTRL)
    driver.frames(3)
    assert (pygame.surfarray.array3d(driver.app.surface) == at_once).all()


@pytest.mark.parametrize(
    ("desktop", "expected"),
    [((1024, 600), (1024, 528)), ((1366, 768), (1280, 696)), ((1920, 1080), (1280, 720)), ((320, 240), (640, 400))],
)
def test_a_window_is_no_larger_than_a_desktop_shows(desktop: tuple[int, int], expected: tuple[int, int]) -> None:
    assert usable_size((1280, 720), desktop) == expected


def test_a_tick_stands_before_what_was_done_alone(driver: Driver) -> None:
    driver.key(pygame.K_y)  # The key Y has an effect only if a bead or a contact is selected.
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert [one.kind for one in driver.app.messages.visible] == [HINT, HINT]
    driver.select("bead", 1)
    driver.key(pygame.K_a)
    driver.key(pygame.K_z, pygame.KMOD_CTRL)
    assert driver.app.messages.visible[-1].kind == DONE
    assert "undid: bead added" in driver.messages
    driver.app.show_gallery()
    driver.key(pygame.K_F3)  # The gallery looks the same in both views, but the message must appear.
    assert driver.messages[-1] == "Explore: few controls"
