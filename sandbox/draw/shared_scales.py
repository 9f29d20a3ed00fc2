"""Common scales of a picture. All lanes have the same time axis, the same vertical axes and the same camera. This makes
them comparable.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from softcradle.physics import Chain, Trajectory
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.story.numbers import round_down, scientific
from softcradle.scenes import Scene

# Largest number of decades of the overlap axis. Overlaps deep inside nearly rigid clusters can be smaller than this
# range.
MOST_DECADES = 32
DRAWN_OVERLAP = 0.22  # Length at which the largest overlap is drawn, relative to the length of a bead.
# Largest magnification of overlaps. If the overlaps need a larger factor, they are drawn to scale.
MOST_MAGNIFIED = 1e6
FORCE_MARGIN = 1.12  # Ratio of the upper end of the force axis to the largest force.
Span = tuple[float, float]


@dataclass(frozen=True)
class Scales:
    """Common scales of all lanes of a picture.

    Attributes:
        time: ends of the time axis [s].
        window: left and right end of the lanes [m].
        velocity: ends of the velocity axis [m/s].
        force: upper end of the force axis [N], for pushes and pulls alike.
        pull: lower end of the force axis of plots [N]; below 0 if couplers pull.
        decades: exponents of ten at the ends of the overlap axis.
        magnify: factor by which lanes draw overlaps larger than they are.
        deepest: for each lane (n,) the largest overlap of each contact [m]. The magnification of an inset follows from
            it.
        energy: energy [J] that fills the energy bar.
        momentum: ends of the momentum bar [N s].
    """

    time: Span
    window: Span
    velocity: Span
    force: float
    pull: float
    decades: tuple[int, int]
    magnify: float
    deepest: tuple[tuple[float, ...], ...]
    energy: float
    momentum: Span


class Reached(NamedTuple):
    """Ranges of the values of some motions. Scales are chosen to contain these ranges. The energy includes the absorbed
    energy.
    """

    velocity: Span
    force: float
    pull: float
    energy: float
    momentum: Span


def reached(motions: Sequence[Motion]) -> Reached:
    """Return the ranges of the values of all `motions`."""
    momenta = [motion.momentum for motion in motions]
    low = min(float(np.minimum(p, 0.0).sum(axis=1).min()) for p in momenta)
    high = max(float(np.maximum(p, 0.0).sum(axis=1).max()) for p in momenta)
    return Reached(
        velocity=(min(float(m.velocity.min()) for m in motions), max(float(m.velocity.max()) for m in motions)),
        force=max(float(np.abs(m.force).max()) for m in motions),
        pull=min(float(m.force.min()) for m in motions),
        energy=max(float((m.energy + m.absorbed if m.absorbed.size else m.energy).max()) for m in motions),
        momentum=(low, high),
    )


def scales_of(scene: Scene, motions: Sequence[Motion]) -> Scales:
    """Return the common scales of all `motions`. There is one motion for each lane of `scene`."""
    deepest = tuple(tuple(np.maximum(motion.overlap.max(axis=0), 0.0).tolist()) for motion in motions)
    magnify = scene.view.magnify or _magnify(max(map(max, deepest)), scene.view.length)
    begin, end = min(float(m.time[0]) for m in motions), max(float(m.time[-1]) for m in motions)
    most = reached(motions)
    low, high = most.momentum
    return Scales(
        time=(begin, end if end > begin else begin + 1.0),
        window=_window(scene, motions, magnify),
        velocity=axis_range([motion.velocity for motion in motions]),
        force=FORCE_MARGIN * most.force or 1.0,
        pull=FORCE_MARGIN * min(0.0, most.pull),
        decades=_decades(deepest),
        magnify=magnify,
        deepest=deepest,
        energy=most.energy or 1.0,
        momentum=(low, high if high > low else 1.0),
    )


def left_edges(position: Array, overlap: Array, length: float, magnify: float) -> Array:
    """Return the positions [m] (..., n+1) at which the left edges of the beads are drawn.

    Overlaps are magnified by `magnify`. The magnification does not change the mean position of the beads.
    """
    shift = np.zeros_like(position)
    if magnify != 1.0:
        np.cumsum((1.0 - magnify) * np.maximum(overlap, 0.0), axis=-1, out=shift[..., 1:])
        shift -= shift.mean(axis=-1, keepdims=True)
    return position + shift + length * np.arange(position.shape[-1])


def _magnify(deepest: float, length: float) -> float:
    wanted = DRAWN_OVERLAP * length / deepest if deepest > 0.0 else 1.0
    return round_down(wanted) if 1.0 < wanted < MOST_MAGNIFIED else 1.0


def _window(scene: Scene, motions: Sequence[Motion], magnify: float) -> Span:
    length = scene.view.length
    edges = [left_edges(motion.position, motion.overlap, length, magnify) for motion in motions]
    low, high = min(float(e.min()) for e in edges), max(float(e.max()) for e in edges) + length
    return low - 0.25 * length, high + 0.25 * length


def axis_range(values: Sequence[Array]) -> Span:
    """Return a range that contains 0 and all `values`, with some space at its ends."""
    low, high = min(0.0, *(float(v.min()) for v in values)), max(0.0, *(float(v.max()) for v in values))
    if low == high:
        return low - 1.0, high + 1.0
    room = 0.06 * (high - low)
    return (low - room if low < 0.0 else low), high + room


def _decades(deepest: tuple[tuple[float, ...], ...]) -> tuple[int, int]:
    """Return the exponents of ten at the ends of the overlap axis.

    Each contact has a largest overlap. The axis ends at the power of ten above the largest of these values. The axis
    begins one decade below the smallest of these values.
    """
    depths = [depth for lane in deepest for depth in lane if depth > 0.0]
    if not depths:
        return -3, 0
    high = math.ceil(math.log10(max(depths)))
    return max(math.floor(math.log10(min(depths))) - 1, high - MOST_DECADES), high


@np.errstate(over="ignore", invalid="ignore")  # The code that shows a motion rejects values that are not finite.
def motion_of(trajectory: Trajectory, lead: Array | None = None) -> Motion:
    """Return the motion of `trajectory`. Add free flight at the times `lead` < 0 [s] before its start, see
    :func:`longest_lead`.
    """
    times = np.empty(0) if lead is None else lead - trajectory.time[0]
    flight, open_contacts = times[:, None], np.zeros((len(times), trajectory.chain.contacts))
    start = trajectory.anchor[0]
    anchor = np.column_stack((start[0] + times * start[1], np.full(len(times), start[1])))
    absorbed = trajectory.absorbed_by_contacts + trajectory.absorbed_by_bed
    balance = np.column_stack((trajectory.ledger, trajectory.momentum - trajectory.impulse))
    return Motion(
        chain=trajectory.chain,
        time=np.concatenate((times, trajectory.time)),
        overlap=np.concatenate((trajectory.overlap[0] + flight * trajectory.rate[0], trajectory.overlap)),
        rate=np.concatenate((open_contacts + trajectory.rate[0], trajectory.rate)),
        anchor=np.concatenate((anchor, trajectory.anchor)),
        force=np.concatenate((open_contacts, trajectory.force)),
        absorbed=np.concatenate((np.zeros(len(times)), absorbed)) if trajectory.chain.dissipative else np.zeros(0),
        balance=np.concatenate((np.tile(balance[0], (len(times), 1)), balance)),
        method=f"{trajectory.method}, step {scientific(trajectory.step)} s" if trajectory.step else trajectory.method,
    )


def longest_lead(chain: Chain, velocity: Array) -> float:
    """Return the longest time [s] before the start for which free flight can be shown. It can be infinite.

    The beads fly backwards in time from their state at the start. If two beads move apart at the start, the backward
    flight ends when they touch. The returned time is 0 for chains with friction, brakes or strings, because their beads
    did not move at constant velocities.
    """
    if chain.takes_momentum:
        return 0.0
    parting, gap = np.maximum(np.diff(velocity), 0.0), np.array(chain.gap)
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.min(np.where(parting > 0.0, gap / parting, np.inf)))
