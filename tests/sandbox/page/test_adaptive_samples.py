"""Adaptive samples: straight lines between them miss nothing by more than is allowed."""

from __future__ import annotations

import numpy as np
import pytest
from softcradle.sandbox.page.adaptive_samples import needed_rows


def curves(seed):
    """(T,) times and (T, 3) values with smooth parts, a jump and a power of the time since an onset."""
    random = np.random.default_rng(seed)
    time = np.sort(random.uniform(0.0, 1.0, 3000))
    onset, jump = random.uniform(0.1, 0.9, 2)
    since = np.maximum(time - onset, 0.0)
    return time, np.stack((np.sin(random.uniform(3, 60) * time), np.where(time > jump, 1.0, 0.0), since**0.1), axis=1)


def missed(time, values, rows):
    lines = [np.interp(time, time[rows], column[rows]) for column in values.T]
    return np.abs(np.stack(lines, axis=1) - values)


@pytest.mark.parametrize("seed", range(20))
def test_nothing_is_missed(seed):
    time, values = curves(seed)
    allowed = np.full(values.shape, 1e-3)
    rows = needed_rows(time, values, allowed)
    assert (np.diff(rows) > 0).all()
    assert (rows[0], rows[-1]) == (0, len(time) - 1)
    assert (missed(time, values, rows) <= allowed * (1 + 1e-9)).all()
    assert len(rows) < len(time) / 4


def test_finer_lines_need_more_rows():
    time, values = curves(1)
    counts = [len(needed_rows(time, values, np.full(values.shape, error))) for error in (1e-2, 1e-3, 1e-4)]
    assert counts == sorted(counts)
    assert counts[0] < counts[2]


def test_a_straight_line_needs_its_ends():
    time = np.linspace(0.0, 1.0, 500)
    rows = needed_rows(time, time[:, None], np.full((500, 1), 1e-9))
    assert rows.tolist() == [0, 499]


def test_two_rows_at_one_time():
    """A force that jumps has a row before and a row after; times of both may be the same number."""
    time = np.array([0.0, 0.5, 0.5, 1.0])
    values = np.array([[0.0], [0.0], [1.0], [1.0]])
    assert needed_rows(time, values, np.full((4, 1), 1e-6)).tolist() == [0, 1, 2, 3]
