"""Runner of the adaptive methods: one integration, an error estimate and, if that is not trustworthy, further runs that
confirm it.

    one run          estimates DOUBT * amplification * sqrt(sum of squared local errors, neglected bounces and
        round-off)
    amplification    above MOST_GROWN, another run of a slightly perturbed chain must agree: a coarser run, which is
                     cheap, or otherwise finer runs
    chattering       if following each bounce does not pay any more, several runs of `conserving` finish the motion

In the random chains of `benchmarks scan`, no run whose errors were amplified by less than MOST_GROWN had an undetected
error. A small estimate is not sufficient: draft gears far below their preload do not make local errors, but round-off
decides which of them yields. Thousands of bounces at a millionth of the closing speed determine no digit of the end
that a finer run could confirm. Each step of the discrete gradient keeps energy and momentum, so `conserving` finishes
such a motion in bounded time. The difference between its runs with unlike steps shows how well the end is determined.
"""

from __future__ import annotations

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from sys import float_info
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.adaptive import runner as adaptive
from softcradle.physics.adaptive.constants import ROUND_OFF, TOLERANCE_PART
from softcradle.physics.adaptive.error_estimate import (
    DOUBT,
    GUARANTEED,
    LEAST_GUARANTEED,
    MOST_GROWN,
    guaranteed_error,
)
from softcradle.physics.adaptive.runner import sampled
from softcradle.physics.adaptive.step_records import ERROR_EXPONENT, RADAU
from softcradle.physics.adaptive.usual_budget import STEPS_A_CONTACT, usual_steps
from softcradle.physics.chain import Chain, Joint, per_chain
from softcradle.physics.checked_input import LARGEST, SMALLEST
from softcradle.physics.contact import Contact
from softcradle.physics.fixed_step import runner as fixed_step
from softcradle.physics.kernel_records import law_rows
from softcradle.physics.numerics.records import Samples
from softcradle.physics.problem import NO_TIMES, Problem, Record, first_samples, with_ends_as_samples
from softcradle.physics.scales import default_step, is_possible, largest_error
from softcradle.physics.segments import PiecewiseContact, SegmentTable
from softcradle.physics.state import State, Switches
from softcradle.physics.status import CodedWarning, Status, WarningCode

Array = NDArray[np.float64]

# Confirmation by other runs
FINER = 10.0  # Ratio of the tolerances of successive runs
# Error amplification, and estimated error as a fraction of the closing speed, above which another run may agree by
# chance. The difference between runs shows their errors only as long as these are small. Above these limits a coarser
# run does not confirm anything, and two finer runs must.
MOST_TRUSTED = FINER**3
MOST_STATED = 0.3
# Smallest confirmed error, as a fraction of the estimate of the first run. Another run can agree with the first by
# chance, or because both damp a motion that neither resolves. None of 1 900 runs with an amplification above MOST_GROWN
# had an error above the estimate of the first run, but that estimate is often ten times too large.
LEAST_OF_ESTIMATE = 0.1
# Ratio of the steps of two successive runs that the order of radau predicts. If a run takes more than this many times
# the steps of a coarser run, the coarser one may have damped a motion and does not confirm it. A finer run does not
# confirm either if it takes more than the square of this ratio.
ALIKE = FINER ** ERROR_EXPONENT[RADAU]
# Runs of `conserving` that finish a motion
STEP_PART = 0.25  # Longest step of these runs, as a fraction of the default step
# The same as a fraction of the elapsed time of the motion; the longer one counts. The number of steps stays bounded.
ELAPSED_PART = 1.0 / 1500.0
# Step of each run, as a fraction of the longest step. The fractions are unlike so that the runs differ; the last run
# gives the result.
PARTS = (1.0, 0.83, 0.61, 0.5)
# Steps of such a run after which its step length doubles, so that a long end takes only few more steps
STEPS_ALIKE = 12_000
# Energy balance
SOFTEST = 0.02  # Exponent of contacts below which the energy balance bounds the error as well
# Steps of a run above which its error is at least what the change of its energy shows. Local errors of many similar
# bounces have one sign, so their sum is larger than the root of the sum of their squares.
LONG_RUN = 10_000
MOST_ENERGY = 100.0  # Largest relative error of the energy without a warning, in tolerances

