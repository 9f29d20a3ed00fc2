"""Sessions for tests. The module also contains random inputs for Hypothesis and checks that hold in every session."""

import copy
import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st
from softcradle.physics.contact import draft_gear, hertz, power_law
from softcradle.sandbox.session import inputs
from softcradle.sandbox.session.contact_conversion import KINDS
from softcradle.sandbox.session.replay import Replay
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.snapshots import NOTHING_HELD, snapshot_table

from softcradle import scenes


def opened(name: str = "one-on-four", *done: inputs.Input | int, frames: int = 0, **options: Any) -> Session:
    """Return a session with the scene `name`. The session first processes the inputs in `done` in the given order. A
    number n in `done` means that the session runs n frames. The clock of the session does not advance.
    """
    session = Session(scenes.load(name), **{"clock": lambda: 0.0, **options})
    for one in (*done, frames):
        session.step_frames(one) if isinstance(one, int) else session.apply(one)
    return session


def pull(session: Session, bead: int, places: Iterable[float]) -> None:
    """Start the session and pull a bead. In each frame, the bead is pulled to the next of the positions `places` [m]."""
    session.play()
    for place in places:
        session.drag(0, bead, place)
        session.tick(1 / 60)


# The four scenes that differ most from each other. The first scene has a single chain, and the second scene has two
# lanes. The third scene has a permanent external force. The fourth scene has couplers, friction and forces over time.
# Tests of other scenes are slow tests.
UNLIKE = ("one-on-four", "beads-against-gear", "driven-cluster", "train-braking")
EVERY_SCENE = [name if name in UNLIKE else pytest.param(name, marks=pytest.mark.slow) for name in scenes.names()]


def check_invariants(session: Session) -> None:
    """Raise AssertionError if a property that holds in every session is violated. All numbers must be finite, the
    memory must be bounded, and the session must show a frame of the history.
    """
    for lane in session.lanes:
        for values in (lane.state.overlap, lane.state.rate, lane.state.anchor, lane.state.force, lane.ledger):
            assert np.isfinite(values).all()
        assert len(lane.chain.mass) == len(lane.state.overlap) + 1
    assert session.history.memory <= session.history.bound + 2 * session.history.blocks[-1].memory
    check_order(session)


def read_all(session: Session) -> None:
    """Read all values that a window shows. Raise AssertionError if a value is not finite or not in order."""
    for lane in range(len(session.lanes)):
        for part in session.history_slices(lane, 240):
            assert np.isfinite(part.velocity).all()
            assert np.isfinite(part.kinetic).all()
        assert session.health(lane).sentence
    assert all(impact.speed > 0.0 for impact in session.impacts)
    assert (np.diff(session.contact_events().time) >= 0.0).all()


def frame_table(session: Session) -> dict[str, Any]:
    """Return the frame that the session shows, with all digits. The held bead is left out."""
    table = snapshot_table(session.snapshot())
    del table["hand"]
    return table


def picture(session: Session) -> tuple[object, ...]:
    """Return the contents of a window for this session: the frame with all digits, and the range of stored frames."""
    return session.frame, session.history.first, session.history.last, session.setup, frame_table(session)


def check_order(session: Session) -> None:
    """Check that the session shows a frame of the history, and that the recording ends at the end of the history. Raise
    AssertionError otherwise.
    """
    history, recording = session.history, session.recording
    assert history.first <= session.frame <= history.last == recording.last
    frames = [recording.frame, *(frame for frame, _ in recording.inputs), recording.last]
    assert frames == sorted(frames)
    if session.held != NOTHING_HELD:
        assert session.held.bead <= session.lanes[int(session.held.lane)].chain.contacts


def check_round_trip(session: Session) -> None:
    """Check undo and redo with a copy of the session. Undo followed by redo, and redo followed by undo, must return to
    the present frame. Raise AssertionError otherwise.
    """
    stack = session.undo_stack
    for steps, there, back in ((stack.done, Session.undo, Session.redo), (stack.undone, Session.redo, Session.undo)):
        if not steps:
            continue
        twin = copy.deepcopy(session)
        name = there(twin)
        assert name
        check_order(twin)
        assert back(twin) == name
        check_order(twin)
        assert (twin.frame, twin.span, twin.scene) == (session.frame, session.span, session.scene)
        assert frame_table(twin) == frame_table(session)
        assert twin.recording.inputs == session.recording.inputs
        assert twin.recording.hashes == session.recording.hashes
        for one, other in ((twin.undo_stack.done, stack.done), (twin.undo_stack.undone, stack.undone)):
            assert [step.number for step in one] == [step.number for step in other]


