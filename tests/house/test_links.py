"""Links of the documentation and the README: what they point to inside the project is there, anchors included."""

from __future__ import annotations

import re

import pytest

from tests.helpers.paths import ROOT

PAGES = [
    *sorted((ROOT / "docs").glob("*.md")),
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")),
]
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
DOCUMENT = re.compile(r"\{doc\}`([^`<]+)`|\{doc\}`[^`<]*<([^`>]+)>`")
INCLUDED = re.compile(r"^```\{include\} (\S+)$", re.MULTILINE)


def links():
    """Every link of a page that points inside the project."""
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        found = [target for target in LINK.findall(text) if "://" not in target and not target.startswith("mailto:")]
        yield from ((page, target) for target in found)


def anchors(text: str) -> set[str]:
    """The anchors of the headings of a page, as GitHub and Sphinx make them."""
    headings = re.findall(r"^#{1,6} (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize(("page", "target"), list(links()), ids=lambda value: getattr(value, "name", value))
def test_a_link_points_to_something(page, target):
    name, _, anchor = target.partition("#")
    place = page.parent / name if name else page
    assert place.exists()
    if anchor:
        assert anchor in anchors(place.read_text(encoding="utf-8"))


def test_documents_that_are_named_exist():
    for page in PAGES:
        for plain, titled in DOCUMENT.findall(page.read_text(encoding="utf-8")):
            assert (page.parent / f"{plain or titled}.md").is_file(), (page.name, plain or titled)


def test_parts_that_are_included_are_kept_or_written():
    written = (ROOT / "docs" / "written_by_softcradle.py").read_text(encoding="utf-8")
    for page in PAGES:
        for part in INCLUDED.findall(page.read_text(encoding="utf-8")):
            folder, _, name = part.partition("/")
            if folder == "_made":
                assert f'"{name.removesuffix(".md")}":' in written
            else:
                assert (page.parent / part).is_file()


def test_every_page_is_in_the_contents():
    contents = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    listed = {
        line for block in re.findall(r"```\{toctree\}\n(.*?)```", contents, re.DOTALL) for line in block.split("\n")
    }
    assert {page.stem for page in (ROOT / "docs").glob("*.md")} - {"index"} <= listed


def test_there_are_links_to_check():
    assert len(list(links())) > 10
