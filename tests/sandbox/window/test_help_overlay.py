"""The help overlay: every text fits into its column, every group has one."""

from __future__ import annotations

import pytest
from softcradle.sandbox.draw.text import width
from softcradle.sandbox.languages import LANGUAGES, gettext, use_language
from softcradle.sandbox.window.keys import COLUMN, COLUMNS, KEYS_ROOM, MOUSE, groups


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_text_fits_into_its_column(code):
    use_language(code)
    bindings = [binding for group in groups().values() for binding in group]
    texts = [gettext(text) for text in [binding.text for binding in bindings] + [text for _, text in MOUSE]]
    keys = [str(binding.keys[0]) for binding in bindings] + [gettext(what) for what, _ in MOUSE]
    use_language("en")
    assert not [text for text in texts if KEYS_ROOM + 2 + width(text, 13.0) > COLUMN + 15]
    assert not [text for text in keys if width(text, 13.0, bold=True) + 10 > KEYS_ROOM]


def test_every_group_is_shown():
    assert sorted(name for column in COLUMNS for name in column) == sorted([*groups(), "Mouse"])
