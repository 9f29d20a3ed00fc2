"""Scales of a running scene. They are taken from a run ahead of time, or estimated until this run is available.

Edits and new frames of the history change the scales.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from softcradle.physics.methods import AUTO, Family, find_method
from softcradle.physics.scales import scales_at
from softcradle.sandbox.draw.shared_scales import Scales, reached, scales_of
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.scene_runs import SHOWN
from softcradle.sandbox.session.history_slices import history_slices
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.story.numbers import round_step
from softcradle.sandbox.window.page import Host
from softcradle.scenes import Scene

ROWS = 240  # Smallest number of samples in the motion of a run ahead of time.
ROWS_PER_SECOND = 60.0  # Smallest number of samples per second of the displayed motion.
# Families of methods that run in Python. Their steps can take a thousand times as long.
IN_PYTHON = (Family.PYMUNK, Family.REFERENCE)
# Limit of the number of steps times contacts of a lane, for a run that the window waits for. It takes about 0.2 s.
MOST_AT_ONCE = 1_000_000
# Limit of the number of steps times contacts of a lane, for a run in the background thread. It takes some seconds.
# Better scales are not worth more time.
MOST_BEHIND = 6_000_000


def motions_ahead(scene: Scene, most: int = MOST_BEHIND) -> list[Motion]:
    """Return the motion of each lane, accurate enough for a picture. Warnings are omitted, because the badges show them
    later.

    Most scenes take some milliseconds. Raise GaveUpError if a lane needs more than `most` steps times contacts.
    """
    from softcradle.sandbox.film.scene_motion import scene_motions_quietly

    rate = max(ROWS / (scene.duration or 1.0), ROWS_PER_SECOND * scene.view.slow)
    method = scene.method if scene.method not in (None, AUTO) else SHOWN
    if find_method(method).family in IN_PYTHON:
        method = SHOWN
    motions, _ = scene_motions_quietly(scene, rate, method=method, most=most)
    return motions


GROWTH = 1.25  # New limit of a scale after a value has exceeded it, as a multiple of this value.
DEEPER = 1.5  # Overlap at which the magnification changes, relative to the largest overlap so far.
SLACK = 0.02  # Fraction by which a value may exceed the scales of energy and momentum.
FEWEST_DECADES = 4  # Smallest number of decades of an estimated overlap axis.


def estimated_scales(scene: Scene, session: Session) -> Scales:
    """Estimate the scales from the start of the scene, without a simulation.

    The kinetic energy that is available to a single contact gives bounds for its force and overlap.
    """
    scales = scales_of(scene, [lane.motion for lane in session.lanes])
    forces, depths = [], []
    for lane in session.lanes:
        depth = scales_at(lane.chain, lane.setup.scale)[0]
        depths.append(tuple(depth.tolist()))
        forces.append(max(float(law.force(d)) for law, d in zip(lane.chain.contact, depth, strict=True)))
    high = math.ceil(math.log10(max(max(d) for d in depths)))
    left, right = scales.window
    return replace(
        scales,
        force=1.12 * 2.0 * max(forces),
        deepest=tuple(depths),
        decades=(high - 2 * FEWEST_DECADES, high),
        window=(left, right + 0.35 * (right - left)),
    )


class LiveScales:
    """The scales in use. They are the scales of the run `ahead`, enlarged so that the history fits."""

    ahead: Scales

    def __init__(self, session: Session) -> None:
        self.session = session

    def take(self, ahead: Scales) -> None:
        """Use the scales of a run ahead of time."""
        self.ahead = ahead
        self.follow_history()

    def follow_history(self) -> None:
        """Set the scales to those of the run ahead, and enlarge them for the present frames of the history.

        This is necessary after frames were removed or restored.
        """
        self.scales, history = self.ahead, self.session.history
        self.reset_lanes(self.session.lanes)
        lanes = (history_slices(history, k, history.first, history.last) for k in range(len(self.session.lanes)))
        for motions in zip(*lanes, strict=True):
            self.fit(motions)

    def reset_lanes(self, lanes: Sequence[LiveLane]) -> None:
        """If the number of beads of a lane has changed, set the scale of each contact to the largest overlap of the
        lane.
        """
        deepest = []
        for lane, depths in zip(lanes, self.scales.deepest, strict=True):
            same = len(depths) == lane.chain.contacts
            deepest.append(depths if same else (max(depths),) * lane.chain.contacts)
        self.scales = replace(self.scales, deepest=tuple(deepest))

    def fit(self, motions: Sequence[Motion]) -> None:
        """Enlarge the scales if the given motion of a lane does not fit."""
        found, now = reached(motions), self.scales
        (least, most), (low, high) = found.velocity, now.velocity
        (falls, rises), (left, right) = found.momentum, now.momentum
        slack = SLACK * (right - left)
        self.scales = replace(
            now,
            velocity=(_rounded(least) if least < low else low, _rounded(most) if most > high else high),
            force=_rounded(found.force) if found.force > now.force else now.force,
            pull=_rounded(found.pull) if found.pull < now.pull else now.pull,
            energy=_rounded(found.energy) if found.energy > (1.0 + SLACK) * now.energy else now.energy,
            momentum=(GROWTH * falls if falls < left - slack else left, GROWTH * rises if rises > right + slack else right),
        )  # fmt: skip
        self._overlaps(motions)

    def _overlaps(self, motions: Sequence[Motion]) -> None:
        pairs = [(m.overlap.max(axis=0), np.array(d)) for m, d in zip(motions, self.scales.deepest, strict=True)]
        if any(len(overlap) != len(depths) for overlap, depths in pairs):
            return  # Skip these frames, because their number of beads is different.
        if all((overlap <= DEEPER * depths).all() for overlap, depths in pairs):
            return
        grown: list[Array] = [np.where(overlap > DEEPER * depths, 2.0 * overlap, depths) for overlap, depths in pairs]
        low, high = self.scales.decades
        higher = max(high, math.ceil(math.log10(max(float(depths.max()) for depths in grown))))
        deepest = tuple(tuple(depths.tolist()) for depths in grown)
        self.scales = replace(self.scales, deepest=deepest, decades=(low, higher))


def _rounded(value: float) -> float:
    """Return a round number that has the same sign as `value` and a larger magnitude."""
    if value == 0.0:
        return 0.0
    return math.copysign(round_step(GROWTH * abs(value), 4) * 4, value)


EDIT_SECONDS = 0.3  # Time in seconds after the last edit until the user's gesture counts as finished.


class EditFollower:
    """Computes new `scales` after edits of the scene."""

    def __init__(self, host: Host, session: Session, scales: LiveScales) -> None:
        self.host, self.session, self.scales = host, session, scales
        self._age: float | None = None  # Seconds since the last edit; None if no edit waits for new scales.

    def notice(self) -> None:
        """Note that the scene was edited."""
        self._age = 0.0

    @property
    def pending(self) -> bool:
        """True if the scales do not yet include the last edit."""
        return self._age is not None

    def update(self, seconds: float) -> None:
        """Start a run ahead of time if enough time has passed since the last edit."""
        if self._age is None:
            return
        self._age += seconds
        if self._age > EDIT_SECONDS:
            self._age = None
            try:
                scene = self.session.to_scene()
            except ValueError:  # The state cannot be written as a scene file, so the present scales are kept.
                return
            self.host.warmup.submit(partial(self._take, scene), partial(motions_ahead, scene))

    def _take(self, scene: Scene, motions: object) -> None:
        """Use the new scales, or estimates if the run failed. If the scene was edited again, ignore the result."""
        if not self.pending:
            found = scales_of(scene, motions) if isinstance(motions, list) else estimated_scales(scene, self.session)
            self.scales.take(found)
