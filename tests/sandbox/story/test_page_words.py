"""Tests of the table of texts for web pages.

Scripts and HTML documents must use exactly the keys of this table, in every language.
"""

import re
import string

import pytest
from softcradle.sandbox.languages import LANGUAGES, use_language
from softcradle.sandbox.page import document
from softcradle.sandbox.story.bodies import BODIES
from softcradle.sandbox.story.page_story import page_words

from tests.helpers.paths import ROOT

# Beginnings of keys. Scripts append the state of a contact, a contact law, a group of beads or the second row of beads.
COMPLETED = (
    "law ",
    "guess ",
    "verdict ",
    "lead ",
    "compare ",
    "bead ",
    "beads ",
    "wall ",
    "energy ",
    "momentum ",
    "alpha",
    "right",
    "more group",
)


def used_texts():
    scripts = "".join((ROOT / f"assets/page/{name}.js").read_text(encoding="utf-8") for name in document.SCRIPTS)
    parts = [document.heading("", ""), document.player("", "", True, True, True), document.numbers(""), document.keys()]
    rest = [path.read_text(encoding="utf-8") for path in (ROOT / "sandbox/page").glob("*.py")]
    return scripts, "".join([*parts, *rest])


def test_every_key_of_a_script_has_words():
    scripts, page = used_texts()
    keys = set(re.findall(r'\bsay\("([^"]+)"', scripts)) | set(re.findall(r'data-(?:say|name)="([^"{}]+)"', page))
    assert len(keys) > 60
    assert keys <= set(page_words())


def test_every_word_is_used():
    scripts, page = used_texts()
    literals = set(re.findall(r'"([^"\n]*)"', scripts + page))
    bodies = {f"{kind} {name}" for kind, body in BODIES.items() for name in body.words()}
    unused = set(page_words()) - literals - bodies
    assert {key for key in unused if not key.startswith(COMPLETED)} == set()


@pytest.mark.parametrize("code", [code for code in LANGUAGES if code != "en"])
def test_translations_have_the_placeholders_of_the_english_text(code):
    english = page_words()
    use_language(code)
    for key, text in page_words().items():
        assert placeholders(text) == placeholders(english[key]), key
        # In French, an ordinary space before a punctuation mark could move the mark to the next line.
        assert code != "fr" or not re.search(" [:;!?]", text), key


def placeholders(text):
    return sorted(name for _, name, _, _ in string.Formatter().parse(text) if name)
