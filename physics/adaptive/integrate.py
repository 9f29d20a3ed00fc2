"""The loop around `radau` and `dop853`: step sizes, contact switches, free flight, the end of a collision.

Steps grade themselves into the singular times of soft contacts (onset, loss) by factors of up to 8. A sample inside a
step is one shorter step of the method from the start of that step, so it has the step's own accuracy, forces included.
"""

from __future__ import annotations

import math

from softcradle.physics.adaptive.events import CLOSES, OPENS, YIELDS, continued, set_modes
from softcradle.physics.adaptive.fallback_step import rescue
from softcradle.physics.adaptive.sampling import flown, sample_flight, sample_inside
from softcradle.physics.adaptive.step import NEWTON_PART, REJECTED, SAMPLE, STEP, attempt, settle
from softcradle.physics.adaptive.step_control import LAST, NEXT, begin, first_step, learn, next_step, onset_step
from softcradle.physics.adaptive.switch_log import find_openings, note_switches
from softcradle.physics.fixed_step.step_loop import DONE, OUT_OF_STEPS, SEPARATED
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.law_curve import LOADED, OPEN, TOUCHING, flow_into

TOLERANCE_PART = 0.1  # of the tolerance: to this each step is held
SLOW_PART = 1e-2  # of a step's tolerance: a contact that arrives at d = 0 slower than this rests there
STILL_PART = 0.1  # of a step's tolerance: a gap that closes slower than this counts as not closing
RESCUE_PART = 0.25  # of a step at which Newton fails: so long the step of `conserving` in its place may be


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
def bring_to_rest(i, given, moving):
    """Give the two beads of contact i the velocity of their centre of mass: what takes its rate leaves momentum alone.

    Beside soft contacts, which are stiff where they are deep, they are not touched: only what lies between them moves.
    """
    for k in range(max(i - 1, 0), min(i + 2, moving.mode.size)):
        if given.law[k, 2] < 1.0 or moving.mode[k] == TOUCHING:
            moving.rate[i] = 0.0
            return
    weight = given.inverse_mass[i] + given.inverse_mass[i + 1]
    impulse = moving.rate[i] / weight if weight > 0.0 else 0.0
    if i > 0:
        moving.rate[i - 1] += impulse * given.inverse_mass[i]
    if i + 1 < moving.mode.size:
        moving.rate[i + 1] += impulse * given.inverse_mass[i + 1]
    if given.anchor_bead == i:
        moving.anchor[1] -= impulse * given.inverse_mass[i]
    elif given.anchor_bead == i + 1:
        moving.anchor[1] += impulse * given.inverse_mass[i + 1]
    moving.rate[i] = 0.0


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
                moving.overlap[i] = 0.0
                bring_to_rest(i, given, moving)
    return any_passed


@jit
def switch(landing, kind, time, given, moving, wanted, slow, trial, book):
    """Carry out the event of contact `landing`; the forces of all that touch are found anew."""
    if kind == CLOSES:
        begin(trial.pace, min(trial.pace[NEXT], onset_step(given, landing, moving.rate[landing], wanted)))
    if moving.mode[landing] != TOUCHING:
        moving.overlap[landing] = 0.0
    elif kind == YIELDS:
        moving.mode[landing], moving.held[landing] = LOADED, 1
    elif kind == OPENS:
        moving.mode[landing], moving.held[landing] = OPEN, 1
    set_all_modes(given, moving, slow, trial)
    note_switches(time, time, moving, trial.opening, book)


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
        moving.overlap[i] = flown(moving.overlap[i], moving.rate[i], until - time)
        moving.held[i] = 0
    moving.anchor[0] += (until - time) * moving.anchor[1]
    return until, closing


