"""The architecture page is true: its paths and names exist, and every room is on it."""

from __future__ import annotations

import re

import pytest

from tests.helpers.paths import LAYERS, ROOT, source_files

PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
PATHS = sorted(set(re.findall(r"`([\w.]+(?:/[\w.]*)+)`", PAGE)))
NAMES = sorted(set(re.findall(r"`(\w+)`\s+(?:in\s+|\()`([\w./]+)`", PAGE)))


def rooms() -> set[str]:
    """Every folder of modules below a layer, with / at its end, and every module that lies in a layer itself."""
    found = set()
    for path in source_files():
        layer, *folders, _ = path.relative_to(ROOT).parts
        if layer in LAYERS and path.name != "__init__.py":
            found.add("/".join((layer, *folders)) + "/" if folders else f"{layer}/{path.name}")
    return found


@pytest.mark.parametrize("path", PATHS)
def test_a_path_exists(path):
    assert (ROOT / path).is_dir() if path.endswith("/") else (ROOT / path).is_file()


@pytest.mark.parametrize(("name", "path"), NAMES)
def test_a_name_is_where_the_page_says(name, path):
    text = (ROOT / path).read_text(encoding="utf-8")
    assert re.search(rf"^(?:class|def) {name}\b|^{name}\b.*=", text, re.MULTILINE)


def test_every_room_is_on_the_page():
    assert sorted(rooms() - set(PATHS)) == []


def test_the_page_is_read():
    assert len(PATHS) > 60
    assert len(NAMES) > 8
    assert "docs/architecture.md" in (ROOT / "README.md").read_text(encoding="utf-8")
