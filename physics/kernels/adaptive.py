"""The loop around `radau` and `dop853`: step sizes, events, samples, the end of a collision.

Steps grade themselves into the singular times of soft contacts (onset, loss) by factors of up to 8. A sample inside a
step is one shorter step of the method from the start of that step, so it has the step's own accuracy, forces included.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from physics.kernels.conserving import conserving_step
from physics.kernels.dop853 import dop853_step, window
from physics.kernels.jit import jit
from physics.kernels.march import DONE, OUT_OF_STEPS, SEPARATED
from physics.kernels.modes import CLOSES, NOTHING, OPENS, YIELDS, continued, find_event, miss_of, set_modes
from physics.kernels.radau import (
    LOADED,
    MOST_NEWTON,
    OPEN,
    TOUCHING,
    embedded_errors,
    first_guess,
    flow_into,
    move_anchor,
    slope_at,
    solve_stages,
    stage_rates,
)

Array = NDArray[np.float64]

RADAU, DOP853, ACCURATE = 0, 1, 2  # which step is taken: the last is dop853 where the contacts are not stiff

# entries of the counter array: evaluations of all contacts, rejected steps, steps, sample rows, switches, rescues
EVALUATION, REJECTED, STEP, SAMPLE, SWITCH, RESCUE = 0, 1, 2, 3, 4, 5
COUNTERS = 6

TOLERANCE_PART = 0.25  # of the tolerance: to this each step is held
RATIO = 3.0  # error taken of radau = fine error times this times fine over coarse
NEWTON_PART = 1e-2  # of a step's tolerance: to this the stages are solved
SLOW_PART = 1e-2  # of a step's tolerance: a contact that arrives at d = 0 slower than this rests there
STILL_PART = 1e-3  # of a step's tolerance: a gap that closes slower than this counts as not closing
GROW, SHRINK, SAFETY = 8.0, 0.1, 0.9
STIFF = 1.0  # (step times local frequency)², above which a soft contact is left to radau
LANDING_TRIES = 20
EARLY = 0.1  # part of a step: an event before it is sought again in a shorter one
LANDED = 1e-13  # of the step: an event is hit
MOST_FAILURES = 6  # of Newton, a step: then `conserving` takes it


class Given(NamedTuple):
    """What does not move: contact laws (n, 3), inverse masses (n+1,), forces from outside (n+1,) and accelerations of
    the overlaps and the anchor by them (n+1,) or both (0,), the anchor bead, the kind of step."""

    law: Array
    inverse_mass: Array
    push: Array
    external: Array
    anchor_bead: int
    kind: int


class Moving(NamedTuple):
    """What moves: overlaps, rates, forces (n,), anchor (2,), modes (n,), flags of modes held at an event (n,)."""

    overlap: Array
    rate: Array
    anchor: Array
    force: Array
    mode: NDArray[np.int8]
    held: NDArray[np.int8]


class Trial(NamedTuple):
    """A step tried: overlaps, rates, forces at its three output nodes (3, n), the anchor at its end (2,), scratch."""

    overlap: Array
    rate: Array
    force: Array
    anchor: Array
    along: Array  # (3, n)
    across: Array  # (3, n)
    z: Array  # (3, n)
    block: Array  # (n, 9)
    past: Array  # (8, n) forces and overlaps of the step before
    acceleration: Array  # (12, n)
    of_anchor: Array  # (12,)
    work: Array  # (16, n+1)


class Samples(NamedTuple):
    """Times (T,) at which samples are wanted, and their rows (T, n), the anchor's (T, 2)."""

    time: Array
    overlap: Array
    rate: Array
    anchor: Array
    force: Array


class Book(NamedTuple):
    """Contact switches: which (S,), when (S,); flags of the contacts that push (n,); counters."""

    contact: NDArray[np.int64]
    time: Array
    closed: NDArray[np.int8]
    counter: NDArray[np.int64]


@jit
def pushes(i, moving):
    """True where contact i is closed: it pushes."""
    return moving.mode[i] != OPEN and (moving.overlap[i] > 0.0 or moving.force[i] > 0.0)