# Statuses of a run whose end is less accurate than the tolerance
UNCERTAIN = (Status.UNDETERMINED, Status.BUDGET_SPENT)

advance = adaptive.advance


def run(problem: Problem) -> Record:
    """Compute the whole motion and confirm its end; ``problem.state`` stays unchanged."""
    adaptive.KERNELS.load_made()  # the measured cost should not contain the time to load kernels
    record = to_its_end(problem)
    if problem.most_steps is None:
        record = confirmed(problem, record)
    # Samples are taken from the confirmed run only.
    if record.kept is not None:
        began = perf_counter()
        record = sampled(record, problem.sample_times(record.end.time))
        record.seconds += perf_counter() - began
    # The energy balance reveals errors that all runs have in common; energy and momentum also limit the error.
    before, change = _ledger(problem, record)
    record.velocity_error = record.velocity_error + _unresolved(problem.chain, change)
    if record.steps > LONG_RUN:
        record.velocity_error = np.maximum(record.velocity_error, _least_error(problem.chain, before, change))
    _bound_by_energy(problem, record)
    if record.status in UNCERTAIN:
        record.warnings += (_uncertain_warning(record),)
    if change > MOST_ENERGY * problem.tolerance * before:
        record.warnings += (_energy_warning(problem, change / before),)
    return record


def to_its_end(problem: Problem) -> Record:
    """Run to the end of the problem; if the method gives up because contacts chatter, `conserving` finishes the motion.

    Samples are computed later.
    """
    record = adaptive.one_run(problem)
    return _finished(problem, record) if record.status.gave_up and problem.most_steps is None else record


# ---- confirmation by another run


def confirmed(problem: Problem, record: Record) -> Record:
    """Return the confirmed record, with an error of at least a tenth of the estimate of the first run."""
    least = LEAST_OF_ESTIMATE * record.velocity_error
    found = _confirmed(problem, record)
    found.velocity_error = np.maximum(found.velocity_error, least)
    return found


def _confirmed(problem: Problem, record: Record) -> Record:
    """Return the record if its errors are hardly amplified or another run of a slightly perturbed chain agrees,
    otherwise a finer one.

    The other run is coarser, because it takes the fewest steps. If it ends within half of the guaranteed error of the
    record, errors do not grow beyond the estimate. If the two runs disagree, finer runs decide. The same holds if the
    first run already estimates an error above the guarantee: a coarser run would estimate ten times as much, and the
    two could agree by chance, or because both damp a motion that neither resolves.
    """
    # Small amplification: the estimate of the run itself is reliable.
    if record.growth <= MOST_GROWN or record.warnings:
        return record
    # An undetermined motion was finished by several runs from one state. The other run reaches another state, so the
    # comparison shows the spread of the end.
    determined = record.status != Status.BUDGET_SPENT
    promised = guaranteed_error(problem.tolerance, problem.scale)
    # Large amplification or a large estimate: only finer runs can confirm.
    if determined and (record.growth > MOST_TRUSTED or record.velocity_error.max() > promised):
        return _finer(problem, record)
    most = 2 * record.steps + STEPS_A_CONTACT if determined else None
    # The steps of `conserving` are not a measure for other runs, because flights that it skips count as steps.
    budget = min(record.steps, usual_steps(problem, problem.end))
    coarse = _shaken_run(problem, FINER * problem.tolerance, 0, samples=2, budget=budget, most_steps=most)
    other = to_its_end(coarse)
    apart = np.abs(other.velocity - record.velocity)
    # The coarser run failed, disagrees, or took so few steps that it may have damped what the finer one follows.
    if determined and (other.warnings or record.steps > ALIKE * other.steps or not apart.max() <= 0.5 * promised):
        finest = _finer(problem, record)
        return _beside(finest, other, finest.velocity_error)
    return _beside(record, other, np.maximum(record.velocity_error, _error_of(apart)))


