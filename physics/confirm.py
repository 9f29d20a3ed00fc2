"""Runner of the adaptive methods: one integration and an error estimate. If the estimate is not sufficient, further
runs with smaller tolerances confirm the result.

    one run          estimates DOUBT * amplification * sqrt(sum of squared local errors, neglected bounces and
        round-off)
    amplification    above MOST_GROWN, a finer run of a slightly perturbed chain must agree, see `verdict`
    chattering       if following each bounce does not pay any more, several runs of `conserving` finish the motion

In the random chains of `benchmarks scan`, no run with an error amplification below MOST_GROWN had an undetected error.
A small error estimate alone is not sufficient. For example, draft gears far below their preload do not produce local
errors, but round-off decides which of them yields.

Some motions end with thousands of bounces at a millionth of the closing speed. These bounces do not determine any digit
of the end that a finer run could confirm. The method `conserving` finishes such a motion in bounded time, because each
of its steps conserves energy and momentum. Several of its runs with different steps are compared. The difference
between these runs shows how well the end is determined.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from sys import float_info
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.adaptive import runner as adaptive
from softcradle.physics.adaptive.constants import ROUND_OFF, TOLERANCE_PART
from softcradle.physics.adaptive.error_estimate import DOUBT, GUARANTEED, LEAST_GUARANTEED, MOST_GROWN
from softcradle.physics.adaptive.runner import sampled
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

# Confirmation by finer runs
FINER = 10.0  # Ratio of the tolerances of two successive runs
# Lower limit of the reported error after further runs have confirmed it, as a fraction of the error estimate of the
# first run. Two runs may agree by chance, or because both damp a motion that neither of them resolves. The estimate of
# the first run is often ten times too large. In `benchmarks scan`, three chains would have undetected errors without
# this limit: `extreme` 855 at 1e-6, `clusters` 76 at 1e-4 and `one-on-n` 1747 at 1e-8.
LEAST_OF_ESTIMATE = 0.1
# Runs of `conserving` that finish a motion
STEP_PART = 0.25  # Longest step of the runs of `conserving`, as a fraction of the default step
# Longest step as a fraction of the elapsed time of the motion. The longer of both limits applies, so that the number of
# steps stays bounded.
ELAPSED_PART = 1.0 / 1500.0
# Step of each run, as a fraction of the longest step. The fractions are irregular to make the runs different. The last
# run provides the result.
PARTS = (1.0, 0.83, 0.61, 0.5)
# Number of steps after which a run of `conserving` doubles its step length. A long motion then takes only few more
# steps.
STEPS_ALIKE = 12_000
# Energy balance
SOFTEST = 0.02  # Exponent of contacts below which the energy balance also limits the error
# Number of steps above which the change of energy gives a lower limit of the error. Local errors of many similar
# bounces have the same sign. The sum of such errors is larger than the root of the sum of their squares.
LONG_RUN = 10_000
MOST_ENERGY = 100.0  # Largest relative error of the energy that is accepted without a warning, in tolerances

# Statuses of a run whose end is less accurate than the tolerance
UNCERTAIN = (Status.UNDETERMINED, Status.BUDGET_SPENT)

advance = adaptive.advance


def run(problem: Problem) -> Record:
    """Compute the whole motion, and confirm its end by further runs if necessary. ``problem.state`` stays unchanged."""
    adaptive.KERNELS.load_made()  # Load the kernels now. The measured cost should not include the loading time.
    record = to_its_end(problem)
    if problem.most_steps is None:
        record = confirmed(problem, record)
    # Only the confirmed run provides samples.
    if record.kept is not None:
        began = perf_counter()
        record = sampled(record, problem.sample_times(record.end.time))
        record.seconds += perf_counter() - began
    # The energy balance reveals errors that all runs have in common. Energy and momentum also limit the error.
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
    """Run to the end of the problem. If the adaptive method gives up because contacts chatter, `conserving` finishes
    the motion.

    Samples are computed later.
    """
    record = adaptive.one_run(problem)
    return _finished(problem, record) if record.status.gave_up and problem.most_steps is None else record


# ---- confirmation by finer runs


class Run(NamedTuple):
    """Data of one run that are needed to confirm its result.

    Attributes:
        tolerance: tolerance of the run.
        velocity: (n+1,) bead velocities [m/s] at the end of the run.
        estimate: (n+1,) error [m/s] of these velocities, as estimated by the run itself.
        growth: error amplification of the run.
        steps: number of steps of the run.
        spent: True if the step budget ended before the motion. In this case `conserving` finished the motion.
        warns: True if the run gave up, or could not log all contact switches.
    """

    tolerance: float
    velocity: Array
    estimate: Array
    growth: float
    steps: int
    spent: bool = False
    warns: bool = False


class Aim(NamedTuple):
    """Wanted accuracy of a motion: the tolerance, the speed scale [m/s] to which it is relative, and the usual step
    budget.
    """

    tolerance: float
    scale: float
    budget: int


class Verdict(NamedTuple):
    """Conclusion from all runs of one motion so far.

    Attributes:
        enough: False if another run with a smaller tolerance is needed. The other attributes are then unused.
        run: index of the run whose result is used.
        error: (n+1,) estimated error [m/s] of the result; None if the run's own estimate is valid.
        status: status of the result; None if the run's own status is valid.
    """

    enough: bool
    run: int = 0
    error: Array | None = None
    status: Status | None = None


def confirmed(problem: Problem, first: Record) -> Record:
    """Confirm the result of the run `first`, and return the record of the motion.

    Runs with smaller tolerances are added until no further run is needed. The record contains the cost of all runs.
    """
    records, runs = [first], [_run_of(first, problem.tolerance)]
    # Most motions need a single run. Computing the step budget would cost as much as some steps, so it is skipped.
    if _is_enough(runs[0]):
        return first
    aim = Aim(problem.tolerance, problem.scale, usual_steps(problem, problem.end))
    while not (found := verdict(aim, runs)).enough:
        tolerance = finer_tolerance(runs[-1].tolerance)
        assert tolerance is not None
        budget = min(int(FINER * (runs[-1].steps + STEPS_A_CONTACT)), aim.budget)
        records.append(to_its_end(_perturbed_run(problem, tolerance, len(runs), budget=budget)))
        runs.append(_run_of(records[-1], tolerance))
    chosen = records[found.run]
    return replace(
        chosen,
        steps=sum(record.steps for record in records),
        evaluations=sum(record.evaluations for record in records),
        seconds=sum(record.seconds for record in records),
        velocity_error=chosen.velocity_error if found.error is None else found.error,
        status=chosen.status if found.status is None else found.status,
    )


def _run_of(record: Record, tolerance: float) -> Run:
    spent, warns = record.status == Status.BUDGET_SPENT, bool(record.warnings)
    return Run(tolerance, record.velocity, record.velocity_error, record.growth, record.steps, spent, warns)


def finer_tolerance(tolerance: float) -> float | None:
    """Return the tolerance of the next run, or None if round-off does not allow a smaller tolerance."""
    finer = max(tolerance / FINER, ROUND_OFF)
    # Two runs with nearly equal tolerances agree even if both are wrong.
    return finer if finer < 0.5 * tolerance else None


def verdict(aim: Aim, runs: Sequence[Run]) -> Verdict:
    """Decide from the runs of a motion if another run is needed. If not, select the run whose result is used.

    The first run has the tolerance of the `aim`. Each later run has a smaller tolerance than the one before it. In the
    table, *apart* is the largest difference between the final velocities of the last two runs.

    ===========================================  ============================  =====================
    situation                                    result                        its error
    ===========================================  ============================  =====================
    one run, errors hardly amplified             this run                      own estimate
    one run, with a warning or budget spent      this run                      own estimate
    one run, errors amplified                    add a finer run
    the last run spent its budget                the run before, budget spent  from both runs
    apart by at most the tolerance               the run before                from the difference
    further apart                                add a finer run
    no finer run possible, within the guarantee  the last run                  from the difference
    no finer run possible, beyond the guarantee  the last run, undetermined    from the difference
    ===========================================  ============================  =====================

    A confirmed error is at least LEAST_OF_ESTIMATE times the error estimate of the first run. A finer run is possible
    until round-off limits its tolerance, or until all runs together have used the usual step budget.
    """
    first, last, at = runs[0], runs[-1], len(runs) - 1
    finer = finer_tolerance(last.tolerance)
    if at == 0:
        return Verdict(enough=_is_enough(last))
    # The difference between the last two runs shows how much the errors of both are amplified.
    difference, allowed = np.abs(last.velocity - runs[-2].velocity), max(aim.tolerance, LEAST_GUARANTEED) * aim.scale
    error = np.maximum(_error_of(difference), LEAST_OF_ESTIMATE * first.estimate)
    if last.spent:
        return Verdict(True, at - 1, error + last.estimate, Status.BUDGET_SPENT)
    if difference.max() <= allowed:
        return Verdict(True, at - 1, error)
    if finer is not None and not last.warns and sum(run.steps for run in runs) + last.steps <= aim.budget:
        return Verdict(enough=False)
    return Verdict(True, at, error, Status.UNDETERMINED if difference.max() > GUARANTEED * allowed else None)


def _is_enough(first: Run) -> bool:
    """Return True if the result of the first run needs no confirmation by another run."""
    return first.growth <= MOST_GROWN or first.spent or first.warns or finer_tolerance(first.tolerance) is None


def _error_of(apart: Array) -> Array:
    """Return the estimated error of two runs whose final velocities differ by `apart` (n+1,) [m/s].

    The difference of a single bead may be small by chance. Therefore the largest difference of all beads is used as a
    lower limit. Without this limit, the estimate for one bead of chain `clusters` 323 in `benchmarks scan` would be
    seven times too small at a tolerance of 1e-8.
    """
    return np.maximum(DOUBT * apart, apart.max())


def _perturbed_run(problem: Problem, tolerance: float, runs: int, **other: Any) -> Problem:
    """Return the problem with another tolerance and a slightly perturbed chain.

    The perturbation is a fraction of the tolerance. `other` fields replace those of the problem. Steps between jumps of
    a force are the same at all tolerances. Two runs of the same chain would then have the same errors, and so would two
    runs with the same perturbation. Therefore the sign of the perturbation alternates with the number of `runs`.
    """
    chain, state = _perturbed(problem.chain, (-1) ** runs * TOLERANCE_PART * tolerance), problem.state.copy()
    # Rates are perturbed as well, by a few units of round-off.
    state.rate *= _up_and_down(runs * float_info.epsilon, state.rate.size)
    return replace(problem, tolerance=tolerance, chain=chain, state=state, **other)


def _perturbed(chain: Chain, part: float) -> Chain:
    """Return the chain with forces perturbed by the fraction `part`. With user-defined laws, perturb the masses
    instead.

    Perturbed forces are preferred: they hardly change the oscillation phase of a bead that is pressed from both sides.
    Perturbed masses do change it. The heaviest bead stays the heaviest, because a State stores its velocity.
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
    """Return the number multiplied by `factor`, limited to the range that a chain accepts. The result for 0 is 0."""
    return number and min(max(number * factor, SMALLEST), LARGEST)