@jit
def note_switches(before, time, moving, book):
    """Write into the book the contacts that have begun or ceased to push in the step from `before` to `time`.

    One that has begun does so at the start: steps end where contacts close. One that has opened did so when its overlap
    was last 0.
    """
    for i in range(moving.mode.size):
        now = pushes(i, moving)
        if now != (book.closed[i] != 0):
            book.closed[i] = 1 if now else 0
            k = book.counter[SWITCH]
            if k < book.contact.size:
                book.contact[k], book.time[k] = i, before if now else time
                if not now and moving.overlap[i] < 0.0 and moving.rate[i] < 0.0:
                    book.time[k] = max(before, time - moving.overlap[i] / moving.rate[i])
            book.counter[SWITCH] = k + 1


@jit
def onset_step(given, i, speed, wanted):
    """First step after contact i closes at `speed`: its impulse L K (v h)**a h / (1+a) is the error; inf if smooth."""
    exponent, stiffness = given.law[i, 2], given.law[i, 1]
    if exponent == 1.0 or stiffness == 0.0 or speed <= 0.0:
        return math.inf
    weight = (given.inverse_mass[i] + given.inverse_mass[i + 1]) * stiffness * speed**exponent
    return ((1.0 + exponent) * wanted / weight) ** (1.0 / (1.0 + exponent))


@jit
def first_step(given, moving, scale):
    """A step to begin with where no onset gives one: a hundredth of the fastest local period or crossing."""
    fastest = 0.0
    for i in range(moving.mode.size):
        weight = given.inverse_mass[i] + given.inverse_mass[i + 1]
        preload, stiffness, exponent = given.law[i, 0], given.law[i, 1], given.law[i, 2]
        if moving.mode[i] == LOADED and moving.overlap[i] > 0.0:
            slope = slope_at(preload, stiffness, exponent, moving.overlap[i], moving.force[i])
            fastest = max(fastest, math.sqrt(weight * slope))
        if moving.mode[i] != OPEN:
            push = max(moving.force[i], preload)
            fastest = max(fastest, weight * push / scale, 1e-3 * math.sqrt(weight * stiffness))
        if given.external.size:
            fastest = max(fastest, abs(given.external[i]) / scale)
    return 0.01 / fastest if fastest > 0.0 else 1.0


@jit
def opening_limit(h, given, moving, wanted):
    """The step that ends just before a soft contact opens, unless what it still pushes is below the error."""
    for i in range(moving.mode.size):
        overlap, rate = moving.overlap[i], moving.rate[i]
        if moving.mode[i] != LOADED or given.law[i, 2] >= 1.0 or overlap <= 0.0 or rate >= 0.0:
            continue
        left = -overlap / rate
        weight = given.inverse_mass[i] + given.inverse_mass[i + 1]
        slope = slope_at(given.law[i, 0], given.law[i, 1], given.law[i, 2], overlap, moving.force[i])
        if left < h and left * left * weight * slope < 4.0 and weight * moving.force[i] * left > 0.05 * wanted:
            h = 0.9 * left
    return h


@jit
def explicit_fits(h, given, moving):
    """True where dop853 takes the step: no soft contact is stiff in it."""
    if given.kind != ACCURATE:
        return given.kind == DOP853
    for i in range(moving.mode.size):
        if moving.mode[i] == LOADED and given.law[i, 2] < 1.0:
            if moving.overlap[i] <= 0.0:
                return False
            slope = slope_at(given.law[i, 0], given.law[i, 1], given.law[i, 2], moving.overlap[i], moving.force[i])
            if h * h * (given.inverse_mass[i] + given.inverse_mass[i + 1]) * slope > STIFF:
                return False
    return True


