"""Scales of all chains of a batch: the numbers that `scales` gives for each, computed for all at once.

Chains that are driven or pressed at the start are asked one by one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.batch.chain_batch import ChainBatch
from softcradle.physics.checked_input import SMALLEST
from softcradle.physics.default_step import STEPS_A_CONTACT, STEPS_A_STOP, default_step
from softcradle.physics.numerics.array_powers import powers
from softcradle.physics.scales import (
    LEAST_DEPTH,
    LEAST_SCALE,
    MOST_DEPTH,
    ROUND_OFF,
    closing_scale,
    contact_scales,
    require_computable,
)
from softcradle.physics.state import State, from_anchor

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BatchStart:
    """The motion of all chains at the start, a row a chain, as `State.at_start` gives it."""

    overlap: Array  # (C, n) [m]
    rate: Array  # (C, n) [m/s]
    anchor: Array  # (C, 2) [m], [m/s]
    force: Array  # (C, n) [N]
    velocity: Array  # (C, n+1) of the beads, as rates give them


def start_of(batch: ChainBatch, speeds: Array) -> BatchStart:
    """The start of a batch with bead velocities `speeds` (C, n+1)."""
    chains = np.arange(batch.chains)
    position = np.concatenate((np.zeros((batch.chains, 1)), np.cumsum(batch.gap, axis=1)), axis=1)
    anchor = np.stack([position[chains, batch.anchor], speeds[chains, batch.anchor]], axis=1)
    overlap, rate = 0.0 - batch.gap, speeds[:, :-1] - speeds[:, 1:]
    force = np.zeros(overlap.shape)
    for k in _pressed(batch):
        force[k] = State.at_start(batch.chain(k), speeds[k]).force
    return BatchStart(overlap, rate, anchor, force, velocities_of(batch, rate, anchor))


def velocities_of(batch: ChainBatch, rate: Array, anchor: Array) -> Array:
    """(C, n+1) bead velocities from the rates and the anchor beads."""
    found = np.empty(batch.mass.shape)
    for bead in np.unique(batch.anchor).tolist():
        rows = batch.anchor == bead
        found[rows] = from_anchor(rate[rows], anchor[rows, 1], bead)
    return found


def contact_times(batch: ChainBatch, velocity: Array) -> Array:
    """(C, n) contact times [s]. Raises ValueError where a chain is pressed so little or so far that floats end."""
    speed = np.ptp(velocity, axis=1)
    speed[speed == 0.0] = 1.0
    inverse_reduced = batch.inverse_mass[:, :-1] + batch.inverse_mass[:, 1:]
    energy = (0.5 * speed * speed)[:, None] / inverse_reduced
    with np.errstate(divide="ignore", over="ignore", under="ignore"):
        by_power = powers((1.0 + batch.exponent) * energy / batch.stiffness, 1.0 / (1.0 + batch.exponent))
        depth = np.minimum(energy / batch.preload, by_power)
        times: Array = 2.0 * depth / speed[:, None]
    computable = (speed >= SMALLEST) & ((depth >= LEAST_DEPTH) & (depth <= MOST_DEPTH)).all(axis=1)
    for k in {*np.flatnonzero(~computable).tolist(), *_special(batch)}:
        chain = batch.chain(k)
        require_computable(chain, velocity[k])
        times[k] = contact_scales(chain, velocity[k])[1]
    return times


def default_steps(batch: ChainBatch, velocity: Array, times: Array) -> Array:
    """(C,) default steps [s] of chains whose contacts take `times` (C, n) [s]."""
    steps: Array = times.min(axis=1) / STEPS_A_CONTACT
    strongest = batch.bed.max(axis=1)
    speed = np.ptp(velocity, axis=1)
    speed[speed == 0.0] = 1.0
    braked = strongest > 0.0
    steps[braked] = np.minimum(steps[braked], speed[braked] / strongest[braked] / STEPS_A_STOP)
    for k in _special(batch):
        steps[k] = default_step(batch.chain(k), velocity[k])
    return steps


def closing_scales(batch: ChainBatch, start: BatchStart, durations: Array) -> Array:
    """(C,) the speeds [m/s] that tolerances are relative to; a duration of inf is none."""
    velocity = start.velocity
    ahead = np.maximum.accumulate(velocity, axis=1)[:, :-1]
    behind = np.minimum.accumulate(velocity[:, ::-1], axis=1)[:, -2::-1]
    approach = np.maximum((ahead - behind).max(axis=1), 0.0)
    approach[approach <= ROUND_OFF * np.abs(velocity).max(axis=1)] = 0.0
    spread = np.ptp(velocity, axis=1)
    scale: Array = np.maximum(approach, LEAST_SCALE * spread)
    scale[scale == 0.0] = np.where(spread == 0.0, 1.0, spread)[scale == 0.0]
    for k in _special(batch):
        chain, duration = batch.chain(k), float(durations[k])
        limit = None if np.isinf(duration) else duration
        scale[k] = closing_scale(chain, velocity[k], start.overlap[k], chain.drive_force, limit)
    return scale


def _pressed(batch: ChainBatch) -> list[int]:
    """Chains with a contact that is pressed at the start."""
    return np.flatnonzero((batch.gap < 0.0).any(axis=1)).tolist()


def _special(batch: ChainBatch) -> list[int]:
    """Chains with more in their scales than velocities: they are driven, or pressed at the start."""
    return np.flatnonzero(batch.driven | (batch.gap < 0.0).any(axis=1)).tolist()
