"""The page that says where each part of the paper is: it names what exists, and misses no claim."""

import importlib
import re

from softcradle.sandbox.studies.claims.claim_list import CLAIMS
from softcradle.sandbox.studies.figures.figure_list import FIGURES

from softcradle import scenes
from tests.helpers.paths import ROOT

PAGE = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")


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