def _finer(problem: Problem, record: Record) -> Record:
    """Return the first record that a finer run confirms, or the finest record, which is then undetermined.

    The usual budget limits the steps of each finer run, and those of all runs before another one is tried.
    """
    # `confirming` counts consecutive agreements, `chance` is true if the last run may agree by chance, `surprised` if a
    # run differed by more than it had estimated, and `alone` is the estimate of the last run itself.
    allowed = max(problem.tolerance, LEAST_GUARANTEED) * problem.scale
    usual, steps, tolerance = usual_steps(problem, problem.end), record.steps, problem.tolerance
    runs, confirming, chance = 0, 0, _agrees_by_chance(record, problem)
    alone, surprised = record.velocity_error, False
    while not record.warnings:
        tolerance, runs = max(tolerance / FINER, ROUND_OFF), runs + 1
        # A run with the same tolerance agrees with this one, whatever error both have.
        finest = tolerance < 2.0 * ROUND_OFF
        budget = min(int(FINER * (record.steps + STEPS_A_CONTACT)), usual)
        finer = to_its_end(_shaken_run(problem, tolerance, runs, budget=budget))
        apart = np.abs(finer.velocity - record.velocity)
        error, agrees = _error_of(apart) + _error_anyway(finer), apart.max() <= allowed
        # The finer run did not reach the end within its budget: the record stays unconfirmed.
        if finer.status == Status.BUDGET_SPENT:
            record.status = Status.BUDGET_SPENT
            return _beside(record, finer, error)
        # A finer run that takes many more steps than predicted may follow a motion that the other run damped.
        confirming = confirming + 1 if agrees and finer.steps <= ALIKE**2 * steps else 0
        # errors are amplified by more than the run has estimated
        surprised = surprised or (not agrees and apart.max() > alone.max())
        before, chance = chance, surprised or _agrees_by_chance(finer, problem)
        # Two agreements are needed if either run may agree by chance.
        if confirming >= (2 if chance or before else 1):
            return _beside(record, finer, error)
        # Continue with the finer run, until round-off limits the tolerance or the budget is used up.
        alone, steps, record = finer.velocity_error, finer.steps, _beside(finer, record, error)
        if finest or record.steps + steps > usual:
            if apart.max() > GUARANTEED * allowed:
                record.status = Status.UNDETERMINED
            elif not finest:  # Unconfirmed: the error may be larger than a difference that is small by chance.
                record.velocity_error = np.maximum(error if agrees else FINER * error, alone if chance else 0.0)
            return record
    return record


def _agrees_by_chance(record: Record, problem: Problem) -> bool:
    """Return whether another run of the same accuracy may agree with the record by chance."""
    return record.growth > MOST_TRUSTED or float(record.velocity_error.max()) > MOST_STATED * problem.scale


def _error_of(apart: Array) -> Array:
    """Return the estimated error of two runs whose ends differ by `apart` (n+1,) [m/s].

    The difference of one bead may be small by chance, so the largest difference of all beads is a lower limit.
    """
    return np.maximum(DOUBT * apart, apart.max())


def _error_anyway(record: Record) -> Array:
    """Return the error that a record may have in addition to the difference from another run, which showed its error
    amplification.

    For a motion that several runs finished, the estimate already is the difference between those runs, so it is not
    amplified.
    """
    # The difference from the other run contains all amplification above MOST_GROWN.
    grown = record.growth if record.status != Status.BUDGET_SPENT else 1.0
    return np.maximum(record.velocity_error * (min(grown, MOST_GROWN) / grown), record.unseen)


