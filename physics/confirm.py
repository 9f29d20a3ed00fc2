"""Adaptive runs above their runner: samples, what one run states of its error, and other runs where that is not enough.

    one run          states DOUBT * growth * sqrt(sum of the squares of its local errors, of bounces left out and of round-off)
    grown errors     another run of a slightly different chain has to agree: a coarser one, which is cheap, else finer ones
    rattling         where following each bounce stops paying, several runs of `conserving` carry the motion to its end

Over the random chains of `benchmarks scan` no run whose errors grew by less than MOST_GROWN was silent. That one states little
tells nothing: gears far below their preload make no local error, and round-off decides which of them yields. Bounces by the
thousand at a millionth of the closing speed determine no digit of the end that a finer run would confirm. Energy and momentum
are kept by every step of the discrete gradient, so it carries such a motion on in bounded time, and how far runs of unlike steps
differ says how well the end is determined.
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
from softcradle.physics.adaptive.runner import (
    DOUBT,
    GUARANTEED,
    LEAST_GUARANTEED,
    MOST_GROWN,
    guaranteed_error,
    sampled,
)
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

# Other runs
FINER = 10.0  # ratio of the tolerances of successive runs
# Where errors grow by more, or where a run states more than this part of the closing speed, another run may agree with it by
# chance: differences tell of errors as long as these are small. A coarser one then confirms nothing, and two finer ones have to.
MOST_TRUSTED = FINER**3
MOST_STATED = 0.3
# Part of the first run's own estimate below which no confirmed error falls. Another run can agree with the first by chance, or
# because both damp what neither follows; the first run's estimate was exceeded in none of 1 900 runs whose errors grew by
# more than MOST_GROWN, but it is often ten times too large.
LEAST_OF_ESTIMATE = 0.1
# Times the steps of a run that the order of radau asks for in one as much finer. A finer one that takes more of them may follow
# what the other damped: a coarser run then confirms nothing, and with the square of it a finer one neither.
ALIKE = FINER ** ERROR_EXPONENT[RADAU]
# Runs of `conserving` to the end
STEP_PART = 0.25  # of the default step: the longest step of these runs, or
ELAPSED_PART = 1.0 / 1500.0  # of the time that the motion took so far, where that is longer
PARTS = (1.0, 0.83, 0.61, 0.5)  # of the longest step, one for each run; the last one is the result
STEPS_ALIKE = 12_000  # of one of these runs, after which they are twice as long: a long end takes few more
# The ledger
SOFTEST = 0.02  # exponent of contacts below which the ledger bounds the error too
# Steps of a run above which its error is at least what the change of its energy shows. Local errors of many like bounces have one
# sign and add up to more than the root of the sum of their squares.
LONG_RUN = 10_000
MOST_ENERGY = 100.0  # tolerances: a larger relative error of the energy gives a warning

# Statuses of a run whose end is known less well than the tolerance
UNCERTAIN = (Status.UNDETERMINED, Status.BUDGET_SPENT)

advance = adaptive.advance


def run(problem: Problem) -> Record:
    """Compute the whole motion; ``problem.state`` stays as it is."""
    adaptive.KERNELS.load_made()  # so that the cost measured is that of the motion
    record = to_its_end(problem)
    if problem.most_steps is None:
        record = confirmed(problem, record)
    if record.kept is not None:
        began = perf_counter()
        record = sampled(record, problem.sample_times(record.end.time))
        record.seconds += perf_counter() - began
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
    """One run to the end of the problem, by `conserving` from where contacts only rattle; samples may be still to be taken."""
    record = adaptive.one_run(problem)
    return _finished(problem, record) if record.status.gave_up and problem.most_steps is None else record


# ---- another run


def confirmed(problem: Problem, record: Record) -> Record:
    """Return the record that another run confirms, with an error of at least a tenth of what the first run estimates."""
    least = LEAST_OF_ESTIMATE * record.velocity_error
    found = _confirmed(problem, record)
    found.velocity_error = np.maximum(found.velocity_error, least)
    return found


def _confirmed(problem: Problem, record: Record) -> Record:
    """The record, if its errors hardly grow or another run of a slightly different chain agrees with it; else a finer one.

    The other run is a coarser one, which takes the fewest steps: where it ends within half of what is promised of the record,
    errors do not grow beyond what the record states. Where it does not, finer ones decide; and where the record states more than
    is promised, for then a coarser one states ten times as much, and agrees by chance or because both damp what neither follows.
    """
    if record.growth <= MOST_GROWN or record.warnings:
        return record
    # one that is not was carried to its end by several runs from one state: the other one has a state of its own
    determined = record.status != Status.BUDGET_SPENT
    promised = guaranteed_error(problem.tolerance, problem.scale)
    if determined and (record.growth > MOST_TRUSTED or record.velocity_error.max() > promised):
        return _finer(problem, record)
    most = 2 * record.steps + STEPS_A_CONTACT if determined else None
    # steps of `conserving` are no measure of what another run may take: it counts those of flights that it skips
    budget = min(record.steps, usual_steps(problem, problem.end))
    coarse = _shaken_run(problem, FINER * problem.tolerance, 0, samples=2, budget=budget, most_steps=most)
    other = to_its_end(coarse)
    apart = np.abs(other.velocity - record.velocity)
    if determined and (other.warnings or record.steps > ALIKE * other.steps or not apart.max() <= 0.5 * promised):
        finest = _finer(problem, record)
        return _beside(finest, other, finest.velocity_error)
    return _beside(record, other, np.maximum(record.velocity_error, _error_of(apart)))


def _finer(problem: Problem, record: Record) -> Record:
    """The first record with which a finer one agrees, or the finest, which is undetermined.

    The usual budget bounds the steps of each finer run, and those of all runs before another is tried.
    """
    allowed = max(problem.tolerance, LEAST_GUARANTEED) * problem.scale
    usual, steps, tolerance = usual_steps(problem, problem.end), record.steps, problem.tolerance
    runs, confirming, chance = 0, 0, _agrees_by_chance(record, problem)
    alone, surprised = record.velocity_error, False
    while not record.warnings:
        tolerance, runs = max(tolerance / FINER, ROUND_OFF), runs + 1
        finest = tolerance < 2.0 * ROUND_OFF  # a run as fine as another agrees with it, whatever both are off by
        budget = min(int(FINER * (record.steps + STEPS_A_CONTACT)), usual)
        finer = to_its_end(_shaken_run(problem, tolerance, runs, budget=budget))
        apart = np.abs(finer.velocity - record.velocity)
        error, agrees = _error_of(apart) + _error_anyway(finer), apart.max() <= allowed
        if finer.status == Status.BUDGET_SPENT:
            record.status = Status.BUDGET_SPENT
            return _beside(record, finer, error)
        confirming = confirming + 1 if agrees and finer.steps <= ALIKE**2 * steps else 0
        surprised = surprised or (not agrees and apart.max() > alone.max())  # errors grow by more than it knows of
        before, chance = chance, surprised or _agrees_by_chance(finer, problem)
        if confirming >= (2 if chance or before else 1):
            return _beside(record, finer, error)
        alone, steps, record = finer.velocity_error, finer.steps, _beside(finer, record, error)
        if finest or record.steps + steps > usual:
            if apart.max() > GUARANTEED * allowed:
                record.status = Status.UNDETERMINED
            elif not finest:  # unconfirmed: it may be off by more than a difference that is small by chance
                record.velocity_error = np.maximum(error if agrees else FINER * error, alone if chance else 0.0)
            return record
    return record


def _agrees_by_chance(record: Record, problem: Problem) -> bool:
    """Whether a run as fine as the record's may agree with it by chance."""
    return record.growth > MOST_TRUSTED or float(record.velocity_error.max()) > MOST_STATED * problem.scale


