"""One step tried, and the search for one that holds the error and ends at an event."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.adaptive.dop853 import KINK, dop853_step
from softcradle.physics.adaptive.events import (
    NOTHING,
    OPENS,
    continued,
    find_event,
    first_crossing,
    miss_of,
    passing_yield,
)
from softcradle.physics.adaptive.radau import MOST_NEWTON, first_guess, solve_stages
from softcradle.physics.adaptive.radau_error import embedded_error, move_anchor, stage_rates
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.law_curve import LOADED, OPEN, TOUCHING

Array = NDArray[np.float64]

RADAU, DOP853, ACCURATE = 0, 1, 2  # which step is taken: the last is dop853 where the contacts are not stiff

# entries of the counter array: evaluations of all contacts, rejected steps, steps, sample rows, switches, rescues
EVALUATION, REJECTED, STEP, SAMPLE, SWITCH, RESCUE = 0, 1, 2, 3, 4, 5
COUNTERS = 6

NEWTON_PART = 1e-2  # of a step's tolerance: to this the stages are solved
IDLE = 10.0  # times that: contacts that neither come nor push with more wait beside the stretches of dop853
SHRINK, SAFETY = 0.1, 0.9
LANDING_TRIES, SLOW_TRIES = 20, 3  # to hit an event; one that moves nothing
EARLY = 0.1  # part of a step: an event before it is sought again in a shorter one,
AT_ONCE = 1e-12  # down to this part of the step first tried: an event before it is one of its start
PLAIN_GUESS = -1.0  # as length of the step before: nothing is known of it
LATE = 0.95  # part of a step: a contact that opens after it has pushed through the step
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
    opening: Array  # (n,) when within the step a contact opens, -1 where it does not
    work: Array  # (15, n+1)
    pace: Array  # (7,) of the steps, see pace


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
def attempt(h, explicit, given, moving, precision, past_step, trial, book):
    """Try one step; returns its error as a velocity [m/s], negative where Newton does not converge."""
    if explicit:
        book.counter[EVALUATION] += 15
        return dop853_step(
            h, IDLE * precision, given.law, given.inverse_mass, given.external, given.anchor_bead, moving.mode, moving.overlap,
            moving.rate, moving.anchor, moving.force, trial.overlap, trial.rate, trial.force, trial.acceleration,
            trial.of_anchor, trial.z[0], trial.z[1], trial.z[2], trial.anchor,
        )  # fmt: skip
    used, guess = 0, past_step
    for _ in range(2):
        first_guess(
            h, given.law, given.inverse_mass, given.external, moving.mode, moving.overlap, moving.rate, moving.force,
            guess, trial.past, trial.overlap, trial.force,
        )  # fmt: skip
        used = solve_stages(
            h, given.law, given.inverse_mass, given.external, moving.mode, moving.overlap, moving.rate, moving.force,
            precision, trial.overlap, trial.force, trial.along, trial.across, trial.block, trial.z,
        )  # fmt: skip
        book.counter[EVALUATION] += 3 * (used if used > 0 else MOST_NEWTON)
        if used > 0:
            break
        guess = PLAIN_GUESS
    if used == 0:
        return -1.0
    stage_rates(
        h, given.inverse_mass, given.external, moving.overlap, moving.rate, trial.overlap, trial.force, trial.rate
    )
    move_anchor(
        h, given.inverse_mass, given.external, given.anchor_bead, trial.force, moving.anchor, trial.anchor
    )  # fmt: skip
    return embedded_error(
        h, given.law, given.inverse_mass, given.external, moving.mode, moving.overlap, moving.rate, moving.force,
        trial.overlap, trial.rate, trial.force, trial.work[0], trial.work[1], trial.work[2],
    )  # fmt: skip


@jit
def turned_back(landing, kind, moving, trial):
    """True where the contact moves the other way at what looked, from further off, like its event."""
    if moving.mode[landing] == TOUCHING:
        return False
    speed = trial.rate[2, landing]
    return speed > 0.0 if kind == OPENS else speed < 0.0


@jit
def opened_early(h, given, moving, trial, wanted):
    """The part of the step at which a contact opens that still pushes enough to matter; 1 where none does.

    An error estimate knows nothing of a force that ends between its nodes.
    """
    part = 1.0
    for i in range(moving.mode.size):
        if moving.mode[i] == LOADED and moving.overlap[i] > 0.0 > trial.overlap[2, i] and not continued(given.law, i):
            d, soft = trial.overlap, given.law[i, 2] < 1.0
            x = first_crossing(moving.overlap[i], d[0, i], d[1, i], d[2, i], False, 1.0)
            push = (given.inverse_mass[i] + given.inverse_mass[i + 1]) * moving.force[i] * h
            if x < part and ((soft and x < LATE and x * push > wanted) or (not soft and KINK * push > wanted)):
                part = x
    return part


@jit
def settle(time, h, explicit, given, moving, wanted, past_step, trial, book, most_steps):
    """Find the step that holds the error and ends at the first event in it, if any.

    Returns its length (0: Newton does not settle, or out of steps), error, the contact and kind of the event, and the length
    of the last step refused for its error (inf: none).
    """
    refused, idle = math.inf, IDLE * NEWTON_PART * wanted
    landing, kind, tries, failures, ceiling, peaked, least = -1, NOTHING, 0, 0, h, False, AT_ONCE * h
    while book.counter[STEP] + book.counter[REJECTED] < most_steps:
        error = attempt(h, explicit, given, moving, NEWTON_PART * wanted, past_step, trial, book)
        if error < 0.0 or not math.isfinite(error):
            book.counter[REJECTED] += 1
            failures += 1
            landing, h = -1, 0.25 * h
            if failures > MOST_FAILURES or time + h <= time:
                return 0.0, 0.0, -1, NOTHING, refused
            continue
        if landing >= 0 and turned_back(landing, kind, moving, trial):
            landing, tries = -1, tries + 1
        found, its_kind, part = find_event(
            given.law, given.inverse_mass, idle, moving.mode, landing, moving.overlap, moving.rate, moving.force,
            trial.overlap, trial.rate, trial.force,
        )  # fmt: skip
        if landing >= 0:
            miss = miss_of(given.law, moving.mode, landing, kind, h, trial.overlap, trial.rate, trial.force)
            waits = moving.mode[landing] == OPEN and abs(trial.rate[2, landing]) <= idle
            most_tries = SLOW_TRIES if waits else LANDING_TRIES
            if tries < most_tries and found >= 0 and part * h < h + min(miss, 0.0):
                landing, kind, h = found, its_kind, part * h
                tries += 1
                continue
            if tries < most_tries and abs(miss) > LANDED * h and time + miss != time and h > least:
                h = min(max(h + miss, 0.1 * h), ceiling)
                tries += 1
                continue
        elif found >= 0 and tries < LANDING_TRIES:
            ceiling, tries = h, tries + 1
            if part < EARLY and h > least and time + EARLY * h > time:
                h *= EARLY  # it was seen through the cubic of a long step: look again from nearer
            else:
                landing, kind, h = found, its_kind, part * h
            continue
        early = opened_early(h, given, moving, trial, wanted) if given.kind != DOP853 else 1.0
        if (error <= wanted and early == 1.0) or time + h <= time:
            peak = 1.0 if peaked else passing_yield(given.law, moving.mode, moving.force, trial.force)
            if peak < 1.0:  # end there: a multiplier at the end of a step is exact
                peaked, landing, tries, h = True, -1, 0, peak * h
                continue
            return h, error, landing, kind, refused
        book.counter[REJECTED] += 1
        if early < 1.0 and error <= 10.0 * wanted:
            h, landing = 0.9 * early * h, -1
            continue
        refused = h if early == 1.0 else refused
        h *= max(SHRINK, SAFETY * (wanted / error) ** (0.125 if explicit else 0.2))
        landing = -1
    return 0.0, 0.0, -1, NOTHING, refused