def _shaken_run(problem: Problem, tolerance: float, runs: int, **other: Any) -> Problem:
    """Return the problem with another tolerance and a chain that is perturbed by a fraction of it. `other` fields
    replace its own.

    Steps between sharp events (jumps of a force) are the same at all tolerances, so two runs of one chain have the same
    errors; so do two runs with the same perturbation. Therefore the sign of the perturbation alternates with the number
    of `runs`.
    """
    chain, state = _shaken(problem.chain, (-1) ** runs * TOLERANCE_PART * tolerance), problem.state.copy()
    # Rates are perturbed as well, by a few units of round-off.
    state.rate *= _up_and_down(runs * float_info.epsilon, state.rate.size)
    return replace(problem, tolerance=tolerance, chain=chain, state=state, **other)


def _beside(record: Record, other: Record, error: Array) -> Record:
    """Return the record with the cost of another run added, and with the `error` (n+1,) [m/s] that both together show."""
    record.steps += other.steps
    record.evaluations += other.evaluations
    record.seconds += other.seconds
    record.velocity_error = error
    return record


def _shaken(chain: Chain, part: float) -> Chain:
    """Return the chain with forces perturbed by the fraction `part`; with user-defined laws, masses are perturbed
    instead.

    Forces are preferred, because they hardly change the phase of a bead that is pressed from both sides; masses do.
    The heaviest bead stays the heaviest, because a State stores its velocity.
    """
    if not chain.own_laws:
        factors = _up_and_down(part, chain.contacts).tolist()
        return replace(chain, contact=tuple(map(_stronger, chain.contact, factors)))
    # Alternating perturbations of the masses, within the range that a chain accepts.
    mass = np.array(chain.mass) * _up_and_down(part, len(chain.mass))
    np.clip(mass, SMALLEST, (1.0 - 4.0 * float_info.epsilon) * LARGEST, out=mass, where=np.isfinite(mass))
    mass[chain.anchor] = (1.0 + float_info.epsilon) * mass.max()
    return replace(chain, mass=tuple(mass.tolist()))


def _stronger(contact: Joint, factor: float) -> Joint:
    """Return the contact with its forces multiplied by `factor`."""
    if isinstance(contact, PiecewiseContact):
        rows = (
            one._replace(
                preload=_scaled(one.preload, factor), stiffness=_scaled(one.stiffness, factor), stop=one.stop * factor
            )
            for one in contact.segments
        )
        return SegmentTable(tuple(rows), contact.coupled)
    assert isinstance(contact, Contact)
    return _times(contact, factor)


def _times(contact: Contact, factor: float) -> Contact:
    preload, stiffness = _scaled(contact.preload, factor), _scaled(contact.stiffness, factor)
    return Contact(preload, stiffness, contact.exponent, contact.loss)


def _scaled(number: float, factor: float) -> float:
    """Return the number multiplied by `factor`, within the range that a chain accepts; 0 stays 0."""
    return number and min(max(number * factor, SMALLEST), LARGEST)


def _up_and_down(part: float, size: int) -> Array:
    """Return (size,) factors 1 + part, 1 - part, 1 + part, ..."""
    factors = np.full(size, 1.0 + part)
    factors[1::2] = 1.0 - part
    return factors


# ---- the end of a chattering motion


def _finished(problem: Problem, given_up: Record) -> Record:
    """Return the whole record of a motion that the adaptive method gave up at ``given_up.end``. Its error is the spread
    of several runs.
    """
    # Longest step: short compared with a contact, but long enough that the number of steps stays bounded.
    start = given_up.end
    elapsed = start.time - problem.state.time
    step = STEP_PART * default_step(problem.chain, problem.velocity, touching=True)
    step = max(step, ELAPSED_PART * elapsed)
    # Several runs of `conserving` with unlike steps, in parallel.
    with ThreadPoolExecutor(min(len(PARTS), os.cpu_count() or 1)) as threads:
        ends = list(threads.map(lambda part: _run_on(problem, start, part * step, problem.end, NO_TIMES), PARTS))
    # The spread of their ends, plus rates whose sign is the same in all runs by the nature of the method.
    velocities = np.array([end.velocity for end in ends])
    error = _error_anyway(given_up) + _error_of(np.ptp(velocities, axis=0) + _rattling(problem.chain, ends[-1].end))
    # Samples before the switch come from the adaptive run, the others from the last run of `conserving`.
    times, last = problem.sample_times(ends[-1].end.time), ends[-1]
    early, late = times[times <= start.time], times[times > start.time]
    if (late < last.end.time).any():
        last = replace(_run_on(problem, start, PARTS[-1] * step, last.end.time, late), end=last.end)
    else:
        last = with_ends_as_samples(last, start, late)
    record = _in_a_row(problem.chain, [problem.state.time, start.time], [sampled(given_up, early), last])
    return replace(
        record,
        status=Status.BUDGET_SPENT,
        warnings=(),
        velocity_error=error,
        growth=given_up.growth,
        carried_from=start.time,
    )


