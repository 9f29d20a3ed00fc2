"""Tests of the tools of the scene page: arrows, tables of values, sharing, comparison, stopwatch and ruler.

The tests also check that the menus of the tools can be used with keys.
"""

import pygame
import pytest
from softcradle.sandbox.draw.lane_drawing import ARROWS
from softcradle.sandbox.session.inputs import SetMass
from softcradle.sandbox.window.scene.editor import Pick
from softcradle.sandbox.window.scene.toolbar import MENUS
from softcradle.sandbox.window.scene.values_board import MOST_DIGITS, table_places

from tests.helpers.drawn_text import colliding
from tests.helpers.windows import Driver

CTRL = pygame.KMOD_CTRL


def test_arrows_show_what_is_chosen(driver: Driver) -> None:
    driver.play(260)
    seen = {}
    for name in ARROWS:
        lane = driver.page.view.lanes[0]
        assert lane.drawing.arrows == name
        shares = ARROWS[name](driver.page.view.motions[0], 0, lane.scales)
        assert (abs(shares) <= 1.0).all()
        seen[name] = shares
        driver.key(pygame.K_v)
    force = driver.session.lanes[0].state.force
    assert seen["net force"][0] < 0.0 < seen["net force"][4]
    assert seen["net force"][4] == pytest.approx(force[3] / lane.scales.force)
    assert not seen["none"].any()


def test_values_and_outcome_are_shown_and_copied(driver: Driver) -> None:
    driver.key(pygame.K_t)
    beads, contacts = driver.page.tools.values.places
    assert (beads.kind, beads.count, contacts.kind, contacts.count) == ("bead", 5, "contact", 4)
    assert beads.whole
    assert contacts.whole
    assert (len(beads.columns.shown), beads.columns.digits) == (len(beads.names), MOST_DIGITS)
    driver.key(pygame.K_c)
    table = [line.split(",") for line in pygame.scrap.get_text().splitlines()]
    assert table[0] == ["time (s)", "0.0"]
    assert table[2][:3] == ["alpha = 1/10", "0", "1.0"]
    # The fifth cell of a row contains the velocity [m/s] of a bead, which is the striker in this row.
    assert float(table[2][4]) == 1.0
    assert len(table) == 1 + 6 + 5
    driver.key(pygame.K_w)
    assert "Bead 0 moves right at 1\N{NO-BREAK SPACE}m/s." in driver.app.dialog.note
    driver.key(pygame.K_LEFT)
    driver.key(pygame.K_RETURN)
    assert pygame.scrap.get_text().startswith("At 0\N{NO-BREAK SPACE}s.")
    # The table of values replaces the plots. If the plots are hidden, the table cannot be shown.
    for key in (pygame.K_b, pygame.K_t, pygame.K_t):
        driver.key(key)


def test_a_table_that_does_not_fit_leaves_out_the_other(driver: Driver) -> None:
    lanes, wide, narrow = driver.session.lanes, pygame.Rect(0, 0, 700, 200), pygame.Rect(0, 0, 350, 200)
    for area, pick, kinds in (
        (wide, None, ["bead", "contact"]),
        (narrow, None, ["bead"]),
        (narrow, Pick(0, "bead", 1), ["bead"]),
        (narrow, Pick(0, "contact", 1), ["contact"]),
    ):
        places = table_places(lanes, area, 1.0, {}, pick)
        assert [place.kind for place in places] == kinds
        assert all(place.fits and area.contains(place.rect) for place in places)


def test_a_scene_is_copied_as_text_and_pasted(driver: Driver) -> None:
    driver.session.apply(SetMass(0, 1, 2.5))
    driver.key(pygame.K_c, CTRL)
    assert pygame.scrap.get_text().startswith("softcradle:")
    driver.session.undo()
    driver.key(pygame.K_v, CTRL)
    assert driver.session.lanes[0].chain.mass[1] == 2.5
    page = driver.app.page
    pygame.scrap.put_text(pygame.scrap.get_text()[:-20])
    driver.key(pygame.K_v, CTRL)
    assert driver.app.page is page
    assert any("not a whole scene" in text for text in driver.messages)
    pygame.scrap.put_text(" ")
    driver.key(pygame.K_v, CTRL)
    driver.app.open("")  # An empty name is opened if the user confirms an empty input.
    assert [text[:22] for text in driver.messages[-2:]] == ["the clipboard is empty", "unknown scene '' (soft"]


def test_a_scene_is_compared_with_an_edited_copy(driver: Driver) -> None:
    driver.key(pygame.K_d, CTRL)
    assert [lane.chain for lane in driver.session.lanes] == [driver.session.lanes[0].chain] * 2
    assert not driver.page.unsaved
    assert "One bead on four, compared" in [one.text for one in driver.texts()]
    driver.session.apply(SetMass(1, 1, 3.0))
    driver.run(60)
    assert driver.session.lanes[0].chain.mass[1] == 1.0
    driver.session.apply(SetMass(0, 2, 3.0))
    driver.key(pygame.K_d, CTRL)  # With two rows of beads, this key compares the first row with a copy.
    # The button discards the edits of the second row.
    driver.click(driver.app.dialog.buttons["Don't save"].rect.center)
    assert "• One bead on four, compared" in [one.text for one in driver.texts()]
    assert [driver.session.label(k) for k in (0, 1)] == ["alpha = 1/10, edited", "alpha = 1/10, edited, the other"]
    assert driver.session.lanes[1].chain.mass == (1.0, 1.0, 3.0, 1.0, 1.0)
    assert driver.page.unsaved


