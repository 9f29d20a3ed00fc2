"""Tests of edits of a running session, including undo and redo.

The tests check which values an edit changes and which values it must not change. The tests also check in which tables
and panels a number can be edited.
"""

import math
import re

import numpy as np
import pytest
from softcradle.physics import hertz, power_law, step_force
from softcradle.sandbox.quantities import OVERLAP
from softcradle.sandbox.session import inputs
from softcradle.sandbox.session.contact_conversion import kind_of, steel_ball
from softcradle.sandbox.session.editable_numbers import NUMBERS, parameters
from softcradle.sandbox.session.run_verdict import PASSED
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.undo import MOST_STEPS
from softcradle.sandbox.session.values_table import SET_COLUMNS, values_table
from softcradle.scenes import load, parse

from tests.helpers.sessions import check_replay, opened, picture, pull

PYTHON = re.compile(
    r"float64|np\.|\w+\(|[a-z]_[a-z]|\w+Error|Traceback|<|None|\bself\b|\n"
)  # Pattern of Python error messages, which a user must not see.
LOADED = 280  # Number of frames after which all contacts of the scene "one-on-four" are loaded.


@pytest.mark.parametrize("bead", range(5))
def test_a_new_mass_or_velocity_of_one_bead_changes_no_other(bead):
    session = opened(frames=LOADED)
    position, velocity = session.lanes[0].position, session.lanes[0].velocity
    # With this mass, the edited bead becomes the heaviest bead and therefore the anchor of the positions.
    session.apply(inputs.SetMass(0, bead, 50.0))
    assert session.lanes[0].chain.anchor == bead
    assert session.lanes[0].position == pytest.approx(position, abs=1e-15)
    assert session.lanes[0].velocity == pytest.approx(velocity, abs=1e-15)
    overlap = session.lanes[0].state.overlap.copy()
    session.apply(inputs.SetVelocity(0, bead, 3.25))
    velocity[bead] = 3.25
    assert session.lanes[0].velocity == pytest.approx(velocity, abs=1e-15)
    assert (session.lanes[0].state.overlap == overlap).all()


def test_gaps_go_until_a_coupler_that_pulls_is_solid():
    """Check the upper limit of the gap between two wagons.

    At this limit, the coupler has pulled its springs solid. In an earlier version, the limit was two lengths of a
    wagon. At that distance, the stop of the coupler already pulled.
    """
    ends = [parameters(Session(load(name)), 0, "contact", 2)[-1].high for name in ("train-starting", "train-shunting")]
    assert ends == pytest.approx([0.04 + 0.166, 2.0 * 14.0 + 0.04])


def test_a_placed_bead_pushes_its_neighbours_along():
    session = opened()
    session.drag(0, 0, 1.5)
    assert session.lanes[0].position.tolist() == [1.5] * 5
    # The gap of two touching beads must be shown as 0.0, not as -0.0.
    assert str(parameters(session, 0, "contact", 1)[-1].value) == "0.0"
    session.drag(0, 4, -0.5)
    assert session.lanes[0].position == pytest.approx([-0.5] * 5)
    session.drag(0, 2, -0.25)
    assert session.lanes[0].position == pytest.approx([-0.5, -0.5, -0.25, -0.25, -0.25])
    assert (session.lanes[0].state.overlap <= 0.0).all()
    walled = opened("one-on-four", inputs.SetGap(0, 3, 0.5))
    # If a gap is widened, all beads to its right move.
    assert walled.lanes[0].position.tolist() == [0.0, 1.0, 1.0, 1.0, 1.5]
    walled.apply(inputs.SetMass(0, 4, math.inf))
    walled.apply(inputs.Place(0, 0, 99.0))
    assert walled.lanes[0].position == pytest.approx([1.5] * 5)
    assert walled.lanes[0].state.overlap.max() <= 0.0
    loaded = opened(frames=LOADED)  # Moving a loaded bead must not increase any overlap.
    before = loaded.lanes[0].state.overlap.copy()
    loaded.apply(inputs.Place(0, 2, loaded.lanes[0].position[2] + 0.3))
    after = loaded.lanes[0].state.overlap
    assert after[1] == pytest.approx(before[1] - 0.3)
    assert (after[2:] == before[2:]).all()


