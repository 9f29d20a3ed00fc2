"""The tables of values: every number has its own room, rows that do not fit are scrolled to, a click selects one."""

from __future__ import annotations

from itertools import product

import pygame
import pytest
from softcradle.sandbox.draw.number_format import scientific
from softcradle.sandbox.draw.text import width
from softcradle.sandbox.session.values_table import BEAD_COLUMNS, CONTACT_COLUMNS, SET_COLUMNS
from softcradle.sandbox.window.scene.editor import Pick
from softcradle.sandbox.window.scene.values_board import BODY, HEAD, LESS_NEEDED, MOST_DIGITS, fitting

from tests.helpers.windows import Driver

ALL_COLUMNS = BEAD_COLUMNS, CONTACT_COLUMNS, (*CONTACT_COLUMNS, *SET_COLUMNS)

NUMBERS = (0.0, 1.0, -0.1657, 4.277e-3, -6.846e-4, -2.466e-7, 0.09249, 123.4, -5.678e8)


def test_no_number_covers_another():
    for names, unit, room in product(ALL_COLUMNS, (0.75, 1.0, 1.5, 2.0), (300, 370, 520, 900)):
        columns = fitting(names, room, unit)
        assert columns.shown[0] == 0
        assert set(names) - {names[k] for k in columns.shown} <= set(LESS_NEEDED)
        if columns.right[-1] > room + 1:  # no more can be left out
            assert {names[k] for k in columns.shown}.isdisjoint(LESS_NEEDED)
        rooms = [right - left for left, right in zip((0.0, *columns.right), columns.right, strict=False)]
        for k, free in zip(columns.shown[1:], rooms[1:], strict=True):
            assert max(width(scientific(number, columns.digits), BODY * unit) for number in NUMBERS) < free
            assert max(width(word, HEAD * unit) for word in names[k].replace(" (", "\n(").split("\n")) < free


def test_all_columns_are_there_where_there_is_room():
    for names in (BEAD_COLUMNS, CONTACT_COLUMNS):
        columns = fitting(names, 700, 1.0)
        assert columns.shown == tuple(range(len(names)))
        assert columns.digits == MOST_DIGITS


def test_rows_are_selected_and_scrolled_to(monkeypatch: pytest.MonkeyPatch) -> None:
    driver = Driver("one-on-ten")
    driver.key(pygame.K_t)
    driver.app.scale = 1.5
    driver.app.rebuild()
    driver.frames(2)
    values = driver.page.tools.values
    place = values.places[0]
    assert not place.whole
    driver.click(place.strip(1).center)
    assert driver.page.editor.selection == Pick(0, "bead", 1)
    monkeypatch.setattr(pygame.mouse, "get_pos", lambda: place.rect.center)
    pygame.event.post(pygame.Event(pygame.MOUSEWHEEL, x=0, y=-9, precise_x=0.0, precise_y=-9.0, flipped=False))
    driver.frames(2)
    assert values.places[0].last == 11
    driver.key(pygame.K_LEFT)
    driver.key(pygame.K_LEFT)  # the selection comes into view
    assert values.places[0].first == 0