def _rattling(chain: Chain, end: State) -> Array:
    """Return (n+1,) the largest rate [m/s] of a contact at each bead that touches under load: its sign is not reliable.

    A step of the discrete gradient that starts and ends at the touching position ends with the opposite rate. So all
    runs may agree in the sign of this rate.
    """
    pulls_below = np.full(chain.contacts, -np.inf)
    for i, contact in chain.piecewise:
        pulls_below[i] = contact.pulls_below
    touches = ((end.overlap == 0.0) | (end.overlap == pulls_below)) & (end.force != 0.0)
    rate = np.pad(np.where(touches, np.abs(end.rate), 0.0), 1)
    return np.maximum(rate[:-1], rate[1:])


def _run_on(problem: Problem, start: State, step: float, end: float, times: Array) -> Record:
    """Run `conserving` from `start` to `end`, with a step length that doubles after every STEPS_ALIKE steps."""
    state, left = start, times
    records: list[Record] = []
    # Each part runs at most STEPS_ALIKE steps; the next part has twice the step length.
    while not records or records[-1].status.gave_up:
        duration = None if np.isinf(end) else end - state.time
        if duration is not None and state.time + duration < end:  # the last sample is at the end
            duration = float(np.nextafter(duration, np.inf))
        samples = left if left.size else 2
        part = Problem(
            problem.chain, state.copy(), "conserving", duration, step, samples=samples, most_steps=STEPS_ALIKE
        )
        found = fixed_step.run(part)
        records.append(replace(found, samples=first_samples(found.samples, left.size)))
        left = left[records[-1].samples.time.size :]  # samples within the step after the last one are included
        state, step = found.end, 2.0 * step
    starts = [start.time, *(record.end.time for record in records[:-1])]
    return records[0] if len(records) == 1 else _in_a_row(problem.chain, starts, records)


def _in_a_row(chain: Chain, starts: list[float], records: list[Record]) -> Record:
    """Join the records of consecutive runs, each with its start time [s], into one."""
    closed, switches = np.zeros(chain.contacts, dtype=bool), []
    for start, record in zip(starts, records, strict=True):
        switches += _continued_switches(closed, start, record)
    samples = Samples(*map(np.concatenate, zip(*(record.samples for record in records), strict=True)))
    contact, time = Switches.of(switches)
    return replace(
        records[-1],
        samples=samples,
        switch_contact=contact,
        switch_time=time,
        steps=sum(record.steps for record in records),
        evaluations=sum(record.evaluations for record in records),
        seconds=sum(record.seconds for record in records),
    )


def _continued_switches(closed: NDArray[np.bool_], start: float, record: Record) -> list[tuple[int, float]]:
    """Return (contact, time) of the switches in the `record` of a run that continues another at `start` [s]. Updates
    `closed` (n,).

    A run logs closed contacts as closing at its start. Contacts that were `closed` before have not switched then.
    Contacts that were closed and are not logged have opened.
    """
    begun, now = np.zeros(closed.size, dtype=bool), np.zeros(closed.size, dtype=bool)
    kept = []
    for contact, time in zip(record.switch_contact.tolist(), record.switch_time.tolist(), strict=True):
        now[contact] = not now[contact]
        if time <= start and now[contact] and not begun[contact]:
            begun[contact] = True
            if closed[contact]:
                continue
        kept.append((contact, time))
    opened = np.flatnonzero(closed & ~begun)
    closed[:] = now
    return [*((int(contact), start) for contact in opened), *kept]


