"""Motion that a page plays. The module adapts recorded trajectories to the player and writes tables with their exact
numbers.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from softcradle.physics import Trajectory
from softcradle.physics.status import Status
from softcradle.sandbox.draw.shared_scales import Scales, motion_of, scales_of
from softcradle.sandbox.film.scene_motion import require_finite, shown_span
from softcradle.sandbox.languages import N_, _, ngettext, scene_words
from softcradle.sandbox.motion import Motion
from softcradle.sandbox.page.document import note, table
from softcradle.sandbox.story.numbers import force_unit, scientific, time_unit
from softcradle.sandbox.trajectory_summary import bead_table, contact_table, summarise
from softcradle.scenes import Scene
from softcradle.scenes.contact_text import contact_text

# Time from the last sample before the start to the start, as a fraction of the free flight. The sample just before the
# start allows the force to jump at the start.
JUST_BEFORE = 1e-6


@dataclass(frozen=True)
class PlayedMotion:
    """Content of a page: a scene with title and view, one trajectory for each lane, and one label for each lane."""

    scene: Scene
    trajectories: tuple[Trajectory, ...]
    labels: tuple[str, ...]

    @cached_property
    def motions(self) -> list[Motion]:
        """The motions of all lanes. Free flight is added after the end, and also before the start if a motion starts at
        t = 0.
        """
        motions = _drawable(self.scene, self.trajectories)
        require_finite(motions)
        return motions

    @cached_property
    def scales(self) -> Scales:
        """Common scales of the axes of all lanes."""
        return scales_of(self.scene, self.motions)

    @cached_property
    def time_unit(self) -> tuple[float, str]:
        """Unit of the time axis: its size in seconds, and its name."""
        return time_unit(self.scales.time[1] - self.scales.time[0])

    @cached_property
    def force_unit(self) -> tuple[float, str]:
        """Unit of the force axis: its size in newtons, and its name."""
        return force_unit(self.scales.force)


def played_motion(scene: Scene, trajectories: Sequence[Trajectory]) -> PlayedMotion:
    """Return the PlayedMotion with the labels of the lanes of `scene`."""
    return PlayedMotion(scene, tuple(trajectories), tuple(lane.label for lane in scene.lanes))


def _drawable(scene: Scene, trajectories: Sequence[Trajectory]) -> list[Motion]:
    """Return the motions of all lanes. All of them cover the same time span.

    An edit may have restarted the recording of a lane. Therefore the motions begin at the latest start of a lane. Free
    flight is added as in films. Free flight precedes a start at t = 0. If all lanes have separated, it also follows the
    end.
    """
    end = max(float(found.time[-1]) for found in trajectories)
    lead, until = shown_span(scene, end)
    early = lead > 0.0 and all(found.time[0] == 0.0 for found in trajectories)
    before = np.array([-lead, -JUST_BEFORE * lead]) if early else None
    if not all(found.status is Status.SEPARATED for found in trajectories):
        until = end
    motions = [_continued(motion_of(found, before), found.status, until) for found in trajectories]
    begin = max(float(motion.time[0]) for motion in motions)
    return [_since(begin, motion) for motion in motions]


def _since(begin: float, motion: Motion) -> Motion:
    """Return the part of `motion` that begins with the last sample at or before the time `begin` [s]."""
    rows = slice(int(np.searchsorted(motion.time, begin, side="right")) - 1, None)
    names = ("time", "overlap", "rate", "anchor", "force", "absorbed", "balance")
    return replace(motion, **{name: getattr(motion, name)[rows] for name in names})


def _continued(motion: Motion, status: Status, end: float) -> Motion:
    """Return `motion`, continued to the time `end` [s] if its beads have separated.

    One sample is added at `end`. The beads fly freely, so straight lines lead to this sample.
    """
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
        balance=np.concatenate((motion.balance, motion.balance[-1:])),
        method=motion.method,
    )


def result_tables(played: PlayedMotion) -> str:
    """Return two tables for each lane: the velocities of the beads, and the contacts."""
    parts = []
    for lane, trajectory in enumerate(played.trajectories):
        summary = summarise(played.labels[lane], trajectory)
        beads, contacts = bead_table(summary), contact_table(summary)
        laws = map(contact_text, trajectory.chain.contact)
        rows = [(*row, law) for row, law in zip(contacts.rows, laws, strict=True)]
        parts.append(table(beads.titles, beads.rows, _named(played, lane, _("Velocities"))))
        parts.append(table((*contacts.titles, _("law")), rows, _named(played, lane, _("Contacts"))))
    return "".join(parts)


def result_notes(played: PlayedMotion) -> str:
    """Return notes about the computation of each lane. The notes include the warnings of the simulation."""
    parts = []
    for lane, trajectory in enumerate(played.trajectories):
        parts.append(note(_named(played, lane, recorded_sentence(trajectory))))
        parts += [note(_named(played, lane, str(warning)), warning=True) for warning in trajectory.warnings]
    return "".join(parts)


def _named(played: PlayedMotion, lane: int, text: str) -> str:
    """Return `text`. If there are several lanes, put the label of the lane in front of it."""
    label = scene_words(played.labels[lane])
    return f"{label}: {text}" if label and len(played.labels) > 1 else text


def recorded_sentence(trajectory: Trajectory) -> str:
    """Return the sentence that names the method and the errors of a recorded motion."""
    summary = summarise("", trajectory)
    if summary.step:
        fineness = _("step {step} s", step=scientific(summary.step))
    else:
        fineness = _("tolerance {tolerance:g}", tolerance=summary.tolerance)
    errors = [
        _(text, error=scientific(value) if value > 1e-17 else "0")
        for text, value in (
            (N_("velocities at the end to {error} m/s"), summary.velocity_error),
            (N_("energy error {error}"), summary.energy_error),
            (N_("momentum error {error}"), summary.momentum_error),
        )
        if value is not None
    ]
    cost = [ngettext("{n} step", "{n} steps", summary.steps)] if summary.steps else []
    said = f"; {', '.join(errors + cost)}" if errors or cost else ""
    return _("Recorded motion, computed by {method}, {fineness}", method=summary.method, fineness=fineness) + said
