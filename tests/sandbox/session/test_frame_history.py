"""The history of a session: its frames, and the bound of its memory."""

import numpy as np
import pytest
from softcradle.sandbox.session import (
    AddBead,
    RemoveBead,
    Session,
    SetMass,
)
from softcradle.sandbox.session.frame_history import BLOCK_ROWS
from softcradle.sandbox.session.history_slices import history_slices, last_slice, slice_at
from softcradle.sandbox.session.ledger import KINETIC, STORED, energy_error

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


@pytest.fixture(scope="module")
def edited():
    """A session of several blocks with edits in between, which change the number of beads too."""
    session = Session(scenes.load("beads-against-gear"))
    session.apply(AddBead(0, 4))
    session.step_frames(100)
    session.apply(AddBead(0, 5))
    session.step_frames(200)
    for k in range(20):
        session.apply(SetMass(0, 1, 0.4 + 0.1 * k))
        session.step_frames(7)
    session.apply(SetMass(0, 2, 77.0))
    session.step_frames(FRAMES)
    return session


def test_slices_are_the_frames_one_by_one(edited):
    last = edited.frame
    slices = edited.history_slices(0, 10_000)
    assert sum(len(part.time) for part in slices) == last + 1
    rng = np.random.default_rng(1)
    for frame in sorted({*rng.integers(0, last, 60).tolist(), 99, 100, 101, 300, last}):
        edited.scrub_frame(frame)
        part = next(part for part in reversed(slices) if part.first <= frame)
        lane, row = edited.lanes[0], frame - part.first
        assert part.setup is lane.setup
        assert edited.time == part.time[row]
        assert (lane.state.overlap == part.overlap[row]).all()
        assert part.position[row] == pytest.approx(lane.position, abs=1e-15)
        assert part.velocity[row] == pytest.approx(lane.velocity, abs=1e-15)
        kinetic = 0.5 * np.array(lane.chain.mass) * lane.velocity**2
        assert part.kinetic[row] == pytest.approx(kinetic, rel=1e-12)
        stored = sum(c.energy(d) for c, d in zip(lane.chain.contact, lane.state.overlap, strict=True))
        assert part.stored[row] == pytest.approx(stored, rel=1e-12)
        assert part.energy[row] == pytest.approx(part.ledger[row, [KINETIC, STORED]].sum(), rel=1e-12)
        assert energy_error(part.ledger).max() < 1e-10
    edited.scrub_frame(last)


def test_slices_end_at_the_frame_shown(edited):
    last = edited.frame
    edited.scrub_frame(last - 50)
    slices = edited.history_slices(1, 30)
    assert slices[-1].time[-1] == edited.time
    assert sum(len(part.time) for part in slices) == 30
    edited.scrub_frame(last)


def test_the_last_slice_begins_where_the_chain_was_last_changed(edited):
    part = last_slice(edited.history, 0, edited.frame)
    assert part.first == edited.frame - FRAMES
    assert (np.diff(part.time) > 0.0).all()
    assert (part.overlap[-1] == edited.lanes[0].state.overlap).all()


def test_slices_are_thinned_and_follow_changes_of_the_number_of_beads():
    session = Session(scenes.load("one-on-four"))
    session.step_frames(700)
    session.apply(AddBead(0, 5, 1.0))
    session.step_frames(50)
    whole = list(history_slices(session.history, 0, 0, session.history.last, 10**6))
    assert sum(len(part.time) for part in whole) == session.history.last + 1
    assert {part.velocity.shape[1] for part in whole} == {5, 6}
    thin = list(history_slices(session.history, 0, 0, session.history.last, 100))
    assert 90 <= sum(len(part.time) for part in thin) <= 200
    taken = {float(time) for part in thin for time in part.time}
    for first, last, most in ((0, 330, 50), (17, 680, 99), (301, 699, 60)):
        pieces = history_slices(session.history, 0, first, last, most)
        times = {float(time) for part in pieces for time in part.time}
        wanted = {
            time
            for time in taken
            if session.history.snapshot(first).time <= time <= session.history.snapshot(last).time
        }
        assert wanted <= times
    part = slice_at(session.history, 0, 600)
    state = session.history.snapshot(600).states[0]
    assert np.array_equal(part.velocity[0], state.velocity(part.chain))
    assert part.energy[0] == pytest.approx(0.5, rel=1e-9)
