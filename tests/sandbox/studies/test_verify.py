"""The verification: every number known from outside is met, and one that is not is said."""

import json

import pytest
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies import verify
from softcradle.sandbox.studies.verify import KnownNumber


def test_every_number_is_met(capsys):
    """As the command says, which is what a user has."""
    assert main(["verify", "--json"]) == 0, capsys.readouterr().out
    rows = json.loads(capsys.readouterr().out)["numbers"]
    assert len({row["name"] for row in rows}) == len(rows) == len(verify.known_numbers())
    assert all(row["met"] and row["source"] for row in rows)


def test_a_number_that_is_missed_is_said(capsys, monkeypatch):
    wrong = KnownNumber("two", 2.0, "counting", lambda: 2.1, 0.01)
    monkeypatch.setattr(verify, "known_numbers", lambda: [wrong])
    assert main(["verify"]) == 1
    shown = capsys.readouterr().out
    assert "missed" in shown
    assert "1e-02" in shown  # the bound, of every row
    assert main(["verify", "--json"]) == 1
    row = json.loads(capsys.readouterr().out)["numbers"][0]
    assert row["allowed"] == 0.01
    assert row["met"] is False
    assert row["error"] == pytest.approx(0.05)
