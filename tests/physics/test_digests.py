"""Determinism: the same digits run for run and on every machine."""

import json

import numpy as np
import pytest

from tests.helpers.digests import FILE, NOT_OURS, digest, motions, runs, solved, states

RECORDED = json.loads(FILE.read_text())


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


def test_a_last_digit_changes_a_digest():
    rows = np.linspace(0.1, 1.0, 60).reshape(12, 5)
    assert (
        len({digest(rows), *(digest(np.nextafter(rows, rows + step)) for step in np.eye(60).reshape(60, 12, 5))}) == 61
    )