def _error_of(apart: Array) -> Array:
    """What runs state that end `apart` (n+1,) [m/s]: that of one bead may be small by chance, where those of others are not."""
    return np.maximum(DOUBT * apart, apart.max())


def _error_anyway(record: Record) -> Array:
    """What a record whose growth of errors another run has shown, or bounded, may be off by beside their difference.

    One that several runs carried to its end states what these differ by, which is of no growth.
    """
    grown = record.growth if record.status != Status.BUDGET_SPENT else 1.0
    return np.maximum(record.velocity_error * (min(grown, MOST_GROWN) / grown), record.unseen)


def _shaken_run(problem: Problem, tolerance: float, runs: int, **other: Any) -> Problem:
    """The problem at another tolerance, of a chain that differs by a part of it; `other` fields replace its own.

    Steps between sharp events are the same at all tolerances, so two runs of one chain are off alike; and so are two that are
    shaken alike: this goes to and fro with the number of `runs` so far.
    """
    chain, state = _shaken(problem.chain, (-1) ** runs * TOLERANCE_PART * tolerance), problem.state.copy()
    state.rate *= _up_and_down(runs * float_info.epsilon, state.rate.size)
    return replace(problem, tolerance=tolerance, chain=chain, state=state, **other)


def _beside(record: Record, other: Record, error: Array) -> Record:
    """The record with the cost of another run too, beside which it states `error` (n+1,) [m/s]."""
    record.steps += other.steps
    record.evaluations += other.evaluations
    record.seconds += other.seconds
    record.velocity_error = error
    return record


