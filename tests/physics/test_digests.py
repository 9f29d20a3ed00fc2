"""Determinism: the same digits run for run and on every machine."""

import json

import pytest

from tests.helpers.digests import FILE, NOT_OURS, digest, motions, runs, solved, states
from tests.helpers.own_process import python

RECORDED = json.loads(FILE.read_text())

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
    assert set(RECORDED) == {name for name, *_ in (*motions(), *runs())}


def test_digits_of_random_runs_are_those_recorded():
    ours = [(name, rest) for name, *rest in runs() if rest[-1] not in NOT_OURS]
    assert [name for name, rest in ours if solved(*rest) != RECORDED[name]] == []


@pytest.mark.parametrize(
    ("name", "chain", "velocity", "method"), list(motions()), ids=lambda value: value if isinstance(value, str) else ""
)
def test_digits_are_those_recorded(name, chain, velocity, method):
    again = digest(states(chain, velocity, method)) if method in NOT_OURS else RECORDED[name]
    assert digest(states(chain, velocity, method)) == again


@pytest.mark.parametrize(
    ("module", "name", "method"),
    [("adaptive.step_control", "SAFETY", "accurate"), ("adaptive.adaptive_loop", "TOLERANCE_PART", "radau")],
)
def test_a_constant_that_moves_by_its_last_digits_changes_a_digest(module, name, method):
    """By one part in 1e15, in a process whose kernels are plain Python, so that the constant can be replaced."""

    def told(moved):
        script = MOVE_A_CONSTANT.format(module=module, name=name, method=method, moved=moved)
        return python("-c", script, NUMBA_DISABLE_JIT="1").stdout.split()[-1]

    assert told(True) != told(False)
