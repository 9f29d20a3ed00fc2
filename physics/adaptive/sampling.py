"""Samples of the adaptive methods: inside a step, each a shorter step of the method, and in free flight."""

from __future__ import annotations

from softcradle.physics.adaptive.step import try_step
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.records import SAMPLE

SHRINK = 0.9  # of the time to a sample where a step to it does not converge; the rest is flown


@jit
def sample_inside(time, h, kind, chain, motion, precision, past_step, trial, scratch, samples, log):
    """Fill the rows of the samples within the step to come, each by a shorter step into `trial`.

    Where its stages do not converge, the step is made a little shorter and the rest drifts.
    """
    counter = log.counter
    while counter[SAMPLE] < samples.time.size and samples.time[counter[SAMPLE]] < time + h:
        k = counter[SAMPLE]
        wanted = samples.time[k] - time
        length = wanted
        while (
            try_step(length, kind, chain, motion, precision, past_step, trial, scratch, log) < 0.0
            and time + length > time
        ):
            length *= SHRINK
        for i in range(motion.mode.size):
            samples.overlap[k, i] = trial.overlap[2, i] + (wanted - length) * trial.rate[2, i]
            samples.rate[k, i], samples.force[k, i] = trial.rate[2, i], max(trial.force[2, i], 0.0)
        samples.anchor[k, 0] = trial.anchor[0] + (wanted - length) * trial.anchor[1]
        samples.anchor[k, 1] = trial.anchor[1]
        counter[SAMPLE] += 1


@jit
def flown(overlap, rate, time):
    """The overlap after `time` of free flight; a contact that is too slow to close stops at 0, however long the flight is."""
    return min(overlap + time * rate, max(overlap, 0.0)) if rate > 0.0 else overlap + time * rate


@jit
def sample_flight(time, until, motion, samples, log):
    """Fill the rows of samples from `time` to `until` while no contact pushes; at `time` itself also while one does."""
    counter = log.counter
    while counter[SAMPLE] < samples.time.size and samples.time[counter[SAMPLE]] <= until:
        k = counter[SAMPLE]
        beyond = samples.time[k] - time
        for i in range(motion.mode.size):
            samples.overlap[k, i] = flown(motion.overlap[i], motion.rate[i], beyond)
            samples.rate[k, i], samples.force[k, i] = motion.rate[i], max(motion.force[i], 0.0)
        samples.anchor[k, 0], samples.anchor[k, 1] = motion.anchor[0] + beyond * motion.anchor[1], motion.anchor[1]
        counter[SAMPLE] += 1