@jit
def fly_on(time, end, stop, given, moving, wanted, slow, negligible, trial, samples, book):
    """Let go of what pushes no more, fly, and begin the contact that closes. Returns as :func:`fly`."""
    for i in range(moving.mode.size):
        if moving.mode[i] == LOADED:
            moving.mode[i], moving.force[i] = OPEN, 0.0
    note_switches(time, time, moving, trial.opening, book)
    time, closing = fly(time, math.inf if stop else end, given, moving, negligible, samples, book)
    if closing >= 0 and time < end:
        moving.overlap[closing] = 0.0
        set_all_modes(given, moving, slow, trial)
        begin(trial.pace, onset_step(given, closing, moving.rate[closing], wanted))
    return time, closing


@jit
def recover(time, tried, given, moving, wanted, slow, trial, book):
    """A small step of `conserving` where Newton does not settle. Returns the time reached."""
    h = rescue(RESCUE_PART * tried, given, moving, wanted, trial, book)
    set_all_modes(given, moving, slow, trial)
    note_switches(time, time + h, moving, trial.opening, book)
    begin(trial.pace, 4.0 * h)
    return time + h


@jit
def integrate(start, end, stop, most_steps, scale, tolerance, given, moving, trial, samples, book):
    """Integrate from `start` to `end` (or, with `stop`, until no contact can close again); the state is moved in place.

    `scale` is the velocity [m/s] that `tolerance` is relative to. Returns the status and the time reached.
    """
    n = moving.mode.size
    wanted = TOLERANCE_PART * tolerance * scale
    slow, negligible = SLOW_PART * wanted, max(STILL_PART * wanted, 1e-15 * scale)
    time, past_step, first, pace = start, 0.0, math.inf, trial.pace
    for i in range(n):
        moving.held[i] = 0
    set_all_modes(given, moving, slow, trial)
    for i in range(n):
        if moving.mode[i] == LOADED and moving.overlap[i] == 0.0:
            first = min(first, onset_step(given, i, max(moving.rate[i], 0.0), wanted))
    begin(pace, first)
    note_switches(time, time, moving, trial.opening, book)
    while True:
        sample_flight(time, time, given, moving, samples, book)
        if time >= end:
            return DONE, end
        if book.counter[STEP] + book.counter[REJECTED] >= most_steps:
            return OUT_OF_STEPS, time
        if resting(given, moving, negligible):
            time, closing = fly_on(time, end, stop, given, moving, wanted, slow, negligible, trial, samples, book)
            if closing < 0 and stop:
                return SEPARATED, time
            if closing < 0 or time >= end:
                continue
            past_step = 0.0
        if not math.isfinite(pace[NEXT]):
            begin(pace, first_step(given, moving, scale))
        explicit, tried, near = next_step(pace, end - time, given, moving, wanted)
        h, error, landing, kind, refused = settle(
            time, tried, explicit, given, moving, wanted, past_step, trial, book, most_steps
        )
        if h == 0.0:
            if book.counter[STEP] + book.counter[REJECTED] >= most_steps:
                return OUT_OF_STEPS, time
            time, past_step = recover(time, tried, given, moving, wanted, slow, trial, book), 0.0
            continue
        learn(pace, h, explicit, error, near and h == tried, landing, refused, wanted)
        precision = NEWTON_PART * wanted
        lost = find_openings(h, explicit, given, moving, wanted, past_step, trial, book)
        if book.counter[SAMPLE] < samples.time.size and samples.time[book.counter[SAMPLE]] < time + h:
            sample_inside(time, h, explicit, given, moving, precision, past_step, trial, samples, book)
            lost = True
        if lost:
            attempt(h, explicit, given, moving, precision, past_step, trial, book)
        keep(explicit, moving, trial)
        before, time = time, time + h if h < end - time else end
        past_step = 0.0 if explicit else h
        book.counter[STEP] += 1
        if open_passed(landing, given, moving, slow):
            pace[LAST] = 0.0
        note_switches(before, time, moving, trial.opening, book)
        if landing >= 0:
            past_step = 0.0
            switch(landing, kind, time, given, moving, wanted, slow, trial, book)
