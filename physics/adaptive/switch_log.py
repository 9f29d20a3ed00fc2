"""The book of contact switches of the adaptive methods, and when within a step contacts open without an event.

Contacts with preload and linear ones open by an event that ends a step; others, whose force vanishes smoothly or with the
smallest of overlaps, are passed over and looked up afterwards.
"""

from __future__ import annotations

from softcradle.physics.adaptive.dop853 import hermite
from softcradle.physics.adaptive.events import continued
from softcradle.physics.adaptive.step import NEWTON_PART, SWITCH, attempt
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.law_curve import LOADED, OPEN, cubic, flow_into

BISECTIONS = 50
QUINTIC_GAIN = 100.0  # times finer than the cubic through the stages is the quintic of both ends, at the least
OPENING_PART, OPENING_TRIES = 0.1, 4  # of a step's tolerance times its length: to this overlap an opening is located


@jit
def note_switches(before, time, moving, opening, book):
    """Write into the book the contacts that have begun or ceased to push in the step from `before` to `time`.

    One that has begun does so at the start: steps end where contacts close. One that has opened did so at `opening` (n,)
    after the start, or at the end where that is negative.
    """
    mode, overlap, force, closed = moving.mode, moving.overlap, moving.force, book.closed
    for i in range(mode.size):
        now = mode[i] != OPEN and (overlap[i] > 0.0 or force[i] > 0.0)  # closed means pushing
        if now != (closed[i] != 0):
            closed[i] = 1 if now else 0
            k = book.counter[SWITCH]
            if k < book.contact.size:
                book.contact[k], book.time[k] = i, before if now else time
                if not now and time > before and opening[i] >= 0.0:
                    book.time[k] = before + opening[i]
            book.counter[SWITCH] = k + 1


@jit
def find_openings(h, explicit, given, moving, wanted, past_step, trial, book):
    """When within the step contacts open without an event, into `trial.opening`: by the quintic of both ends, then, where
    the stages tell that it may be off, by shorter steps of the method. Returns True where such were taken: the trial of
    the whole step is then lost."""
    doubtful, allowed = False, OPENING_PART * wanted * h
    mode, overlap, end, opening, law = moving.mode, moving.overlap, trial.overlap, trial.opening, given.law
    for i in range(mode.size):
        opening[i] = -1.0
        if mode[i] == LOADED and overlap[i] > 0.0 > end[2, i] and not continued(law, i):
            opening[i], by_stages = opening_of_quintic(i, h, given, moving, trial)
            doubtful |= abs(by_stages) > QUINTIC_GAIN * allowed
    if doubtful:
        for i in range(moving.mode.size):
            if trial.opening[i] >= 0.0:
                locate_opening(i, h, allowed, explicit, given, moving, NEWTON_PART * wanted, past_step, trial, book)
    return doubtful


@jit
def opening_of_quintic(i, h, given, moving, trial):
    """When contact i opens by the quintic through overlaps, rates and accelerations of both ends of the step, and the
    overlap that the cubic through the stages has then."""
    drive = given.external[i] if given.external.size else 0.0
    d0, w0, d1, w1 = moving.overlap[i], moving.rate[i], trial.overlap[2, i], trial.rate[2, i]
    a0 = drive - flow_into(i, given.inverse_mass, moving.force)
    a1 = drive - flow_into(i, given.inverse_mass, trial.force[2])
    low, high = 0.0, 1.0
    for _ in range(BISECTIONS):
        x = 0.5 * (low + high)
        if hermite(x, h, d0, w0, a0, d1, w1, a1) > 0.0:
            low = x
        else:
            high = x
    return low * h, cubic(low, d0, trial.overlap[0, i], trial.overlap[1, i], d1)


@jit
def locate_opening(i, h, allowed, explicit, given, moving, precision, past_step, trial, book):
    """Newton on the time at which contact i opens, with a step of the method for its overlap there."""
    for _ in range(OPENING_TRIES):
        part = trial.opening[i]
        if part <= 0.0 or attempt(part, explicit, given, moving, precision, past_step, trial, book) < 0.0:
            return
        miss, speed = trial.overlap[2, i], trial.rate[2, i]
        if speed >= 0.0:
            return
        trial.opening[i] = min(max(part - miss / speed, 0.5 * part), h)
        if abs(miss) <= allowed:
            return
