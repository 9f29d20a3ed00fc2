"""Every number known from outside is met, and the page that says where each part of the paper is names what exists."""

import importlib
import json
import re

import pytest
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies import verify
from softcradle.sandbox.studies.claims.catalogue import CLAIMS
from softcradle.sandbox.studies.figures.catalogue import FIGURES
from softcradle.sandbox.studies.verify import KnownNumber

from softcradle import scenes
from tests.helpers.paths import ROOT


def test_every_number_is_met(capsys):
    assert main(["verify", "--json"]) == 0, capsys.readouterr().out
    rows = json.loads(capsys.readouterr().out)["numbers"]
    assert len({row["name"] for row in rows}) == len(rows) == len(verify.known_numbers())
    assert all(row["met"] and row["source"] for row in rows)


def test_a_number_that_is_missed_is_said(softcradle, monkeypatch):
    wrong = KnownNumber("two", 2.0, "counting", lambda: 2.1, 0.01)
    monkeypatch.setattr(verify, "known_numbers", lambda: [wrong])
    shown = softcradle("verify", code=1).out
    assert "missed" in shown
    assert "1e-02" in shown  # the bound, of every row
    row = json.loads(softcradle("verify", "--json", code=1).out)["numbers"][0]
    assert row["allowed"] == 0.01
    assert row["met"] is False
    assert row["error"] == pytest.approx(0.05)


PAGE = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")


def named(kind: str) -> set[str]:
    """The names in backticks after `kind`, or its plural, up to the next semicolon or cell."""
    lists = re.findall(rf"\b{kind}s? ((?:`[^`]+`(?:, | and | to )?)+)", PAGE)
    return {name for text in lists for name in re.findall(r"`([^`]+)`", text)}


def test_what_the_page_names_exists_by_the_names_of_a_wheel():
    assert named("claim") == {claim.name for claim in CLAIMS}  # and none is missing
    assert named("figure") == {figure.name for figure in FIGURES}
    assert named("scene") <= set(scenes.names())
    for path in re.findall(r"`([a-z]+/[\w/]+\.py)`", PAGE):
        assert path.startswith("tests/")  # what is no test is named as it is imported
        assert (ROOT / path).is_file(), path
    for module in re.findall(r"`(softcradle\.[\w.]+)`", PAGE):
        importlib.import_module(module)
