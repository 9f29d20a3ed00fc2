"""Drawable trajectories: the Motion in a Trajectory, with free flight before its start."""

from __future__ import annotations

import numpy as np
from softcradle.physics import Chain, Trajectory
from softcradle.sandbox.draw.number_format import scientific
from softcradle.sandbox.motion import Array, Motion


def motion_of(trajectory: Trajectory, lead: Array | None = None) -> Motion:
    """The motion in `trajectory`, with free flight before it at the times `lead` < 0 (see :func:`longest_lead`)."""
    times = np.empty(0) if lead is None else lead - trajectory.time[0]
    flight, open_contacts = times[:, None], np.zeros((len(times), trajectory.chain.contacts))
    start = trajectory.anchor[0]
    anchor = np.column_stack((start[0] + times * start[1], np.full(len(times), start[1])))
    absorbed = trajectory.absorbed_by_contacts + trajectory.absorbed_by_bed
    return Motion(
        chain=trajectory.chain,
        time=np.concatenate((times, trajectory.time)),
        overlap=np.concatenate((trajectory.overlap[0] + flight * trajectory.rate[0], trajectory.overlap)),
        rate=np.concatenate((open_contacts + trajectory.rate[0], trajectory.rate)),
        anchor=np.concatenate((anchor, trajectory.anchor)),
        force=np.concatenate((open_contacts, trajectory.force)),
        absorbed=np.concatenate((np.zeros(len(times)), absorbed)) if trajectory.chain.dissipative else np.zeros(0),
        given=np.concatenate((np.zeros((len(times), 2)), trajectory.given))
        if trajectory.chain.forces
        else np.zeros((0, 2)),
        method=f"{trajectory.method}, step {scientific(trajectory.step)} s" if trajectory.step else trajectory.method,
    )


def longest_lead(chain: Chain, velocity: Array) -> float:
    """Longest time [s] before the start for which free flight can be shown: until two beads that now part would touch, or inf.

    0 where friction or brakes act, for beads were faster before the start.
    """
    if chain.on_bed:
        return 0.0
    parting, gap = np.maximum(np.diff(velocity), 0.0), np.array(chain.gap)
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.min(np.where(parting > 0.0, gap / parting, np.inf)))
