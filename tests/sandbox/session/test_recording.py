"""Recordings: a replay has the digits of the session, or tells the first frame that differs."""

import json
import re

import numpy as np
import pytest
from softcradle.sandbox.session import Drag, Replay, SetMass, SetMethod, SetSlow, recording
from softcradle.sandbox.session.inputs import INPUTS
from softcradle.sandbox.user_error import UserError

from tests.helpers.sessions import frame_table, opened


def played(method="auto"):
    """A session with edits, a drag, a branch and a slow motion that changes."""
    session = opened("one-on-four", SetMethod(None, method))
    session.play()
    for k in range(40):
        session.tick(1 / 60)
        if 5 < k < 15:
            session.drag(0, 0, 0.1 * k)
    session.drop()
    session.apply(SetMass(0, 1, 2.5))
    session.apply(SetSlow(1.0))
    session.step_frames(60)
    session.scrub_frame(30)
    session.play()
    session.tick(0.2)
    session.apply(Drag(0, 0, -1.0))
    session.tick(0.2)
    return session


def metadata_of(path):
    with np.load(path) as file:
        return json.loads(str(file["metadata"]))


@pytest.mark.parametrize("method", ["auto", "verlet", "pymunk"])
def test_a_replay_has_the_same_digits(tmp_path, method):
    session = played(method)
    session.save_recording(tmp_path / "played.npz")
    replay = Replay.load(tmp_path / "played.npz")
    assert replay.run()
    assert replay.session.frame == session.frame
    assert frame_table(replay.session) == frame_table(session)
    assert "agrees" in replay.sentence


def test_the_names_in_a_recording_stay_those_of_earlier_versions(tmp_path):
    """Classes and attributes may get other names; what is in the files that people have must not."""
    played().save_recording(tmp_path / "played.npz")
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
    assert set(INPUTS) == {
        *("Place", "SetVelocity", "SetMass", "SetContact", "SetKind", "Lock", "SetGap", "SetDrive", "SetFriction"),
        *("AddBead", "RemoveBead", "SetMethod", "SetStep", "Drag", "Drop", "SetSlow", "Resume"),
    }


@pytest.mark.parametrize("part", [0.0, 0.3, 1.0])
def test_diverged_names_the_first_frame_that_differs(tmp_path, part):
    """How many frames were played depends on the clock: on a loaded machine they are fewer."""
    session = played()
    hashes = session.recording.hashes
    frame = 1 + round(part * (len(hashes) - 1))
    hashes[frame - 1] ^= 1
    session.save_recording(tmp_path / "played.npz")
    replay = Replay.load(tmp_path / "played.npz")
    assert not replay.run()
    assert replay.diverged == frame
    assert re.search(rf"DIVERGED.*\b{frame}\b", replay.sentence)


def test_only_the_last_pointer_position_of_a_frame_is_recorded():
    session = opened()
    session.play()
    for k in range(1000):
        session.drag(0, 0, 0.001 * k)
    assert [item for _, item in session.recording.inputs] == [Drag(0, 0, 0.999)]


def test_a_full_recording_begins_anew_and_still_replays(tmp_path, monkeypatch):
    monkeypatch.setattr(recording, "MOST_INPUTS", 20)
    session = opened()
    session.play()
    for k in range(100):
        session.drag(0, 0, 0.01 * k)
        session.tick(1 / 60)
    assert session.recording.frame > 0
    assert len(session.recording.inputs) <= 22
    session.save_recording(tmp_path / "late.npz")
    assert Replay.load(tmp_path / "late.npz").run()
    session.scrub_frame(5)
    session.step_frames(-1)
    session.play()
    session.tick(0.1)
    session.save_recording(tmp_path / "early.npz")
    replay = Replay.load(tmp_path / "early.npz")
    assert replay.recording.frame == 4
    assert replay.run()


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"softcradle recording": 99}, "later softcradle"),
        ({"inputs": [[0, {"input": "Explode"}]]}, "not a recording"),
        ({"inputs": [[0, {"input": "Drop", "loudly": 1}]]}, "not a recording"),
        ({"base": {}}, "not a recording"),
        ({"scene": "title ="}, "not a recording"),
    ],
)
def test_a_file_that_is_no_recording_is_refused_in_a_sentence(tmp_path, changes, sentence):
    session, path = opened(), tmp_path / "bad.npz"
    session.save_recording(path)
    np.savez(path, metadata=json.dumps(metadata_of(path) | changes), hashes=session.recording.hashes)
    with pytest.raises(UserError, match=sentence):
        Replay.load(path)


def test_other_files_are_refused(tmp_path):
    (tmp_path / "text.npz").write_text("hello")
    np.savez(tmp_path / "other.npz", a=np.zeros(3))
    for name, sentence in (("text", "not a recording"), ("other", "not a recording"), ("none", "cannot read")):
        with pytest.raises(UserError, match=sentence):
            Replay.load(tmp_path / f"{name}.npz")
