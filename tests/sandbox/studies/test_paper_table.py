"""The page that says where each part of the paper is: it names what exists, misses no claim, and lists all equations."""

import importlib
import re
import subprocess

from softcradle.sandbox.studies.claims.claim_list import CLAIMS
from softcradle.sandbox.studies.figures.figure_list import FIGURES

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


def test_every_text_names_equations_of_the_list():
    tracked = subprocess.run(["git", "ls-files", *TEXTS], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    wrong = {path: numbers_in((ROOT / path).read_text(encoding="utf-8")) - NUMBERS for path in tracked.split()}
    assert {path: numbers for path, numbers in wrong.items() if numbers} == {}
