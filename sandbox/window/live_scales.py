"""Scales of a running scene: those of a run computed ahead where there is one, grown in round steps as the motion asks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from physics import State
from physics.time_scale import contact_scales
from sandbox.draw.numbers import round_step
from sandbox.draw.scales import Scales, scales_of
from sandbox.draw.track import Array, Track
from sandbox.session.lanes import LiveLane
from sandbox.session.session import Session
from scenes import Scene

GROW = 1.25  # past the value that did not fit
DEEPER = 1.5
FEWEST_DECADES = 4


def moment(lane: LiveLane) -> Track:
    """The state of a lane now, as a track of one row."""
    return track_of_state(lane, lane.state)


def track_of_state(lane: LiveLane, state: State) -> Track:
    """A track of one row."""
    return Track(
        chain=lane.chain,
        time=np.array([state.time]),
        position=state.position(lane.chain)[None],
        velocity=state.velocity(lane.chain)[None],
        overlap=state.overlap[None],
        force=state.force[None],
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

    def fit(self, lanes: Sequence[LiveLane]) -> bool:
        """Grow so that the lanes as they are now fit in."""
        old = self.scales
        self._velocities(lanes)
        self._forces(lanes)
        self._overlaps(lanes)
        self._energies(lanes)
        return self.scales is not old

    def _velocities(self, lanes: Sequence[LiveLane]) -> None:
        low, high = self.scales.velocity
        least = min(float(lane.velocity.min()) for lane in lanes)
        most = max(float(lane.velocity.max()) for lane in lanes)
        if least < low or most > high:
            low = _rounded(least) if least < low else low
            high = _rounded(most) if most > high else high
            self.scales = replace(self.scales, velocity=(low, high))

    def _forces(self, lanes: Sequence[LiveLane]) -> None:
        most = max(float(lane.state.force.max()) for lane in lanes)
        if most > self.scales.force:
            self.scales = replace(self.scales, force=_rounded(most))

    def _overlaps(self, lanes: Sequence[LiveLane]) -> None:
        deepest = [np.array(one) for one in self.scales.deepest]
        if all((lane.state.overlap <= DEEPER * deep).all() for lane, deep in zip(lanes, deepest, strict=True)):
            return
        grown = [
            np.where(lane.state.overlap > DEEPER * deep, 2.0 * lane.state.overlap, deep)
            for lane, deep in zip(lanes, deepest, strict=True)
        ]
        most = max(float(deep.max()) for deep in grown)
        low, high = self.scales.decades
        higher = max(high, math.ceil(math.log10(most)))
        self.scales = replace(
            self.scales, deepest=tuple(tuple(deep.tolist()) for deep in grown), decades=(low, higher)
        )

    def _energies(self, lanes: Sequence[LiveLane]) -> None:
        tracks = [moment(lane) for lane in lanes]
        energy = max(float(t.kinetic.sum() + t.stored[0]) for t in tracks)
        if energy > 1.02 * self.scales.energy:
            self.scales = replace(self.scales, energy=_rounded(energy))
        low, high = self.scales.momentum
        least = min(float(np.minimum(t.momentum, 0.0).sum()) for t in tracks)
        most = max(float(np.maximum(t.momentum, 0.0).sum()) for t in tracks)
        if least < 1.02 * low - 1e-300 or most > 1.02 * high:
            self.scales = replace(
                self.scales, momentum=(min(low, GROW * least), GROW * most if most > 1.02 * high else high)
            )


def _rounded(value: float) -> float:
    """A round value past `value`, on its side of zero."""
    if value == 0.0:
        return 0.0
    return math.copysign(round_step(GROW * abs(value), 4) * 4, value)
