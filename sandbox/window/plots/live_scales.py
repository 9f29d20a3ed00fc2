"""Scales of a running scene: those of a run ahead where there is one, grown in round steps as the motion asks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from softcradle.physics.scales import contact_scales
from softcradle.sandbox.draw.number_format import round_step
from softcradle.sandbox.draw.shared_scales import Scales, scales_of
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.session.history import BY_BED, BY_CONTACTS
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.session.session import Session
from softcradle.scenes import Scene

GROW = 1.25  # past the value that did not fit
DEEPER = 1.5
FEWEST_DECADES = 4


def moment(lane: LiveLane) -> Motion:
    """The state of a lane now."""
    state = lane.state
    return Motion(
        chain=lane.chain,
        time=np.array([state.time]),
        overlap=state.overlap[None],
        rate=state.rate[None],
        anchor=state.anchor[None],
        force=state.force[None],
        absorbed=lane.books[[BY_CONTACTS, BY_BED]].sum()[None] if lane.chain.dissipative else np.zeros(0),
    )


def estimated(scene: Scene, session: Session) -> Scales:
    """Scales from the start alone, before the physics can run: energies of single contacts say how large things get."""
    scales = scales_of(scene, [moment(lane) for lane in session.lanes])
    forces, depths = [], []
    for lane in session.lanes:
        depth = contact_scales(lane.chain, [0.0, lane.setup.speed])[0] if lane.chain.contacts == 1 else _depth(lane)
        depths.append(tuple(depth.tolist()))
        force = [float(law.force(d)) for law, d in zip(lane.chain.contact, depth, strict=True)]
        forces.append(max(force))
    high = math.ceil(math.log10(max(max(d) for d in depths)))
    low, right = scales.window
    return replace(
        scales,
        force=1.12 * 2.0 * max(forces),
        deepest=tuple(depths),
        decades=(high - 2 * FEWEST_DECADES, high),
        window=(low, right + 0.35 * (right - low)),
    )


def _depth(lane: LiveLane) -> Array:
    depth: Array = contact_scales(lane.chain, lane.velocity)[0]
    return depth


class LiveScales:
    """The scales in use. `fit` says whether they had to change."""

    def __init__(self, scales: Scales, lanes: Sequence[LiveLane]) -> None:
        self.scales = scales
        self.reset_lanes(lanes)

    def reset_lanes(self, lanes: Sequence[LiveLane]) -> None:
        """The number of beads has changed: loupes magnify anew."""
        kept = []
        for lane, deepest in zip(lanes, self.scales.deepest, strict=True):
            same = len(deepest) == lane.chain.contacts
            kept.append(deepest if same else (max(deepest),) * lane.chain.contacts)
        self.scales = replace(self.scales, deepest=tuple(kept))

    def fit(self, tracks: Sequence[Motion]) -> bool:
        """Grow so that the lanes as they are now, one row each, fit in."""
        old = self.scales
        self._velocities(tracks)
        self._forces(tracks)
        self._overlaps(tracks)
        self._energies(tracks)
        return self.scales is not old

    def _velocities(self, tracks: Sequence[Motion]) -> None:
        low, high = self.scales.velocity
        least = min(float(track.velocity.min()) for track in tracks)
        most = max(float(track.velocity.max()) for track in tracks)
        if least < low or most > high:
            low = _rounded(least) if least < low else low
            high = _rounded(most) if most > high else high
            self.scales = replace(self.scales, velocity=(low, high))

    def _forces(self, tracks: Sequence[Motion]) -> None:
        most = max(float(track.force.max()) for track in tracks)
        if most > self.scales.force:
            self.scales = replace(self.scales, force=_rounded(most))

    def _overlaps(self, tracks: Sequence[Motion]) -> None:
        pairs = [(track.overlap[0], np.array(deep)) for track, deep in zip(tracks, self.scales.deepest, strict=True)]
        if all((overlap <= DEEPER * deep).all() for overlap, deep in pairs):
            return
        grown = [np.where(overlap > DEEPER * deep, 2.0 * overlap, deep) for overlap, deep in pairs]
        low, high = self.scales.decades
        higher = max(high, math.ceil(math.log10(max(float(deep.max()) for deep in grown))))
        deepest = tuple(tuple(deep.tolist()) for deep in grown)
        self.scales = replace(self.scales, deepest=deepest, decades=(low, higher))

    def _energies(self, tracks: Sequence[Motion]) -> None:
        energy = max(float(track.kinetic.sum() + track.stored[0]) for track in tracks)
        if energy > 1.02 * self.scales.energy:
            self.scales = replace(self.scales, energy=_rounded(energy))
        low, high = self.scales.momentum
        least = min(float(np.minimum(track.momentum, 0.0).sum()) for track in tracks)
        most = max(float(np.maximum(track.momentum, 0.0).sum()) for track in tracks)
        slack = 0.02 * (high - low)
        if least < low - slack or most > high + slack:
            low, high = min(low, GROW * least), GROW * most if most > high + slack else high
            self.scales = replace(self.scales, momentum=(low, high))


def _rounded(value: float) -> float:
    """A round value past `value`, on its side of zero."""
    if value == 0.0:
        return 0.0
    return math.copysign(round_step(GROW * abs(value), 4) * 4, value)
