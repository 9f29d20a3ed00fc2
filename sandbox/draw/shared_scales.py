"""The scales of a picture: one clock, one set of axes and one camera for all lanes, so that lanes can be compared."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from softcradle.sandbox.draw.number_format import round_down
from softcradle.sandbox.motion import Array, Motion
from softcradle.scenes import Scene

MOST_DECADES = 32
STAGE_OVERLAP = 0.22  # of a bead's length: as large as an overlap may be drawn on the stage
Span = tuple[float, float]


@dataclass(frozen=True)
class Scales:
    """What stands for what.

    Attributes:
        time: first and last time on the time axis [s].
        window: left and right end of the stage [m].
        velocity: of the velocity axis [m/s].
        force: upper end of the force axis [N].
        decades: exponents at the ends of the overlap axis.
        magnify: factor by which the stage draws overlaps larger than they are.
        deepest: per lane (n,) greatest overlap of each contact [m]; the loupes magnify by it.
        energy: of the energy bar [J].
        momentum: ends of the momentum bar [N s].
    """

    time: Span
    window: Span
    velocity: Span
    force: float
    decades: tuple[int, int]
    magnify: float
    deepest: tuple[tuple[float, ...], ...]
    energy: float
    momentum: Span


def scales_of(scene: Scene, tracks: Sequence[Motion]) -> Scales:
    """Scales that hold all of the `tracks`, one a lane of `scene`."""
    deepest = tuple(tuple(np.maximum(track.overlap.max(axis=0), 0.0).tolist()) for track in tracks)
    magnify = scene.view.magnify or _magnify(max(map(max, deepest)), scene.view.length)
    speeds = np.concatenate([track.velocity.ravel() for track in tracks])
    momenta = [track.momentum for track in tracks]
    return Scales(
        time=(min(float(t.time[0]) for t in tracks), max(float(t.time[-1]) for t in tracks)),
        window=_window(scene, tracks, magnify),
        velocity=_padded(min(0.0, float(speeds.min())), max(0.0, float(speeds.max()))),
        force=1.12 * max(float(t.force.max()) for t in tracks) or 1.0,
        decades=_decades(deepest),
        magnify=magnify,
        deepest=deepest,
        energy=max(float((t.kinetic.sum(axis=1) + t.stored).max()) for t in tracks) or 1.0,
        momentum=(
            min(float(np.minimum(p, 0.0).sum(axis=1).min()) for p in momenta),
            max(float(np.maximum(p, 0.0).sum(axis=1).max()) for p in momenta) or 1.0,
        ),
    )


def left_edges(position: Array, overlap: Array, length: float, magnify: float) -> Array:
    """(..., n+1) where each bead's left edge is drawn [m]; overlaps `magnify` times too large, the mean unmoved."""
    shift = np.zeros_like(position)
    if magnify != 1.0:
        np.cumsum((1.0 - magnify) * np.maximum(overlap, 0.0), axis=-1, out=shift[..., 1:])
        shift -= shift.mean(axis=-1, keepdims=True)
    return position + shift + length * np.arange(position.shape[-1])


def followed(centre: float, track: Motion, row: int, length: float, share: float) -> float:
    """Where the camera looks next [m]: from `centre` a `share` (0 to 1) of the way to the middle of the beads."""
    position = track.position[row]
    middle = 0.5 * (float(position.min()) + float(position.max()) + length * len(position))
    return centre + share * (middle - centre)


def _magnify(deepest: float, length: float) -> float:
    wanted = STAGE_OVERLAP * length / deepest if deepest > 0.0 else 1.0
    return round_down(wanted) if 1.0 < wanted < 1e6 else 1.0


def _window(scene: Scene, tracks: Sequence[Motion], magnify: float) -> Span:
    length = scene.view.length
    edges = [left_edges(track.position, track.overlap, length, magnify) for track in tracks]
    low, high = min(float(e.min()) for e in edges), max(float(e.max()) for e in edges) + length
    return low - 0.25 * length, high + 0.25 * length


def _padded(low: float, high: float) -> Span:
    if low == high:
        return low - 1.0, high + 1.0
    margin = 0.06 * (high - low)
    return (low - margin if low < 0.0 else low), high + margin


def _decades(deepest: tuple[tuple[float, ...], ...]) -> tuple[int, int]:
    """From a decade below the shallowest contact that closes to that of the deepest overlap."""
    depths = [depth for lane in deepest for depth in lane if depth > 0.0]
    if not depths:
        return -3, 0
    high = math.ceil(math.log10(max(depths)))
    return max(math.floor(math.log10(min(depths))) - 1, high - MOST_DECADES), high
