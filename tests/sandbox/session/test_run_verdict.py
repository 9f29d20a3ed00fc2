"""The verdict of a whole run: what was wrong, when, for as long as the run is in the history."""

import numpy as np
import pytest
from softcradle.physics.scales import speed_scale
from softcradle.sandbox.session import (
    RemoveBead,
    Session,
    SetContact,
    SetKind,
    SetMass,
    SetMethod,
    SetSlow,
    SetStep,
    SetVelocity,
)
from softcradle.sandbox.session.run_verdict import PASSED
from softcradle.sandbox.session.velocity_check import VelocityCheck

from softcradle import scenes


def test_chatter_stays_known_after_it_has_ended():
    session = Session(scenes.load("draft-gear-one-on-three"))
    session.apply(SetMethod(0, "verlet"))
    session.step_frames(4000)
    assert session.health(0).level == "good"  # of the last second
    found = [item for item in session.findings(0) if "chattered" in item.cause]
    assert found
    assert found[0].level == "bad"
    assert 0.0 < found[0].begin < found[0].end < session.time
    session.scrub_frame(found[0].first)
    assert session.health(0).level == "bad"
    session.undo()
    assert session.findings(0) == []


def test_the_badge_and_the_findings_of_a_run_are_one_verdict():
    session = Session(scenes.load("draft-gear-one-on-three"))
    session.apply(SetMethod(0, "verlet"))
    for slow in (None, 5.0, 20.0):  # a new setup begins a new slice, and chatter goes on
        if slow:
            session.apply(SetSlow(slow))
        session.step_frames(300)
    bad = {frame for item in session.findings(0) for frame in range(item.first, item.last + 1)}
    for frame in range(session.history.last, 0, -25):
        session.scrub_frame(frame)
        assert (session.health(0).level == "bad") == (frame in bad), frame


@pytest.mark.parametrize("name", ["one-on-four", "train-cut", "hooke-cradle", "mixed"])
def test_nothing_is_found_where_nothing_is_wrong(name):
    session = Session(scenes.load(name))
    session.step_frames(1200)
    assert [session.findings(lane) for lane in range(len(session.lanes))] == [[]] * len(session.lanes)


def test_beads_that_pass_through_each_other_are_not_good():
    session = Session(scenes.load("one-on-four"))
    session.apply(SetVelocity(0, 0, 8.0))
    session.step_frames(240)
    assert (session.lanes[0].state.overlap > 1.0).any()
    level, sentence = session.verdict()
    assert level == "bad"
    assert "passed through each other" in sentence
    assert PASSED in [item.cause for item in session.findings(0)]


def test_marks_of_rigid_clusters_are_of_the_velocities_before_the_collision():
    session = Session(scenes.load("one-on-four"))
    session.step_frames(300)
    assert (session.lanes[0].state.force > 0.0).any()
    assert session.approach(0)[1].tolist() == [1.0, 0.0, 0.0, 0.0, 0.0]
    session.apply(SetMass(0, 1, 1.5))
    assert session.approach(0)[1].tolist() == [1.0, 0.0, 0.0, 0.0, 0.0]
    session.apply(RemoveBead(0, 4))
    assert len(session.approach(0)[1]) == 4


def test_a_contact_converted_to_and_fro_is_what_it_was():
    session = Session(scenes.load("draft-gear-one-on-three"))
    chain = session.lanes[0].chain
    for kind in ("hard", "power", "hard", "gear"):
        session.apply(SetKind(0, None, kind))
    assert session.lanes[0].chain == chain
    session.apply(SetKind(0, 0, "hard"))
    other = session.lanes[0].chain.contact[0]
    session.apply(SetKind(0, 0, "power"))
    session.apply(SetKind(0, 0, "hard"))
    assert session.lanes[0].chain.contact[0] == other


def test_the_label_says_what_the_contacts_are_now():
    session = Session(scenes.load("one-on-four"))
    law = session.lanes[0].chain.contact[0]
    assert session.label(0) == "alpha = 1/10"
    session.apply(SetContact(0, None, law.__class__(0.0, 1.0, 0.02)))
    assert session.label(0) == "alpha = 1/50"
    assert session.to_scene().lanes[0].label == "alpha = 1/50"
    session.apply(SetContact(0, None, law))
    assert session.label(0) == "alpha = 1/10"
    session.apply(SetMass(0, 1, 3.0))
    assert session.label(0) == "alpha = 1/10, edited"
    assert np.isfinite(speed_scale(session.lanes[0].chain, session.lanes[0].velocity))


def test_velocities_are_checked_by_an_accurate_run_from_where_the_motion_was_touched():
    session = Session(scenes.load("one-on-four"))
    check = VelocityCheck(session, 0)
    assert check.job() is None
    session.step_frames(600)
    check.take(check.base, check.job()())
    assert 0.0 < check.error() < 1e-3
    session.apply(SetMethod(0, "euler"))
    session.apply(SetStep(0, 0.05))
    session.restart()
    session.step_frames(600)
    assert check.error() is None  # of another run
    check.take(check.base, check.job()())
    assert check.error() > 1e-3
    session.apply(SetMass(0, 1, 2.0))
    assert check.error() is None
