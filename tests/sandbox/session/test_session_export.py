"""Tests of the files that a session writes and reads.

The tests check that a saved scene reads back equal, and that other programs can read exported motions. The tests also
check measured data and recordings. A replay of a recording must be bitwise equal to the session, or it must name the
first frame that differs.
"""

import json
import math
import re
from contextlib import suppress
from itertools import pairwise

import numpy as np
import pytest
from softcradle.physics import Contact, Trajectory
from softcradle.sandbox.draw.shared_scales import motion_of
from softcradle.sandbox.session import inputs, recording
from softcradle.sandbox.session.history_slices import last_slice
from softcradle.sandbox.session.replay import Replay
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.values_table import values_csv, values_table
from softcradle.sandbox.story.sentences import describe
from softcradle.sandbox.trajectory_summary import summarise
from softcradle.sandbox.user_error import UserError
from softcradle.sandbox.window.plots.kinds import Signal
from softcradle.scenes import parse

from tests.helpers.sessions import check_replay, opened, pull

ROW = 'title = "T"\n[[lanes]]\nvelocity = [0.8, 0.3, 0.1, 0.0]\ncontact = {law = "hooke", stiffness = 1.0}'


def test_velocities_are_written_as_they_were_given():
    """Check that round-off of velocities does not mark a scene as edited.

    A session stores differences of velocities. Computing the velocities from them changes the last digits.
    """
    session = Session(parse(ROW))
    assert not session.edited
    assert session.to_scene() == session.scene
    for item in (inputs.SetVelocity(0, 1, 0.7), inputs.AddBead(0, 4), inputs.RemoveBead(0, 0)):
        session.apply(item)
    assert session.to_scene().lanes[0].velocity == (0.7, 0.1, 0.0, 0.0)
    session.apply(inputs.SetVelocity(0, 1, 1e-9 / 3.0))
    assert session.to_scene().lanes[0].velocity[1] == pytest.approx(1e-9 / 3.0, abs=1e-16)
    session = Session(parse(ROW))
    for velocity in (0.7, 0.3):
        session.apply(inputs.SetVelocity(0, 1, velocity))
    assert not session.edited


def test_words_of_ones_own_stay_those_of_an_edited_scene():
    session = opened("one-on-four")
    session.set_words(session.to_scene().model_copy(update={"text": "Mine."}))
    session.apply(inputs.SetMass(0, 0, 2.0))
    assert session.to_scene().text == "Mine."


def test_a_common_method_is_written_with_different_steps():
    scene = opened("beads-against-gear", inputs.SetMethod(None, "verlet"), inputs.SetStep(1, 1e-4)).to_scene()
    assert (scene.method, scene.step) == ("verlet", None)
    rough = Session(parse('tolerance = 1e-4\nmethod = "radau"\n' + ROW))
    assert rough.to_scene().tolerance == 1e-4
    rough.apply(inputs.SetMethod(None, "verlet"))
    assert rough.to_scene().tolerance is None


def test_a_scene_that_cannot_be_written_is_rejected(tmp_path):
    session = opened("one-on-four", inputs.SetContact(0, 0, Contact(0.0, 1e-30, 0.1)))
    sentence = (
        "this cannot be saved as a scene file: the scene: contact 0-1 would be pressed by .* m; .*: choose other units"
    )
    with pytest.raises(UserError, match=f"^{sentence}$"):
        session.save_scene(tmp_path / "mine.toml")
    assert not list(tmp_path.iterdir())


def test_the_history_is_exported_as_a_trajectory(tmp_path):
    session = opened("beads-against-gear", frames=700)
    paths = session.export(tmp_path / "history.Npz")  # The endings of file names are case-insensitive.
    assert [path.name for path in paths] == ["history-1.Npz", "history-2.Npz"]
    for number, path in enumerate(paths):
        trajectory, part = Trajectory.load(path), last_slice(session.history, number, session.frame)
        assert (trajectory.time == part.time).all()
        assert trajectory.velocity == pytest.approx(part.velocity, abs=1e-14)
        assert (trajectory.final_velocity == session.lanes[number].velocity).all()
        assert trajectory.warnings == ()
        assert [len(intervals) for intervals in trajectory.contact_intervals] == [1, 1, 1]
        assert all(0.0 < closed < opened for ((closed, opened),) in trajectory.contact_intervals)