@pytest.mark.parametrize("action", ["compare", "alone", "compare_balls"])
def test_edits_of_a_row_that_would_go_are_asked_for(action: str) -> None:
    driver = Driver("beads-against-gear")
    page = driver.page
    driver.session.apply(SetMass(1, 1, 7.0))
    driver.app.act(action)
    assert driver.app.dialog.title == "Save your changes?"
    driver.key(pygame.K_ESCAPE)  # Escape closes the question and keeps the current page.
    assert driver.app.page is page
    assert driver.session.lanes[1].chain.mass[1] == 7.0
    driver.page.dialogs.save("save_scene", "mine")
    driver.session.undo()
    driver.session.apply(SetMass(0, 1, 7.0))  # The first row of beads is kept, so this edit is not lost.
    driver.app.act(action)
    assert driver.app.page is not page
    assert driver.session.lanes[0].chain.mass[1] == 7.0
    assert driver.session.playing == (action == "compare_balls")


def test_masses_of_two_low_rows_do_not_lie_on_each_other() -> None:
    driver = Driver("mixed", (800, 600))
    assert any(one.text == "0.8 kg" for one in driver.texts())
    driver.key(pygame.K_d, CTRL)
    assert not colliding(driver.texts())


def test_the_catalogue_text_is_shown_only_for_the_unchanged_scene() -> None:
    for edited in (False, True):
        page = Driver("one-on-four")
        if edited:
            page.session.apply(SetMass(0, 1, 3.0))
        page.app.act("compare")
        page.app.act("alone")
        scene = page.session.scene
        assert (scene.title, scene.text != "", scene.source != "") == ("One bead on four", not edited, not edited)
        page.close()
    page = Driver("locked-pistons")
    for action, lanes in (("compare", 2), ("alone", 1)):
        page.app.act(action)
        assert (len(page.session.lanes), page.session.scene.text, page.session.scene.source) == (lanes, "", "")
        assert "About this scene" not in [one.text for one in page.texts()], "nothing is said"


def test_stopwatch_and_ruler_measure() -> None:
    driver = Driver("steel-and-soft", size=(1280, 800))
    watch, ruler = driver.page.tools.stopwatch, driver.page.tools.ruler
    driver.key(pygame.K_k)
    # The stopwatch has the same unit as the clock from the beginning.
    assert "stopwatch 0.000 s (running)" in [one.text for one in driver.texts()]
    driver.run(30)
    driver.key(pygame.K_k)
    elapsed = watch.elapsed
    driver.frames(10)
    assert watch.elapsed == elapsed
    assert 0.0 < elapsed < driver.session.time
    driver.key(pygame.K_k)
    assert watch.elapsed is None
    driver.session.step_frames(210)
    driver.key(pygame.K_u)
    first, last = ruler.points()
    line = pygame.Rect(first, (last[0] - first[0], 1))
    assert not [one.text for one in driver.texts() if one.rect.colliderect(line)]
    driver.pull(first, (last[0], first[1] + 5))
    assert ruler.distance == pytest.approx(0.0, abs=0.02)
    driver.key(pygame.K_u)
    assert ruler.ends is None


@pytest.mark.parametrize("menu", MENUS)
def test_a_menu_does_its_actions_by_keys_and_clicks(driver: Driver, menu: str) -> None:
    left = ("compare", "compare_balls", "copy_values", "copy_scene", "sound")
    for k, name in enumerate(MENUS[menu]):
        driver.click(driver.page.toolbar.buttons[menu].rect.center)
        driver.key(pygame.K_DOWN, times=k)
        shown = driver.app.dialog
        assert shown.names[shown.focus] == name
        driver.key(pygame.K_ESCAPE if name in left else pygame.K_RETURN)
        assert not shown.open
        if driver.app.dialog.open:
            driver.app.dialog.close()


def test_a_menu_marks_what_is_shown_and_is_clicked(driver: Driver) -> None:
    driver.key(pygame.K_3)  # The key 3 hides the plot of overlaps.
    driver.app.act("plots_menu")
    marked = [button.text.split("  ")[1] for button in driver.app.dialog.buttons if button.text.startswith("✓")]
    assert marked == ["velocities", "forces"]
    driver.click(driver.app.dialog.buttons[MENUS["plots_menu"].index("forces")].rect.center)
    assert not driver.app.dialog.open
    assert driver.page.board.shown == ["velocities"]


def test_rows_are_selected_and_scrolled_to() -> None:
    driver = Driver("one-on-ten")
    driver.key(pygame.K_t)
    driver.app.scale = 1.5
    driver.frames(2)
    values = driver.page.tools.values
    place = values.places[0]
    assert not place.whole
    # Click on the heading of the table, which must not select a bead.
    driver.click((place.rect.centerx, place.rect.top + 2))
    assert driver.page.editor.selection is None
    driver.click(place.strip(1).center)
    assert driver.page.editor.selection == Pick(0, "bead", 1)
    driver.wheel(place.rect.center, -9)
    assert values.places[0].last == 11
    driver.key(pygame.K_LEFT, times=2)  # Selecting another bead scrolls the table to this bead.
    assert values.places[0].first == 0
