"""Samples of the adaptive methods: inside a step, each a shorter step of the method, and in free flight."""

from __future__ import annotations

from softcradle.physics.adaptive.step import SAMPLE, attempt
from softcradle.physics.numerics.jit import jit


@jit
def sample_inside(time, h, explicit, given, moving, precision, past_step, trial, samples, book):
    """Samples within the step to come, each a shorter step; the trial of the whole step is lost.

    Where Newton does not settle on a sample, it is looked for a little earlier and drifts the rest.
    """
    while book.counter[SAMPLE] < samples.time.size and samples.time[book.counter[SAMPLE]] < time + h:
        k = book.counter[SAMPLE]
        wished = samples.time[k] - time
        length = wished
        while (
            attempt(length, explicit, given, moving, precision, past_step, trial, book) < 0.0 and time + length > time
        ):
            length *= 0.9
        for i in range(moving.mode.size):
            samples.overlap[k, i] = trial.overlap[2, i] + (wished - length) * trial.rate[2, i]
            samples.rate[k, i], samples.force[k, i] = trial.rate[2, i], max(trial.force[2, i], 0.0)
        samples.anchor[k, 0] = trial.anchor[0] + (wished - length) * trial.anchor[1]
        samples.anchor[k, 1] = trial.anchor[1]
        book.counter[SAMPLE] += 1


@jit
def flown(overlap, rate, time):
    """The overlap after `time` of free flight; contacts that come too slowly to close do not, however long it lasts."""
    return min(overlap + time * rate, max(overlap, 0.0)) if rate > 0.0 else overlap + time * rate


@jit
def sample_flight(time, until, given, moving, samples, book):
    """Samples from `time` to `until` while nothing pushes; at `time` itself also while something does."""
    while book.counter[SAMPLE] < samples.time.size and samples.time[book.counter[SAMPLE]] <= until:
        k = book.counter[SAMPLE]
        beyond = samples.time[k] - time
        for i in range(moving.mode.size):
            samples.overlap[k, i] = flown(moving.overlap[i], moving.rate[i], beyond)
            samples.rate[k, i], samples.force[k, i] = moving.rate[i], max(moving.force[i], 0.0)
        samples.anchor[k, 0], samples.anchor[k, 1] = moving.anchor[0] + beyond * moving.anchor[1], moving.anchor[1]
        book.counter[SAMPLE] += 1
