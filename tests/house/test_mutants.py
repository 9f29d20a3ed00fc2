"""Mutation testing: which changes are made, that tests notice one, and that a run goes on where it stopped."""

from __future__ import annotations

import ast
import json
import os

import pytest

from benchmarks import __main__ as command
from benchmarks.mutants import command as mutants
from benchmarks.mutants.groups import GROUPS, Group
from benchmarks.mutants.operators import mutants_of
from tests.helpers.paths import ROOT

SOURCE = '''"""A docstring with 1 + 1."""
LIMIT = 1e-8  # é: columns of ast count bytes


@jit
def clamp(x: float, low=0.0) -> float:
    """Another one."""
    if x < low or not x:
        return min(x, -low)
    return x * 2 + LIMIT
'''


def test_every_change_is_made_once_and_nothing_else():
    changes = [(mutant.line, mutant.before, mutant.after) for mutant in mutants_of(SOURCE)]
    assert changes == [
        (2, "1e-8", "1e-05"),
        (6, "0.0", "1.0"),
        (8, "x < low", "(x <= low)"),
        (8, "x < low or not x", "(not (x < low or not x))"),
        (8, "x < low or not x", "(x < low and (not x))"),
        (8, "not x", "(x)"),
        (9, "min(x, -low)", "max(x, -low)"),
        (9, "-low", "(low)"),
        (10, "return x * 2 + LIMIT", "return -(x * 2 + LIMIT)"),
        (10, "x * 2", "(x / 2)"),
        (10, "x * 2 + LIMIT", "(x * 2 - LIMIT)"),
        (10, "2", "3"),
    ]
    for mutant in mutants_of(SOURCE):
        ast.parse(mutant.apply(SOURCE))
        assert len(mutant.apply(SOURCE)) - len(SOURCE) == len(mutant.after) - len(mutant.before)


def test_sources_and_tests_of_every_group_exist():
    for group in GROUPS.values():
        for file in (*group.sources, *(test for test in group.tests if test.startswith("tests/"))):
            assert (ROOT / file).is_file()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="mutants are tried by processes that fork")
def test_a_run_is_kept_and_goes_on(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(
        GROUPS,
        "law",
        Group(("physics/numerics/law_kernels.py",), ("tests/physics/test_contact.py", "-k", "for_another")),
    )
    given = ["mutants", "--of", "law", "--seed", "2", "--folder", str(tmp_path)]
    assert command.main([*given, "--count", "3", "--seconds", "0"]) == 1  # some are left
    assert command.main([*given, "--count", "3", "--markdown", str(tmp_path / "table.md")]) == 0
    kept = json.loads((tmp_path / "law.json").read_text())["mutants"]
    assert len(kept) == 3
    assert any(
        entry["killed by"].startswith("tests/physics/test_contact.py::test_kernels_take_no") for entry in kept.values()
    )
    assert "| law | `physics/numerics/law_kernels.py` | 3 |" in (tmp_path / "table.md").read_text()
    monkeypatch.setattr(mutants, "Trial", lambda *_: pytest.fail("tried again"))
    assert command.main([*given, "--count", "3"]) == 0
    assert "mutants killed" in capsys.readouterr().out
