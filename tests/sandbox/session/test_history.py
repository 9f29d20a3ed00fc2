"""The history of a session: bounded in memory; its slices and contact events are those of the frames one by one."""

import math

import numpy as np
import pytest
from softcradle.physics import hertz, simulate
from softcradle.sandbox.session import (
    AddBead,
    RemoveBead,
    Session,
    SetContact,
    SetGap,
    SetKind,
    SetMass,
    SetSlow,
    SetVelocity,
)
from softcradle.sandbox.session.contact_events import ContactEventIndex
from softcradle.sandbox.session.history import BLOCK_ROWS
from softcradle.sandbox.session.history_slices import last_slice
from softcradle.sandbox.session.ledger import KINETIC, STORED, energy_error

from softcradle import scenes

FRAMES = BLOCK_ROWS + 300


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


def test_frame_at_finds_the_nearest_frame(edited):
    history = edited.history
    times = np.concatenate([block.time[: block.used] for block in history.blocks])
    rng = np.random.default_rng(2)
    for time in [*rng.uniform(-0.01, times[-1] + 0.01, 200), *times[BLOCK_ROWS - 3 : BLOCK_ROWS + 3] + 1e-9]:
        assert abs(times[history.frame_at(time)] - time) == np.abs(times - time).min()


def test_contact_events_are_the_contact_intervals_of_a_trajectory():
    session = Session(scenes.load("hertz-cradle"))
    lane = session.scene.lanes[0]
    session.step_frames(FRAMES)
    session.step_frames(FRAMES)
    truth = simulate(lane.chain(), lane.velocity, session.time, "conserving", step=1e-3)
    events = session.contact_events()
    assert (np.diff(events.time) >= 0.0).all()
    for contact, intervals in enumerate(truth.contact_intervals):
        own = events.select(events.contact == contact)
        expected = [time for interval in intervals for time in interval]
        assert np.isfinite(expected).all()
        assert own.time == pytest.approx(expected, abs=session.setup.frame_time)
        assert own.closed.tolist() == [True, False] * len(intervals)


def test_an_impact_within_one_frame_is_not_missed():
    session = Session(scenes.load("one-on-four"))
    session.apply(SetSlow(1.0))
    session.apply(SetContact(0, None, hertz(1e9)))
    session.apply(SetGap(0, 0, 0.5))
    session.step_frames(120)
    first = session.contact_events().select(session.contact_events().contact == 0)
    assert first.closed.tolist()[:2] == [True, False]
    assert first.speed[0] == pytest.approx(1.0)
    assert first.time[0] == pytest.approx(0.5, abs=0.01)


def test_contact_events_of_a_dropped_branch_are_dropped():
    session = Session(scenes.load("one-on-four"))
    session.step_frames(FRAMES)
    assert session.contact_events().closed.any()
    session.scrub_frame(BLOCK_ROWS - 1)
    session.apply(SetVelocity(0, None, -3.0))
    session.step_frames(FRAMES)
    fresh = ContactEventIndex(session.history).all()
    for known, found in zip(session.contact_events().columns(), fresh.columns(), strict=True):
        assert (known == found).all()
    session.scrub_frame(10)
    session.apply(SetVelocity(0, None, 0.0))
    session.step_frames(10)
    assert len(session.contact_events().time) == 0


def test_contact_events_read_all_along_are_those_found_at_the_end():
    session = Session(scenes.load("hertz-cradle"), memory=700_000)
    for edit in (SetMass(0, 0, math.inf), SetMass(0, 4, math.inf), SetSlow(1.0), SetVelocity(0, None, 0.0)):
        session.apply(edit)
    session.apply(SetVelocity(0, 2, 1.0))
    for k in range(25):
        session.step_frames(190)
        session.contact_events()
        if k % 6 == 5:
            session.scrub_frame(session.history.last - 300)
            session.apply(SetVelocity(0, 1 + k % 3, 1.5))
    assert session.history.first > 0
    fresh = ContactEventIndex(session.history).all()
    assert len(fresh.time) > 20
    for known, found in zip(session.contact_events().columns(), fresh.columns(), strict=True):
        assert (known == found).all()


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
    session = Session(scenes.load("one-on-four"), memory=2_000_000)
    for k in range(1500):
        session.apply(SetKind(0, k % 4, ("power", "gear", "hard")[k % 3]))
        session.apply(RemoveBead(0, 1) if k % 2 else AddBead(0, 1))
        session.step_frames(1)
        assert session.history.memory < 2_500_000
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
