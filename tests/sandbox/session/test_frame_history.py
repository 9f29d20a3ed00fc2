"""Tests of the stored frames of a session.

The tests check the contents of the frames, the memory limit, and the times at which contacts open and close.
"""

import math

import numpy as np
import pytest
from softcradle.physics import hertz, simulate
from softcradle.sandbox.session import frame_history, inputs
from softcradle.sandbox.session.contact_events import contact_events
from softcradle.sandbox.session.frame_history import BLOCK_ROWS
from softcradle.sandbox.session.history_slices import history_slices, last_slice, slice_at
from softcradle.sandbox.session.ledger import KINETIC, STORED, energy_error

from tests.helpers.sessions import opened

FRAMES = BLOCK_ROWS + 300


@pytest.fixture(scope="module")
def edited():
    masses = [one for k in range(20) for one in (inputs.SetMass(0, 1, 0.4 + 0.1 * k), 7)]
    beads = inputs.AddBead(0, 4), 100, inputs.AddBead(0, 5), 200
    return opened("beads-against-gear", *beads, *masses, inputs.SetMass(0, 2, 77.0), FRAMES)


def test_memory_is_bounded_and_the_oldest_is_dropped():
    bound = 600_000
    session = opened("beads-against-gear", memory=bound)
    session.step_frames(6000)
    assert 0.5 * bound < session.history.memory < bound + session.history.blocks[-1].memory
    assert session.history.first > 0
    assert session.span[0] > 0.0
    session.scrub_frame(session.history.frame_at(0.0))
    assert session.frame == session.history.first
    with pytest.raises(IndexError, match="not in the history"):
        session.history.snapshot(session.history.first - 1)
    session.step_frames(-50)
    assert session.frame == session.history.first


def test_only_dropped_or_replaced_frames_make_another_branch():
    session = opened()
    branch, version = session.history.branch, session.history.version
    session.step_frames(BLOCK_ROWS + 10)
    assert session.history.branch == branch
    assert session.history.version != version
    found = [branch]
    for act in (lambda: session.apply(inputs.SetMass(0, 1, 2.0)), session.undo, session.redo, session.restart):
        act()
        found.append(session.history.branch)
    assert len(set(found)) == 5


def test_the_frame_nearest_to_a_time_is_shown(edited):
    times = np.concatenate([block.time[: block.used] for block in edited.history.blocks])
    wanted = np.concatenate((np.linspace(-0.01, times[-1] + 0.01, 200), times[BLOCK_ROWS - 3 : BLOCK_ROWS + 3] + 1e-9))
    for time in wanted:
        edited.scrub_frame(edited.history.frame_at(time))
        assert abs(edited.time - time) == np.abs(times - time).min()
    edited.scrub_frame(edited.history.last)


def test_slices_are_the_frames_one_by_one_up_to_the_one_shown(edited):
    last = edited.frame
    slices = edited.history_slices(0, 10_000)
    assert sum(len(part.time) for part in slices) == last + 1
    for frame in {*np.random.default_rng(1).integers(0, last, 60).tolist(), 99, 100, 101, 300, last}:
        edited.scrub_frame(frame)
        part = next(part for part in reversed(slices) if part.first <= frame)
        lane, row = edited.lanes[0], frame - part.first
        assert part.setup is lane.setup
        assert edited.time == part.time[row]
        assert (lane.state.overlap == part.overlap[row]).all()
        assert (slice_at(edited.history, 0, frame).overlap == part.overlap[row]).all()
        assert part.position[row] == pytest.approx(lane.position, abs=1e-15)
        assert part.velocity[row] == pytest.approx(lane.velocity, abs=1e-15)
        assert part.kinetic[row] == pytest.approx(0.5 * np.array(lane.chain.mass) * lane.velocity**2, rel=1e-12)
        stored = sum(c.energy(d) for c, d in zip(lane.chain.contact, lane.state.overlap, strict=True))
        assert part.stored[row] == pytest.approx(stored, rel=1e-12)
        assert part.energy[row] == pytest.approx(part.ledger[row, [KINETIC, STORED]].sum(), rel=1e-12)
        assert energy_error(part.ledger).max() < 1e-10
    edited.scrub_frame(last)
    part = last_slice(edited.history, 0, last)
    assert part.first == last - FRAMES, "where the chain was last changed"
    assert (np.diff(part.time) > 0.0).all()
    assert (part.overlap[-1] == edited.lanes[0].state.overlap).all()
    edited.scrub_frame(last - 50)
    slices = edited.history_slices(1, 30)
    assert slices[-1].time[-1] == edited.time
    assert sum(len(part.time) for part in slices) == 30
    edited.scrub_frame(last)


