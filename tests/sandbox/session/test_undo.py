"""Undo and redo: every edit, with the motion's history before and after it, within bounds."""

import numpy as np
import pytest
from softcradle.physics import power_law
from softcradle.sandbox.session import inputs
from softcradle.sandbox.session.undo import MOST_STEPS

from tests.helpers.sessions import check_replay, frame_table, opened

EDITS = (
    inputs.SetMass(0, 1, 2.5), inputs.SetVelocity(0, 2, -0.5), inputs.SetContact(0, 1, power_law(2.0, 0.2)),
    inputs.SetKind(0, None, "gear"), inputs.Lock(0, None), inputs.SetGap(0, 0, 0.5), inputs.SetDrive(0, 1, 0.3),
    inputs.SetFriction(0, 0.1), inputs.AddBead(0, 2), inputs.RemoveBead(0, 0), inputs.SetMethod(0, "verlet"),
    inputs.SetStep(0, 1e-3),
)  # fmt: skip


def picture(session):
    return session.frame, session.history.first, session.history.last, session.setup, frame_table(session)


def test_every_edit_is_undone_and_redone_in_turn_with_the_motion_also_across_a_restart():
    session = opened()
    seen = []
    for k, edit in enumerate(EDITS):
        session.step_frames(30)
        session.scrub_frame(session.frame - 10)  # ten frames that the edit drops
        seen.append(picture(session))
        session.apply(edit)
        if k == 5:
            session.restart()
    session.step_frames(50)
    last = picture(session)
    for expected in reversed(seen):
        assert session.undo()
        assert picture(session) == expected
    assert not session.undo()
    for expected in (*seen[1:], last):
        assert session.redo()
        assert picture(session) == expected
    assert not session.redo()
    session.undo()
    session.apply(inputs.SetMass(0, 1, 3.0))
    assert not session.redo()  # what could be redone is dropped by an edit


def test_a_gesture_is_one_step():
    session = opened()
    start = session.lanes[0].position.copy()
    for k in range(20):
        session.drag(0, 0, -0.1 * k)
    session.drop()
    for mass in (1.5, 2.0, 2.5):
        session.apply(inputs.SetMass(0, 1, mass), gesture=True)
    session.end_gesture()
    session.apply(inputs.SetMass(0, 1, 4.0), gesture=True)
    assert session.undo() == "mass"
    assert session.lanes[0].chain.mass[1] == 2.5
    assert session.undo() == "mass"
    assert session.lanes[0].chain.mass[1] == 1.0
    assert session.undo() == "bead moved"
    assert np.array_equal(session.lanes[0].position, start)


def test_several_inputs_are_one_step_and_are_refused_together(tmp_path):
    session = opened("two-on-two")
    for speed in (0.5, 0.7):
        session.apply_all([inputs.SetVelocity(0, bead, speed) for bead in (0, 1)], gesture=True)
    session.step_frames(5)
    before = picture(session)
    with pytest.raises(ValueError, match="no bead 9"):
        session.apply_all([inputs.SetMass(0, 0, 2.0), inputs.SetMass(0, 9, 2.0)])
    session.scrub_frame(3)
    session.apply_all([])
    session.step_frames(2)
    assert picture(session) == before
    check_replay(session, tmp_path / "replay.npz")
    assert session.undo() == "velocity"
    assert session.lanes[0].velocity.tolist() == [1.0, 1.0, 0.0, 0.0]
    assert not session.undo()


def test_a_throw_is_undone_to_the_frame_at_which_the_bead_was_taken():
    session = opened()
    session.step_frames(30)
    before = picture(session)
    session.play()
    for k in range(10):
        session.drag(0, 4, 5.0 + 0.1 * k)
        session.tick(1 / 60)
    session.drop()
    session.tick(0.1)
    assert not session.undo_stack.unsaved  # the scene is as it was
    assert session.undo() == "bead pulled"
    assert picture(session) == before


def test_unsaved_edits_are_known():
    session = opened()
    stack = session.undo_stack
    assert not stack.unsaved
    session.apply(inputs.SetMass(0, 1, 2.5))
    assert stack.unsaved
    for act, unsaved in ((session.undo, False), (session.redo, True), (stack.mark_saved, False), (session.undo, True)):
        act()
        assert stack.unsaved is unsaved


def test_a_saved_edit_that_is_played_away_leaves_the_scene_unsaved(tmp_path):
    session = opened()
    session.step_frames(5)
    session.apply(inputs.SetMass(0, 1, 2.5))
    session.step_frames(2)
    session.save_scene(tmp_path / "saved.toml")
    for frame, unsaved in ((6, False), (3, True)):  # where the edit is made already, and before it
        session.scrub_frame(frame)
        assert not session.undo_stack.unsaved
        session.play()
        session.tick(0.1)
        assert session.undo_stack.unsaved is unsaved


def test_steps_are_bounded_in_number_and_memory(monkeypatch):
    session = opened()
    for k in range(MOST_STEPS + 20):
        session.apply(inputs.SetMass(0, 1, 1.0 + k))
    assert len(session.undo_stack.done) == MOST_STEPS
    monkeypatch.setattr("softcradle.sandbox.session.undo.MEMORY", 400_000)
    for k in range(10):
        session.step_frames(200)
        session.apply(inputs.SetMass(0, 1, 1.0 + k))
    assert sum(step.memory for step in session.undo_stack.done) <= 400_000
    assert session.undo()