@pytest.mark.parametrize("bead", range(6))
@pytest.mark.parametrize("heavy", [0, 2, 4])
def test_adding_and_removing_a_bead_changes_nothing(bead, heavy):
    session = opened("one-on-four", inputs.SetMass(0, heavy, 2.0))
    position, velocity, mass = session.lanes[0].position, session.lanes[0].velocity, session.lanes[0].chain.mass
    session.apply(inputs.AddBead(0, bead, 7.0, 0.25))
    assert session.lanes[0].chain.mass[bead] == 7.0
    assert np.delete(session.lanes[0].position, bead) == pytest.approx(position)
    session.apply(inputs.RemoveBead(0, bead))
    assert session.lanes[0].chain.mass == mass
    assert session.lanes[0].position == pytest.approx(position)
    assert session.lanes[0].velocity == pytest.approx(velocity)


@pytest.mark.parametrize("name", ["one-on-four", "draft-gear-one-on-three", "hertz-cradle"])
@pytest.mark.parametrize("kind", ["power", "gear", "hard"])
def test_a_converted_contact_stops_the_same_impact(name, kind):
    session = opened(name)
    before = session.lanes[0].chain.contact
    own = kind_of(before[0])
    found = {}
    for other in (kind, "hard", own, kind):
        session.apply(inputs.SetKind(0, None, other))
        after = session.lanes[0].chain.contact
        assert {kind_of(contact) for contact in after} == {other}
        assert found.setdefault(other, after) == after
    assert found[own] == before
    session.step_frames(1200)
    assert {session.health(lane).level for lane in range(len(session.lanes))} == {"good"}
    assert PASSED not in {item.cause for item in session.findings(0)}


def test_pistons_are_locked_and_unlocked():
    session = opened("draft-gear-one-on-three", inputs.Lock(0, None), inputs.Lock(0, 1), frames=600)
    final = session.lanes[0].velocity
    assert final[3] > 0.45, "the last cylinder leaves with nearly all of the 0.5 m/s"
    assert abs(final[0]) < 0.05
    session.restart()
    session.apply(inputs.Lock(0, None, locked=False))
    assert session.lanes[0].chain.contact == session.scene.lanes[0].chain().contact


PRESSED = """
title = "T"
[[lanes]]
velocity = [0.1, 0, 0]
gap = [-0.01, {gap}]
contact = {{law = "step_force", f0 = 2.0}}
"""


@pytest.mark.parametrize("frames", [0, 3])
@pytest.mark.parametrize(
    "edit", [inputs.SetContact(0, None, power_law(20.0, 0.1)), inputs.SetKind(0, None, "power"), inputs.Lock(0, None)]
)
def test_a_pressed_contact_uses_its_new_law_at_once(edit, frames):
    session = Session(parse(PRESSED.format(gap=-0.02)))
    session.step_frames(frames)
    session.apply(edit)
    for _ in range(2):
        lane = session.lanes[0]
        laws, overlaps = lane.chain.contact, lane.state.overlap.tolist()
        assert min(overlaps) > 0.0
        assert lane.state.force.tolist() == [law.force(overlap) for law, overlap in zip(laws, overlaps, strict=True)]
        session.restart()


def test_a_touching_contact_keeps_its_force_within_the_new_law():
    session = Session(parse(PRESSED.format(gap=0.0)))
    session.lanes[0].state.force[1] = 1.5
    for law, force in ((step_force(3.0), 1.5), (step_force(1.0), 1.0), (power_law(1.0, 0.1), 0.0)):
        session.apply(inputs.SetContact(0, 1, law))
        assert session.lanes[0].state.force.tolist() == [2.0, force]


def test_only_an_automatic_step_follows_edits():
    session = opened("hertz-cradle")
    chosen = session.setup.lanes[0].step
    session.apply(inputs.SetContact(0, None, hertz(1e5)))
    assert session.setup.lanes[0].step < 0.1 * chosen
    session.apply(inputs.SetStep(0, 0.003))
    session.apply(inputs.SetContact(0, None, hertz(1.0)))
    assert session.setup.lanes[0].step == 0.003
    session.apply(inputs.SetStep(0, None))
    assert session.setup.lanes[0].step > chosen
    # A step of 1e-12 s would make a frame too expensive. The session uses a larger step.
    session.apply(inputs.SetStep(0, 1e-12))
    session.step_frames(1)
    assert session.setup.lanes[0].step_for(session.setup.frame_time) > 1e-8


