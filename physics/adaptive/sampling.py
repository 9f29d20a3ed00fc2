"""Samples inside a step of the adaptive methods, each a shorter step of the method, and what is absorbed on the way."""

from __future__ import annotations

from softcradle.physics.adaptive.step import try_step
from softcradle.physics.numerics.contact_law import energy
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.records import SAMPLE

SHRINK = 0.9  # of the time to a sample where a step to it does not converge; the rest is flown


@jit
def absorbed_between(chain, regime, before, moved, end, path):
    """Energy [J] that (contacts, the bed) absorb while overlaps go from `before` to `end` (n,), and the anchor bead by `path`.

    `moved` (n+1,) is scratch memory. Modes are those of now, so what they absorb is a difference of potentials.
    """
    by_contacts, by_bed = 0.0, 0.0
    for i in range(regime.easing.size):
        if regime.easing[i] != 0:
            preload, stiffness, exponent = regime.law[i, 0], regime.law[i, 1], regime.law[i, 2]
            fall = energy(preload, stiffness, exponent, before[i]) - energy(preload, stiffness, exponent, end[i])
            by_contacts += regime.loss[i] * fall
    if regime.bed.size:
        moved[chain.anchor_bead] = path
        for j in range(chain.anchor_bead - 1, -1, -1):
            moved[j] = moved[j + 1] + (end[j] - before[j])
        for j in range(chain.anchor_bead, before.size):
            moved[j + 1] = moved[j] - (end[j] - before[j])
        for j in range(moved.size):
            if regime.bed[j] > 0.0:
                by_bed += regime.slide[j] * regime.bed[j] / regime.inverse_mass[j] * moved[j]
    return by_contacts, by_bed


@jit
def sample_inside(time, h, kind, chain, regime, motion, precision, past_step, trial, scratch, samples, log):
    """Fill the rows of the samples within the step to come, each by a shorter step into `trial`.

    Where its stages do not converge, the step is made a little shorter and the rest drifts.
    """
    counter = log.counter
    firm = regime.bed.size > 0
    while counter[SAMPLE] < samples.time.size and samples.time[counter[SAMPLE]] < time + h:
        k = counter[SAMPLE]
        wanted = samples.time[k] - time
        length = wanted
        while (
            try_step(length, kind, firm, chain, motion, precision, past_step, trial, scratch, log) < 0.0
            and time + length > time
        ):
            length *= SHRINK
        for i in range(motion.mode.size):
            samples.overlap[k, i] = trial.overlap[2, i] + (wanted - length) * trial.rate[2, i]
            samples.rate[k, i], samples.force[k, i] = trial.rate[2, i], max(trial.force[2, i], 0.0)
        samples.anchor[k, 0] = trial.anchor[0] + (wanted - length) * trial.anchor[1]
        samples.anchor[k, 1] = trial.anchor[1]
        path = samples.anchor[k, 0] - motion.anchor[0]
        absorbed = absorbed_between(chain, regime, motion.overlap, scratch.work[0], samples.overlap[k], path)
        samples.absorbed[k, 0] = motion.absorbed[0] + absorbed[0]
        samples.absorbed[k, 1] = motion.absorbed[1] + absorbed[1]
        counter[SAMPLE] += 1
