"""Tests of arbitrary edits in arbitrary order.

After each edit there must be no exception and no NaN. Memory must be bounded, the energy balance must be correct, and a
replay must be bitwise equal.
"""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from softcradle.sandbox.session.inputs import Input, SetMethod, SetStep
from softcradle.sandbox.session.session import Session

from softcradle import scenes
from tests.helpers.sessions import INPUTS, check_invariants, check_replay, fitted, opened, picture, read_all

# The scenes cover single rows and pairs of rows of beads, external forces and different contact laws. Other scenes
# contain couplers with friction and brakes, and beads that are pressed together at the start.
SCENES = st.sampled_from(
    ("one-on-four", "beads-against-gear", "driven-cluster", "mixed", "train-braking", "prestressed")
)
EDITS = st.lists(INPUTS, min_size=5, max_size=25)


def given_to(session: Session, item: Input) -> bool:
    try:
        session.apply(fitted(item, session))
    except ValueError:
        return False
    return True


@given(name=SCENES, items=EDITS)
@settings(max_examples=40)
def test_inputs_in_any_order_are_undone_and_redone(name, items, tmp_path_factory):
    session, seen = Session(scenes.load(name), memory=100_000), []
    for k, item in enumerate(items):
        before = picture(session)
        if given_to(session, item) and item.undo_name:
            seen.append(before)
            assert session.history.last == session.frame == before[0]
        if k == 5:
            session.restart()
        session.step_frames(3)
        session.step_frames(-1)  # The session goes back by one frame. The next edit drops the newer frame.
        check_invariants(session)
    read_all(session)
    frames = sum(len(part.time) for part in session.history_slices(0, 10**6))
    assert frames == session.frame - session.history.first + 1
    last = picture(session)
    for expected in reversed(seen):
        assert session.undo()
        assert picture(session) == expected
    assert not session.undo()
    for expected in (*seen, last)[1:]:
        assert session.redo()
        assert picture(session) == expected
    assert not session.redo()
    check_replay(session, tmp_path_factory.mktemp("replay") / "replay.npz")


@given(items=EDITS)
@settings(max_examples=30)
def test_the_chosen_method_balances_the_ledger_whatever_is_edited(items):
    session = opened("mixed")
    for item in items:
        if isinstance(item, SetMethod | SetStep) or not given_to(session, item):
            continue
        session.step_frames(3)
        health = session.health(0)
        assert health.energy_error is None or health.energy_error < 1e-6
        assert health.momentum_error is None or health.momentum_error < 1e-9


@given(name=SCENES, items=EDITS)
@settings(max_examples=40)
def test_the_scene_of_any_session_reads_back_as_its_start(name, items):
    session = opened(name)
    for item in items:
        given_to(session, item)
    again = Session(scenes.parse(session.to_scene().to_toml()))
    session.restart()
    assert again.slow == session.slow
    labels = [session.label(lane) for lane in range(len(session.lanes))]
    assert labels == [lane.label for lane in again.scene.lanes] == [lane.setup.label for lane in again.lanes]
    for one, other in zip(session.lanes, again.lanes, strict=True):
        assert replace(one.chain, gap=0.0) == replace(other.chain, gap=0.0)
        # Two rows of beads can have different methods. The method is therefore compared only for a single row.
        if len(labels) == 1:
            assert (one.setup.method, one.setup.step_given) == (other.setup.method, other.setup.step_given)
            assert one.setup.step == other.setup.step or not one.setup.step_given
        assert np.allclose(one.state.overlap, other.state.overlap, rtol=1e-12, atol=1e-12)
        assert np.allclose(one.velocity, other.velocity, rtol=1e-12, atol=1e-12)