@pytest.mark.parametrize(
    ("edit", "sentence"),
    [
        (inputs.SetMass(0, 0, math.nan), "mass"),
        (inputs.SetMass(0, None, np.float64(0.0)), "mass"),
        (inputs.SetVelocity(0, 0, np.float64(1e13)), "velocity"),
        (inputs.SetVelocity(0, 5, 1.0), "from 0 to 4"),
        (inputs.SetContact(0, 4, hertz(1.0)), "from 0 to 3"),
        (inputs.SetKind(0, 0, "rubber"), "power, gear, hard"),
        (inputs.SetGap(0, 0, np.float64(1e13)), "gap"),
        (inputs.SetGap(0, 0, -1.0), "overlap must be below the length of a bead"),
        (inputs.SetMethod(0, "magic"), "unknown method"),
        (inputs.SetStep(0, -1.0), "step"), (inputs.SetFriction(0, np.float64(-0.1)), "friction"),
        ([inputs.SetMethod(0, "scipy"), inputs.SetStep(0, 0.1)], "chooses its own steps"),
        (inputs.AddBead(0, 9), "from 0 to 5"), ([inputs.RemoveBead(0, 0)] * 4, "at least 2 beads"),
        (inputs.Place(0, 1, np.float64("nan")), "position"), (inputs.Drag(0, 9, 0.0), "bead 9 cannot be held"),
        (inputs.SetMass(3, 0, 1.0), "lane 3 does not exist"), (inputs.SetSlow(-1.0), "slow motion must be from"),
    ],
)  # fmt: skip
def test_a_rejected_edit_changes_nothing(edit, sentence):
    session = opened(frames=20)
    session.scrub_frame(5)
    before = picture(session)
    with pytest.raises(ValueError, match=sentence) as refused:
        session.apply_all(edit if isinstance(edit, list) else [edit])
    assert not PYTHON.search(str(refused.value)), refused.value
    assert (picture(session), session.recording.inputs) == (before, [])
    assert not session.undo()


@pytest.mark.parametrize("number", NUMBERS, ids=lambda number: number.name)
def test_a_number_is_wherever_numbers_are(number, tmp_path):
    def value_in(session, index):
        return number.values(session.lanes[0])[index]

    # The three scenes contain power laws, draft gears and open gaps.
    sessions = [opened(name) for name in ("one-on-four", "experiment-one-on-three", "galilean")]
    owners = [(one, index) for one in sessions for index, _ in enumerate(number.values(one.lanes[0]))]
    session, index = next(owner for owner in owners if not math.isnan(value_in(*owner)))
    before = value_in(session, index)
    parameter = next(one for one in parameters(session, 0, number.owner, index) if one.name == number.name)
    assert parameter.value == before
    columns, had = values_table(session, 0, number.owner).columns, np.nan_to_num(number.values(session.lanes[0])).any()
    # A column of the table is hidden if it is empty for all beads.
    assert (number.column in columns) == (had or number.column not in SET_COLUMNS)
    value = parameter.at(0.3)
    assert value != before
    session.apply(parameter.edit(value))
    table = values_table(session, 0, number.owner)
    shown = table.rows[index][table.columns.index(number.column)]
    assert value_in(session, index) == (-shown if number.column == OVERLAP.column else shown)
    assert value_in(session, index) == pytest.approx(value, rel=1e-12)
    assert value_in(Session(session.to_scene()), index) == pytest.approx(value, rel=1e-12)
    session.step_frames(3)
    check_replay(session, tmp_path / "session.npz")
    session.scrub_frame(0)
    assert session.undo()
    assert value_in(session, index) == before


def test_a_gesture_is_one_undo_step():
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
    session.apply(inputs.SetMass(0, 1, 3.0))
    assert not session.redo()  # A new edit deletes the list of edits that could be redone.
    session = opened(frames=30)
    before = picture(session)
    pull(session, 4, [5.0 + 0.1 * k for k in range(10)])
    session.drop()
    session.tick(0.1)
    assert not session.undo_stack.unsaved  # Pulling a bead does not change the scene, so nothing is unsaved.
    assert session.undo() == "bead pulled"
    assert picture(session) == before


def test_several_inputs_are_one_undo_step(tmp_path):
    session = opened("one-on-four", 60, inputs.SetMass(0, 1, 2.0), 60)
    session.scrub_frame(50)
    before = picture(session)
    session.apply_all([])
    for anew in (False, True):
        with pytest.raises(ValueError, match="bead 9 does not exist"):
            session.apply_all([inputs.SetMass(0, 2, 3.0), inputs.SetMass(0, 9, 3.0)], anew=anew)
        assert picture(session) == before
    for mass in (3.0, 4.0):
        session.apply_all([inputs.SetMass(0, bead, mass) for bead in (2, 3)], gesture=True, anew=True)
    assert (session.frame, session.history.last) == (0, 0)
    # The result includes the edit of bead 1, although it was made at a later frame than the one shown.
    assert session.lanes[0].chain.mass == (1.0, 2.0, 4.0, 4.0, 1.0)
    session.step_frames(30)
    check_replay(session, tmp_path / "replay.npz")
    assert session.undo() == "mass"
    assert picture(session) == before
    assert session.redo() == "mass"
    assert (session.frame, session.history.last) == (30, 30)


