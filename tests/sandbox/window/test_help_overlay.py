"""The help overlay: every text fits into its column, every group has one."""

from __future__ import annotations

from softcradle.sandbox.draw.text import width
from softcradle.sandbox.window.help_overlay import COLUMN, COLUMNS, KEYS, MOUSE
from softcradle.sandbox.window.keys import groups


def test_every_text_fits_into_its_column():
    texts = [binding.text for group in groups().values() for binding in group] + [text for _, text in MOUSE]
    assert not [text for text in texts if KEYS + 2 + width(text, 13.0) > COLUMN + 15]


def test_every_group_is_shown():
    assert sorted(name for column in COLUMNS for name in column) == sorted([*groups(), "Mouse"])
