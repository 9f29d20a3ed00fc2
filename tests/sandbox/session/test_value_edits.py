"""Edits of values: a number typed into a column of the tables of values is the number that is then in it."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from softcradle.sandbox.session import SetMass
from softcradle.sandbox.session.value_edits import EDITS, can_be_edited, edit_of
from softcradle.sandbox.session.values_table import BEAD_COLUMNS, CONTACT_COLUMNS, bead_table, value_of, values_csv
from softcradle.sandbox.window.plots.signals import Signal

from tests.helpers.sessions import opened

COLLIDING = 400  # frames after which contacts of one-on-four push
FOLLOWING = {"bead", "contact", "force (N)", "stored energy (J)"}  # of other numbers


def columns(kind: str) -> list[str]:
    return [name for name in (BEAD_COLUMNS if kind == "bead" else CONTACT_COLUMNS) if name in EDITS]


def test_all_but_what_follows_can_be_typed():
    assert set(BEAD_COLUMNS + CONTACT_COLUMNS) - set(EDITS) == FOLLOWING


@pytest.mark.parametrize("frames", [0, COLLIDING])
@pytest.mark.parametrize(
    ("kind", "column", "index"),
    [(kind, column, index) for kind in ("bead", "contact") for column in columns(kind) for index in (0, 2, 3)],
)
def test_a_number_is_in_its_column_after_the_edit_alone(kind: str, column: str, index: int, frames: int):
    session = opened()
    session.step_frames(frames)
    old = value_of(session, 0, kind, index, column)
    wanted = 0.5 * old if old else 0.125
    session.apply(edit_of(session, 0, column, index, wanted))
    assert value_of(session, 0, kind, index, column) == pytest.approx(wanted, rel=1e-12)
    assert session.undo()
    assert value_of(session, 0, kind, index, column) == old


def test_an_overlap_may_be_typed_and_pushes():
    session = opened()
    session.apply(edit_of(session, 0, "overlap (m)", 2, 0.25))
    lane = session.lanes[0]
    assert lane.state.force[2] == lane.chain.contact[2].force(0.25)
    assert lane.position[3] - lane.position[2] == pytest.approx(-0.25)
    assert session.to_scene().lanes[0].chain().gap[2] == -0.25  # a scene file can say it
    pressed = lane.state.force[2]
    session.step_frames(120)
    assert pressed > session.lanes[0].state.force[2]
    assert session.lanes[0].velocity[2] < 0.0 < session.lanes[0].velocity[3]


def test_kinetic_energy_keeps_the_direction():
    session = opened()
    session.step_frames(3 * COLLIDING)
    assert session.lanes[0].velocity[0] < 0.0
    session.apply(edit_of(session, 0, "kinetic energy (J)", 0, 2.0))
    assert session.lanes[0].velocity[0] == pytest.approx(-2.0)
    with pytest.raises(ValueError, match="kinetic energy must be a number from 0 on, not -1"):
        edit_of(session, 0, "kinetic energy (J)", 0, -1.0)


def test_a_wall_has_neither_momentum_nor_energy_to_type():
    session = opened()
    session.apply(SetMass(0, 4, math.inf))
    wall = [column for column in BEAD_COLUMNS if can_be_edited(session.lanes[0], column, 4)]
    assert wall == ["mass (kg)", "position (m)", "velocity (m/s)"]
    session.apply(edit_of(session, 0, "mass (kg)", 4, 2.0))
    assert session.lanes[0].chain.mass[4] == 2.0


@pytest.mark.parametrize(
    ("column", "value", "sentence"),
    [
        ("mass (kg)", -1.0, "mass"),
        ("velocity (m/s)", 1e13, "velocity"),
        ("momentum (N s)", -1e13, "velocity"),
        ("overlap (m)", 1e3, "below the length of a bead, 1 m, not 1000"),
        ("overlap (m)", -1e13, "a gap must be a number up to"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(column: str, value: float, sentence: str):
    session = opened()
    before = session.snapshot()
    with pytest.raises(ValueError, match=sentence):
        session.apply(edit_of(session, 0, column, 1, value))
    assert session.snapshot().states[0].overlap.tolist() == before.states[0].overlap.tolist()
    assert not session.undo_stack.unsaved


def test_beads_that_touch_are_a_length_apart():
    """The position is a place on the line: beads side by side do not have the same one, and the striker is on the left."""
    session = opened()
    session.step_frames(COLLIDING)
    length = session.scene.view.length
    places = [row[2] for row in bead_table(session, 0).rows]
    overlap = session.lanes[0].state.overlap
    assert [b - a for a, b in pairwise(places)] == pytest.approx((length - overlap).tolist())
    assert Signal("x", 2).values(session.lanes[0].motion, length)[0] == places[2]
    rows = [line.split(",") for line in values_csv(session).splitlines()]
    assert [float(row[3]) for row in rows[2:7]] == places
