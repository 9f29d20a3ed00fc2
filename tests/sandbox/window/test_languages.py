"""Tests of the languages of the window. The language is chosen by the locale or by a key.

A change of the language changes all texts at once. Numbers use the decimal mark of the language.
"""

import re
from types import SimpleNamespace

import pygame
import pytest
from softcradle.physics import METHODS
from softcradle.physics.chain import ADJACENT_WALLS
from softcradle.physics.messages import InputError
from softcradle.sandbox.draw.text import width
from softcradle.sandbox.languages import LANGUAGES, VARIABLES, error_words, language, translation
from softcradle.sandbox.window import page_geometry
from softcradle.sandbox.window.keys import bindings
from softcradle.sandbox.window.plots.data_overlay import edges_of
from softcradle.sandbox.window.plots.kinds import pair_of
from softcradle.sandbox.window.scene.editor import Pick
from softcradle.sandbox.window.settings import Settings, system_language

from tests.helpers.windows import Driver


def test_a_key_changes_the_language(driver: Driver) -> None:
    driver.key(pygame.K_F8)
    assert driver.page.toolbar.buttons["undo"].text == "Rückgängig"
    assert driver.messages == ["Deutsch"]
    assert Settings.load().language == language() == "de"
    assert "One bead on four" not in {one.text for one in driver.texts()}
    driver.app.close()
    assert language() == "en"  # After the window is closed, the language is English again.
    again = Driver()
    for code in ("de", "fr", "en"):
        assert language() == code
        again.key(pygame.K_F8)


def test_the_system_locale_chooses_the_language(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)
    for preferred, code in (([{"language": "ja"}, {"language": "fr"}], "fr"), ([], "en")):
        monkeypatch.setattr(pygame.system, "get_pref_locales", lambda preferred=preferred: preferred)
        assert system_language() == code


@pytest.fixture
def german(monkeypatch: pytest.MonkeyPatch) -> Driver:
    monkeypatch.setenv("LANGUAGE", "de")
    return Driver("one-on-four")


def test_numbers_and_messages_follow_the_language(german: Driver) -> None:
    german.select("contact", 1)
    assert german.page.inspector.controls["exponent"].entry.get_text() == "0,1"
    german.enter("exponent", "0,25")
    assert german.session.lanes[0].chain.power_laws[1].exponent == 0.25
    assert german.page.inspector.controls["exponent"].entry.get_text() == "0,25"
    german.enter("loss", "1,5")
    assert german.messages[-1].startswith("der Verlust eines Kontakts muss >= 0 und unter 1 sein, nicht 1,5")
    assert error_words(InputError(ADJACENT_WALLS)).startswith("zwei Wände")  # The error message inside another message.
    assert german.page.cards.health[0].sentence == "Genauigkeit in Ordnung (conserving)"
    german.key(pygame.K_F8)
    german.frames(30)
    assert german.page.cards.health[0].sentence == "précision tenue (conserving)"


def test_words_are_taken_in_the_language_and_in_english(german: Driver) -> None:
    for text in ("f0 über d0", "f0 against d0", "f0, d0", "f0 d0"):
        assert [str(one) for one in pair_of(text, 5)] == ["f0", "d0"]
    for text in ("0 2 1,5 -0,5", "0; 2; 1.5; -0.5", "0, 2, 1.5, -0.5"):
        assert edges_of(text) == (0.0, 2.0, 1.5, -0.5)
    german.app.show_gallery()
    german.app.page._search("federapparat")
    assert "draft-gear-one-on-three" in german.app.page.names


@pytest.mark.parametrize("code", [code for code in LANGUAGES if code != "en"])
def test_names_of_methods_fit_their_place(code: str) -> None:
    translation.use_language(code)
    summaries = [translation.gettext(method.summary) for method in METHODS]
    assert not [text for text in summaries if width(text, 13.0) > page_geometry.PANEL - 24]


def cyrillic(message: str) -> str:
    """Return the message with each letter replaced by a Cyrillic letter. Placeholders are not changed."""
    return re.sub(r"\{[^{}]*\}|[A-Za-z]", lambda one: one[0] if one[0][1:] else chr(ord(one[0]) + 0x3CF), message)


OTHER = SimpleNamespace(
    gettext=cyrillic,
    ngettext=lambda one, many, n: cyrillic(one if n == 1 else many),
    pgettext=lambda context, message: cyrillic(message),
)


NAMES = {"softcradle", "auto", "SoftChain", "SoftContact", *(method.name.strip("4") for method in METHODS)}
NAMES |= {language.name for language in LANGUAGES.values()}
# Actions that leave the page or change the language. The test skips these actions.
LEAVING = ("quit", "fullscreen", "language", "leave", "paste", "compare")


def english_words(text: str) -> list[str]:
    """Return the words of a text that consist of English letters. Names and paths are left out."""
    tokens = [token for token in text.split() if not re.search(r"/|^.?\.\w|\w\.\w", token)]
    return [word for token in tokens for word in re.findall(r"[A-Za-z]{3,}", token) if word not in NAMES]


def shown_texts(driver: Driver) -> list[str]:
    """Return all texts of the window: drawn texts, widgets, tooltips, messages and dialogs."""
    app = driver.app
    found = [one.text for one in driver.texts()] + driver.messages
    managers = [app.manager] + ([app.dialog.manager] if app.dialog is not None and app.dialog.open else [])
    for one in [one for manager in managers for one in manager.get_root_container().elements]:
        found += [getattr(one, "tool_tip_text", None) or "", getattr(one, "name", "")]
        found += [] if hasattr(one, "get_text") else [getattr(one, "text", "")]
    return [text for text in found if isinstance(text, str)]


@pytest.fixture
def other(monkeypatch: pytest.MonkeyPatch) -> Driver:
    """Return a window in an invented language. In this language, each letter of a message differs from English."""
    monkeypatch.setattr(translation, "catalogue", lambda code: OTHER)
    monkeypatch.setenv("LANGUAGE", "de")
    return Driver()


@pytest.mark.slow
@pytest.mark.parametrize("start", [None, "one-on-four", "beads-against-gear", "driven-cluster", "cradle"])
def test_no_text_of_the_window_stays_english(other: Driver, start: str | None) -> None:
    app = other.app
    if start is not None:
        app.open(start)
    other.frames(3)
    found = {(word, text) for text in shown_texts(other) for word in english_words(text)}
    picks = [None, Pick(0, "bead", 1), Pick(0, "contact", 1)] if start is not None else [None]
    for pick in picks:
        for action in ["undo", "redo", *(one.action for one in bindings() if one.action not in LEAVING)]:
            if pick is not None:
                app.page.editor.selection = pick
            app.act(action)
            other.frames(4)
            found |= {(f"{action}: {word}", text) for text in shown_texts(other) for word in english_words(text)}
            if app.dialog is not None and app.dialog.open:
                app.dialog.close()
            app.help = False
    assert not found, "\n".join(map(str, sorted(found)[:40]))
