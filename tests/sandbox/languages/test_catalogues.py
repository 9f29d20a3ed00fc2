"""The catalogues: complete, well-formed, with the placeholders of the source, and in letters that the fonts have."""

from __future__ import annotations

import ast
import re
import string
from functools import cache
from pathlib import Path

import pytest
from softcradle.sandbox.draw.text import font
from softcradle.sandbox.languages import LANGUAGES
from softcradle.sandbox.languages.po_file import read_entries
from softcradle.sandbox.languages.translation import catalogue_path
from softcradle.sandbox.languages.update_catalogues import is_translated, read_catalogue, template, written

from tests.helpers.paths import ROOT

CODES = [code for code in LANGUAGES if code != "en"]
COMMAND = "run `make languages` and translate what it reports"


@cache
def messages() -> set[tuple[str | None, str]]:
    """Context and message, of all that is marked in the code, the scenes and the lessons."""
    return {(message.context, _first(message.id)) for message in template() if message.id}


def _first(text: str | tuple[str, ...]) -> str:
    return text if isinstance(text, str) else text[0]


def fields(text: str) -> set[tuple[str, str, str | None]]:
    """Names, forms and conversions of the {placeholders} in a text."""
    parts = string.Formatter().parse(text)
    return {(name, form or "", conversion) for _, name, form, conversion in parts if name is not None}


def test_the_command_finds_messages_of_every_kind():
    found = {message for _, message in messages()}
    assert len(found) > 500
    for text in ("Undo", "Draft gears", "One bead on four", "play or pause", "leapfrog", "it bounces back"):
        assert text in found
    assert ("button", "velocities") in messages()


@pytest.mark.parametrize("code", CODES)
def test_no_message_is_missing_empty_or_left_over(code):
    catalogue = read_catalogue(code)
    kept = {(message.context, _first(message.id)): message for message in catalogue if message.id}
    assert set(kept) == messages(), COMMAND
    assert not [key for key, message in kept.items() if not is_translated(message) or message.fuzzy], COMMAND
    assert not catalogue.obsolete


@pytest.mark.parametrize("code", CODES)
def test_translations_have_the_placeholders_of_their_source(code):
    for message in read_catalogue(code):
        if isinstance(message.id, str):
            assert fields(message.id) == fields(message.string), message.id
        else:
            few, many = map(fields, message.id)
            assert len(message.string) == read_catalogue(code).num_plurals
            assert all(few <= fields(form) <= many for form in message.string), message.id
            assert fields(message.string[-1]) == many, message.id


@pytest.mark.parametrize("code", CODES)
def test_translations_begin_and_end_as_their_source(code):
    """Spaces at the ends join texts; a sentence ends as a sentence."""
    for message in read_catalogue(code):
        if isinstance(message.id, str) and message.id:
            source, text = message.id, message.string.replace("\N{NO-BREAK SPACE}", " ")
            assert source.endswith(" ") == text.endswith(" "), source
            if len(source.split()) > 4:
                assert source.endswith((".", "?")) == text.endswith((".", "?")), source


@pytest.mark.parametrize("code", CODES)
def test_the_file_is_as_the_command_writes_it(code):
    catalogue = read_catalogue(code)
    catalogue.update(template(), no_fuzzy_matching=True)
    assert catalogue_path(code).read_bytes() == written(catalogue), COMMAND


@pytest.mark.parametrize("code", CODES)
def test_the_reader_reads_what_babel_reads(code):
    expected = {}
    for message in read_catalogue(code):
        source = message.id if isinstance(message.id, str) else "\0".join(message.id)
        text = message.string if isinstance(message.string, str) else "\0".join(message.string)
        expected[f"{message.context}\4{source}" if message.context else source] = text
    found = read_entries(catalogue_path(code))
    assert "nplurals=2" in found.pop("")
    expected.pop("")
    assert found == expected


@pytest.mark.parametrize("code", CODES)
def test_the_header_has_the_plural_forms_of_the_language(code):
    assert f"Plural-Forms: {read_catalogue(code).plural_forms}" in read_entries(catalogue_path(code))[""]


@pytest.mark.parametrize("bold", [False, True])
@pytest.mark.parametrize("code", CODES)
def test_the_fonts_have_every_letter(code, bold):
    letters = sorted(set("".join(read_entries(catalogue_path(code)).values())) - {"\n", "\0"})
    sizes = font(20, bold).metrics("".join(letters))
    assert not [letter for letter, size in zip(letters, sizes, strict=True) if size is None]


def test_entries_that_are_fuzzy_or_empty_stay_english(tmp_path):
    path = tmp_path / "x.po"
    path.write_text(
        'msgid ""\nmsgstr "Content-Type: text/plain; charset=utf-8\\n"\n\n'
        '#, fuzzy\nmsgid "guess"\nmsgstr "geraten"\n\nmsgid "empty"\nmsgstr ""\n\n'
        '#~ msgid "gone"\n#~ msgstr "weg"\n\n'
        'msgctxt "short"\nmsgid ""\n"a long "\n"message"\nmsgstr "eine lange\\n"\n"Nachricht"\n',
        encoding="utf-8",
    )
    assert set(read_entries(path)) == {"", "short\4a long message"}
    assert read_entries(path)["short\4a long message"] == "eine lange\nNachricht"


MARKS = {"_", "gettext", "ngettext", "pgettext", "N_", "NP_"}
PROSE = re.compile(r"[A-Za-z]{2,}[,:;.]? [A-Za-z]{2,}")  # two words
NOT_SHOWN = {  # by file: why its text needs no translation
    "display.py": "said on the terminal: there is no window",
    "signals.py": "names of quantities, which plots show by symbols",
}


def unmarked(tree: ast.AST) -> list[str]:
    """Texts of several words outside docstrings that no call marks for translation."""
    left_out: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr):
            left_out.add(id(node.value))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in MARKS:
            left_out |= {id(part) for argument in node.args for part in ast.walk(argument)}
    texts = [node for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    return [node.value for node in texts if id(node) not in left_out and PROSE.search(node.value)]


def test_texts_of_the_window_are_marked():
    """A table may repeat a message that is marked elsewhere, to look something up."""
    known = {message for _context, message in messages()}
    for path in sorted((ROOT / "sandbox" / "window").rglob("*.py")):
        found = [text for text in unmarked(ast.parse(path.read_text(encoding="utf-8"))) if text not in known]
        assert not found or path.name in NOT_SHOWN, (path, found)
    assert unmarked(ast.parse('show(f"saved {n} to the file")\nshow(_("saved it"))')) == [" to the file"]


def calls_and_assigns(function: ast.AST) -> bool:
    """Whether a function calls `_` for a translation and assigns it, which hides the translation."""
    names = [node for node in ast.walk(function) if isinstance(node, ast.Name) and node.id == "_"]
    loops = [node for node in ast.walk(function) if isinstance(node, ast.comprehension)]
    own = {id(name) for loop in loops for name in ast.walk(loop.target)}
    assigned = any(isinstance(name.ctx, ast.Store) and id(name) not in own for name in names)
    return assigned and any(isinstance(name.ctx, ast.Load) for name in names)


@pytest.mark.parametrize("path", sorted((ROOT / "sandbox").rglob("*.py")), ids=lambda path: path.stem)
def test_no_function_hides_the_translation(path: Path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.Lambda)]
    assert not [node.lineno for node in functions if calls_and_assigns(node)]
    assert calls_and_assigns(ast.parse("def f():\n    a, _ = g()\n    return _('x')"))
