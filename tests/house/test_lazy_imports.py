"""Imports by a name in a string escape type checkers and the test of circles: few files have them."""

from __future__ import annotations

from tests.helpers.paths import ROOT, source_files

FILES = {
    "softcradle/__init__.py": "public names load on first use",
    "physics/notebook_views.py": "what a notebook shows is drawn by the sandbox, which lies above",
    "physics/__init__.py": "public names load on first use",
}


def test_imports_by_string_are_where_they_should_be():
    found = [path for path in source_files() if "import_module(" in path.read_text(encoding="utf-8")]
    assert {path.relative_to(ROOT).as_posix() for path in found} == FILES.keys()
