"""What holds in every session, whatever was done: edits go back and forth, and what was recorded runs again."""

import copy
from pathlib import Path
from typing import Any

import numpy as np
from softcradle.sandbox.session.replay import Replay
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.snapshots import NOTHING_HELD, snapshot_table


def check_invariants(session: Session) -> None:
    """What holds whatever was done: finite numbers, bounded memory, a frame of the history. AssertionError where not."""
    for number, lane in enumerate(session.lanes):
        for name in ("overlap", "rate", "anchor", "force"):
            values = getattr(lane.state, name)
            assert np.isfinite(values).all(), f"lane {number}: {name} is {values}"
        assert np.isfinite(lane.ledger).all(), f"lane {number}: ledger is {lane.ledger}"
        assert len(lane.chain.mass) == len(lane.state.overlap) + 1
    assert session.history.memory <= session.history.bound + 2 * session.history.blocks[-1].memory
    assert session.history.first <= session.frame <= session.history.last


def read_all(session: Session) -> None:
    """Read everything that a window shows. AssertionError where it is not finite or not in order."""
    for lane in range(len(session.lanes)):
        for part in session.history_slices(lane, 240):
            assert np.isfinite(part.velocity).all()
            assert np.isfinite(part.kinetic).all()
        session.health(lane)
    assert session.verdict()[1]
    assert all(impact.speed > 0.0 for impact in session.impacts)
    assert (np.diff(session.contact_events().time) >= 0.0).all()


def frame_table(session: Session) -> dict[str, Any]:
    """The frame that is shown with every digit, but for the bead that is held."""
    table = snapshot_table(session.snapshot())
    del table["hand"]
    return table


def check_order(session: Session) -> None:
    """The frame shown lies in the history, and the recording ends with it. AssertionError where not."""
    history, recording = session.history, session.recording
    assert history.first <= session.frame <= history.last
    assert recording.frame <= history.last
    assert recording.last == history.last
    assert all(recording.frame <= frame <= recording.last for frame, _ in recording.inputs)
    frames = [frame for frame, _ in recording.inputs]
    assert frames == sorted(frames)
    if session.held != NOTHING_HELD:
        lane, bead = int(session.held.lane), int(session.held.bead)
        assert bead <= session.lanes[lane].chain.contacts


def check_round_trip(session: Session) -> None:
    """Undo and redo of a copy lead back to the frame shown, and redo and undo as well. AssertionError where not."""
    for steps, there, back in (
        (session.undo_stack.done, Session.undo, Session.redo),
        (session.undo_stack.undone, Session.redo, Session.undo),
    ):
        if not steps:
            continue
        twin = copy.deepcopy(session)
        before, span, steps_before = frame_table(twin), twin.span, _steps(twin)
        name = there(twin)
        assert name
        check_order(twin)
        assert back(twin) == name
        check_order(twin)
        assert (twin.frame, twin.span, twin.scene) == (session.frame, span, session.scene)
        assert frame_table(twin) == before
        assert twin.recording.inputs == session.recording.inputs
        assert twin.recording.hashes == session.recording.hashes
        assert _steps(twin) == steps_before


def _steps(session: Session) -> list[list[int]]:
    stack = session.undo_stack
    return [[step.number for step in steps] for steps in (stack.done, stack.undone)]


def check_replay(session: Session, file: Path) -> None:
    """The recording, written to `file` and read again, leads to the same frames. AssertionError where not."""
    session.recording.save(file, session.scene)
    replay = Replay.load(file)
    assert replay.run(), f"{replay.sentence}; inputs {replay.recording.inputs}"
    if not session.scrubbed:
        assert frame_table(replay.session) == frame_table(session)