def test_thinned_slices_follow_the_number_of_beads():
    session = opened("one-on-four", 700, inputs.AddBead(0, 5, 1.0), 50)
    thin = list(history_slices(session.history, 0, 0, session.history.last, 100))
    assert 90 <= sum(len(part.time) for part in thin) <= 200
    assert {part.velocity.shape[1] for part in thin} == {5, 6}
    taken = {float(time) for part in thin for time in part.time}
    for first, last, most in ((0, 330, 50), (17, 680, 99), (301, 699, 60)):
        pieces = history_slices(session.history, 0, first, last, most)
        begin, end = (session.history.snapshot(frame).time for frame in (first, last))
        assert {time for time in taken if begin <= time <= end} <= {time for part in pieces for time in part.time}


@pytest.mark.parametrize(("method", "error"), [("conserving", 1.5e-3), ("accurate", 1e-5)])
def test_contact_events_have_the_located_times(method, error):
    session = opened("hertz-cradle", inputs.SetMethod(None, method), frames=2 * FRAMES)
    lane = session.scene.lanes[0]
    truth = simulate(lane.chain(), lane.velocity, session.time, "accurate", tolerance=1e-10)
    events = session.contact_events()
    assert (np.diff(events.time) >= 0.0).all()
    for contact, intervals in enumerate(truth.contact_intervals):
        own = events.select(events.contact == contact)
        expected = [time for interval in intervals for time in interval]
        assert np.isfinite(expected).all()
        assert own.time == pytest.approx(expected, abs=error), "at the most a step"
        assert own.closed.tolist() == [True, False] * len(intervals)
        np.testing.assert_array_equal(np.ravel(session.trajectory(0).contact_intervals[contact]), own.time)


def test_bounces_within_one_frame_are_all_events():
    edits = [inputs.SetMethod(None, "accurate"), inputs.SetContact(0, None, hertz(1e9)), inputs.SetSlow(1.0)]
    edits += [inputs.SetMass(0, bead, mass) for bead, mass in enumerate((math.inf, 1e-3, math.inf))]
    edits += [inputs.SetVelocity(0, 1, 1.0), inputs.SetGap(0, 0, 1e-3), inputs.SetGap(0, 1, 1e-3)]
    session = opened("one-on-four", *edits, frames=1)
    lane = session.to_scene().lanes[0]
    truth = simulate(lane.chain(), lane.velocity, session.time, "accurate").contact_intervals
    events = session.contact_events()
    assert len(truth[1]) > 1
    assert events.speed[events.contact == 1][0] == pytest.approx(1.0)
    for contact in (0, 1):
        times = events.select(events.contact == contact).time
        assert times == pytest.approx([t for span in truth[contact] for t in span if t < math.inf], abs=1e-6)


def test_a_contact_that_an_edit_opens_does_so_at_its_frame():
    session = opened(frames=300)
    before = len(session.contact_events().time)
    session.apply(inputs.Place(0, 0, -0.5))
    assert len(session.contact_events().time) == before + 1
    assert [column[-1] for column in session.contact_events()] == [session.time, 300, 0, 0, False, 0.0, 0.0]


@pytest.mark.parametrize("rows", [BLOCK_ROWS, 1], ids=["inside a block", "at its beginning"])
def test_an_impact_survives_edits_of_its_frame(rows, monkeypatch):
    monkeypatch.setattr(frame_history, "BLOCK_ROWS", rows)
    session = opened()
    while not session.contact_events().time.size:
        session.step_frames(1)
    before = session.contact_events()
    for edit in (inputs.AddBead(0, 3), inputs.RemoveBead(0, 0), inputs.AddBead(0, 1)):
        session.apply(edit)
        np.testing.assert_array_equal(session.contact_events(), before)
    session.step_frames(3)
    session.scrub_frame(session.frame - 4)
    session.apply(inputs.SetSlow(2.0))
    assert not session.contact_events().time.size
    for _ in range(3):
        session.undo()
    np.testing.assert_array_equal(session.contact_events(), before)


def test_contact_events_read_all_along_are_those_found_at_the_end():
    edits = [inputs.SetMass(0, 0, math.inf), inputs.SetMass(0, 4, math.inf), inputs.SetSlow(1.0)]
    edits += [inputs.SetVelocity(0, None, 0.0), inputs.SetVelocity(0, 2, 1.0)]
    session = opened("hertz-cradle", *edits, memory=700_000)
    for k in range(25):
        session.step_frames(190)
        session.contact_events()
        if k % 6 == 5:
            session.scrub_frame(session.history.last - 300)
            session.apply(inputs.SetVelocity(0, 1 + k % 3, 1.5))
    assert session.history.first > 0
    known = session.contact_events()
    for block in session.history.blocks:
        block._found.clear()
    anew = contact_events(session.history)
    assert len(anew.time) > 20
    np.testing.assert_array_equal(known, anew)
