"""The catalogues: well-formed, placeholders as in the source, letters that the fonts have; what is missing is counted."""

from __future__ import annotations

import string

import pytest
from softcradle.sandbox.draw.text import font
from softcradle.sandbox.languages import LANGUAGES, translation
from softcradle.sandbox.languages.translation import catalogue_path

from tools.update_catalogues import is_translated, main, read_catalogue, update

CODES = [code for code in LANGUAGES if code != "en"]


def fields(text: str) -> set[tuple[str, str, str | None]]:
    """Names, forms and conversions of the {placeholders} in a text."""
    parts = string.Formatter().parse(text)
    return {(name, form or "", conversion) for _, name, form, conversion in parts if name is not None}


@pytest.mark.parametrize("code", CODES)
def test_translations_have_the_placeholders_of_their_source(code):
    for message in filter(is_translated, read_catalogue(code)):
        if isinstance(message.id, str):
            assert fields(message.id) == fields(message.string), message.id
        else:
            few, many = map(fields, message.id)
            assert len(message.string) == read_catalogue(code).num_plurals
            assert all(few <= fields(form) <= many for form in message.string), message.id
            assert fields(message.string[-1]) == many, message.id


@pytest.mark.parametrize("bold", [False, True])
@pytest.mark.parametrize("code", CODES)
def test_the_fonts_have_every_letter(code, bold):
    letters = sorted(set(catalogue_path(code).read_text(encoding="utf-8")) - {"\n", "\0"})
    sizes = font(20, bold).metrics("".join(letters))
    assert not [letter for letter, size in zip(letters, sizes, strict=True) if size is None]


def test_what_waits_for_a_translation_is_counted(tmp_path, monkeypatch, capsys):
    """New messages come in empty, and only a release is held up by them."""
    path = tmp_path / "de.po"
    monkeypatch.setattr("tools.update_catalogues.catalogue_path", lambda code: path)
    path.write_bytes(
        translation.catalogue_path("de").read_bytes().replace(b'msgstr "R\xc3\xbcckg\xc3\xa4ngig"', b'msgstr ""')
    )
    waiting = update("de")
    assert waiting > 0
    with monkeypatch.context() as patched:
        patched.setattr(translation, "catalogue_path", lambda code: path)
        translation.catalogue.cache_clear()
        german = translation.catalogue("de")
        translation.catalogue.cache_clear()
    assert german.gettext("Undo") == "Undo"
    assert german.gettext("Redo") != "Redo"
    monkeypatch.setattr("tools.update_catalogues.LANGUAGES", {"de": LANGUAGES["de"]})
    assert main([]) == 0
    assert main(["--complete"]) == 1
    assert f"{waiting} messages wait for Deutsch" in capsys.readouterr().out
