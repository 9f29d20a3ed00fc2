"""The history of a session: its frames, and the bound of its memory."""

import numpy as np
import pytest
from softcradle.sandbox.session import (
    AddBead,
    RemoveBead,
    Session,
    SetKind,
    SetMass,
)
from softcradle.sandbox.session.frame_history import BLOCK_ROWS

from softcradle import scenes

FRAMES = BLOCK_ROWS + 300


def test_frame_at_finds_the_nearest_frame():
    session = Session(scenes.load("beads-against-gear"))
    session.step_frames(FRAMES)
    session.apply(AddBead(0, 1))
    session.step_frames(FRAMES)
    history = session.history
    times = np.concatenate([block.time[: block.used] for block in history.blocks])
    rng = np.random.default_rng(2)
    for time in [*rng.uniform(-0.01, times[-1] + 0.01, 200), *times[BLOCK_ROWS - 3 : BLOCK_ROWS + 3] + 1e-9]:
        assert abs(times[history.frame_at(time)] - time) == np.abs(times - time).min()


def test_memory_is_bounded_and_the_oldest_is_dropped():
    bound = 600_000
    session = Session(scenes.load("beads-against-gear"), memory=bound)
    largest = 0
    for _ in range(60):
        session.step_frames(100)
        largest = max(largest, session.history.memory)
    assert largest < bound + session.history.blocks[-1].memory
    assert session.history.memory > 0.5 * bound
    assert session.history.first > 0
    assert session.span[0] > 0.0
    session.scrub(0.0)
    assert session.frame == session.history.first
    with pytest.raises(IndexError, match="not in the history"):
        session.history.snapshot(session.history.first - 1)
    session.step_frames(-50)
    assert session.frame == session.history.first


def test_memory_is_bounded_under_many_edits():
    session = Session(scenes.load("one-on-four"), memory=600_000)
    for k in range(450):
        session.apply(SetKind(0, k % 4, ("power", "gear", "hard")[k % 3]))
        session.apply(RemoveBead(0, 1) if k % 2 else AddBead(0, 1))
        session.step_frames(1)
        assert session.history.memory < 1_100_000
    assert session.history.first > 0


def test_paused_edits_stay_on_their_frame():
    session = Session(scenes.load("one-on-four"))
    session.step_frames(10)
    for k in range(50):
        session.apply(SetMass(0, 1, 1.0 + k))
        session.apply(AddBead(0, 1))
        session.apply(RemoveBead(0, 1))
    assert (session.frame, session.history.last) == (10, 10)
    assert sum(len(part.time) for part in session.history_slices(0, 100)) == 11


def test_a_branch_is_another_one_where_frames_are_dropped_or_replaced_and_not_where_they_are_added():
    session = Session(scenes.load("one-on-four"))
    branch, version = session.history.branch, session.history.version
    session.step_frames(BLOCK_ROWS + 10)
    assert session.history.branch == branch
    assert session.history.version != version
    found = [branch]
    for act in (lambda: session.apply(SetMass(0, 1, 2.0)), session.undo, session.redo, session.restart):
        act()
        found.append(session.history.branch)
    assert len(set(found)) == 5
