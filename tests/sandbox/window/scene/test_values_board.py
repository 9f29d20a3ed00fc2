"""The tables of values are edited in place: by clicks or by keys alone, one undo step a number, in every language."""

from __future__ import annotations

import math

import pygame
import pytest
from softcradle.sandbox.session.inputs import SetMass
from softcradle.sandbox.session.values_table import value_of
from softcradle.sandbox.window.scene.cell_editor import Cell
from softcradle.sandbox.window.scene.pick import Pick

from tests.helpers.windows import Driver

CTRL, SHIFT = pygame.KMOD_CTRL, pygame.KMOD_SHIFT
pytestmark = pytest.mark.usefixtures("own_folder")


@pytest.fixture
def table(driver: Driver) -> Driver:
    """The driver with the tables on screen."""
    driver.key(pygame.K_t)
    return driver


def cell(kind: str, index: int, column: str) -> Cell:
    return Cell(Pick(0, kind, index), column)


def place_of(driver: Driver, wanted: Cell) -> tuple[int, int]:
    return dict(driver.page.tools.values.shown())[wanted].center


def edited(driver: Driver) -> Cell | None:
    return driver.page.tools.values.cells.cell


def mass(driver: Driver, bead: int) -> float:
    return driver.session.lanes[0].chain.mass[bead]


def test_a_clicked_cell_takes_a_number_as_one_undo_step(table: Driver) -> None:
    table.click(place_of(table, cell("bead", 2, "mass (kg)")))
    assert table.page.editor.selection == Pick(0, "bead", 2)
    assert table.page.typing
    table.type("2.5")  # the old number is selected: what is typed takes its place
    assert mass(table, 2) == 1.0
    table.key(pygame.K_RETURN)
    assert mass(table, 2) == 2.5
    assert not table.page.typing
    assert len(table.session.undo_stack.done) == 1
    table.key(pygame.K_z, CTRL)
    assert mass(table, 2) == 1.0
    table.key(pygame.K_SPACE, text=" ")  # keys are keys of the window again
    assert table.session.playing


def test_escape_leaves_the_number_and_the_table(table: Driver) -> None:
    table.click(place_of(table, cell("bead", 2, "mass (kg)")))
    table.type("7")
    table.key(pygame.K_ESCAPE)
    assert edited(table) is None
    assert not table.page.typing
    assert mass(table, 2) == 1.0
    assert not table.session.undo_stack.done
    assert table.page.tools.covers_plots


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("x", "mass (kg): 'x' is not a number"),
        ("", "mass (kg): '' is not a number"),
        ("1e999", "is not a number"),
        ("-1", "every mass (inf is a wall) must be a finite number > 0"),
    ],
)
def test_a_refused_number_is_one_sentence_and_the_old_one_is_back(table: Driver, text: str, sentence: str) -> None:
    wanted = cell("bead", 2, "mass (kg)")
    table.click(place_of(table, wanted))
    table.key(pygame.K_DELETE)
    table.type(text)
    table.key(pygame.K_RETURN)
    assert sum(sentence in message for message in table.messages) == 1
    assert (mass(table, 2), edited(table)) == (1.0, None)
    table.click(place_of(table, wanted))
    table.key(pygame.K_DELETE)
    table.type(text)
    table.key(pygame.K_TAB)  # it stays there, with the old number
    assert edited(table) == wanted
    assert table.page.tools.values.cells._entry.get_text() == "1"


def test_all_cells_are_reached_and_edited_by_keys_alone(table: Driver) -> None:
    for _ in range(3):
        table.key(pygame.K_RIGHT)  # bead 0, contact 01, bead 1
    table.key(pygame.K_F2)
    seen, cells = [], table.page.tools.values.all_cells()
    assert len(cells) == 5 * 5 + 4 * 2
    for _ in cells:
        seen.append(edited(table))
        table.key(pygame.K_TAB)
    assert seen[0] == edited(table) == cell("bead", 1, "mass (kg)")
    assert set(seen) == set(cells)
    table.type("3")
    table.key(pygame.K_TAB)
    assert (mass(table, 1), edited(table)) == (3.0, cell("bead", 1, "position (m)"))
    table.key(pygame.K_TAB, SHIFT)
    table.key(pygame.K_DOWN)
    assert edited(table) == cell("bead", 2, "mass (kg)")
    table.type("4")
    table.key(pygame.K_UP)
    assert (mass(table, 2), edited(table)) == (4.0, cell("bead", 1, "mass (kg)"))
    table.key(pygame.K_UP)
    table.key(pygame.K_UP)  # there is no row above the first
    assert edited(table) == cell("bead", 0, "mass (kg)")
    table.key(pygame.K_RETURN)
    table.key(pygame.K_RETURN)  # Enter begins as well, where it was last
    assert edited(table) == cell("bead", 0, "mass (kg)")


def test_keys_that_begin_need_the_table(driver: Driver) -> None:
    driver.key(pygame.K_F2)
    assert driver.messages == ["the table of values is not shown: T shows it"]
    assert not driver.page.typing