def _shaken(chain: Chain, part: float) -> Chain:
    """The chain with forces that differ by a part of them; where a law is one's own, with masses that do.

    Masses turn the phase of a bead that is pressed from both sides, forces hardly do: so these where they can be changed. The
    heaviest bead stays the heaviest, for its velocity is the one that a State holds.
    """
    if not chain.own_laws:
        factors = _up_and_down(part, chain.contacts).tolist()
        return replace(chain, contact=tuple(map(_stronger, chain.contact, factors)))
    mass = np.array(chain.mass) * _up_and_down(part, len(chain.mass))
    np.clip(mass, SMALLEST, (1.0 - 4.0 * float_info.epsilon) * LARGEST, out=mass, where=np.isfinite(mass))
    mass[chain.anchor] = (1.0 + float_info.epsilon) * mass.max()
    return replace(chain, mass=tuple(mass.tolist()))


def _stronger(contact: Joint, factor: float) -> Joint:
    """Return the contact with its forces times a factor."""
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
    """The number times a factor, but no further than what a chain takes; 0 stays 0."""
    return number and min(max(number * factor, SMALLEST), LARGEST)


def _up_and_down(part: float, size: int) -> Array:
    """(size,) factors 1 + part, 1 - part, 1 + part, ..."""
    factors = np.full(size, 1.0 + part)
    factors[1::2] = 1.0 - part
    return factors


# ---- the end of a motion that rattles


def _finished(problem: Problem, given_up: Record) -> Record:
    """The whole record of a motion that the adaptive method gave up at ``given_up.end``; its error is the spread of the runs."""
    start = given_up.end
    elapsed = start.time - problem.state.time
    step = STEP_PART * default_step(problem.chain, problem.velocity, touching=True)
    step = max(step, ELAPSED_PART * elapsed)
    with ThreadPoolExecutor(min(len(PARTS), os.cpu_count() or 1)) as threads:
        ends = list(threads.map(lambda part: _run_on(problem, start, part * step, problem.end, NO_TIMES), PARTS))
    velocities = np.array([end.velocity for end in ends])
    error = _error_anyway(given_up) + _error_of(np.ptp(velocities, axis=0) + _rattling(problem.chain, ends[-1].end))
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
    """(n+1,) the largest rate [m/s] of a contact beside each bead that touches under load: it may be of the other sign.

    A step of the discrete gradient that ends at a touch where it began ends at the opposite rate: all runs may agree in its sign.
    """
    pulls_below = np.full(chain.contacts, -np.inf)
    for i, contact in chain.piecewise:
        pulls_below[i] = contact.pulls_below
    touches = ((end.overlap == 0.0) | (end.overlap == pulls_below)) & (end.force != 0.0)
    rate = np.pad(np.where(touches, np.abs(end.rate), 0.0), 1)
    return np.maximum(rate[:-1], rate[1:])