@pytest.mark.parametrize("saved", [False, True])
def test_an_edit_stays_unsaved_after_its_undo_step_is_dropped(saved):
    session = opened("one-on-four", inputs.SetMass(0, 1, 2.5))
    if saved:
        session.undo_stack.mark_saved()
    session.play()
    for _ in range(MOST_STEPS + 1):
        session.drag(0, 4, 5.0)
        session.drop()
    assert [step.name for step in session.undo_stack.done] == ["bead pulled"] * MOST_STEPS
    assert session.edited
    assert session.undo_stack.unsaved is not saved
    session.apply(inputs.SetMass(0, 1, 3.0))
    assert session.undo_stack.unsaved
    session.undo()
    assert session.undo_stack.unsaved is not saved


def test_undoing_a_saved_edit_makes_the_scene_unsaved(tmp_path):
    session = opened("one-on-four", 5, inputs.SetMass(0, 1, 2.5), 2)
    for act, unsaved in ((session.undo, False), (session.redo, True)):
        act()
        assert session.undo_stack.unsaved is unsaved
    session.save_scene(tmp_path / "saved.toml")
    session.undo()
    assert session.undo_stack.unsaved
    session.redo()
    # The session shows a frame after the edit first, and then a frame before the edit.
    for frame, unsaved in ((6, False), (3, True)):
        session.scrub_frame(frame)
        assert not session.undo_stack.unsaved
        session.play()
        session.tick(0.1)
        assert session.undo_stack.unsaved is unsaved


def test_the_memory_of_steps_is_bounded(monkeypatch):
    session = opened()
    monkeypatch.setattr("softcradle.sandbox.session.undo.MEMORY", 400_000)
    for k in range(10):
        session.step_frames(200)
        session.apply(inputs.SetMass(0, 1, 1.0 + k))
    assert sum(step.memory for step in session.undo_stack.done) <= 400_000
    assert session.undo()


def test_there_is_one_kind_of_steel():
    """Check that the steel balls for comparison have the same contacts as the balls in the scene of Newton's cradle."""
    cradle, soft = load("hertz-cradle"), load("one-on-four")
    chain = soft.lanes[0].chain()
    law = steel_ball(chain, 1, 1.0, soft.view.length)
    known = cradle.lanes[0].chain().contact[1]
    assert (law.exponent, law.preload) == (known.exponent, known.preload)
    assert law.stiffness == pytest.approx(known.stiffness, rel=1e-9)


def test_a_wall_has_no_number_that_does_nothing():
    session = opened("one-on-four")
    session.apply(inputs.SetMass(0, 4, math.inf))
    assert [one.key for one in parameters(session, 0, "bead", 4)] == ["velocity"]
    assert {one.key for one in parameters(session, 0, "bead", 3)} == {"mass", "velocity", "drive", "friction"}


def test_sliders_stop_at_round_numbers():
    session = opened("one-on-four")
    alpha = next(one for one in parameters(session, 0, "contact", 1) if one.key == "exponent")
    for value in (1 / 20, 1 / 10, 1 / 2, 1.0, 3 / 2):
        assert alpha.at(alpha.share_of(value) + 0.007) == value
    velocity = next(one for one in parameters(session, 0, "bead", 0) if one.key == "velocity")
    for parameter in (alpha, velocity):
        assert (parameter.at(0.0), parameter.at(1.0)) == (parameter.low, parameter.high)
        found = {parameter.at(k / 400) for k in range(401)}
        digits = [
            len(f"{value:g}".lstrip("-0.").replace(".", "").rstrip("0")) for value in found - set(parameter.stops)
        ]
        assert max(digits) <= 2
        assert len(found) > 50


def test_a_trial_from_the_start_is_no_work_that_could_be_lost(tmp_path):
    session = opened("one-on-four")
    session.apply_all([inputs.SetMass(0, 1, 2.0)], anew=True, trial=True)
    assert session.undo_stack.unsaved
    assert not session.undo_stack.unsaved_work
    session.apply(inputs.SetMass(0, 2, 2.0))
    assert session.undo_stack.unsaved_work
    session.save_scene(tmp_path / "own.toml")
    assert not session.undo_stack.unsaved_work
