"""The verification: every number known from outside is met, and one that is not is said."""

from __future__ import annotations

import json

import pytest
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies.verify import known_numbers
from softcradle.sandbox.studies.verify.known_numbers import KnownNumber, check

NUMBERS = known_numbers.known_numbers()


@pytest.mark.parametrize("known", NUMBERS, ids=lambda known: known.name)
def test_a_number_is_met(known):
    found = check(known)
    assert found.agrees, f"{found.found!r} instead of {known.value!r}, {known.source}"


def test_names_are_different_and_sources_are_given():
    assert len({known.name for known in NUMBERS}) == len(NUMBERS) > 25
    assert all(known.source for known in NUMBERS)


def test_a_number_that_is_missed_is_said(capsys, monkeypatch):
    wrong = KnownNumber("two", 2.0, "counting", lambda: 2.1, 0.01)
    monkeypatch.setattr(known_numbers, "known_numbers", lambda: [wrong])
    assert main(["verify"]) == 1
    shown = capsys.readouterr().out
    assert "missed" in shown
    assert "1e-02" in shown  # the bound, of every row
    assert main(["verify", "--json"]) == 1
    row = json.loads(capsys.readouterr().out)["numbers"][0]
    assert row["allowed"] == 0.01
    assert row["met"] is False
    assert row["error"] == pytest.approx(0.05)