def test_a_number_that_is_left_by_a_click_is_applied(table: Driver) -> None:
    table.click(place_of(table, cell("bead", 1, "mass (kg)")))
    table.type("2")
    table.click(place_of(table, cell("contact", 0, "overlap (m)")))
    assert mass(table, 1) == 2.0
    assert edited(table) == cell("contact", 0, "overlap (m)")
    table.type("-0.25")
    table.click((640, 120))
    assert table.session.lanes[0].state.overlap[0] == -0.25
    assert edited(table) is None


def test_what_is_typed_survives_a_window_made_anew(table: Driver) -> None:
    table.click(place_of(table, cell("bead", 1, "velocity (m/s)")))
    table.type("0.5")
    table.app.rescale(1)
    table.frames(2)
    assert table.page.tools.values.cells._entry.rect.center == place_of(table, cell("bead", 1, "velocity (m/s)"))
    table.type("5")
    table.key(pygame.K_RETURN)
    assert table.session.lanes[0].velocity[1] == 0.55


def test_the_first_key_takes_the_place_of_the_number_in_a_window_made_anew(table: Driver) -> None:
    table.click(place_of(table, cell("bead", 1, "mass (kg)")))
    table.app.rebuild()  # as where cards make room for the panel of the selection
    table.type("2")
    table.key(pygame.K_RETURN)
    assert mass(table, 1) == 2.0


def test_a_cell_that_goes_away_takes_its_number_along(table: Driver) -> None:
    table.click(place_of(table, cell("bead", 1, "mass (kg)")))
    table.type("2")
    table.app.act("plots")  # no plots: the table has no place
    table.frames(2)
    assert (mass(table, 1), edited(table), table.page.typing) == (2.0, None, False)


def test_a_wall_in_the_way_is_told(table: Driver) -> None:
    table.session.apply(SetMass(0, 4, math.inf))
    table.frames()
    table.click(place_of(table, cell("bead", 0, "position (m)")))
    table.type("9")
    table.key(pygame.K_RETURN)
    assert any("a wall is in the way: bead 0 stops at 1.5 m" in text for text in table.messages)


def test_rows_that_do_not_fit_are_scrolled_to(monkeypatch: pytest.MonkeyPatch) -> None:
    driver = Driver("one-on-ten")
    driver.key(pygame.K_t)
    driver.app.scale = 1.5
    driver.app.rebuild()
    driver.frames(2)
    values = driver.page.tools.values
    place = values.places[0]
    assert not place.whole
    assert cell("bead", 10, "mass (kg)") not in dict(values.shown())
    monkeypatch.setattr(pygame.mouse, "get_pos", lambda: place.rect.center)
    pygame.event.post(pygame.Event(pygame.MOUSEWHEEL, x=0, y=-9, precise_x=0.0, precise_y=-9.0, flipped=False))
    driver.frames(2)
    assert cell("bead", 10, "mass (kg)") in dict(values.shown())
    driver.key(pygame.K_RIGHT)  # the selection comes into view
    assert values.places[0].first == 0
    driver.key(pygame.K_F2)
    driver.key(pygame.K_TAB, SHIFT)  # from the first cell to the last
    assert edited(driver).pick == Pick(0, "contact", 9)
    assert edited(driver) in dict(values.shown())
    driver.close()


@pytest.mark.parametrize(
    ("code", "name", "refusal"),
    [
        ("en", "Bead 0, mass (kg) 1", "mass (kg): 'x' is not a number"),
        ("de", "Kugel 0, Masse (kg) 1", "Masse (kg): 'x' ist keine Zahl"),
        ("fr", "Bille 0, masse (kg) 1", "masse (kg)\N{NO-BREAK SPACE}: 'x' n'est pas un nombre"),
    ],
)
def test_a_screen_reader_hears_the_cell(monkeypatch: pytest.MonkeyPatch, code: str, name: str, refusal: str) -> None:
    monkeypatch.setenv("LANGUAGE", code)
    driver = Driver("one-on-four")
    driver.key(pygame.K_t)
    driver.key(pygame.K_TAB)  # a button has the focus, until something is typed
    driver.app.act("edit_values")
    driver.frames()
    assert driver.app.reader.spoken.control == name
    driver.type("x")
    driver.key(pygame.K_RETURN)
    assert driver.app.reader.spoken.status == refusal
    assert driver.app.focus.control is None
    driver.close()


def test_numbers_move_on_while_one_is_typed(table: Driver) -> None:
    table.key(pygame.K_SPACE)
    wanted = cell("bead", 0, "velocity (m/s)")
    table.click(place_of(table, wanted))
    table.frames(120)
    table.type("0.5")
    assert table.session.playing
    table.key(pygame.K_RETURN)
    assert value_of(table.session, 0, "bead", 0, "velocity (m/s)") == pytest.approx(0.5, abs=0.2)
