"""Scales of a running scene: those of a run ahead, or estimated before there is one, which follow edits and the history."""

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

ROWS = 240  # of the motion, at least
ROWS_PER_SECOND = 60.0  # of the scene as it is shown, at least
IN_PYTHON = (Family.PYMUNK, Family.REFERENCE)  # of which a step takes up to a thousand times as long
# steps times contacts of a lane, some 0.2 s: a run ahead that the window waits for takes no more
MOST_AT_ONCE = 1_000_000
MOST_BEHIND = 6_000_000  # likewise of one on a thread, some seconds: scales are not worth more


def motions_ahead(scene: Scene, most: int = MOST_BEHIND) -> list[Motion]:
    """The motion of each lane, near enough for a picture; its warnings are left to the badges of whoever plays the scene.

    Most scenes take some milliseconds. Raises GaveUpError where a lane takes more than `most` steps times contacts.
    """
    from softcradle.sandbox.film.scene_motion import scene_motions_quietly

    rate = max(ROWS / (scene.duration or 1.0), ROWS_PER_SECOND * scene.view.slow)
    method = scene.method if scene.method not in (None, AUTO) else SHOWN
    if find_method(method).family in IN_PYTHON:
        method = SHOWN
    motions, _ = scene_motions_quietly(scene, rate, method=method, most=most)
    return motions


GROWTH = 1.25  # of a scale, relative to the value that was beyond it
DEEPER = 1.5  # overlap relative to the deepest so far at which magnifications change
SLACK = 0.02  # of the energy and momentum scales, by which a value may be beyond them
FEWEST_DECADES = 4  # of an estimated overlap axis


def estimated_scales(scene: Scene, session: Session) -> Scales:
    """Scales from the start alone, before the physics can run: energies of single contacts bound forces and overlaps."""
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
    """The scales in use: those of the run `ahead`, grown by what is in the history."""

    ahead: Scales

    def __init__(self, session: Session) -> None:
        self.session = session

    def take(self, ahead: Scales) -> None:
        """Take those of a run ahead."""
        self.ahead = ahead
        self.follow_history()

    def follow_history(self) -> None:
        """Begin again with the run ahead, and grow by the frames that there are: others were dropped, or have come back."""
        self.scales, history = self.ahead, self.session.history
        self.reset_lanes(self.session.lanes)
        lanes = (history_slices(history, k, history.first, history.last) for k in range(len(self.session.lanes)))
        for motions in zip(*lanes, strict=True):
            self.fit(motions)

    def reset_lanes(self, lanes: Sequence[LiveLane]) -> None:
        """Give every contact of a lane the lane's deepest overlap where the number of beads has changed."""
        deepest = []
        for lane, depths in zip(lanes, self.scales.deepest, strict=True):
            same = len(depths) == lane.chain.contacts
            deepest.append(depths if same else (max(depths),) * lane.chain.contacts)
        self.scales = replace(self.scales, deepest=tuple(deepest))

    def fit(self, motions: Sequence[Motion]) -> None:
        """Grow so that a motion of each lane fits in."""
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
            return  # frames of another number of beads
        if all((overlap <= DEEPER * depths).all() for overlap, depths in pairs):
            return
        grown: list[Array] = [np.where(overlap > DEEPER * depths, 2.0 * overlap, depths) for overlap, depths in pairs]
        low, high = self.scales.decades
        higher = max(high, math.ceil(math.log10(max(float(depths.max()) for depths in grown))))
        deepest = tuple(tuple(depths.tolist()) for depths in grown)
        self.scales = replace(self.scales, deepest=deepest, decades=(low, higher))


def _rounded(value: float) -> float:
    """A round value beyond `value`, on its side of zero."""
    if value == 0.0:
        return 0.0
    return math.copysign(round_step(GROWTH * abs(value), 4) * 4, value)


EDIT_SECONDS = 0.3  # after which no other edit of the gesture is waited for


class EditFollower:
    """Gives `scales` of the edited scene."""

    def __init__(self, host: Host, session: Session, scales: LiveScales) -> None:
        self.host, self.session, self.scales = host, session, scales
        self._age: float | None = None  # seconds since the edit that scales are to follow

    def notice(self) -> None:
        """There was an edit."""
        self._age = 0.0

    @property
    def pending(self) -> bool:
        """Whether scales are still to follow an edit."""
        return self._age is not None

    def update(self, seconds: float) -> None:
        """Begin a run ahead where it is time."""
        if self._age is None:
            return
        self._age += seconds
        if self._age > EDIT_SECONDS:
            self._age = None
            try:
                scene = self.session.to_scene()
            except ValueError:  # what no scene file can say keeps the scales that it has
                return
            self.host.warmup.submit(partial(self._take, scene), partial(motions_ahead, scene))

    def _take(self, scene: Scene, motions: object) -> None:
        """Take the scales, estimated where the run has failed; where there was another edit, those of that one are to come."""
        if not self.pending:
            found = scales_of(scene, motions) if isinstance(motions, list) else estimated_scales(scene, self.session)
            self.scales.take(found)
