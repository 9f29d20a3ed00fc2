"""Runs of adaptive methods that ask finer ones whether they agree, where a motion is sensitive."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.problem import Pass, Problem, Record, run_to_end

Array = NDArray[np.float64]

FEW_BOUNCES = 6  # of a contact; where one bounces more often, a finer run is asked whether it agrees
TIGHT, FEWER_BOUNCES = 4e-10, 3  # and at tolerances below, where errors have more decades to grow through
CONFIRMED = 1e-11  # finer than that nothing is confirmed: round-off has a say
FINER, FINEST = 10.0, 1e-13  # so much finer, and the finest tolerance there is a use for
MOST_APART = 9.0  # tolerances: two runs that lie further apart at the end are told of; within one they agree
MOST_CONFIRMING = 50_000  # steps of all runs of one motion: no finer run beyond
SHAKEN = 0.1  # of its tolerance: so much the forces of a finer run differ, for runs of like steps have like errors
NUDGE = 1e-15  # times which finer run it is: so much its rates do, for motions that make much of round-off


def is_sensitive(problem: Problem, record: Record) -> bool:
    """True where errors of single steps may grow: a contact bounces often, or a steady push brings it back to zero overlap,
    where a change d of the overlap is one of sqrt(d) in velocity."""
    if problem.tolerance <= CONFIRMED:
        return False
    switches = np.bincount(record.switch_contact, minlength=1)
    few = FEWER_BOUNCES if problem.tolerance < TIGHT else FEW_BOUNCES
    soft = any(contact.preload == 0.0 and contact.exponent < 1.0 for contact in problem.chain.contact)
    driven = problem.state.external(problem.chain) is not None
    return int(switches.max()) > 2 * few or (driven and soft)


def confirmed(problem: Problem, record: Record, scale: float, run_pass: Pass) -> Record:
    """The first record with which a finer one of a chain that hardly differs agrees, or one that says that there is none.

    `scale` is the velocity [m/s] that the tolerance is relative to; `run_pass` one run of the method, see `run_to_end`.
    """
    allowed = problem.tolerance * scale
    tolerance, runs = problem.tolerance, 0
    while not record.warnings:
        tolerance, runs = max(tolerance / FINER, FINEST), runs + 1
        chain, state = _shaken(problem.chain, SHAKEN * tolerance), problem.state.copy()
        state.rate *= _up_and_down(runs * NUDGE, state.rate.size)
        finer = run_to_end(replace(problem, tolerance=tolerance, chain=chain, state=state), run_pass)
        ends = finer.end.velocity(problem.chain), record.end.velocity(problem.chain)
        apart = float(np.abs(ends[0] - ends[1]).max())
        if apart <= allowed:
            return _with_cost_of(record, finer)
        record = _with_cost_of(finer, record)
        if tolerance <= FINEST or record.steps > MOST_CONFIRMING:
            if apart > MOST_APART * allowed:
                record.warnings += (_apart(problem, tolerance, apart),)
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


def _apart(problem: Problem, tolerance: float, apart: float) -> str:
    return (
        f"the motion is so sensitive that {problem.method} at tolerance {tolerance:g} still moves final velocities by "
        f"{apart:.1g} m/s, more than {problem.tolerance:g} promises: take a looser tolerance, or method 'conserving'"
    )
