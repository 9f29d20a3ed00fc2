"""The fallback: a step of the discrete gradient where the Newton iteration of `radau` does not converge."""

from __future__ import annotations

from softcradle.physics.adaptive.constants import ROUND_OFF, SHRINK
from softcradle.physics.fixed_step.discrete_gradient import gradient_step
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.records import EVALUATION, FALLBACK, STEP, Motion
from softcradle.physics.numerics.switches import copy_motion


@piece
def fallback_step(h, chain, motion, wanted, trial, scratch, log):
    """One step of the discrete gradient: as long as it and two of half its length agree to the error of a step, `h` at most.

    Returns its length.
    """
    spare, knots = scratch.anchor_acceleration, chain.knots
    whole = as_motion(trial.overlap, trial.anchor, spare[:4], motion)
    halves = as_motion(trial.rate, spare[4:6], spare[6:10], motion)
    least = ROUND_OFF * h
    while True:
        for j in range(knots.push_slope.size):
            chain.push[j] += 0.5 * h * knots.push_slope[j]  # its mean in the step
        copy_motion(whole, motion)
        copy_motion(halves, motion)
        for k in range(3):
            part, moved = (h, whole) if k == 0 else (0.5 * h, halves)
            log.counter[EVALUATION] += abs(gradient_step(part, chain, moved, scratch.work, scratch.work))
        for j in range(knots.push_slope.size):
            chain.push[j] -= 0.5 * h * knots.push_slope[j]
        agree = True  # where a rate is not a number, it is not the same as nothing
        for i in range(motion.mode.size):
            agree &= abs(whole.rate[i] - halves.rate[i]) <= wanted
        if agree or not h > least:
            break
        h *= SHRINK
    copy_motion(motion, halves)
    for i in range(motion.mode.size):
        motion.held[i] = 0
        scratch.opening[i] = -1.0
    log.counter[STEP] += 1
    log.counter[FALLBACK] += 1
    return h


@inlined
def as_motion(rows, anchor, taken, motion):
    """A Motion whose overlaps, rates and forces are `rows` (3, n)."""
    return Motion(rows[0], rows[1], anchor, rows[2], taken, motion.mode, motion.held)
