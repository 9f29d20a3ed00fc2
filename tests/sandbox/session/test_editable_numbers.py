"""Editable numbers: each of the table is in the inspector, the table of values, undo, replay and the scene file."""

import math

import pytest
from softcradle.sandbox.quantities import OVERLAP
from softcradle.sandbox.session.editable_numbers import NUMBERS, EditableNumber, parameters
from softcradle.sandbox.session.replay import Replay
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.values_table import values_table

from tests.helpers.sessions import opened

SCENES = ("one-on-four", "experiment-one-on-three", "galilean")  # power laws, draft gears, open gaps


def owner_of(number: EditableNumber) -> tuple[Session, int]:
    """A session and a bead or contact of it that has the number."""
    for name in SCENES:
        session = opened(name)
        for index, value in enumerate(number.values(session.lanes[0])):
            if not math.isnan(value):
                return session, index
    raise AssertionError(number.key)


def read(session: Session, number: EditableNumber, index: int) -> float:
    """The number as the table of values has it."""
    table = values_table(session, 0, number.owner)
    shown = table.rows[index][table.columns.index(number.column)]
    return -shown if number.column == OVERLAP.column else shown


@pytest.mark.parametrize("number", NUMBERS, ids=lambda number: number.name)
def test_a_number_is_wherever_numbers_are(number: EditableNumber, tmp_path) -> None:
    session, index = owner_of(number)
    before = number.values(session.lanes[0])[index]
    parameter = next(one for one in parameters(session, 0, number.owner, index) if one.name == number.name)
    assert parameter.value == before
    value = parameter.at(0.3)
    assert value != before
    session.apply(parameter.edit(value))
    assert number.values(session.lanes[0])[index] == read(session, number, index) == pytest.approx(value, rel=1e-12)
    again = Session(session.to_scene())
    assert number.values(again.lanes[0])[index] == pytest.approx(value, rel=1e-12)
    session.step_frames(3)
    session.save_recording(tmp_path / "session.npz")
    replay = Replay.load(tmp_path / "session.npz")
    assert replay.run()
    assert number.values(replay.session.lanes[0])[index] == number.values(session.lanes[0])[index]
    session.scrub_frame(0)
    assert session.undo()
    assert number.values(session.lanes[0])[index] == before


def test_a_number_that_no_bead_has_takes_no_room() -> None:
    """All of a row of power laws are without preload and loss: the table of values has no such columns."""
    session = opened()
    columns = values_table(session, 0, "contact").columns
    assert {"f0 (N/m^a)", "alpha"} <= set(columns)
    assert {"preload (N)", "loss", "k (N/m)"}.isdisjoint(columns)
    preload = next(one for one in parameters(session, 0, "contact", 2) if one.key == "preload")
    session.apply(preload.edit(1.0))
    assert "preload (N)" in values_table(session, 0, "contact").columns


def test_a_gap_of_beads_that_touch_has_no_sign() -> None:
    session = opened("two-on-two")
    session.lanes[0].state.overlap[:] = 0.0
    gap = parameters(session, 0, "contact", 1)[-1]
    assert str(gap.value) == "0.0"
