"""The page that says where each part of the paper is: it names what exists, misses no claim, and lists all equations."""

from __future__ import annotations

import importlib
import re
import subprocess

import pytest
from softcradle.physics.analysis.mode_coupling import ModeCoupling
from softcradle.sandbox.studies.claims.claim_list import CLAIMS
from softcradle.sandbox.studies.figures.figure_list import FIGURES

import softcradle
from softcradle import scenes
from tests.helpers.paths import ROOT

PAGE = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
EQUATIONS = re.findall(r"^\| \((\w+)\) \| ([\w ]+) \| (?:`(eq:\S+)`)? ?\| .* \| (.*) \|$", PAGE, re.MULTILINE)
NUMBERS = {number for number, *_ in EQUATIONS}
BETWEEN = r"(?:[\s#*/|\"\\]|,|and|to|und|bis|et|à|n(?=[ \"]))+"  # two numbers, in a comment and in a string, too
NAMED = re.compile(rf"(?:\b[Ee]qs?\.|\bequations?|\bGln?\.|[éÉ]qs?\.)[\s#*]*(\(\w{{1,2}}\)(?:{BETWEEN}\(\w{{1,2}}\))*)")
TEXTS = ["*.py", "*.md", "*.toml", "*.js", "*.ipynb", "*.po", "*.txt", "*.html", "*.css"]


def numbers_in(text: str) -> set[str]:
    """The numbers of all equations of the paper that `text` names."""
    return {number for group in NAMED.findall(text) for number in re.findall(r"\((\w+)\)", group)}


def named(kind: str) -> set[str]:
    """The names in backticks after `kind`, or its plural, up to the next semicolon or cell."""
    lists = re.findall(rf"\b{kind}s? ((?:`[^`]+`(?:, | and | to )?)+)", PAGE)
    return {name for text in lists for name in re.findall(r"`([^`]+)`", text)}


def test_claims_figures_and_scenes_exist():
    assert named("claim") == {claim.name for claim in CLAIMS}  # and none is missing
    assert named("figure") == {figure.name for figure in FIGURES}
    assert named("scene") <= set(scenes.names())


def test_paths_exist_and_are_those_of_a_wheel():
    for path in re.findall(r"`([a-z]+/[\w/]+\.py)`", PAGE):
        assert path.startswith("tests/")  # what is no test is named as it is imported
        assert (ROOT / path).is_file(), path
    for module in re.findall(r"`(softcradle\.[\w.]+)`", PAGE):
        importlib.import_module(module)


def test_readme_leads_to_the_page():
    assert "docs/paper.md" in (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_list_has_every_equation_once_and_in_order():
    assert [number for number, *_ in EQUATIONS] == [*map(str, range(1, 11)), "A1", "A2", "A3", "A4", "C1"]
    labels = [label for _, _, label, _ in EQUATIONS if label]
    assert len(labels) == len(set(labels)) == 12  # the overlap and, twice, psi have none


def test_every_text_names_equations_of_the_list():
    tracked = subprocess.run(["git", "ls-files", *TEXTS], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    wrong = {path: numbers_in((ROOT / path).read_text(encoding="utf-8")) - NUMBERS for path in tracked.split()}
    assert {path: numbers for path, numbers in wrong.items() if numbers} == {}


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("Eq. (5)", {"5"}),
        ("Eqs. (7)\n    and (A1): in", {"7", "A1"}),
        ("equations (8), (A3) of", {"8", "A3"}),
        ("Gl. (2) mit alpha = 1/10 gegen Gl. (C1)", {"2", "C1"}),
        ("Éq. (2) avec", {"2"}),
        ("beyond them (Eq. " + "(11))", {"11"}),
        ("equal (4), sequel (5)", set()),
    ],
)
def test_numbers_are_found_as_they_are_written(text, numbers):
    assert numbers_in(text) == numbers


@pytest.mark.parametrize(("number", "code"), [(number, code) for number, _, _, code in EQUATIONS])
def test_what_an_equation_is_in_code_says_so(number, code):
    """Functions and classes name their equation in their docstring; members and claims that are named exist."""
    spans = re.findall(r"`([^`]+)`", code)
    places = [importlib.import_module(span) for span in spans if re.fullmatch(r"softcradle\.[\w.]+", span)]
    for name in [span for span in spans if not span.startswith("softcradle")]:
        found = [getattr(place, name.partition(".")[0], None) for place in (softcradle, *places)]
        members = (softcradle.Trajectory, softcradle.Contact, ModeCoupling)
        said = [numbers_in(each.__doc__) for each in found if each is not None]
        assert any(number in numbers for numbers in said) or any(
            hasattr(kind, name.partition(".")[2] or name) or name in kind.__annotations__ for kind in members
        ), name
    for span in spans:
        assert not span.startswith("softcradle claims ") or span.split()[-1] in {claim.name for claim in CLAIMS}