# ---- energy balance


def _bound_by_energy(problem: Problem, record: Record) -> None:
    """Limit the estimated error to what energy and momentum allow. If this limit is below the tolerance, the motion is
    determined.
    """
    if is_possible(problem.chain, problem.state, max(record.velocity_error.tolist())):
        return
    # The bound of each bead; a motion whose bounds are below the tolerance is determined.
    most = largest_error(problem.chain, problem.state, record.end)
    record.velocity_error = np.minimum(record.velocity_error, most)
    if record.status in UNCERTAIN and most.max() <= problem.tolerance * problem.scale:
        record.status = Status.DONE


def _ledger(problem: Problem, record: Record) -> tuple[float, float]:
    """Return the energy [J] of a chain at the start, and its error at the end; both 0 if external work is done on the
    chain.
    """
    chain, start, end = problem.chain, problem.state, record.end
    # Without external work the energy must stay constant; otherwise it is not checked.
    wall_moves = chain.walls > 0 and bool((np.isinf(chain.mass) & (problem.velocity != 0.0)).any())
    if wall_moves or chain.forces or start.external(chain) is not None:
        return 0.0, 0.0
    before, after = start.energy(chain, problem.velocity), end.energy(chain, record.velocity)
    absorbed = float((end.absorbed - start.absorbed).sum()) if chain.dissipative else 0.0
    return before, abs(after + absorbed - before)


def _least_error(chain: Chain, energy: float, change: float) -> float:
    """Return an error [m/s] of the bead velocities that explains the `change` [J] of the `energy` [J].

    Errors up to e change the kinetic energy by at most e times the sum of m abs(v), where sqrt(m) abs(v) <= sqrt(2 E).
    """
    if not energy > 0.0:
        return 0.0
    return DOUBT * change / (math.sqrt(2.0 * energy) * float(np.sqrt(chain.finite_mass).sum()))


def _unresolved(chain: Chain, change: float) -> float:
    """Return the velocity [m/s] that the energy `change` of a run corresponds to if contacts are so soft that they
    chatter, else 0.

    A cluster of such contacts is nearly rigid. Chattering far below the closing speed can be damped in every run alike,
    so that no comparison shows it. Its energy is then only known to be at most the error of the energy balance.
    """
    return float(np.sqrt(2.0 * change * chain.inverse_reduced_mass.max())) if _rattles(chain) else 0.0


@per_chain
def _rattles(chain: Chain) -> bool:
    """Return whether contacts are so soft that a cluster of them chatters."""
    return any(preload == 0.0 and exponent < SOFTEST for preload, _, exponent in law_rows(chain).tolist())


def _energy_warning(problem: Problem, error: float) -> CodedWarning:
    sentence = (
        f"energy is off by {error:.1g} of itself, more than {problem.method} promises at tolerance {problem.tolerance:g}: "
        "compare with method 'conserving', or with another tolerance"
    )
    return CodedWarning(WarningCode.ENERGY, sentence, {"error": error})


def _uncertain_warning(record: Record) -> CodedWarning:
    """Return the warning that the end of a motion is less accurate than the tolerance, with its cause and its error."""
    worst = float(record.velocity_error.max())
    if record.status == Status.UNDETERMINED:
        sentence = f"final velocities are determined to {worst:.1g} m/s only: finer runs differ by as much"
        return CodedWarning(WarningCode.SENSITIVE, sentence, {"error": worst})
    numbers = {"error": worst, "steps": record.steps}
    if np.isnan(record.carried_from):
        cause = "the step budget ended before a finer run could confirm the end"
    else:
        cause = f"the step budget ended at t = {record.carried_from:.6g} s, and 'conserving' computed the rest"
        numbers["time"] = record.carried_from
    return CodedWarning(WarningCode.BUDGET, f"{cause}: final velocities may be off by {worst:.1g} m/s", numbers)
