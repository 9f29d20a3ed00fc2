"""A step of `conserving` where the Newton iteration of `radau` does not settle."""

from __future__ import annotations

from softcradle.physics.adaptive.step import EVALUATION, RESCUE, STEP
from softcradle.physics.fixed_step.discrete_gradient import conserving_step
from softcradle.physics.numerics.jit import jit

RESCUE_TRIES = 30


@jit
def rescue(h, given, moving, wanted, trial, book):
    """One step of `conserving`: as long as it and two of half its length agree to the error of a step, `h` at most.

    Returns its length.
    """
    whole, halves = trial.overlap, trial.rate  # overlaps, rates, forces (3, n) of either
    anchor, anchors = trial.anchor, trial.of_anchor[:2]
    for _ in range(RESCUE_TRIES):
        copy_state(moving, whole, anchor)
        copy_state(moving, halves, anchors)
        book.counter[EVALUATION] += conserve(h, given, whole, anchor, trial.work)
        for _ in range(2):
            book.counter[EVALUATION] += conserve(0.5 * h, given, halves, anchors, trial.work)
        agree = True  # no number agrees with nothing
        for i in range(moving.mode.size):
            agree &= abs(whole[1, i] - halves[1, i]) <= wanted
        if agree:
            break
        h *= 0.25
    for i in range(moving.mode.size):
        moving.overlap[i], moving.rate[i], moving.force[i], moving.held[i] = halves[0, i], halves[1, i], halves[2, i], 0
        trial.opening[i] = -1.0
    moving.anchor[0], moving.anchor[1] = anchors[0], anchors[1]
    book.counter[STEP] += 1
    book.counter[RESCUE] += 1
    return h


@jit
def conserve(h, given, row, anchor, work):
    """`conserving_step` of overlaps, rates and forces in `row` (3, n). Returns the iterations used."""
    used = conserving_step(
        h, given.law, given.inverse_mass, given.push, given.anchor_bead, row[0], row[1], anchor, row[2], work
    )  # fmt: skip
    return abs(used)


@jit
def copy_state(moving, row, anchor):
    """Overlaps, rates and forces into `row` (3, n), the anchor into `anchor` (2,)."""
    for i in range(moving.mode.size):
        row[0, i], row[1, i], row[2, i] = moving.overlap[i], moving.rate[i], moving.force[i]
    anchor[0], anchor[1] = moving.anchor[0], moving.anchor[1]