def test_the_export_begins_at_the_last_change_of_the_setup(tmp_path):
    methods = inputs.SetMethod(0, "euler"), 340, inputs.SetMethod(0, "conserving"), 10
    session = opened("one-on-four", *methods, memory=1)
    assert "frame 340, where the chain or its method" in str(session.trajectory(0).warnings[0])
    taken = session.lanes[0].setup.step_for(session.setup.frame_time)
    assert session.trajectory(0).step == taken < session.lanes[0].setup.step
    session.apply(inputs.SetMass(0, 1, 2.0))
    session.step_frames(20)
    session.apply(inputs.SetSlow(5.0))
    session.step_frames(30)
    with pytest.raises(UserError, match=r"\.npz or \.csv"):
        session.export(tmp_path / "history.xls")
    assert list(tmp_path.iterdir()) == []
    path = tmp_path / "history.CSV"
    assert session.export(path) == [path]
    rows = np.loadtxt(path, delimiter=",", skiprows=1)
    assert len(rows) == 51
    assert np.isfinite(rows).all()
    assert "frame 350" in str(session.trajectory(0).warnings[0])
    closed = [intervals[0][0] for intervals in session.trajectory(0).contact_intervals]
    assert min(closed) == session.trajectory(0).time[0], "closed from the start"
    assert session.trajectory(0).step == taken, "the longest: frames are shorter since"
    session.step_frames(2000)
    assert f"frame {session.history.first}, the oldest that is kept" in str(session.trajectory(0).warnings[0])


def test_the_export_of_an_earlier_frame_has_no_contact_of_later_ones():
    session = opened("one-on-four", frames=100)
    before = session.trajectory(0)
    session.step_frames(150)
    # After the first bead is removed, the remaining contacts have other numbers.
    session.apply(inputs.RemoveBead(0, 0))
    session.step_frames(100)
    session.scrub_frame(100)
    found = session.trajectory(0)
    assert found.contact_intervals == before.contact_intervals == ((),) * 4
    assert describe("", found) == describe("", before)
    session.scrub_frame(245)
    assert [intervals[-1][1] for intervals in session.trajectory(0).contact_intervals] == [math.inf] * 4


@pytest.mark.parametrize("name", ["one-on-four", "driven-cluster", "train-starting"])
def test_external_work_is_not_an_error_of_an_exported_motion(name, tmp_path):
    session = opened(name, frames=20)
    pull(session, 1, (float(session.lanes[0].position[1]) + 0.05 * k for k in range(20)))
    session.drop()
    session.pause()
    session.apply(inputs.SetVelocity(0, 0, 6.0))
    session.apply(inputs.Place(0, 0, float(session.lanes[0].position[0]) - 0.2))
    session.step_frames(40)
    (path,) = session.export(tmp_path / "thrown.npz")
    found = Trajectory.load(path)
    health, summary = session.health(0), summarise("", found)
    assert found.time[0] == 0.0
    assert np.abs(found.given[-1]).min() > 0.1
    assert health.energy_error < 1e-10
    assert summary.energy_error < health.energy_error + 1e-12
    assert summary.momentum_error is health.momentum_error is None or summary.momentum_error < 1e-12
    assert health.momentum_error is None or health.momentum_error < 1e-10
    assert motion_of(found).energy_error.max() < health.energy_error + 1e-12


def test_edits_at_the_start_are_not_work():
    """Check that moving a bead before the start is not counted as work of an external force.

    Also check that a bead can be thrown if all beads are at rest.
    """
    found = opened("driven-cluster", inputs.Place(0, 0, -0.5), frames=100).trajectory(0)
    energy = found.kinetic_energy + found.contact_energy
    assert found.driven[0] == 0.0
    assert found.driven == pytest.approx(energy - energy[0], abs=1e-12)
    session = opened("one-on-four", inputs.SetVelocity(0, None, 0.0), 5, inputs.SetVelocity(0, 0, 1.0), 400)
    summary = summarise("", session.trajectory(0))
    assert summary.energy_error == pytest.approx(session.health(0).energy_error, abs=1e-12)
    assert summary.momentum_error < 1e-12


def test_beads_that_touch_are_a_length_apart():
    """Check that the positions of touching beads differ by the length of a bead, and that the striker is on the left."""
    session = opened(frames=400)  # After 400 frames, the contacts are pressed.
    length = session.scene.view.length
    places = [row[2] for row in values_table(session, 0, "bead").rows]
    overlap = session.lanes[0].state.overlap
    assert [b - a for a, b in pairwise(places)] == pytest.approx((length - overlap).tolist())
    assert Signal("x", 2).values(session.lanes[0].motion, length)[0] == places[2]
    rows = [line.split(",") for line in values_csv(session).splitlines()]
    assert [float(row[3]) for row in rows[2:7]] == places


