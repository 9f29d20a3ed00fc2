"""Editors, type checkers and ctags read one folder of links, which set-up makes; `make check` reads it with two of them."""

import tomllib

import pytest

from tests.helpers.paths import ROOT

TOOLS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
(TYPED,) = TOOLS["pyright"]["extraPaths"]

pytestmark = pytest.mark.skipif(not (ROOT / TYPED / "softcradle" / "physics").is_dir(), reason="set up without make")


def test_every_tool_reads_the_same_links():
    assert TOOLS["mypy"]["mypy_path"] == TYPED
    assert {path.name: path.resolve() for path in (ROOT / TYPED / "softcradle").iterdir()} == {
        **{name: ROOT / "softcradle" / name for name in ("__init__.py", "__main__.py")},
        **{room: ROOT / room for room in ("physics", "scenes", "sandbox")},
    }
