"""Every example in a docstring runs, under the name that users import it by."""

from __future__ import annotations

import doctest
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FLAGS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS


def modules() -> list[str]:
    """Every module with an example in it."""
    files = [path for layer in ("softcradle", "physics", "scenes", "sandbox") for path in (ROOT / layer).rglob("*.py")]
    found = (path.relative_to(ROOT).with_suffix("").parts for path in files if ">>> " in path.read_text())
    return sorted(".".join(parts if parts[0] == "softcradle" else ("softcradle", *parts)) for parts in found)


@pytest.mark.parametrize("name", modules())
def test_examples_run(name):
    failed, tried = doctest.testmod(import_module(name.removesuffix(".__init__")), optionflags=FLAGS)
    assert tried > 0
    assert failed == 0
