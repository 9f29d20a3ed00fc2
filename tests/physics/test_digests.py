"""Determinism: the same digits run for run, and on every machine of one arithmetic; close to them on any other."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from tests.helpers.digests import FILE, arithmetic, differences, digest, motions, runs, solved, states, velocities

RECORDED = json.loads(FILE.read_text())
ELSEWHERE = 1e-12  # closing speeds: how far velocities may be off in another arithmetic

MOVE_A_CONSTANT = """
from tests.helpers.digests import digest, motions, states
import importlib
room = importlib.import_module("softcradle.physics.{module}")
if {moved}:
    room.{name} = room.{name} * (1.0 + 1e-15)
chosen = {{name: rest for name, *rest in motions()}}["one-on-four/{method}"]
print(digest(states(*chosen)))
"""


def test_every_motion_and_every_run_has_a_digest():
    assert set(RECORDED["motions"]) == {name for name, *_ in motions()}
    assert set(RECORDED["runs"]) == {name for name, *_ in runs()}


@pytest.mark.skipif(arithmetic() != RECORDED["arithmetic"], reason="the record is of another arithmetic")
def test_digits_of_random_runs_are_those_recorded():
    assert [name for name, *rest in runs() if solved(*rest) != RECORDED["runs"][name]] == []


def test_what_differs_is_named():
    other = {"motions": {"a": {"digest": "1"}}, "runs": {"b": "2", "c": "3"}}
    assert differences(other, {"motions": {"a": {"digest": "0"}}, "runs": {"b": "2"}}) == ["a", "c"]


@pytest.mark.parametrize(
    ("name", "chain", "velocity", "method"), list(motions()), ids=lambda value: value if isinstance(value, str) else ""
)
def test_digits_are_those_recorded(name, chain, velocity, method):
    rows, entry = states(chain, velocity, method), RECORDED["motions"][name]
    if arithmetic() == RECORDED["arithmetic"]:
        assert digest(rows) == entry["digest"]
    if entry["calm"]:
        found = velocities(chain, rows[entry["calm"] - 1])
        assert np.abs(found - entry["velocity"]).max() <= ELSEWHERE * (np.ptp(velocity) or 1.0)
    assert digest(states(chain, velocity, method)) == digest(rows)


def test_most_motions_are_calm_enough_to_compare_in_any_arithmetic():
    entries = RECORDED["motions"].values()
    assert sum(entry["calm"] > 0 for entry in entries) > 0.9 * len(entries)


@pytest.mark.parametrize(
    ("module", "name", "method"),
    [("adaptive.step", "SAFETY", "accurate"), ("adaptive.adaptive_loop", "TOLERANCE_PART", "radau")],
)
def test_a_constant_that_moves_by_its_last_digits_changes_a_digest(module, name, method):
    """By one part in 1e15, in a process whose kernels are plain Python, so that the constant can be replaced."""

    def told(moved):
        script = MOVE_A_CONSTANT.format(module=module, name=name, method=method, moved=moved)
        environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
        found = subprocess.run(
            [sys.executable, "-c", script], env=environment, check=True, capture_output=True, text=True
        )
        return found.stdout.split()[-1]

    assert told(True) != told(False)
