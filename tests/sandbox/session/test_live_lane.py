"""A live lane: no frame takes more than a bounded work, whatever the method."""

from __future__ import annotations

import numpy as np
import pytest
from softcradle.physics.reference.extended_precision import ExtendedRun
from softcradle.sandbox.session import SetMethod
from softcradle.sandbox.session.live_lane import REFERENCE_WORK

from tests.helpers.sessions import opened

FRAMES = 6


@pytest.mark.parametrize(
    ("scene", "told"), [("train-solid", False), ("train-shunting", True), ("train-starting", True)]
)
def test_the_reference_takes_a_bounded_work_in_a_frame(scene: str, told: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames of trains took it seconds. What it does not finish is moved on by `conserving`, and the lane says so."""
    taken, step = [0], ExtendedRun.step

    def counted(run: ExtendedRun, end: float) -> None:
        taken[-1] += 1
        step(run, end)

    monkeypatch.setattr(ExtendedRun, "step", counted)
    session = opened(scene)
    for lane in range(len(session.lanes)):
        session.apply(SetMethod(lane, "scipy"))
    for _ in range(FRAMES):  # a warning stays for longer
        taken.append(0)
        session.step_frames(1)
    most = sum(max(1, REFERENCE_WORK // lane.chain.contacts) for lane in session.lanes)
    assert max(taken) <= most + len(session.lanes)
    assert session.time == pytest.approx(FRAMES * session.setup.frame_time)
    assert all(np.isfinite(lane.velocity).all() for lane in session.lanes)
    if told:
        assert any("gave up" in lane.warning for lane in session.lanes)
