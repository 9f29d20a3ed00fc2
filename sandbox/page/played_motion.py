"""The played motion: recorded trajectories as the player of a page shows them, one or a family of them on the same axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from softcradle.physics import Trajectory
from softcradle.physics.status import Status
from softcradle.sandbox.draw import Scales, motion_of, scales_of
from softcradle.sandbox.draw.number_format import force_unit, time_unit
from softcradle.sandbox.film.scene_motion import after_time, lead_time, require_finite
from softcradle.sandbox.motion import Motion
from softcradle.scenes import Scene

JUST_BEFORE = 1e-6  # of the lead: the last moment of free flight, so that a force may jump at the start


@dataclass(frozen=True)
class Member:
    """One motion: its name on the slider of a family, and for each lane a trajectory and a label."""

    name: str
    trajectories: tuple[Trajectory, ...]
    labels: tuple[str, ...]


def scene_member(scene: Scene, trajectories: Sequence[Trajectory], name: str = "") -> Member:
    """The Member with the labels of the lanes of `scene`."""
    return Member(name, tuple(trajectories), tuple(lane.label for lane in scene.lanes))


@dataclass(frozen=True)
class PlayedMotion:
    """What a page plays.

    Attributes:
        scene: gives title, lanes and view.
        members: one, or several that differ in one `parameter`.
        parameter: its name; "" for a single member.
        first: number of the member that is shown first.
    """

    scene: Scene
    members: tuple[Member, ...]
    parameter: str = ""
    first: int = 0

    @cached_property
    def motions(self) -> list[list[Motion]]:
        """The motion of every lane of every member, with free flight before a start at t = 0 and after its end."""
        motions = [_drawable(member.trajectories, _shown_end(self.scene, member)) for member in self.members]
        for lanes in motions:
            require_finite(lanes)
        return motions

    @cached_property
    def scales(self) -> Scales:
        """The axes, which hold all members."""
        return scales_of(self.scene, [motion for lanes in self.motions for motion in lanes])

    @cached_property
    def time_unit(self) -> tuple[float, str]:
        """(seconds in the unit of the time axis, its name)."""
        return time_unit(self.scales.time[1] - self.scales.time[0])

    @cached_property
    def force_unit(self) -> tuple[float, str]:
        """(newtons in the unit of the force axis, its name)."""
        return force_unit(self.scales.force)

    @cached_property
    def strongest_time(self) -> float:
        """Time of the greatest force of the member shown first [s]: the moment of a still picture."""
        strongest = max(self.motions[self.first], key=lambda motion: float(np.abs(motion.force).max()))
        return float(strongest.time[int(np.argmax(np.abs(strongest.force).max(axis=1)))])


def _shown_end(scene: Scene, member: Member) -> float:
    """Until when a member is shown [s]: with some free flight where all its lanes have come apart."""
    end = max(float(found.time[-1]) for found in member.trajectories)
    apart = all(found.status is Status.SEPARATED for found in member.trajectories)
    return end + after_time(scene, end) if apart else end


def _drawable(trajectories: Sequence[Trajectory], end: float) -> list[Motion]:
    lead = 0.0
    if all(found.time[0] == 0.0 for found in trajectories):
        starts = [(found.chain, found.velocity[0]) for found in trajectories]
        lead = lead_time(starts, max(float(found.time[-1]) for found in trajectories))
    before = np.array([-lead, -JUST_BEFORE * lead]) if lead > 0.0 else None
    return [_continued(motion_of(found, before), found.status, end) for found in trajectories]


def _continued(motion: Motion, status: Status, end: float) -> Motion:
    """`motion` until `end`, in free flight where it has come apart: one more row, which straight lines lead to."""
    span = end - float(motion.time[-1])
    if status is not Status.SEPARATED or span <= 0.0:
        return motion
    position, velocity = motion.anchor[-1]
    return Motion(
        chain=motion.chain,
        time=np.append(motion.time, end),
        overlap=np.vstack((motion.overlap, motion.overlap[-1] + span * motion.rate[-1])),
        rate=np.vstack((motion.rate, motion.rate[-1])),
        anchor=np.vstack((motion.anchor, (position + span * velocity, velocity))),
        force=np.vstack((motion.force, np.zeros(motion.chain.contacts))),
        absorbed=np.append(motion.absorbed, motion.absorbed[-1:]),
        given=np.concatenate((motion.given, motion.given[-1:])),
        method=motion.method,
    )
