"""Tests of translations: plural forms, number formats, and the choice of the language from the locale.

The tests also check the translated texts of scenes and the translated error messages of the physics.
"""

import string
from dataclasses import replace

import pytest
from softcradle.physics import draft_gear, one_on, power_law
from softcradle.physics import hooke as hooke_contact
from softcradle.sandbox import languages
from softcradle.sandbox.draw.scene_picture import speed_text
from softcradle.sandbox.draw.text import font
from softcradle.sandbox.languages import LANGUAGES, translation, use_language
from softcradle.sandbox.languages.translation import catalogue_path
from softcradle.sandbox.session.export import contacts_text, lane_label
from softcradle.sandbox.story.numbers import MINUS, TIMES, factor, fixed, number_text, prefixed, scientific, ticks
from softcradle.sandbox.story.sentences import time_text
from softcradle.scenes import Lane

from tools.update_catalogues import is_translated, main, read_catalogue, update


def test_numbers_have_the_decimal_mark_of_the_language():
    use_language("de")
    assert fixed(-1.5, 2) == f"{MINUS}1,50"
    assert scientific(1.25e-7) == "1,2·10⁻⁷"
    assert prefixed(1.25e6) == "1,25 M"
    assert factor(0.5) == f"{TIMES}0,5"
    assert number_text(12345.678) == "1,23·10⁴"
    assert [text for _value, text in ticks(0.0, 1.0, 2)] == ["0,0", "0,5", "1,0"]
    assert languages.localized("0.1") == "0,1"
    assert speed_text(2.5) == "Zeitlupe 1/2,5"
    assert time_text(1.5) == "1,5\u00a0s"
    with languages.english():
        assert fixed(1.5, 1) == "1.5"
    assert fixed(1.5, 1) == "1,5"


@pytest.mark.parametrize(
    ("variables", "code"),
    [
        ({"LANG": "de_DE.UTF-8"}, "de"),
        ({"LANG": "de_DE.UTF-8", "LC_MESSAGES": "fr_CA"}, "fr"),
        ({"LC_ALL": "C.UTF-8", "LANG": "de_DE.UTF-8"}, "en"),
        ({"LANGUAGE": "ja:fr:de", "LANG": "de_DE.UTF-8"}, "fr"),
        ({"LANGUAGE": "", "LANG": "fr"}, "fr"),
        ({"LANG": "ja_JP.UTF-8"}, "en"),
        ({}, "en"),
    ],
)
def test_the_locale_chooses(variables, code):
    assert languages.language_of_environment(variables) == code


def test_words_of_scenes_and_labels():
    use_language("fr")
    assert languages.scene_words("One bead on four") == "Une bille contre quatre"
    assert languages.scene_words("One bead\n  on four") == "Une bille contre quatre"
    assert languages.scene_words("A scene {of mine") == "A scene {of mine"
    assert languages.scene_words("draft gear") == "amortisseur d'attelage"


def test_labels_of_edited_lanes():
    use_language("fr")
    gear, hooke, soft, hard = draft_gear(1.0, 1.0), hooke_contact(1.0), power_law(1.0, 0.1), power_law(1.0, 0.123)
    assert label_of(gear, hooke) == "amortisseur d'attelage et Hooke, alpha = 1"
    assert label_of(hard) == "alpha = 0,123"
    assert label_of(soft, hard, power_law(1.0, 0.2)) == "alpha = 1/10 et alpha = 0,123 …"
    heavy = replace(one_on(1, gear), mass=(1.0, 2.0))
    edited = lane_label(contacts_text((gear,)), one_on(1, gear), heavy)
    assert languages.scene_words(edited) == "amortisseur d'attelage, modifié"
    assert lane_label(edited, one_on(1, gear), heavy) == "draft gear, edited"  # A label in a file is always English.
    assert Lane.of(heavy, (1.0, 0.0), edited).label is edited
    with languages.english():
        assert languages.scene_words(edited) == "draft gear, edited"


def label_of(*contacts):
    """Return the label of a row of beads with these contacts, in the current language."""
    return languages.scene_words(contacts_text(contacts))


def test_a_label_of_a_user_is_not_translated():
    use_language("fr")
    assert languages.scene_words("version 1.2 and a half") == "version 1.2 and a half"


CODES = [code for code in LANGUAGES if code != "en"]


def fields(text: str) -> set[tuple[str, str, str | None]]:
    """Return the name, the format and the conversion of each {placeholder} in a text."""
    parts = string.Formatter().parse(text)
    return {(name, form or "", conversion) for _, name, form, conversion in parts if name is not None}


@pytest.mark.parametrize("code", CODES)
def test_translations_have_the_placeholders_of_their_source(code):
    catalogue = read_catalogue(code)
    for message in filter(is_translated, catalogue):
        sources, forms = (message.id, message.string) if message.pluralizable else (2 * [message.id], [message.string])
        few, many = map(fields, sources)
        assert len(forms) == (catalogue.num_plurals if message.pluralizable else 1)
        assert all(few <= fields(form) <= many for form in forms), message.id
        assert fields(forms[-1]) == many, message.id


SIGNS = "0123456789δvf₀₁₉₋⁰¹²⁹⁻·…✓µ()=!éüα\N{MULTIPLICATION SIGN}\N{MINUS SIGN}\N{NARROW NO-BREAK SPACE}"


@pytest.mark.parametrize("bold", [False, True])
@pytest.mark.parametrize("code", CODES)
def test_the_fonts_have_every_letter(code, bold):
    letters = sorted(set(catalogue_path(code).read_text(encoding="utf-8") + SIGNS) - {"\n", "\0"})
    sizes = font(20, bold).metrics("".join(letters))
    assert not [letter for letter, size in zip(letters, sizes, strict=True) if size is None]
    assert len({font(40, bold).size(digit)[0] for digit in f"0123456789{MINUS}"}) == 1, "changing numbers do not move"


def test_missing_translations_are_counted(tmp_path, monkeypatch, capsys):
    """Check that a new message has an empty translation, which is counted as missing.

    A missing translation is an error only before a release.
    """
    path = tmp_path / "de.po"
    for module in ("tools.update_catalogues", "softcradle.sandbox.languages.translation"):
        monkeypatch.setattr(f"{module}.catalogue_path", lambda code: path)
    text = catalogue_path("de").read_text(encoding="utf-8")
    path.write_text(text.replace('msgstr "Rückgängig"', 'msgstr ""'), encoding="utf-8")
    waiting = update("de")
    assert waiting > 0
    german = translation.catalogue.__wrapped__("de")  # Call the function without its cache to read the changed file.
    assert german.gettext("Undo") == "Undo"
    assert german.gettext("Redo") != "Redo"
    monkeypatch.setattr("tools.update_catalogues.LANGUAGES", {"de": LANGUAGES["de"]})
    assert main([]) == 0
    assert main(["--complete"]) == 1
    assert f"{waiting} messages wait for Deutsch" in capsys.readouterr().out