def _up_and_down(part: float, size: int) -> Array:
    """Return (size,) factors 1 + part, 1 - part, 1 + part, ..."""
    factors = np.full(size, 1.0 + part)
    factors[1::2] = 1.0 - part
    return factors


# ---- the end of a chattering motion


def _finished(problem: Problem, given_up: Record) -> Record:
    """Finish a motion that the adaptive method gave up at ``given_up.end``, and return the record of the whole motion.

    The method `conserving` computes the rest in several runs. The error is the spread of their results.
    """
    # The longest step is short compared with a contact, but long enough to keep the number of steps bounded.
    start = given_up.end
    elapsed = start.time - problem.state.time
    step = STEP_PART * default_step(problem.chain, problem.velocity, touching=True)
    step = max(step, ELAPSED_PART * elapsed)
    # Several runs of `conserving` with different steps, in parallel.
    with ThreadPoolExecutor(min(len(PARTS), os.cpu_count() or 1)) as threads:
        ends = list(threads.map(lambda part: _run_on(problem, start, part * step, problem.end, NO_TIMES), PARTS))
    # The error is the spread of the final velocities. Add those rates whose sign is the same in all runs because of the
    # method.
    velocities = np.array([end.velocity for end in ends])
    spread = _error_of(np.ptp(velocities, axis=0) + _rattling(problem.chain, ends[-1].end))
    # The error estimate of the adaptive run is reliable if the error amplification is small. Otherwise the estimate is
    # often ten times too large.
    part = 1.0 if given_up.growth <= MOST_GROWN else LEAST_OF_ESTIMATE
    error = part * given_up.velocity_error + spread
    # Samples before the change of method come from the adaptive run. The last run of `conserving` provides the others.
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
    """Return for each bead (n+1,) the largest rate [m/s] of its contacts that touch under load. The sign of this rate
    is unreliable.

    If a step of the discrete gradient starts and ends at the touching position, it reverses the rate. All runs may
    therefore agree in the sign of this rate, although it is wrong.
    """
    pulls_below = np.full(chain.contacts, -np.inf)
    for i, contact in chain.piecewise:
        pulls_below[i] = contact.pulls_below
    touches = ((end.overlap == 0.0) | (end.overlap == pulls_below)) & (end.force != 0.0)
    rate = np.pad(np.where(touches, np.abs(end.rate), 0.0), 1)
    return np.maximum(rate[:-1], rate[1:])