@jit
def attempt(h, explicit, given, moving, precision, past_step, trial, book):
    """Try one step; returns its error as a velocity [m/s], negative where Newton does not converge."""
    if explicit:
        first, last = window(moving.mode, moving.overlap, moving.rate, moving.force, given.external)
        book.counter[EVALUATION] += 15
        return dop853_step(
            h, given.law, given.inverse_mass, given.external, given.anchor_bead, moving.mode, moving.overlap, moving.rate,
            moving.anchor, trial.overlap, trial.rate, trial.force, first, last, trial.acceleration, trial.of_anchor,
            trial.z[0], trial.z[1], trial.z[2], trial.anchor,
        )  # fmt: skip
    first_guess(
        h, given.law, given.inverse_mass, given.external, moving.mode, moving.overlap, moving.rate, moving.force,
        past_step, trial.past, trial.overlap, trial.force,
    )  # fmt: skip
    used = solve_stages(
        h, given.law, given.inverse_mass, given.external, moving.mode, moving.overlap, moving.rate, precision,
        trial.overlap, trial.force, trial.along, trial.across, trial.block, trial.z,
    )  # fmt: skip
    book.counter[EVALUATION] += 3 * (used if used > 0 else MOST_NEWTON)
    if used == 0:
        return -1.0
    stage_rates(
        h, given.inverse_mass, given.external, moving.overlap, moving.rate, trial.overlap, trial.force, trial.rate
    )
    move_anchor(
        h, given.inverse_mass, given.external, given.anchor_bead, trial.force, moving.anchor, trial.anchor
    )  # fmt: skip
    fine, coarse = embedded_errors(
        h, given.law, given.inverse_mass, given.external, moving.mode, moving.overlap, moving.rate, moving.force,
        trial.overlap, trial.rate, trial.force, trial.work[0], trial.work[1], trial.work[2],
    )  # fmt: skip
    return fine * min(1.0, RATIO * fine / max(coarse, 1e-300))


@jit
def settle(time, h, explicit, given, moving, wanted, past_step, trial, book, most_steps):
    """Find the step that holds the error and ends at the first event in it, if any.

    Returns its length (0: Newton does not settle, or out of steps), error, and the contact and kind of the event.
    """
    landing, kind, tries, failures, ceiling = -1, NOTHING, 0, 0, h
    while book.counter[STEP] + book.counter[REJECTED] < most_steps:
        error = attempt(h, explicit, given, moving, NEWTON_PART * wanted, past_step, trial, book)
        if error < 0.0 or not math.isfinite(error):
            book.counter[REJECTED] += 1
            failures += 1
            landing, h = -1, 0.25 * h
            if failures > MOST_FAILURES or time + h <= time:
                return 0.0, 0.0, -1, NOTHING
            continue
        found, its_kind, part = find_event(
            given.law, moving.mode, landing, moving.overlap, moving.rate, moving.force, trial.overlap, trial.rate, trial.force
        )  # fmt: skip
        if landing >= 0:
            miss = miss_of(given.law, moving.mode, landing, kind, h, trial.overlap, trial.rate, trial.force)
            if tries < LANDING_TRIES and found >= 0 and part * h < h + min(miss, 0.0):
                landing, kind, h = found, its_kind, part * h
                tries += 1
                continue
            if tries < LANDING_TRIES and abs(miss) > LANDED * h and time + miss != time:
                h = min(max(h + miss, 0.1 * h), ceiling)
                tries += 1
                continue
        elif found >= 0 and tries < LANDING_TRIES:
            ceiling, tries = h, tries + 1
            if part < EARLY:  # seen through the cubic of a long step: look again from nearer
                h *= EARLY
            else:
                landing, kind, h = found, its_kind, part * h
            continue
        if error <= wanted or time + h <= time:
            return h, error, landing, kind
        book.counter[REJECTED] += 1
        h *= max(SHRINK, SAFETY * (wanted / error) ** (0.125 if explicit else 0.2))
        landing = -1
    return 0.0, 0.0, -1, NOTHING


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
def sample_flight(time, until, given, moving, samples, book):
    """Samples from `time` to `until` while nothing pushes; at `time` itself also while something does."""
    while book.counter[SAMPLE] < samples.time.size and samples.time[book.counter[SAMPLE]] <= until:
        k = book.counter[SAMPLE]
        beyond = samples.time[k] - time
        for i in range(moving.mode.size):
            samples.overlap[k, i] = moving.overlap[i] + beyond * moving.rate[i]
            samples.rate[k, i], samples.force[k, i] = moving.rate[i], max(moving.force[i], 0.0)
        samples.anchor[k, 0], samples.anchor[k, 1] = moving.anchor[0] + beyond * moving.anchor[1], moving.anchor[1]
        book.counter[SAMPLE] += 1


