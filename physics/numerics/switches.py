"""Kernels on the switches of contacts between open and closed, and on copies of a motion."""

from __future__ import annotations

from softcradle.physics.numerics.bead_velocities import at_rest
from softcradle.physics.numerics.jit import inlined
from softcradle.physics.numerics.records import SWITCH, Motion


@inlined
def is_closed(overlap, force):
    """Whether a contact pushes: it overlaps, or it touches and carries a force; or pulls, as couplers alone do."""
    return overlap > 0.0 or (overlap == 0.0 and force > 0.0) or force < 0.0


@inlined
def log_switch(log, i, now, time):
    """Log that contact i closes (`now` true) or opens at `time`; what the log has no row for is counted all the same."""
    log.closed[i] = 1 if now else 0
    k = log.counter[SWITCH]
    if k < log.contact.size:
        log.contact[k], log.time[k] = i, time
    log.counter[SWITCH] = k + 1


@inlined
def has_stopped(chain, motion, closed):
    """Whether a run of steps ends: a contact has left the state that its flag in `closed` (n,) says, or all beads of a chain
    with dissipation rest."""
    stopped = chain.dissipation.loss.size > 0 and at_rest(motion)
    for i in range(closed.size):
        stopped |= is_closed(motion.overlap[i], motion.force[i]) != (closed[i] != 0)
    return stopped


@inlined
def copy_into(target, source):
    """``target[:] = source`` of arrays (k,): a slice that takes an array might overlap it, so numba would allocate."""
    for i in range(source.size):
        target[i] = source[i]


@inlined
def copy_motion(target, source):
    """Copy overlaps, rates, forces, anchor and absorbed energy of one Motion into another."""
    copy_into(target.overlap, source.overlap)
    copy_into(target.rate, source.rate)
    copy_into(target.force, source.force)
    copy_into(target.anchor, source.anchor)
    copy_into(target.taken, source.taken)


@inlined
def row_of(rows, k, motion):
    """Row k of Samples as a Motion, with the modes of `motion`."""
    return Motion(rows.overlap[k], rows.rate[k], rows.anchor[k], rows.force[k], rows.taken[k], motion.mode, motion.held)


@inlined
def take_no_pull(motion):
    """An open contact does not push, whatever its mean force in the last step was."""
    for i in range(motion.force.size):
        if motion.overlap[i] < 0.0:
            motion.force[i] = min(motion.force[i], 0.0)
