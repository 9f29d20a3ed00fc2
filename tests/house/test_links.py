"""Tests of links in the documentation and of paths in the architecture page. The tests also check the links to folders
that the set-up creates for editors.

`make check` runs this file. `make links` checks the links to other sites.
"""

import re
import tomllib
from pathlib import Path

import pytest

from tests.helpers.paths import ROOT

PAGES = [*(ROOT / "docs").glob("*.md"), *map(ROOT.joinpath, ("README.md", "CONTRIBUTING.md", "CHANGELOG.md"))]
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
DOCUMENT = re.compile(r"\{doc\}`(?:[^`<]*<)?([^`<>]+)>?`")
INCLUDED = re.compile(r"^```\{include\} (\S+)$", re.MULTILINE)


def anchors(text: str) -> set[str]:
    """Return the anchors of the headings of a page. The anchors are formed in the same way as on GitHub and by Sphinx."""
    headings = re.findall(r"^#{1,6} (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def leads_somewhere(page: Path, target: str) -> bool:
    name, _, anchor = target.partition("#")
    place = page.parent / name if name else page
    return place.exists() and (not anchor or anchor in anchors(place.read_text(encoding="utf-8")))


def dead_links(page: Path, text: str) -> list[str]:
    inside = [target for target in LINK.findall(text) if "://" not in target and not target.startswith("mailto:")]
    dead = [target for target in inside if not leads_somewhere(page, target)]
    dead += [name for name in DOCUMENT.findall(text) if not (page.parent / f"{name}.md").is_file()]
    # The build of the documentation writes the files in the folder _made/.
    kept = [part for part in INCLUDED.findall(text) if not part.startswith("_made/")]
    return dead + [part for part in kept if not (page.parent / part).is_file()]


def test_links_lead_to_something():
    assert [(page.name, dead) for page in PAGES for dead in dead_links(page, page.read_text(encoding="utf-8"))] == []


def test_a_dead_link_is_found():
    page = ROOT / "docs" / "index.md"
    bad = ["[x](nowhere.md)", "[x](../README.md#nowhere)", "{doc}`nowhere`", "{doc}`a title <nowhere>`"]
    assert [text for text in bad if not dead_links(page, text)] == []
    assert dead_links(page, "[x](../README.md) [y](https://example.org) {doc}`architecture`") == []


@pytest.mark.parametrize("page", ["architecture.md", "glossary.md"])
def test_paths_of_a_page_about_the_source_exist(page):
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    paths = set(re.findall(r"`([\w.]+(?:/[\w.]*)+)`", text))
    assert sorted(path for path in paths if not (ROOT / path).exists()) == []
    named = re.findall(r"`(\w+)`\s+(?:in\s+|\()`([\w./]+)`", text)
    definition = r"^(?:class|def) {0}\b|^{0}\b.*="
    sources = [(name, (ROOT / path).read_text(encoding="utf-8")) for name, path in named if (ROOT / path).is_file()]
    assert [name for name, source in sources if not re.search(definition.format(name), source, re.MULTILINE)] == []


PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
TOOLS = PYPROJECT["tool"]


def test_citation_names_the_version_of_the_package():
    version = PYPROJECT["project"]["version"]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.search(rf"^version: {re.escape(version)}$", citation, re.MULTILINE)
    assert f"version = {{{version}}}" in (ROOT / "docs" / "cite.md").read_text(encoding="utf-8")


TYPED = ROOT / TOOLS["mypy"]["mypy_path"]
made = pytest.mark.skipif(not (TYPED / "softcradle" / "physics").is_dir(), reason="set up without make")


@made
def test_every_tool_reads_the_same_links_to_the_folders():
    assert TOOLS["pyright"]["extraPaths"] == [TOOLS["mypy"]["mypy_path"]]
    rooms = {room: ROOT / room for room in ("physics", "scenes", "sandbox")}
    rooms |= {name: ROOT / "softcradle" / name for name in ("__init__.py", "__main__.py")}
    assert {path.name: path.resolve() for path in (TYPED / "softcradle").iterdir()} == rooms


@made
def test_an_editor_finds_a_definition_in_another_room():
    jedi = pytest.importorskip("jedi")
    text = "from softcradle.physics.chain import Chain\nfrom softcradle.scenes.catalogue import load\nChain, load\n"
    project = jedi.Project(ROOT, sys_path=[str(TYPED)], smart_sys_path=False)
    script = jedi.Script(
        text, path=ROOT / "sandbox" / "new.py", environment=jedi.InterpreterEnvironment(), project=project
    )
    found = [script.goto(3, column, follow_imports=True)[0] for column in (0, 7)]
    places = [("Chain", ROOT / "physics" / "chain.py"), ("load", ROOT / "scenes" / "catalogue.py")]
    assert [(one.name, Path(one.module_path).resolve()) for one in found] == places