def _run_on(problem: Problem, start: State, step: float, end: float, times: Array) -> Record:
    """Run `conserving` from `start` to `end`. The step length doubles after every STEPS_ALIKE steps."""
    state, left = start, times
    records: list[Record] = []
    # Each part runs at most STEPS_ALIKE steps; the next part has twice the step length.
    while not records or records[-1].status.gave_up:
        duration = None if np.isinf(end) else end - state.time
        if duration is not None and state.time + duration < end:  # The last sample lies at the end.
            duration = float(np.nextafter(duration, np.inf))
        samples = left if left.size else 2
        part = Problem(
            problem.chain, state.copy(), "conserving", duration, step, samples=samples, most_steps=STEPS_ALIKE
        )
        found = fixed_step.run(part)
        records.append(replace(found, samples=first_samples(found.samples, left.size)))
        left = left[records[-1].samples.time.size :]  # Samples within the last step of the previous part are included.
        state, step = found.end, 2.0 * step
    starts = [start.time, *(record.end.time for record in records[:-1])]
    return records[0] if len(records) == 1 else _in_a_row(problem.chain, starts, records)


def _in_a_row(chain: Chain, starts: list[float], records: list[Record]) -> Record:
    """Join the records of consecutive runs into one record. `starts` contains the start time [s] of each run."""
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
    """Return the (contact, time) pairs of the switches in a run that continues another run at time `start` [s].

    `closed` (n,) contains the contacts that were closed before, and is updated. At its start, a run logs every closed
    contact as closing. A contact that was `closed` before has not switched then. A contact that was closed and is not
    logged has opened.
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
    """Limit the estimated error to the largest error that energy and momentum allow.

    If this limit is below the tolerance, the status of the motion becomes DONE.
    """
    if is_possible(problem.chain, problem.state, max(record.velocity_error.tolist())):
        return
    # Each bead has its own limit. If all limits are below the tolerance, the motion is determined.
    most = largest_error(problem.chain, problem.state, record.end)
    record.velocity_error = np.minimum(record.velocity_error, most)
    if record.status in UNCERTAIN and most.max() <= problem.tolerance * problem.scale:
        record.status = Status.DONE


def _ledger(problem: Problem, record: Record) -> tuple[float, float]:
    """Return the energy [J] of a chain at the start, and the error of the energy [J] at the end.

    Both results are 0 if external work is done on the chain.
    """
    chain, start, end = problem.chain, problem.state, record.end
    # Without external work, the energy must stay constant. With external work, it is not checked.
    wall_moves = chain.walls > 0 and bool((np.isinf(chain.mass) & (problem.velocity != 0.0)).any())
    if wall_moves or chain.forces or start.external(chain) is not None:
        return 0.0, 0.0
    before, after = start.energy(chain, problem.velocity), end.energy(chain, record.velocity)
    absorbed = float((end.absorbed - start.absorbed).sum()) if chain.dissipative else 0.0
    return before, abs(after + absorbed - before)


def _least_error(chain: Chain, energy: float, change: float) -> float:
    """Return an error [m/s] of the bead velocities that can explain the `change` [J] of the `energy` [J].

    Velocity errors up to e change the kinetic energy by at most e times the sum of m abs(v) over all beads. Here
    sqrt(m) abs(v) <= sqrt(2 E) for each bead.
    """
    if not energy > 0.0:
        return 0.0
    return DOUBT * change / (math.sqrt(2.0 * energy) * float(np.sqrt(chain.finite_mass).sum()))


def _unresolved(chain: Chain, change: float) -> float:
    """Return the velocity [m/s] that corresponds to the energy error `change` [J] of a run.

    The result is 0 unless contacts are so soft that they chatter. A cluster of such contacts is nearly rigid.
    Chattering far below the closing speed can be damped equally in every run, so a comparison of runs does not show it.
    The energy of the chattering is at most the error of the energy balance.
    """
    return float(np.sqrt(2.0 * change * chain.inverse_reduced_mass.max())) if _rattles(chain) else 0.0


@per_chain
def _rattles(chain: Chain) -> bool:
    """Return True if contacts are so soft that a cluster of them chatters."""
    return any(preload == 0.0 and exponent < SOFTEST for preload, _, exponent in law_rows(chain).tolist())


def _energy_warning(problem: Problem, error: float) -> CodedWarning:
    sentence = (
        f"energy is off by {error:.1g} of itself, more than {problem.method} promises at tolerance {problem.tolerance:g}: "
        "compare with method 'conserving', or with another tolerance"
    )
    return CodedWarning(WarningCode.ENERGY, sentence, {"error": error})


def _uncertain_warning(record: Record) -> CodedWarning:
    """Return the warning that the end of a motion is less accurate than the tolerance. The warning contains the cause
    and the error.
    """
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
