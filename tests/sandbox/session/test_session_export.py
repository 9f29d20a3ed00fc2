"""Exports of a session: scenes that read back equal, histories that other programs read."""

import csv
import math
from itertools import pairwise

import numpy as np
import pytest
from softcradle.physics import Contact, Trajectory, hertz
from softcradle.sandbox.session import (
    AddBead,
    Lock,
    Place,
    RemoveBead,
    Session,
    SetContact,
    SetDrive,
    SetGap,
    SetMass,
    SetMethod,
    SetSlow,
    SetStep,
    SetVelocity,
)
from softcradle.sandbox.session.history_slices import last_slice
from softcradle.sandbox.session.values_table import values_csv, values_table
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.plots.kinds import Signal
from softcradle.scenes import parse

from softcradle import scenes
from tests.helpers.scene_kinds import EVERY_SCENE
from tests.helpers.sessions import opened


@pytest.mark.parametrize("name", EVERY_SCENE)
def test_an_unedited_scene_comes_back_equal(name):
    scene = scenes.load(name)
    session = Session(scene)
    session.step_frames(50)
    assert session.to_scene() == scene
    assert parse(session.to_scene().to_toml()) == scene


def test_an_edited_scene_reads_back_as_the_same_session(tmp_path):
    session = Session(scenes.load("beads-against-gear"))
    for edit in (
        AddBead(0, 4, 0.25, 0.5),
        RemoveBead(1, 0),
        SetMass(0, 4, math.inf),
        SetMass(1, 0, 1.0 / 3.0),
        SetContact(0, 0, hertz(12.0)),
        SetContact(0, 1, Contact(0.1, 0.3, 0.7)),
        SetVelocity(0, 1, -0.1),
        SetGap(0, 2, 0.015),
        Place(1, 0, -0.5),
        SetDrive(1, 1, 0.2),
        Lock(1, 0),
        SetSlow(7.0),
        SetMethod(None, "verlet"),
        SetStep(None, 1e-4),
    ):
        session.apply(edit)
    session.save_scene(tmp_path / "mine.toml")
    again = Session(scenes.load(tmp_path / "mine.toml"))
    for one, other in zip(session.lanes, again.lanes, strict=True):
        assert (one.chain.mass, one.chain.contact, one.chain.drive) == (
            other.chain.mass,
            other.chain.contact,
            other.chain.drive,
        )
        assert (one.setup.method, one.setup.step) == (other.setup.method, other.setup.step)
        assert one.velocity == pytest.approx(other.velocity, abs=1e-15)
        assert one.state.overlap == pytest.approx(other.state.overlap, abs=1e-15)
    labels = [session.label(lane) for lane in (0, 1)]
    assert labels == [again.label(lane) for lane in (0, 1)] == [lane.label for lane in again.scene.lanes]
    assert labels == [one.setup.label for one in again.lanes] == ["mixed contacts", "Hertz, alpha = 3/2 and draft gear"]
    assert again.slow == 7.0
    session.step_frames(200)
    again.step_frames(200)
    assert session.lanes[1].velocity == pytest.approx(again.lanes[1].velocity, abs=1e-9)


def test_a_label_says_once_that_a_lane_was_edited(tmp_path):
    session = Session(scenes.load("beads-against-gear"))
    for mass in (2.0, 3.0):
        session.apply(SetMass(0, 1, mass))
        session.save_scene(tmp_path / "mine.toml")
        session = Session(scenes.load(tmp_path / "mine.toml"))
    assert session.label(0) == f"{scenes.load('beads-against-gear').lanes[0].label}, edited"


def test_a_scene_is_the_start_with_the_edits_and_not_the_frame_shown():
    session = Session(scenes.load("one-on-four"))
    session.step_frames(300)
    session.apply(SetMass(0, 1, 2.0))
    session.apply(SetVelocity(0, 1, 9.0))
    lane = session.to_scene().lanes[0]
    assert lane.velocity == (1.0, 0.0, 0.0, 0.0, 0.0)
    assert lane.chain().mass[1] == 2.0


def test_a_scene_with_two_walls_has_a_duration():
    session = Session(scenes.load("one-on-four"))
    session.apply(SetMass(0, 0, math.inf))
    session.apply(SetMass(0, 4, math.inf))
    assert parse(session.to_scene().to_toml()).duration == 10.0


def test_the_history_is_exported_as_a_trajectory(tmp_path):
    session = Session(scenes.load("beads-against-gear"))
    session.step_frames(700)
    paths = session.export(tmp_path / "history.npz")
    assert [path.name for path in paths] == ["history-1.npz", "history-2.npz"]
    for number, path in enumerate(paths):
        trajectory, part = Trajectory.load(path), last_slice(session.history, number, session.frame)
        assert (trajectory.time == part.time).all()
        assert trajectory.velocity == pytest.approx(part.velocity, abs=1e-14)
        assert (trajectory.final_velocity == session.lanes[number].velocity).all()
        assert trajectory.warnings == ()
        assert [len(intervals) for intervals in trajectory.contact_intervals] == [1, 1, 1]
        assert all(0.0 < closed < opened for ((closed, opened),) in trajectory.contact_intervals)


def test_the_export_begins_where_the_chain_was_last_changed(tmp_path):
    session = Session(scenes.load("one-on-four"))
    session.step_frames(350)
    session.apply(SetMass(0, 1, 2.0))
    session.step_frames(20)
    session.apply(SetSlow(5.0))
    session.step_frames(30)
    (path,) = session.export(tmp_path / "history.csv")
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    assert len(rows) == 1 + 51
    assert "frame 350" in str(session.trajectory(0).warnings[0])
    closed = [intervals[0][0] for intervals in session.trajectory(0).contact_intervals]
    assert min(closed) == session.trajectory(0).time[0], "closed from the start"
    assert np.isfinite(np.array(rows[1:], dtype=float)).all()


def test_an_export_that_cannot_be_written_is_refused_in_a_sentence(tmp_path):
    session = Session(scenes.load("one-on-four"))
    with pytest.raises(UserError, match=r"\.npz or \.csv"):
        session.export(tmp_path / "history.xls")
    with pytest.raises(UserError, match="no folder"):
        session.export(tmp_path / "nowhere" / "history.csv")
    with pytest.raises(UserError, match="no folder"):
        session.save_scene(tmp_path / "nowhere" / "mine.toml")


def test_beads_that_touch_are_a_length_apart():
    """The position is a place on the line: beads side by side do not have the same one, and the striker is on the left."""
    session = opened()
    session.step_frames(400)  # contacts push
    length = session.scene.view.length
    places = [row[2] for row in values_table(session, 0, "bead").rows]
    overlap = session.lanes[0].state.overlap
    assert [b - a for a, b in pairwise(places)] == pytest.approx((length - overlap).tolist())
    assert Signal("x", 2).values(session.lanes[0].motion, length)[0] == places[2]
    rows = [line.split(",") for line in values_csv(session).splitlines()]
    assert [float(row[3]) for row in rows[2:7]] == places
