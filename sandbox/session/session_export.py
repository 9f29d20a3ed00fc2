"""Keeping: the session's start with all edits as a scene, and its history as a trajectory."""

from __future__ import annotations

import math
from typing import Any

from softcradle.physics.state import State
from softcradle.physics.trajectory import Interval, Trajectory
from softcradle.sandbox.session.contact_events import Marks
from softcradle.sandbox.session.history import BY_BED, BY_CONTACTS
from softcradle.sandbox.session.history_slices import Series
from softcradle.sandbox.session.lane_setup import LaneSetup, Setup
from softcradle.scenes import Lane, Scene
from softcradle.scenes.contact_table import law_of

DURATION = 10.0  # s, of a scene that an edit has made one without an end


def scene_of(scene: Scene, setup: Setup) -> Scene:
    """`scene` as `setup` has it now: edited lanes, slow motion, and method and step where all lanes share them.

    A lane that has not been edited keeps the form in which it was written. A locked piston is written as the hard
    contact it is.
    """
    lanes = tuple(_lane(old, new) for old, new in zip(scene.lanes, setup.lanes, strict=True))
    changed: dict[str, Any] = {**scene.model_dump(), "lanes": [lane.model_dump() for lane in lanes]}
    changed["view"] = {**changed["view"], "slow": setup.slow}
    changed |= _method(scene, setup)
    if scene.duration is None and any(one.chain.walls > 1 or one.chain.drive for one in setup.lanes):
        changed["duration"] = DURATION
    return Scene.model_validate(changed)


def _lane(old: Lane, new: LaneSetup) -> Lane:
    """`old` if `new` still begins as it says, else a lane with a list of everything."""
    chain, start = new.chain, new.start
    velocity = tuple(start.velocity(chain).tolist())
    gap = tuple((0.0 - start.overlap).tolist())  # 0.0 - 0.0 is 0.0, not -0.0
    before = old.chain()
    same = (before.mass, before.contact, before.gap, before.drive, before.friction, old.velocity)
    if same == (chain.mass, chain.contact, gap, chain.drive, chain.friction, velocity):
        return old
    laws = [law_of(contact) for contact in chain.contact]
    alike = all(law == laws[0] for law in laws)
    return Lane.model_validate(
        {
            "label": new.label,
            "mass": chain.mass,
            "contact": laws[0] if alike else laws,
            "velocity": velocity,
            "gap": gap,
            "drive": chain.drive,
            "friction": chain.friction,
        }
    )


def _method(scene: Scene, setup: Setup) -> dict[str, Any]:
    """Keys for what all lanes share and nobody but a person has chosen."""
    first = setup.lanes[0]
    method = None if first.automatic else first.method
    step = first.step if first.step_given else None
    for lane in setup.lanes:
        if (lane.automatic, lane.step_given) != (first.automatic, first.step_given):
            return {}
        if lane.method != first.method or (first.step_given and lane.step != first.step):
            return {}
    return {"method": method, "step": step}


def trajectory_of(series: Series, lane: int, marks: Marks) -> Trajectory:
    """The end of `series` in which the chain is the last one, as a Trajectory; a warning says what it leaves out."""
    first = next(row for row, setup in series.setups if setup.chain is series.chain)
    left_out = (f"made by hand; begins at frame {series.first + first}, where the chain was last changed",)
    setup = series.setups[-1][1]
    end = State(0.0, *(array[-1] for array in (series.overlap, series.rate, series.anchor, series.force)))
    rows = slice(first, None)
    absorbed = series.ledger[rows, BY_CONTACTS : BY_BED + 1] - series.ledger[first, BY_CONTACTS : BY_BED + 1]
    return Trajectory(
        chain=series.chain,
        time=series.time[rows],
        overlap=series.overlap[rows],
        rate=series.rate[rows],
        anchor=series.anchor[rows],
        force=series.force[rows],
        final_velocity=end.velocity(series.chain),
        contact_intervals=_intervals(series.from_row(first), marks.chosen(marks.lane == lane)),
        method=setup.method,
        step=setup.step,
        tolerance=0.0 if setup.step else setup.tolerance,
        warnings=left_out if series.first + first > 0 else (),
        absorbed_by_contacts=absorbed[:, 0],
        absorbed_by_bed=absorbed[:, 1],
    )


def _intervals(series: Series, marks: Marks) -> tuple[tuple[Interval, ...], ...]:
    """(closed, opened) of every contact within `series`; what was closed before it closes at its first time."""
    found: list[tuple[Interval, ...]] = []
    for contact in range(series.chain.contacts):
        own = marks.chosen((marks.contact == contact) & (marks.frame > series.first))
        closings = own.time[own.closed].tolist()
        if series.closed[0, contact]:
            closings.insert(0, float(series.time[0]))
        openings = own.time[~own.closed].tolist()
        found.append(tuple(zip(closings, openings + [math.inf] * (len(closings) - len(openings)), strict=True)))
    return tuple(found)
