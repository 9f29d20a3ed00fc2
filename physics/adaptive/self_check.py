"""Self-check of adaptive methods: where a motion is sensitive, finer runs of a slightly different chain must agree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.problem import Pass, Problem, Record, run_to_end
from softcradle.physics.status import CodedWarning, WarningCode

Array = NDArray[np.float64]

FEW_BOUNCES = 6  # of one contact: a motion with more is sensitive
TIGHT = 4e-10  # tolerance below which errors have more decades to grow through,
FEWER_BOUNCES = 3  # of one contact: the limit below TIGHT
LEAST_CHECKED = 1e-11  # tolerance: at and below it round-off decides, and no run is checked
FINER = 10.0  # ratio of the tolerances of successive runs
FINEST = 1e-13  # tolerance: double precision has no room for a finer one
MOST_APART = 9.0  # tolerances: two runs that end further apart give a warning; within one they agree
MOST_CHECKING = 50_000  # steps of all runs of one motion, before no finer run is tried
FORCE_SHAKE = (
    0.1  # of the tolerance of a finer run: the relative change of its forces, for runs of like steps err alike
)
RATE_SHAKE = (
    1e-15  # times the number of the finer run: the relative change of its rates, which shows chaos by round-off
)


def is_sensitive(problem: Problem, record: Record) -> bool:
    """True where errors of single steps may grow: a contact bounces often, or a steady push brings it back to zero overlap,
    where a change d of the overlap is one of sqrt(d) in velocity."""
    if problem.tolerance <= LEAST_CHECKED:
        return False
    switches = np.bincount(record.switch_contact, minlength=1)
    few = FEWER_BOUNCES if problem.tolerance < TIGHT else FEW_BOUNCES
    soft = any(contact.preload == 0.0 and contact.exponent < 1.0 for contact in problem.chain.contact)
    driven = problem.state.external(problem.chain) is not None
    return int(switches.max()) > 2 * few or (driven and soft)


def checked(problem: Problem, record: Record, scale: float, run_pass: Pass) -> Record:
    """The first record with which a finer one of a slightly different chain agrees, or the finest, with a warning.

    `scale` is the velocity [m/s] that the tolerance is relative to; `run_pass` one run of the method, see `run_to_end`.
    """
    allowed = problem.tolerance * scale
    tolerance, runs = problem.tolerance, 0
    while not record.warnings:
        tolerance, runs = max(tolerance / FINER, FINEST), runs + 1
        chain, state = _shaken(problem.chain, FORCE_SHAKE * tolerance), problem.state.copy()
        state.rate *= _up_and_down(runs * RATE_SHAKE, state.rate.size)
        finer = run_to_end(replace(problem, tolerance=tolerance, chain=chain, state=state), run_pass)
        ends = finer.end.velocity(problem.chain), record.end.velocity(problem.chain)
        apart = float(np.abs(ends[0] - ends[1]).max())
        if apart <= allowed:
            return _with_cost_of(record, finer)
        record = _with_cost_of(finer, record)
        if tolerance <= FINEST or record.steps > MOST_CHECKING:
            if apart > MOST_APART * allowed:
                record.warnings += (_sensitive(problem, tolerance, apart),)
            break
    return record


def _with_cost_of(record: Record, other: Record) -> Record:
    return replace(
        record,
        steps=record.steps + other.steps,
        evaluations=record.evaluations + other.evaluations,
        seconds=record.seconds + other.seconds,
    )


def _shaken(chain: Chain, part: float) -> Chain:
    """The chain with forces that differ by a part of them."""
    contacts = [
        replace(contact, preload=contact.preload * factor, stiffness=contact.stiffness * factor)
        for contact, factor in zip(chain.contact, _up_and_down(part, chain.contacts), strict=True)
    ]
    return replace(chain, contact=tuple(contacts))


def _up_and_down(part: float, size: int) -> Array:
    """(size,) factors 1 + part, 1 - part, 1 + part, ..."""
    factors: Array = np.resize([1.0 + part, 1.0 - part], size)
    return factors


def _sensitive(problem: Problem, tolerance: float, apart: float) -> CodedWarning:
    sentence = (
        f"the motion is so sensitive that {problem.method} at tolerance {tolerance:g} still moves final velocities by "
        f"{apart:.1g} m/s, more than {problem.tolerance:g} promises: take a looser tolerance, or method 'conserving'"
    )
    return CodedWarning(WarningCode.SENSITIVE, sentence, {"apart": apart, "tolerance": tolerance})
