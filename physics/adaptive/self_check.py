"""Self-check of adaptive methods: where a motion is sensitive, other runs of a slightly different chain must agree."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.adaptive.constants import ROUND_OFF, TOLERANCE_PART
from softcradle.physics.adaptive.step_records import ERROR_EXPONENT, RADAU
from softcradle.physics.adaptive.undetermined import DOUBT, MOST_GROWN, confirmed_error
from softcradle.physics.adaptive.usual_budget import STEPS_A_CONTACT, usual_steps
from softcradle.physics.chain import Chain
from softcradle.physics.problem import Problem, Record
from softcradle.physics.status import Status

Array = NDArray[np.float64]
EPSILON = float(np.finfo(np.float64).eps)

FINER = 10.0  # ratio of the tolerances of successive runs; errors of so many tolerances are promised
# growth of errors beyond which another run may agree by chance: two finer ones have to confirm such a motion
MOST_TRUSTED = FINER**3
# Times the steps of a run that the order of radau asks for in one as much finer. A finer one that takes more of them may follow
# what the other damped: a coarser run then confirms nothing, and with the square of it a finer one neither.
ALIKE = FINER ** ERROR_EXPONENT[RADAU]
# tolerance: nothing finer is promised, for round-off decides; the stated error tells how far it goes
LEAST_PROMISED = 1e-11


def checked(problem: Problem, record: Record, scale: float, complete: Callable[[Problem], Record]) -> Record:
    """The record, if its errors hardly grow or another run of a slightly different chain agrees with it; else a finer one.

    The other run is a coarser one, which takes the fewest steps: where it ends within half of what is promised of the record, the
    latter is off by less than that, as a rule by far. Where it does not, finer ones decide. `scale` is the velocity [m/s] that
    the tolerance is relative to; `complete` runs a problem by the same method.
    """
    if record.growth <= MOST_GROWN or record.warnings:
        return record
    if record.growth > MOST_TRUSTED:
        return _finer(problem, record, scale, complete)
    coarse = _shaken_run(problem, FINER * problem.tolerance, 0)
    coarser = complete(replace(coarse, samples=2, later=False, most_steps=2 * record.steps + STEPS_A_CONTACT))
    apart = np.abs(coarser.end.velocity(problem.chain) - record.end.velocity(problem.chain))
    promised = FINER * max(problem.tolerance, LEAST_PROMISED) * scale
    if coarser.warnings or record.steps > ALIKE * coarser.steps or not apart.max() <= 0.5 * promised:
        return _with_cost_of(_finer(problem, record, scale, complete), coarser)
    return replace(_with_cost_of(record, coarser), velocity_error=DOUBT * apart + confirmed_error(record))


def _finer(problem: Problem, record: Record, scale: float, complete: Callable[[Problem], Record]) -> Record:
    """The first record with which a finer one agrees, or the finest, which is undetermined.

    The usual budget bounds the steps of each finer run, and those of all runs before another is tried.
    """
    allowed = max(problem.tolerance, LEAST_PROMISED) * scale
    tolerance, runs, confirmed, usual, steps = problem.tolerance, 0, 0, usual_steps(problem, scale), record.steps
    while not record.warnings:
        tolerance, runs = max(tolerance / FINER, ROUND_OFF), runs + 1
        finest = tolerance < 2.0 * ROUND_OFF  # a run as fine as another agrees with it, whatever both are off by
        budget = min(int(FINER * (record.steps + STEPS_A_CONTACT)), usual)
        finer = complete(replace(_shaken_run(problem, tolerance, runs), budget=budget))
        apart = np.abs(finer.end.velocity(problem.chain) - record.end.velocity(problem.chain))
        error, agrees = DOUBT * apart + confirmed_error(finer), apart.max() <= allowed
        if finer.status == Status.UNDETERMINED:
            return _undetermined(_with_cost_of(record, finer), error)
        confirmed = confirmed + 1 if agrees and finer.steps <= ALIKE**2 * steps else 0
        if confirmed >= (2 if finer.growth > MOST_TRUSTED else 1):
            return replace(_with_cost_of(record, finer), velocity_error=error)
        steps, record = finer.steps, replace(_with_cost_of(finer, record), velocity_error=error)
        if finest or record.steps + finer.steps > usual:
            if apart.max() > FINER * allowed:
                return _undetermined(record, error)
            # what its budget leaves unconfirmed may be off by more than the difference
            return record if finest or agrees else replace(record, velocity_error=FINER * error)
    return record


def _shaken_run(problem: Problem, tolerance: float, runs: int) -> Problem:
    """The problem at another tolerance, of a chain that differs by a part of it.

    Steps between sharp events are the same at all tolerances, so two runs of one chain are off alike; and so are two that are
    shaken alike: this goes to and fro with the number of `runs` so far.
    """
    chain, state = _shaken(problem.chain, (-1) ** runs * TOLERANCE_PART * tolerance), problem.state.copy()
    state.rate *= _up_and_down(runs * EPSILON, state.rate.size)
    return replace(problem, tolerance=tolerance, chain=chain, state=state)


def _undetermined(record: Record, error: Array) -> Record:
    return replace(record, status=Status.UNDETERMINED, velocity_error=error)


def _with_cost_of(record: Record, other: Record) -> Record:
    return replace(
        record,
        steps=record.steps + other.steps,
        evaluations=record.evaluations + other.evaluations,
        seconds=record.seconds + other.seconds,
    )


def _shaken(chain: Chain, part: float) -> Chain:
    """The chain with masses that differ by a part of them: so do all accelerations, whatever the laws."""
    return replace(chain, mass=tuple((np.array(chain.mass) * _up_and_down(part, len(chain.mass))).tolist()))


def _up_and_down(part: float, size: int) -> Array:
    """(size,) factors 1 + part, 1 - part, 1 + part, ..."""
    factors: Array = np.resize([1.0 + part, 1.0 - part], size)
    return factors