def _run_on(problem: Problem, start: State, step: float, end: float, times: Array) -> Record:
    """`conserving` from `start` to `end` in steps that double again and again."""
    state, left = start, times
    records: list[Record] = []
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
        left = left[records[-1].samples.time.size :]  # samples within the step after the last one are taken too
        state, step = found.end, 2.0 * step
    starts = [start.time, *(record.end.time for record in records[:-1])]
    return records[0] if len(records) == 1 else _in_a_row(problem.chain, starts, records)


def _in_a_row(chain: Chain, starts: list[float], records: list[Record]) -> Record:
    """Records of runs that go on from each other, each from its start [s], as one."""
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
    """(contact, time) of the switches in the `record` of a run that goes on from `start` [s]; `closed` (n,) is updated.

    A run logs its closed contacts as closing at its start: those that were `closed` before have not switched, and those that
    were and are not logged have opened.
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


# ---- what energy tells


def _bound_by_energy(problem: Problem, record: Record) -> None:
    """State no error that energy and momentum do not allow; a motion that these determine is determined."""
    if is_possible(problem.chain, problem.state, max(record.velocity_error.tolist())):
        return
    most = largest_error(problem.chain, problem.state, record.end)
    record.velocity_error = np.minimum(record.velocity_error, most)
    if record.status in UNCERTAIN and most.max() <= problem.tolerance * problem.scale:
        record.status = Status.DONE


def _ledger(problem: Problem, record: Record) -> tuple[float, float]:
    """The energy [J] of a chain at the start, and by how much it is off in the end; both 0 where work is done on it."""
    chain, start, end = problem.chain, problem.state, record.end
    wall_moves = chain.walls > 0 and bool((np.isinf(chain.mass) & (problem.velocity != 0.0)).any())
    if wall_moves or chain.forces or start.external(chain) is not None:
        return 0.0, 0.0
    before, after = start.energy(chain), end.energy(chain)
    absorbed = float((end.absorbed - start.absorbed).sum()) if chain.dissipative else 0.0
    return before, abs(after + absorbed - before)


def _least_error(chain: Chain, energy: float, change: float) -> float:
    """Return an error [m/s] of the bead velocities that explains the `change` [J] of the `energy` [J].

    Errors up to e change the kinetic energy by e times the sum of m abs(v) at the most, where sqrt(m) abs(v) <= sqrt(2 E).
    """
    if not energy > 0.0:
        return 0.0
    return DOUBT * change / (math.sqrt(2.0 * energy) * float(np.sqrt(chain.finite_mass).sum()))


def _unresolved(chain: Chain, change: float) -> float:
    """What velocities [m/s] the energy `change` of a run could be, where contacts are so soft that they rattle.

    A cluster of such contacts is all but rigid: rattling far below the closing speed can be damped in every run alike, so that
    none tells of it, and of its energy alone is known that it is no more than what the ledger lacks.
    """
    return float(np.sqrt(2.0 * change * chain.inverse_reduced_mass.max())) if _rattles(chain) else 0.0


@per_chain
def _rattles(chain: Chain) -> bool:
    """Whether contacts are so soft that a cluster of them rattles."""
    return any(preload == 0.0 and exponent < SOFTEST for preload, _, exponent in law_rows(chain).tolist())


def _energy_warning(problem: Problem, error: float) -> CodedWarning:
    sentence = (
        f"energy is off by {error:.1g} of itself, more than {problem.method} promises at tolerance {problem.tolerance:g}: "
        "compare with method 'conserving', or with another tolerance"
    )
    return CodedWarning(WarningCode.ENERGY, sentence, {"error": error})


def _uncertain_warning(record: Record) -> CodedWarning:
    """Report why the end of a motion is known less well than the tolerance, and how well."""
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
