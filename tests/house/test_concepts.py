"""Every concept of `concepts.toml` is in the file where a stranger looks for it, and the first line there names it."""

from __future__ import annotations

import ast
import tomllib

import pytest

from tests.helpers.paths import LAYERS, ROOT

CONCEPTS = tomllib.loads((ROOT / "tests" / "house" / "concepts.toml").read_text(encoding="utf-8"))
ENTRIES = [(concept, *entry) for part in CONCEPTS.values() for concept, entry in part.items()]
COMING = {  # files that are being added, and first lines that are being written
    "the call of a method",
    "how a run ended",
    "the default step",
    "the fallback of radau",
    "friction of the bed",
    "when a motion has stopped",
    "the critical speed",
    "the film encoder",
}


def entry(concept: str, file: str, word: str) -> object:
    marks = [pytest.mark.xfail(reason="is being written", strict=False)] if concept in COMING else []
    return pytest.param(file, word, id=concept, marks=marks)


@pytest.mark.parametrize(("file", "word"), [entry(*found) for found in ENTRIES])
def test_the_first_line_names_it(file, word):
    docstring = ast.get_docstring(ast.parse((ROOT / file).read_text(encoding="utf-8")))
    assert docstring is not None
    assert word.lower() in docstring.partition("\n")[0].lower()


def test_the_list_is_long_and_each_file_is_in_it_once():
    assert tuple(CONCEPTS) == LAYERS
    files = [file for _, file, _ in ENTRIES]
    assert len(files) >= 30
    assert len(set(files)) == len(files)
    assert {concept for concept, *_ in ENTRIES} >= COMING