@jit
def resting(given, moving, negligible):
    """True where no contact pushes, or only with what gives less than `negligible` [m/s]."""
    for i in range(moving.mode.size):
        if moving.mode[i] == LOADED:
            weight = given.inverse_mass[i] + given.inverse_mass[i + 1]
            left = weight * max(moving.force[i], 0.0) * max(moving.overlap[i], 0.0)
            if left > negligible * negligible or moving.rate[i] > negligible:
                return False
        if moving.mode[i] == TOUCHING and moving.force[i] > 1e-11 * given.law[i, 0]:
            return False
    return given.external.size == 0


@jit
def set_all_modes(given, moving, slow, trial):
    """`set_modes` of the state as it stands."""
    set_modes(
        given.law, given.inverse_mass, given.external, slow, moving.mode, moving.overlap, moving.rate, moving.force,
        moving.held, trial.work,
    )  # fmt: skip


@jit
def keep(explicit, moving, trial):
    """Keep the trial: its end becomes the state, its stages the guess for the next step of radau."""
    past = trial.past
    if not explicit:
        for i in range(moving.mode.size):
            past[0, i], past[4, i] = moving.force[i], moving.overlap[i]
            for k in range(3):
                past[1 + k, i], past[5 + k, i] = trial.force[k, i], trial.overlap[k, i]
    for i in range(moving.mode.size):
        moving.overlap[i], moving.rate[i], moving.force[i] = trial.overlap[2, i], trial.rate[2, i], trial.force[2, i]
        moving.held[i] = 0
        if moving.mode[i] == TOUCHING:
            moving.rate[i] = 0.0
    moving.anchor[0], moving.anchor[1] = trial.anchor[0], trial.anchor[1]


@jit
def open_passed(landing, given, moving, slow):
    """Open the contacts that the step has carried past d = 0; returns True where there are any."""
    any_passed = False
    for i in range(moving.mode.size):
        if i == landing or (continued(given.law, i) and moving.mode[i] == LOADED):
            continue
        if moving.mode[i] == OPEN and moving.overlap[i] > 0.0:  # an event that could not be hit
            moving.mode[i] = LOADED
        elif moving.mode[i] == LOADED and moving.overlap[i] < 0.0:
            any_passed = True
            moving.force[i] = 0.0
            drive = given.external[i] if given.external.size else 0.0
            if abs(moving.rate[i]) > slow or flow_into(i, given.inverse_mass, moving.force) > drive:
                moving.mode[i] = OPEN
            else:  # pushed from both sides, or not at all, and slower than what counts: it stays
                moving.overlap[i], moving.rate[i] = 0.0, 0.0
    return any_passed


@jit
def switch(landing, kind, given, moving, slow, trial):
    """Carry out the event of contact `landing`; the forces of all that touch are found anew."""
    if moving.mode[landing] != TOUCHING:
        moving.overlap[landing] = 0.0
    elif kind == YIELDS:
        moving.mode[landing], moving.held[landing] = LOADED, 1
    elif kind == OPENS:
        moving.mode[landing], moving.held[landing] = OPEN, 1
    set_all_modes(given, moving, slow, trial)


@jit
def rescue(h, given, moving, slow, trial, book):
    """One small step of `conserving`, where Newton does not settle."""
    for i in range(moving.mode.size):
        moving.held[i] = 0
    used = conserving_step(
        h, given.law, given.inverse_mass, given.push, given.anchor_bead, moving.overlap, moving.rate, moving.anchor,
        moving.force, trial.work,
    )  # fmt: skip
    book.counter[EVALUATION] += abs(used)
    book.counter[STEP] += 1
    book.counter[RESCUE] += 1
    set_all_modes(given, moving, slow, trial)


@jit
def fly(time, end, given, moving, negligible, samples, book):
    """Free flight to the first closing or to `end`. Returns the time and the contact that closes (-1: none, ever)."""
    flight, closing = math.inf, -1
    for i in range(moving.mode.size):
        if moving.rate[i] > negligible and -moving.overlap[i] / moving.rate[i] < flight:
            flight, closing = max(-moving.overlap[i] / moving.rate[i], 0.0), i
    until = min(time + flight, end)
    if until == math.inf:
        return time, -1
    sample_flight(time, until, given, moving, samples, book)
    for i in range(moving.mode.size):
        moving.overlap[i] += (until - time) * moving.rate[i]
        moving.held[i] = 0
    moving.anchor[0] += (until - time) * moving.anchor[1]
    return until, closing


