"""The stages that Newton's iteration of `radau` begins from."""

from __future__ import annotations

from softcradle.physics.adaptive.constants import FOLLOW, MOST_GUESSED, ROUND_OFF, SUDDEN
from softcradle.physics.numerics.elementary import exp, log
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.knots import drive_at
from softcradle.physics.numerics.law_curve import (
    NODES,
    SMALLEST,
    cubic,
    curve_force,
    curve_overlap,
    pressed_force,
    put_on_curve,
)
from softcradle.physics.numerics.records import FROZEN, LOADED, OPEN, TOUCHING

NO_GUESS = -1.0  # in place of the length of the step before: nothing of it is used
AFTER, INSIDE = 1.0, 0.0  # where a step begins in the one whose cubics it is guessed by, as part of it


@inlined
def first_guess(h, chain, motion, past_step, origin, past, trial):
    """Put first stages into `trial`: the cubics of the step before, where there was one of like size, extrapolated.

    `past` (8, n): force at the start and stages of that step, then the overlaps; `origin` says whether the new one begins AFTER
    it or with it, INSIDE. Else soft contacts go on as a power of the time since an onset, d (1 + t/T)**(w T/d), or keep their
    force where `past_step` is NO_GUESS; others keep their rate.
    """
    law, own_laws, inverse_mass = chain.law, chain.own, chain.inverse_mass
    overlap, rate, force, mode = motion.overlap, motion.rate, motion.force, motion.mode
    stage_overlap, stage_force = trial.overlap, trial.force
    follows = past_step > 0.0 and h < FOLLOW * past_step
    since = time_since_onset(law, mode, overlap, rate, force)
    for i in range(overlap.size):
        preload, exponent = law[i, 0], law[i, 2]
        for k in range(3):
            flown = overlap[i] + h * NODES[k] * rate[i]
            x = origin + NODES[k] * h / past_step if follows else 0.0
            if mode[i] == OPEN:
                stage_overlap[k, i], stage_force[k, i] = flown, 0.0
            elif mode[i] == TOUCHING or mode[i] == FROZEN:
                stage_overlap[k, i], stage_force[k, i] = overlap[i], force[i]
                if follows and mode[i] == TOUCHING:
                    stage_force[k, i] = cubic(x, past[0, i], past[1, i], past[2, i], past[3, i])
            elif exponent < 1.0 and force[i] > preload:
                stage_overlap[k, i], stage_force[k, i] = overlap[i], force[i]
                weight = inverse_mass[i] + inverse_mass[i + 1]
                stiff = weight * exponent * (force[i] - preload)  # times d: it keeps its rate until d = 0 where small
                own = rate[i] < 0.0 and overlap[i] > SMALLEST and overlap[i] * stiff < 4.0 * rate[i] * rate[i]
                time = overlap[i] / rate[i] if own else since
                if (
                    past_step >= 0.0
                    and (not follows or (origin == AFTER and h > SUDDEN * abs(time)))
                    and overlap[i] > SMALLEST
                ):
                    growth = log(max(1.0 + h * NODES[k] / time, ROUND_OFF))
                    if own and flown <= 0.0 and preload == 0.0:
                        stage_overlap[k, i], stage_force[k, i] = flown, 0.0
                        continue
                    if not own:
                        growth *= rate[i] * time / overlap[i]
                    most = log(MOST_GUESSED) / exponent
                    growth = min(max(growth, -most), most)
                    stage_overlap[k, i] = overlap[i] * exp(growth)
                    stage_force[k, i] = preload + (force[i] - preload) * exp(exponent * growth)
                    put_on_curve(law, own_laws, i, k, stage_overlap, stage_force)
                elif follows:
                    excess = cubic(x, past[0, i], past[1, i], past[2, i], past[3, i]) - preload
                    if force[i] - preload < MOST_GUESSED * excess < MOST_GUESSED * MOST_GUESSED * (force[i] - preload):
                        stage_overlap[k, i] = curve_overlap(law, own_laws, i, excess, 1.0)
                        stage_force[k, i] = preload + excess
            elif overlap[i] == 0.0 and rate[i] == 0.0:
                stage_overlap[k, i], stage_force[k, i] = 0.0, preload
                if i > 0 and preload == 0.0:
                    set_pushed(h, chain, i, k, i, stage_force[k, i - 1], stage_overlap, stage_force)
            else:
                if follows:
                    flown = cubic(x, past[4, i], past[5, i], past[6, i], past[7, i])
                stage_overlap[k, i] = flown
                stage_force[k, i] = curve_force(law, own_laws, i, flown)
    for i in range(overlap.size - 2, -1, -1):
        for k in range(3):
            if mode[i] == LOADED and overlap[i] == 0.0 and rate[i] == 0.0 and stage_force[k, i] == 0.0:
                set_pushed(h, chain, i, k, i + 1, stage_force[k, i + 1], stage_overlap, stage_force)
                drive = drive_at(chain, i, h * NODES[k])
                if drive > 0.0 and law[i, 0] == 0.0:  # of two halves the lighter bead's mass
                    push = drive / (inverse_mass[i] + inverse_mass[i + 1])
                    set_pushed(h, chain, i, k, i + 1, push, stage_overlap, stage_force)


@piece
def time_since_onset(law, mode, overlap, rate, force):
    """Time since the overlap of the soft contact that pushes most was zero, had its rate been constant; negative until then."""
    largest, since = 0.0, 1e30
    for i in range(overlap.size):
        if mode[i] == LOADED and law[i, 2] < 1.0 and overlap[i] > 0.0 and force[i] > largest and rate[i] != 0.0:
            largest, since = force[i], overlap[i] / rate[i]
    return since


@piece
def set_pushed(h, chain, i, k, bead, push, stage_overlap, stage_force):
    """Guess for contact i at rest when its neighbour pushes `bead`: what the bead would fly, at most most of the push."""
    if push <= 0.0:
        return
    time = h * NODES[k]
    flown = 0.5 * (time * time) * chain.inverse_mass[bead] * push
    stage_force[k, i] = min(0.8 * push, pressed_force(chain.law, chain.own, i, flown))
    stage_overlap[k, i] = curve_overlap(chain.law, chain.own, i, stage_force[k, i], 1.0)
