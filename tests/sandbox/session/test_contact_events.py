"""Contact events: those of the physics, found in the history, and dropped with it."""

import math

import numpy as np
import pytest
from softcradle.physics import hertz, simulate
from softcradle.sandbox.session import Place, Session, SetContact, SetGap, SetMass, SetMethod, SetSlow, SetVelocity
from softcradle.sandbox.session.contact_events import contact_events
from softcradle.sandbox.session.frame_history import BLOCK_ROWS

from softcradle import scenes

FRAMES = BLOCK_ROWS + 300


@pytest.mark.parametrize(("method", "error"), [("conserving", 1.5e-3), ("accurate", 1e-5)])
def test_contact_events_and_exported_times_are_those_the_engine_located(method, error):
    session = Session(scenes.load("hertz-cradle"))
    session.apply(SetMethod(None, method))
    lane = session.scene.lanes[0]
    session.step_frames(2 * FRAMES)
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
    session = Session(scenes.load("one-on-four"))
    session.apply(SetMethod(None, "accurate"))
    session.apply(SetContact(0, None, hertz(1e9)))
    for bead, mass in ((0, math.inf), (1, 1e-3), (2, math.inf)):
        session.apply(SetMass(0, bead, mass))
    session.apply(SetVelocity(0, 1, 1.0))
    session.apply(SetGap(0, 0, 1e-3))
    session.apply(SetGap(0, 1, 1e-3))
    session.apply(SetSlow(1.0))
    session.step_frames(1)
    lane = session.to_scene().lanes[0]
    truth = simulate(lane.chain(), lane.velocity, session.time, "accurate").contact_intervals
    events = session.contact_events()
    assert len(truth[1]) > 1
    assert events.speed[events.contact == 1][0] == pytest.approx(1.0)
    for contact in (0, 1):
        times = events.select(events.contact == contact).time
        assert times == pytest.approx([t for span in truth[contact] for t in span if t < math.inf], abs=1e-6)


def test_a_contact_that_an_edit_opens_does_so_at_its_frame():
    session = Session(scenes.load("one-on-four"))
    session.step_frames(300)
    before = len(session.contact_events().time)
    session.apply(Place(0, 0, -0.5))
    assert len(session.contact_events().time) == before + 1
    assert [column[-1] for column in session.contact_events().columns()] == [session.time, 300, 0, 0, False, 0.0]


def events_anew(session):
    for block in session.history.blocks:
        block._found.clear()
    return contact_events(session.history)


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
    known_events, fresh = session.contact_events(), events_anew(session)
    assert len(fresh.time) > 20
    for known, found in zip(known_events.columns(), fresh.columns(), strict=True):
        assert (known == found).all()