@jit
def integrate(start, end, stop, most_steps, scale, tolerance, given, moving, trial, samples, book):
    """Integrate from `start` to `end` (or, with `stop`, until no contact can close again); the state is moved in place.

    `scale` is the velocity [m/s] that `tolerance` is relative to. Returns the status and the time reached.
    """
    n = moving.mode.size
    wanted = TOLERANCE_PART * tolerance * scale
    slow, negligible = SLOW_PART * wanted, max(STILL_PART * wanted, 1e-15 * scale)
    time, h_next = start, math.inf
    last_step, last_error, past_step = 0.0, wanted, 0.0
    for i in range(n):
        moving.held[i] = 0
    set_all_modes(given, moving, slow, trial)
    for i in range(n):
        if moving.mode[i] == LOADED and moving.overlap[i] == 0.0:
            h_next = min(h_next, onset_step(given, i, max(moving.rate[i], 0.0), wanted))
    note_switches(time, time, moving, book)
    while True:
        sample_flight(time, time, given, moving, samples, book)
        if time >= end:
            return DONE, end
        if book.counter[STEP] + book.counter[REJECTED] >= most_steps:
            return OUT_OF_STEPS, time
        if resting(given, moving, negligible):
            time, closing = fly(time, math.inf if stop else end, given, moving, negligible, samples, book)
            if closing < 0 and stop:
                for i in range(n):
                    if moving.mode[i] == LOADED:
                        moving.mode[i], moving.force[i] = OPEN, 0.0
                note_switches(time, time, moving, book)
                return SEPARATED, time
            if closing < 0 or time >= end:
                continue
            moving.overlap[closing] = 0.0
            set_all_modes(given, moving, slow, trial)
            h_next, past_step, last_step = onset_step(given, closing, moving.rate[closing], wanted), 0.0, 0.0
        h = opening_limit(min(h_next, end - time), given, moving, wanted)
        if not math.isfinite(h):
            h = first_step(given, moving, scale)
        explicit = explicit_fits(h, given, moving)
        h, error, landing, kind = settle(time, h, explicit, given, moving, wanted, past_step, trial, book, most_steps)
        if h == 0.0:
            if book.counter[STEP] + book.counter[REJECTED] >= most_steps:
                return OUT_OF_STEPS, time
            h = min(end - time, max(1e-4 * min(h_next, scale), 4e-16 * abs(time), 1e-15))
            rescue(h, given, moving, slow, trial, book)
            before, time = time, time + h if h < end - time else end
            note_switches(before, time, moving, book)
            h_next, last_step, past_step = 4.0 * h, 0.0, 0.0
            continue
        power = 0.125 if explicit else 0.2
        grow = min(GROW, SAFETY * (wanted / max(error, 1e-300)) ** power)
        if h < last_step and landing < 0:  # steps that shrink go on shrinking (Gustafsson)
            grow = min(grow, SAFETY * (h / last_step) * (wanted * last_error / max(error * error, 1e-300)) ** power)
        last_step, last_error = (h, max(error, 1e-3 * wanted)) if landing < 0 else (0.0, wanted)
        h_next = max(h_next, h * grow) if landing >= 0 and math.isfinite(h_next) else h * grow
        if book.counter[SAMPLE] < samples.time.size and samples.time[book.counter[SAMPLE]] < time + h:
            precision = NEWTON_PART * wanted
            sample_inside(time, h, explicit, given, moving, precision, past_step, trial, samples, book)
            attempt(h, explicit, given, moving, precision, past_step, trial, book)
        keep(explicit, moving, trial)
        before, time = time, time + h if h < end - time else end
        past_step = 0.0 if explicit else h
        book.counter[STEP] += 1
        if open_passed(landing, given, moving, slow):
            last_step = 0.0
        note_switches(before, time, moving, book)
        if landing >= 0:
            past_step = 0.0
            if kind == CLOSES:
                h_next = min(h_next, onset_step(given, landing, moving.rate[landing], wanted))
            switch(landing, kind, given, moving, slow, trial)
            note_switches(time, time, moving, book)
