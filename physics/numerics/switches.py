"""Kernels that test and log switches of contacts between open and closed, and that copy a motion."""

from __future__ import annotations

from softcradle.physics.numerics.bead_velocities import at_rest
from softcradle.physics.numerics.jit import inlined
from softcradle.physics.numerics.records import SWITCH, Motion


@inlined
def is_closed(overlap, force):
    """Return True if a contact pushes (it overlaps, or touches and carries a force) or pulls, as only couplers do."""
    return overlap > 0.0 or (overlap == 0.0 and force > 0.0) or force < 0.0


@inlined
def log_switch(log, i, now, time):
    """Log that contact i closes (`now` true) or opens at `time` [s]. Switches are counted even if the log is full."""
    log.closed[i] = 1 if now else 0
    # the counter runs on if the log is full, so that the caller can provide a larger one
    k = log.counter[SWITCH]
    if k < log.contact.size:
        log.contact[k], log.time[k] = i, time
    log.counter[SWITCH] = k + 1


@inlined
def has_stopped(chain, motion, closed):
    """Return True if a sequence of steps has to end.

    This is so if a contact has left the state that its flag in `closed` (n,) gives, or if all beads of a chain with
    dissipation are at rest.
    """
    stopped = chain.dissipation.loss.size > 0 and at_rest(motion)
    for i in range(closed.size):
        stopped |= is_closed(motion.overlap[i], motion.force[i]) != (closed[i] != 0)
    return stopped


@inlined
def copy_into(target, source):
    """Copy an array (k,) element by element.

    For ``target[:] = source`` numba would allocate memory, because both slices might overlap.
    """
    for i in range(source.size):
        target[i] = source[i]


@inlined
def copy_motion(target, source):
    """Copy overlaps, rates, forces, anchor and energy balance from one Motion into another."""
    copy_into(target.overlap, source.overlap)
    copy_into(target.rate, source.rate)
    copy_into(target.force, source.force)
    copy_into(target.anchor, source.anchor)
    copy_into(target.taken, source.taken)


@inlined
def row_of(rows, k, motion):
    """Return row k of some Samples as a Motion, with the modes of `motion`."""
    return Motion(rows.overlap[k], rows.rate[k], rows.anchor[k], rows.force[k], rows.taken[k], motion.mode, motion.held)


@inlined
def take_no_pull(motion):
    """Set the force of each open contact to at most 0, because an open contact does not push.

    The mean force of a contact that opened during the last step can be positive.
    """
    for i in range(motion.force.size):
        if motion.overlap[i] < 0.0:
            motion.force[i] = min(motion.force[i], 0.0)
