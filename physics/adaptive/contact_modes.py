"""Modes of contacts and beads, with friction and loss, resolved at each switch: what is held, and what yields, eases or slips.

Three kinds of row are held by a bounded multiplier: a contact that touches (0 <= f <= F at d = 0), a contact with loss that
stands still ((1 - l) f(d) <= f <= f(d)), and a bead at rest on its bed (friction within -+ mu m g). Which of them give way is
one problem for all, see `yield_or_slip`.
"""

from __future__ import annotations

from softcradle.physics.adaptive.constants import ROUND_OFF
from softcradle.physics.adaptive.stick_slip_friction import (
    GIVE,
    LOAD,
    drive_overlaps,
    is_firm,
    load_beads,
    rest_exactly,
)
from softcradle.physics.adaptive.yield_or_slip import balance
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.law_curve import curve_force
from softcradle.physics.numerics.records import FROZEN, LOADED, OPEN, TOUCHING

# rows (n+1,) of the work array
LOW, HIGH, ACCELERATION, CARRIED = 7, 8, 9, 10  # after those of `stick_slip_friction`
CANDIDATE = 11  # 1 for contacts that may be held


@inlined
def loss_of(regime, i):
    """The part of its energy that contact i keeps."""
    return regime.loss[i] if regime.loss.size else 0.0


@inlined
def force_pressing(chain, regime, i, overlap):
    """The force of contact i as it is pressed in."""
    return curve_force(regime.law, chain.own, i, overlap)


@inlined
def multiplier_bounds(chain, regime, i, overlap):
    """(least, largest) force that contact i may carry while its overlap is held."""
    if overlap > 0.0:
        full = force_pressing(chain, regime, i, overlap)
        return (1.0 - loss_of(regime, i)) * full, full
    return 0.0, regime.law[i, 0]


@inlined
def classify(chain, regime, motion, slow, work):
    """Modes as far as overlaps and rates tell them, and bounds of the forces. Returns whether any row may be held."""
    overlap, rate, force, mode = motion.overlap, motion.rate, motion.force, motion.mode
    low, high, candidate = work[LOW], work[HIGH], work[CANDIDATE]
    undetermined = False
    for i in range(mode.size):
        candidate[i] = 0.0
        if motion.held[i] == 0:
            at_rest = overlap[i] == 0.0 and abs(rate[i]) <= slow
            stands = overlap[i] > 0.0 and rate[i] == 0.0 and loss_of(regime, i) > 0.0
            mode[i] = LOADED
            if overlap[i] < 0.0 or (overlap[i] == 0.0 and rate[i] < 0.0 and not at_rest):
                mode[i] = OPEN
            elif (at_rest and (regime.law[i, 0] > 0.0 or chain.external.size > 0)) or stands:
                mode[i], candidate[i], undetermined = TOUCHING, 1.0, True
            if regime.easing.size:
                eases = mode[i] == LOADED and loss_of(regime, i) > 0.0 and overlap[i] > 0.0 and rate[i] < 0.0
                regime.easing[i] = 1 if eases else 0
        if candidate[i] != 0.0:
            low[i], high[i] = multiplier_bounds(chain, regime, i, overlap[i])
            continue
        force[i] = 0.0
        if mode[i] == LOADED:
            force[i] = force_pressing(chain, regime, i, overlap[i])
            if regime.easing.size and regime.easing[i] != 0:
                force[i] *= 1.0 - loss_of(regime, i)
        low[i] = high[i] = force[i]
    return undetermined


@inlined
def settle_contact(i, regime, motion, work):
    """The mode of a contact that may be held, from the accelerations of its beads."""
    apart = work[ACCELERATION, i] - work[ACCELERATION, i + 1]
    low, high = work[LOW, i], work[HIGH, i]
    none = ROUND_OFF * (regime.inverse_mass[i] + regime.inverse_mass[i + 1]) * high
    motion.force[i] = work[CARRIED, i]
    if apart > none or (low == high and apart >= -none):
        motion.mode[i], motion.force[i] = LOADED, high
    elif apart < -none:
        motion.force[i] = low
        motion.mode[i] = LOADED if motion.overlap[i] > 0.0 else OPEN
        if motion.overlap[i] > 0.0:
            regime.easing[i] = 1
    else:
        motion.rate[i] = 0.0


@inlined
def make_effective(chain, regime, motion):
    """The chain that the next steps see."""
    n = motion.mode.size
    if regime.loss.size:
        for i in range(n):
            part = 1.0 - regime.loss[i] if regime.easing[i] != 0 else 1.0
            chain.law[i, 0], chain.law[i, 1] = part * regime.law[i, 0], part * regime.law[i, 1]
    if regime.bed.size:
        for j in range(n + 1):
            chain.inverse_mass[j] = 0.0 if is_firm(regime, j) else regime.inverse_mass[j]
        rest_exactly(chain, regime, motion)
    if regime.bed.size or chain.knots.bend.size:
        drive_overlaps(chain, regime)
    for i in range(n):
        held = motion.mode[i] == LOADED or motion.mode[i] == TOUCHING
        if held and motion.rate[i] == 0.0 and chain.inverse_mass[i] == 0.0 and chain.inverse_mass[i + 1] == 0.0:
            motion.mode[i] = FROZEN


@piece
def resolve_modes(chain, regime, motion, slow, scratch):
    """Modes, forces and the effective chain from overlaps, rates and slides; contacts at rest are slower than `slow` [m/s].

    A contact that an event has just switched keeps its mode (``motion.held`` nonzero).
    """
    work = scratch.work
    undetermined = classify(chain, regime, motion, slow, work)
    if load_beads(regime, work) or undetermined:
        n = motion.mode.size
        balance(
            regime.inverse_mass, work[LOAD], work[GIVE], work[LOW, :n], work[HIGH, :n], work[ACCELERATION],
            work[CARRIED, :n], scratch.bounds, scratch.knots,
        )  # fmt: skip
        for i in range(n):
            if work[CANDIDATE, i] != 0.0:
                settle_contact(i, regime, motion, work)
        for j in range(regime.slide.size):
            if work[GIVE, j] > 0.0:
                a = work[ACCELERATION, j]
                regime.slide[j] = 1 if a > 0.0 else (-1 if a < 0.0 else 0)
    make_effective(chain, regime, motion)