def check_replay(session: Session, file: Path) -> Replay:
    """Return the Replay of the recording. The recording is first written to `file` and read again. Raise AssertionError
    if the frames of the Replay differ.
    """
    session.recording.save(file, session.scene)
    replay = Replay.load(file)
    assert replay.run(), f"{replay.sentence}; inputs {replay.recording.inputs}"
    if not session.scrubbed:
        assert frame_table(replay.session) == frame_table(session)
    return replay


METHODS = ("auto", "conserving", "verlet", "euler", "yoshida4", "accurate", "radau", "dop853", "pymunk")
# Largest number of beads in a lane. If a lane has more beads, an input that would add a bead removes a bead instead.
MOST_BEADS = 30

# Numbers of lanes, beads and contacts. These numbers are taken modulo the number of existing items.
_NUMBERS = st.integers(0, 60)
_OR_ALL = st.one_of(_NUMBERS, st.none())
_LAWS = st.one_of(
    st.builds(power_law, st.sampled_from((0.1, 1.0, 100.0)), st.sampled_from((1 / 30, 1 / 14, 0.1, 0.5, 1.0, 1.5))),
    st.builds(draft_gear, st.sampled_from((0.1, 5.0, 800.0)), st.sampled_from((1e-3, 0.02, 0.5))),
    st.builds(hertz, st.sampled_from((1.0, 1e3))),
)
_MASSES = st.sampled_from((1.0, 0.01, 0.3, 100.0, math.inf, 0.0))
_NUMBER = st.sampled_from((0.0, 1.0, -1.0, 0.3, -2.5, 1e3, math.nan, math.inf))
_POSITIONS = st.sampled_from((0.0, 1.0, -1.0, 0.3, -2.5, 50.0))

INPUTS: st.SearchStrategy[inputs.Input] = st.one_of(
    st.builds(inputs.Place, _NUMBERS, _NUMBERS, _POSITIONS),
    st.builds(inputs.Drag, _NUMBERS, _NUMBERS, _POSITIONS),
    st.builds(inputs.Drop),
    st.builds(inputs.SetVelocity, _NUMBERS, _OR_ALL, _NUMBER),
    st.builds(inputs.SetMass, _NUMBERS, _OR_ALL, _MASSES),
    st.builds(inputs.SetContact, _NUMBERS, _OR_ALL, _LAWS),
    st.builds(inputs.SetKind, _NUMBERS, _OR_ALL, st.sampled_from(KINDS)),
    st.builds(inputs.Lock, _NUMBERS, _OR_ALL, st.booleans()),
    st.builds(inputs.SetGap, _NUMBERS, _NUMBERS, st.sampled_from((0.0, 0.5, -1.0))),
    st.builds(inputs.SetDrive, _NUMBERS, _OR_ALL, _NUMBER),
    st.builds(inputs.SetFriction, _NUMBERS, st.sampled_from((0.0, 0.2, 1.0, -0.1))),
    st.builds(inputs.AddBead, _NUMBERS, _NUMBERS, _MASSES, st.sampled_from((0.0, 0.4))),
    st.builds(inputs.RemoveBead, _NUMBERS, _NUMBERS),
    st.builds(inputs.SetMethod, _OR_ALL, st.sampled_from(METHODS)),
    st.builds(inputs.SetStep, _NUMBERS, st.sampled_from((None, 1e-3, 0.02, 0.0))),
    st.builds(inputs.SetSlow, st.sampled_from((1.0, 10.0, 400.0, 0.0))),
)


def fitted(item: inputs.Input, session: Session) -> inputs.Input:
    """Return a copy of `item` in which the numbers of lane, bead and contact are valid for `session`."""
    contacts = session.lanes[(getattr(item, "lane", None) or 0) % len(session.lanes)].chain.contacts
    beads = contacts + (2 if isinstance(item, inputs.AddBead) else 1)
    most = {"lane": len(session.lanes), "bead": beads, "contact": contacts}
    given = {key: getattr(item, key) for key in most if getattr(item, key, None) is not None}
    item = replace(item, **{key: value % most[key] for key, value in given.items()})
    if isinstance(item, inputs.AddBead) and contacts >= MOST_BEADS:
        return inputs.RemoveBead(item.lane, item.bead % (contacts + 1))
    return item