def metadata_of(path):
    with np.load(path) as file:
        return json.loads(str(file["metadata"]))


def test_the_names_in_a_recording_stay_those_of_earlier_versions(tmp_path):
    """Check the names of edits in the file of a recording.

    Python classes and attributes can be renamed. Files of users must nevertheless stay readable.
    """
    opened("one-on-four", inputs.SetMethod(None, "auto")).save_recording(tmp_path / "played.npz")
    metadata = metadata_of(tmp_path / "played.npz")
    assert set(metadata) == {"softcradle recording", "versions", "scene", "frame", "base", "inputs"}
    base = metadata["base"]
    assert set(base) == {"time", "slow", "hand", "lanes", "states", "ledgers"}
    assert base["hand"] == [-1.0, 0.0, 0.0]
    lane = {"label", "chain", "method", "step", "automatic", "step_given", "tolerance", "locked", "speed", "start"}
    assert set(base["lanes"][0]) == lane
    assert set(base["lanes"][0]["chain"]) == {"mass", "contact", "gap", "drive", "friction"}
    assert set(base["states"][0]) == {"time", "overlap", "rate", "anchor", "force"}
    assert metadata["inputs"][0] == [0, {"input": "SetMethod", "lane": None, "method": "auto"}]
    assert set(inputs.INPUTS) == {
        *("Place", "SetVelocity", "SetMass", "SetContact", "SetKind", "Lock", "SetGap", "SetDrive", "SetFriction"),
        *("AddBead", "RemoveBead", "SetMethod", "SetStep", "Drag", "Drop", "SetSlow", "Resume"),
    }


@pytest.mark.parametrize("part", [0.0, 0.3, 1.0])
def test_diverged_names_the_first_frame_that_differs(tmp_path, part):
    session = opened("one-on-four", inputs.SetMass(0, 1, 2.5), frames=60)
    hashes = session.recording.hashes
    frame = 1 + round(part * (len(hashes) - 1))
    hashes[frame - 1] ^= 1
    session.save_recording(tmp_path / "played.npz")
    replay = Replay.load(tmp_path / "played.npz")
    assert not replay.run()
    assert replay.diverged == frame
    assert re.search(rf"DIVERGED.*\b{frame}\b", replay.sentence)


@pytest.mark.parametrize("method", ["auto", "verlet", "pymunk"])
def test_a_full_recording_starts_again(method, tmp_path, monkeypatch):
    monkeypatch.setattr(recording, "MOST_INPUTS", 20)
    session = opened("one-on-four", inputs.SetMethod(None, method))
    session.play()
    for k in range(1000):
        session.drag(0, 0, 0.001 * k)
    assert [item for _, item in session.recording.inputs[1:]] == [inputs.Drag(0, 0, 0.999)]
    pull(session, 0, [0.01 * k for k in range(100)])
    assert session.recording.frame > 0
    assert len(session.recording.inputs) <= 22
    replay = check_replay(session, tmp_path / "late.npz")
    assert "agrees" in replay.sentence
    assert replay.session.frame == session.frame
    # This frame is played after the end of the recording and is therefore not in the file.
    replay.session.step_frames(1)
    assert f"left at frame {session.frame - session.recording.frame}" in replay.sentence
    session.scrub_frame(5)
    session.step_frames(-1)
    session.play()
    session.tick(0.1)
    assert check_replay(session, tmp_path / "early.npz").recording.frame == 4


def test_a_file_that_is_no_recording_is_refused_in_a_sentence(tmp_path):
    session, path = opened(frames=50), tmp_path / "bad.npz"
    session.save_recording(path)
    whole, metadata = np.fromfile(path, np.uint8), metadata_of(path)
    # Some damaged bytes cannot be detected, so loading may succeed. An exception other than UserError must not occur.
    for place in range(0, len(whole) - 4, 7):
        torn = whole.copy()
        torn[place : place + 4] ^= 0xFF
        torn.tofile(path)
        with suppress(UserError):
            Replay.load(path)
    unknown = {"inputs": [[0, {"input": "Explode"}]]}
    for changes, sentence in (({"softcradle recording": 99}, "later softcradle"), (unknown, "not a recording")):
        np.savez(path, metadata=json.dumps(metadata | changes), hashes=session.recording.hashes)
        with pytest.raises(UserError, match=sentence):
            Replay.load(path)
    (tmp_path / "text.npz").write_text("hello")
    for name, sentence in (("text", "not a recording"), ("none", "cannot read")):
        with pytest.raises(UserError, match=sentence):
            Replay.load(tmp_path / f"{name}.npz")
