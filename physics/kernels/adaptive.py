"""The loop around `radau`: step sizes, events, samples, the end of a collision.

Steps grade themselves into the singular times of soft contacts (onset, loss) by factors of up to 8. A sample inside a
step is one shorter step of the method from the start of that step, so it has the step's own accuracy, forces included.
"""

from __future__ import annotations

import math

from physics.kernels.conserving import conserving_step
from physics.kernels.jit import jit
from physics.kernels.march import DONE, FAILED, OUT_OF_STEPS, SEPARATED
from physics.kernels.modes import CLOSES, NOTHING, OPENS, YIELDS, continued, find_event, miss_of, set_modes
from physics.kernels.radau import (
    LOADED,
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

# entries of the counter array: evaluations of all contacts, rejected steps, steps, sample rows, switches, events, rescues
EVALUATION, REJECTED, STEP, SAMPLE, SWITCH, EVENT, RESCUE = 0, 1, 2, 3, 4, 5, 6
COUNTERS = 7

GROW, SHRINK, SAFETY = 8.0, 0.1, 0.9
TOLERANCE_PART = 0.25  # of the tolerance: to this each step is held
RATIO = 3.0  # error taken = fine error times this times fine over coarse
NEWTON_PART = 1e-2  # of the tolerance: to this the stages are solved
SLOW_PART = 1e-2  # of the tolerance: a contact with preload that arrives at d = 0 slower than this rests there
LANDING_TRIES = 12
MOST_FAILURES = 6  # of Newton, a step: then `conserving` takes it
LANDED = 1e-13  # of the step: an event is hit


@jit
def onset_step(law, inverse_mass, i, speed, tolerance):
    """First step after contact i closes at `speed`: its impulse L K (v h)**a h / (1+a) is the tolerance; inf if smooth."""
    exponent = law[i, 2]
    if exponent == 1.0 or law[i, 1] == 0.0 or speed <= 0.0:
        return math.inf
    weight = (inverse_mass[i] + inverse_mass[i + 1]) * law[i, 1] * speed**exponent
    return ((1.0 + exponent) * tolerance / weight) ** (1.0 / (1.0 + exponent))


@jit
def opening_limit(h, law, inverse_mass, mode, overlap, rate, force, tolerance):
    """The step that ends just before a soft contact opens, unless what it still pushes is below the tolerance."""
    for i in range(mode.size):
        if mode[i] != LOADED or law[i, 2] >= 1.0 or overlap[i] <= 0.0 or rate[i] >= 0.0:
            continue
        left = -overlap[i] / rate[i]
        weight = inverse_mass[i] + inverse_mass[i + 1]
        stiff = left * left * weight * slope_at(law[i, 0], law[i, 1], law[i, 2], overlap[i], force[i])
        if left < h and stiff < 4.0 and weight * force[i] * left > 0.05 * tolerance:
            h = 0.9 * left
    return h


@jit
def book(contact, time, switch_contact, switch_time, counter):
    """Write one contact switch into the book."""
    k = counter[SWITCH]
    if k < switch_contact.size:
        switch_contact[k], switch_time[k] = contact, time
    counter[SWITCH] = k + 1


@jit
def try_step(
    h, law, inverse_mass, external, mode, overlap, rate, force, precision, past_step, past,
    stage_overlap, stage_rate, stage_force, along, across, block, z, counter,
):  # fmt: skip
    """Solve the stages of one step; False where Newton does not converge."""
    first_guess(h, law, inverse_mass, mode, overlap, rate, force, past_step, past, stage_overlap, stage_force)
    used = solve_stages(
        h, law, inverse_mass, external, mode, overlap, rate, precision, stage_overlap, stage_force, along, across, block, z
    )  # fmt: skip
    counter[EVALUATION] += 3 * (used if used > 0 else 15)
    if used == 0:
        return False
    stage_rates(h, inverse_mass, external, overlap, rate, stage_overlap, stage_force, stage_rate)
    return True


@jit
def resting(law, mode, overlap, rate, force, negligible):
    """True where no contact pushes."""
    for i in range(mode.size):
        if mode[i] == LOADED and (overlap[i] > 0.0 or rate[i] > negligible):
            return False
        if mode[i] == TOUCHING and force[i] > 1e-11 * law[i, 0]:
            return False
    return True


@jit
def integrate(
    start, end, stop, most_steps, scale, tolerance, law, inverse_mass, push, external, anchor_bead,
    overlap, rate, anchor, force, mode, held, switch_contact, switch_time,
    sample_time, sample_overlap, sample_rate, sample_anchor, sample_force,
    stage_overlap, stage_rate, stage_force, along, across, z, block, past, work, counter,
):  # fmt: skip
    """Integrate from `start` to `end` (or, with `stop`, until no contact can close again); the state is moved in place.

    `scale` is the velocity [m/s] that `tolerance` is relative to; `external` (n+1,) accelerations e_i of the overlaps
    and of the anchor, or (0,). Returns the status and the time reached.
    """
    n = overlap.size
    wanted = TOLERANCE_PART * tolerance * scale
    precision, slow, negligible = NEWTON_PART * wanted, SLOW_PART * wanted, 1e-15 * scale
    time = start
    last_step, last_error, past_step = 0.0, wanted, 0.0
    set_modes(law, inverse_mass, external, slow, mode, overlap, rate, force, held, work)
    h_next = math.inf
    for i in range(n):
        if mode[i] != OPEN:
            book(i, time, switch_contact, switch_time, counter)
            if mode[i] == LOADED and overlap[i] == 0.0:
                h_next = min(h_next, onset_step(law, inverse_mass, i, max(rate[i], 0.0), wanted))
    while True:
        while counter[SAMPLE] < sample_time.size and sample_time[counter[SAMPLE]] <= time:
            k = counter[SAMPLE]
            for i in range(n):
                sample_overlap[k, i], sample_rate[k, i], sample_force[k, i] = overlap[i], rate[i], max(force[i], 0.0)
            sample_anchor[k, 0], sample_anchor[k, 1] = anchor[0], anchor[1]
            counter[SAMPLE] += 1
        if time >= end:
            return DONE, end
        if counter[STEP] + counter[REJECTED] >= most_steps:
            return OUT_OF_STEPS, time
        if external.size == 0 and resting(law, mode, overlap, rate, force, negligible):
            flight, closing = math.inf, -1
            for i in range(n):
                if rate[i] > negligible and -overlap[i] / rate[i] < flight:
                    flight, closing = -overlap[i] / rate[i], i
            if stop and closing < 0:
                return SEPARATED, time
            until = min(time + flight, end)
            while counter[SAMPLE] < sample_time.size and sample_time[counter[SAMPLE]] <= until:
                k = counter[SAMPLE]
                beyond = sample_time[k] - time
                for i in range(n):
                    sample_overlap[k, i], sample_rate[k, i] = overlap[i] + beyond * rate[i], rate[i]
                    sample_force[k, i] = 0.0
                sample_anchor[k, 0], sample_anchor[k, 1] = anchor[0] + beyond * anchor[1], anchor[1]
                counter[SAMPLE] += 1
            for i in range(n):
                overlap[i] += (until - time) * rate[i]
                held[i] = 0
            anchor[0] += (until - time) * anchor[1]
            time = until
            if closing >= 0 and until < end:
                overlap[closing] = 0.0
                book(closing, time, switch_contact, switch_time, counter)
                set_modes(law, inverse_mass, external, slow, mode, overlap, rate, force, held, work)
                h_next = onset_step(law, inverse_mass, closing, rate[closing], wanted)
                counter[EVENT] += 1
            if time >= end:
                continue
        h = opening_limit(min(h_next, end - time), law, inverse_mass, mode, overlap, rate, force, wanted)
        if not math.isfinite(h):
            h = first_step(law, inverse_mass, external, mode, overlap, rate, force, scale)
        landing, kind, tries, error, ceiling = -1, NOTHING, 0, 0.0, h
        failures = 0
        while True:
            if counter[STEP] + counter[REJECTED] >= most_steps:
                return OUT_OF_STEPS, time
            if not try_step(
                h, law, inverse_mass, external, mode, overlap, rate, force, precision, past_step, past,
                stage_overlap, stage_rate, stage_force, along, across, block, z, counter,
            ):  # fmt: skip
                counter[REJECTED] += 1
                landing, h = -1, 0.25 * h
                failures += 1
                if failures > MOST_FAILURES or time + h <= time:
                    break
                continue
            found, its_kind, part = find_event(law, mode, landing, overlap, force, stage_overlap, stage_force, 1.0)
            if landing >= 0:
                miss = miss_of(law, mode, landing, kind, h, overlap, force, stage_overlap, stage_rate, stage_force)
                if found >= 0 and part * h < h + min(miss, 0.0) and tries < LANDING_TRIES:
                    landing, kind, h = found, its_kind, part * h
                    tries += 1
                    continue
                if abs(miss) > LANDED * h and tries < LANDING_TRIES and time + miss != time:
                    h = min(max(h + miss, 0.1 * h), ceiling)
                    tries += 1
                    continue
            elif found >= 0 and tries < LANDING_TRIES:
                landing, kind, ceiling = found, its_kind, h
                h = max(part * h, 1e-15 * (abs(time) + h))
                continue
            fine, coarse = embedded_errors(
                h, law, inverse_mass, external, mode, overlap, rate, force, stage_overlap, stage_rate, stage_force,
                work[0], work[1], work[6],
            )  # fmt: skip
            error = fine * min(1.0, RATIO * fine / max(coarse, 1e-300))
            if error > wanted and time + h > time:
                counter[REJECTED] += 1
                h *= max(SHRINK, SAFETY * (wanted / error) ** 0.2)
                landing = -1
                continue
            break
        if failures > MOST_FAILURES or time + h <= time:  # Newton does not settle: one small step of `conserving`
            h = min(max(h, 1e-15 * abs(time)), end - time)
            counter[EVALUATION] += abs(
                conserving_step(h, law, inverse_mass, push, anchor_bead, overlap, rate, anchor, force, work)
            )
            counter[STEP] += 1
            counter[RESCUE] += 1
            time = time + h if h < end - time else end
            for i in range(n):
                held[i] = 0
                z[0, i] = mode[i]
            set_modes(law, inverse_mass, external, slow, mode, overlap, rate, force, held, work)
            for i in range(n):
                if (z[0, i] != OPEN) != (mode[i] != OPEN):
                    book(i, time, switch_contact, switch_time, counter)
            h_next, last_step, past_step = 4.0 * h, 0.0, 0.0
            continue
        grow = min(GROW, SAFETY * (wanted / max(error, 1e-300)) ** 0.2)
        if h < last_step and landing < 0:  # steps that shrink go on shrinking (Gustafsson)
            grow = min(grow, SAFETY * (h / last_step) * (wanted * last_error / max(error * error, 1e-300)) ** 0.2)
        last_step, last_error = (h, max(error, 1e-3 * wanted)) if landing < 0 else (0.0, wanted)
        h_next = max(h_next, h * grow) if landing >= 0 and math.isfinite(h_next) else h * grow
        # samples need the stages, so what the step found is kept first
        for i in range(n):
            work[2, i], work[3, i], work[4, i] = stage_overlap[2, i], stage_rate[2, i], stage_force[2, i]
            past[8, i] = force[i]
            for k in range(3):
                past[9 + k, i], past[13 + k, i] = stage_force[k, i], stage_overlap[k, i]
            past[12, i] = overlap[i]
        move_anchor(h, inverse_mass, external, anchor_bead, stage_force, anchor, work[5])
        while counter[SAMPLE] < sample_time.size and sample_time[counter[SAMPLE]] < time + h:
            k = counter[SAMPLE]
            beyond = sample_time[k] - time
            if not try_step(
                beyond, law, inverse_mass, external, mode, overlap, rate, force, precision, past_step, past,
                stage_overlap, stage_rate, stage_force, along, across, block, z, counter,
            ):  # fmt: skip
                return FAILED, time
            for i in range(n):
                sample_overlap[k, i], sample_rate[k, i] = stage_overlap[2, i], stage_rate[2, i]
                sample_force[k, i] = max(stage_force[2, i], 0.0)
            move_anchor(beyond, inverse_mass, external, anchor_bead, stage_force, anchor, sample_anchor[k])
            counter[SAMPLE] += 1
        time = time + h if h < end - time else end
        counter[STEP] += 1
        for i in range(n):
            overlap[i], rate[i], force[i] = work[2, i], work[3, i], work[4, i]
            held[i] = 0
            for k in range(8):
                past[k, i] = past[8 + k, i]
        for i in range(n):
            if mode[i] == TOUCHING:
                rate[i] = 0.0
            elif mode[i] == OPEN and overlap[i] > 0.0 and i != landing:  # an event that could not be hit
                mode[i] = LOADED
                book(i, time, switch_contact, switch_time, counter)
            elif mode[i] == LOADED and overlap[i] < 0.0 and i != landing and not continued(law, i):
                last_step, force[i] = 0.0, 0.0
                if abs(rate[i]) > slow or flow_into(i, inverse_mass, force) > (external[i] if external.size else 0.0):
                    mode[i] = OPEN
                    back = overlap[i] / rate[i] if rate[i] < 0.0 else 0.0
                    book(i, time - min(back, h), switch_contact, switch_time, counter)
                else:  # pushed from both sides, or not at all, and slower than what counts: it stays
                    overlap[i], rate[i] = 0.0, 0.0
        past_step = h
        anchor[0], anchor[1] = work[5, 0], work[5, 1]
        if landing >= 0:
            past_step = 0.0
            counter[EVENT] += 1
            i = landing
            if mode[i] != TOUCHING:
                overlap[i] = 0.0
            if kind == YIELDS:
                mode[i], held[i] = LOADED, 1
            elif kind == OPENS and mode[i] == TOUCHING:
                mode[i], held[i] = OPEN, 1
            if kind == CLOSES:
                h_next = min(h_next, onset_step(law, inverse_mass, i, rate[i], wanted))
            for j in range(n):
                z[0, j] = mode[j]
            set_modes(law, inverse_mass, external, slow, mode, overlap, rate, force, held, work)
            for j in range(n):
                before = z[0, j] != OPEN
                if j == landing:
                    before = kind != CLOSES
                if before != (mode[j] != OPEN):
                    book(j, time, switch_contact, switch_time, counter)


@jit
def first_step(law, inverse_mass, external, mode, overlap, rate, force, scale):
    """A step to begin with where no onset gives one: a hundredth of the fastest local period or crossing."""
    fastest = 0.0
    for i in range(mode.size):
        weight = inverse_mass[i] + inverse_mass[i + 1]
        if mode[i] == LOADED and overlap[i] > 0.0:
            fastest = max(fastest, math.sqrt(weight * slope_at(law[i, 0], law[i, 1], law[i, 2], overlap[i], force[i])))
        if mode[i] != OPEN:
            fastest = max(fastest, weight * max(force[i], law[i, 0]) / scale, math.sqrt(weight * law[i, 1]) * 1e-3)
        if external.size:
            fastest = max(fastest, abs(external[i]) / scale)
    return 0.01 / fastest if fastest > 0.0 else 1.0
