"""The tables of values: places on the line, and every digit as CSV."""

from __future__ import annotations

from itertools import pairwise

import pytest
from softcradle.sandbox.session.values_table import bead_table, values_csv
from softcradle.sandbox.window.plots.plot_kinds import Signal

from tests.helpers.sessions import opened


def test_beads_that_touch_are_a_length_apart():
    """The position is a place on the line: beads side by side do not have the same one, and the striker is on the left."""
    session = opened()
    session.step_frames(400)  # contacts push
    length = session.scene.view.length
    places = [row[2] for row in bead_table(session, 0).rows]
    overlap = session.lanes[0].state.overlap
    assert [b - a for a, b in pairwise(places)] == pytest.approx((length - overlap).tolist())
    assert Signal("x", 2).values(session.lanes[0].motion, length)[0] == places[2]
    rows = [line.split(",") for line in values_csv(session).splitlines()]
    assert [float(row[3]) for row in rows[2:7]] == places
