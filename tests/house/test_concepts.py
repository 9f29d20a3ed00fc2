"""Every concept of `concepts.toml` is in the file where a stranger looks for it, and the first line there names it."""

from __future__ import annotations

import ast
import tomllib

import pytest

from tests.helpers.paths import LAYERS, ROOT

CONCEPTS = tomllib.loads((ROOT / "tests" / "house" / "concepts.toml").read_text(encoding="utf-8"))
ENTRIES = [(concept, *entry) for part in CONCEPTS.values() for concept, entry in part.items()]


@pytest.mark.parametrize(("file", "word"), [pytest.param(*entry[1:], id=entry[0]) for entry in ENTRIES])
def test_the_first_line_names_it(file, word):
    docstring = ast.get_docstring(ast.parse((ROOT / file).read_text(encoding="utf-8")))
    assert docstring is not None
    assert word.lower() in docstring.partition("\n")[0].lower()


def test_the_list_is_long_and_each_file_is_in_it_once():
    assert tuple(CONCEPTS) == LAYERS
    files = [file for _, file, _ in ENTRIES]
    assert len(files) >= 30
    assert len(set(files)) == len(files)
