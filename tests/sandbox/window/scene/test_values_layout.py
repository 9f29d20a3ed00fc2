"""The tables of values: every number has its own room, at any size of the window and any scale."""

from __future__ import annotations

from itertools import product

import pytest
from softcradle.sandbox.draw.number_format import scientific
from softcradle.sandbox.draw.text import width
from softcradle.sandbox.session.values_table import BEAD_COLUMNS, CONTACT_COLUMNS
from softcradle.sandbox.window.scene.values_layout import BODY, HEAD, LESS_NEEDED, MOST_DIGITS, fitting

NUMBERS = (0.0, 1.0, -0.1657, 4.277e-3, -6.846e-4, -2.466e-7, 0.09249, 123.4, -5.678e8)


@pytest.mark.parametrize("names", [BEAD_COLUMNS, CONTACT_COLUMNS], ids=["beads", "contacts"])
def test_no_number_covers_another(names):
    for unit, room in product((0.75, 1.0, 1.25, 1.5, 2.0), (300, 370, 430, 520, 900)):
        numbers_are_apart(names, unit, room)


def numbers_are_apart(names, unit, room):
    columns = fitting(names, room, unit)
    assert columns.shown[0] == 0
    assert set(names) - {names[k] for k in columns.shown} <= set(LESS_NEEDED)
    if columns.right[-1] > room + 1:  # no more can be left out
        assert {names[k] for k in columns.shown}.isdisjoint(LESS_NEEDED)
    rooms = [right - left for left, right in zip((0.0, *columns.right), columns.right, strict=False)]
    for k, free in zip(columns.shown[1:], rooms[1:], strict=True):
        for number in NUMBERS:
            assert width(scientific(number, columns.digits), BODY * unit) < free
        assert max(width(word, HEAD * unit) for word in names[k].replace(" (", "\n(").split("\n")) < free


def test_all_columns_are_there_where_there_is_room():
    for names in (BEAD_COLUMNS, CONTACT_COLUMNS):
        columns = fitting(names, 700, 1.0)
        assert columns.shown == tuple(range(len(names)))
        assert columns.digits == MOST_DIGITS
