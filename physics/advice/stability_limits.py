"""Limits of fixed time steps: the longest stable step of explicit methods, and warnings about steps that are too long."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.checked_input import magnitude, require_kind
from softcradle.physics.own_law import OwnLaw
from softcradle.physics.problem import Problem, Record
from softcradle.physics.scales import as_it_pulls, scales_at, shortest_contact, speed_scale
from softcradle.physics.state import checked_velocity
from softcradle.physics.status import CodedWarning, WarningCode, Warnings

Array = NDArray[np.float64]

TRUSTED_ERROR = 1e-2  # Expected error, relative to the closing speed, above which a step gives a warning.
# Smallest number of steps of `conserving` in the shortest contact time. With five steps the velocity errors reach 1 %.
LEAST_STEPS = 6
# Largest number of halvings in the search for a step, which starts with the time to the largest overlap. Shorter steps
# do not matter.
MOST_HALVINGS = 200
# Number of steps between two switches of a contact that count as chatter. A real bounce takes longer.
CHATTER_STEPS = 8
MOST_RETURNS = 6  # Largest number of repeated closings in a run without a warning; see `returning_warnings`.
MOST_CHATTER = 10  # Largest number of chattering switches in a run without a warning.


def stable_step(chain: Chain, velocity: ArrayLike, error: float = 1e-3) -> float:
    """Estimate the longest step [s] at which euler, verlet and yoshida4 stay within `error` of the closing speed.

    Let h be the step, d the overlap, a the exponent, K the stiffness, F the preload and v the closing speed. L is the
    inverse reduced mass of the two beads. A strict stability limit of explicit steps does not exist for a < 1: at small
    overlaps h² L a K d**(a-1) exceeds 4, and the contact chatters. The function returns the shortest of four steps::

        stiffness  h = 2 / sqrt(2 L a K d**(a-1)) at the largest overlap, for a >= 1
        chatter    the same at the overlap whose energy gives the velocity `error`, for a < 1
        onset      the impulse of the step after the touch, h L K (v h)**a, equals `error`
        preload    the impulse of a step, h L F, equals `error`

    The estimate is correct within a small factor. The estimate refers to errors of velocities, not to errors of small
    overlaps deep inside a cluster. The errors of successive collisions add up.

    Parameters
    ----------
    chain : Chain
    velocity : array_like, shape (n+1,)
        Start velocities [m/s].
    error : float, optional
        Wanted error, relative to the closing speed.

    Returns
    -------
    float
        The time step [s].

    Examples
    --------
    >>> from softcradle import hertz, one_on, stable_step
    >>> 0.001 < stable_step(one_on(4, hertz(1.0)), [1, 0, 0, 0, 0]) < 1.0
    True
    """
    require_kind("chain", chain, Chain)
    velocity, error = checked_velocity(chain, velocity), magnitude("error", error)
    speed, pulling = speed_scale(chain, velocity), as_it_pulls(chain)
    longest = _longest_step(chain, speed, error * speed)
    return longest if pulling is None else min(longest, _longest_step(pulling, speed, error * speed))


def _longest_step(chain: Chain, speed: float, small: float) -> float:
    """Return the shortest of the four steps [s] of :func:`stable_step` for contacts that are struck at `speed` [m/s].

    `small` [m/s] is the allowed velocity error.
    """
    preload, stiffness, exponent = chain.law_rows.T
    weight, depth = chain.inverse_reduced_mass, scales_at(chain, speed)[0]
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        chatter = (small**2 / (2.0 * weight * stiffness)) ** (1.0 / (1.0 + exponent))
        at = np.where(exponent < 1.0, chatter, depth)
        stiff = 2.0 / np.sqrt(2.0 * weight * exponent * stiffness * at ** (exponent - 1.0))
        onset = (small / (weight * stiffness * speed**exponent)) ** (1.0 / (1.0 + exponent))
        push = small / (weight * preload)
    for i, law in chain.own_contacts:
        stiff[i], onset[i] = _bounds_of(law, float(weight[i]), speed, small, float(depth[i]))
    for i, contact in chain.piecewise:
        if contact.stop_stiffness:
            stiff[i] = min(stiff[i], 2.0 / math.sqrt(2.0 * weight[i] * contact.stop_stiffness))
    bounds = np.stack([stiff, np.where(stiffness != 0.0, onset, np.inf), push])
    return float(np.nanmin(bounds))


def _bounds_of(law: OwnLaw, weight: float, speed: float, small: float, depth: float) -> tuple[float, float]:
    """Return two limits of the step [s] for a contact with a user-defined law: by stiffness or chatter, and by onset.

    Both limits follow from the force of the law. The slope of the force is evaluated at the largest overlap, and at the
    overlap whose energy corresponds to the velocity `small`. The larger slope is used.
    """
    chatter = law.depth(0.5 * small**2 / weight)
    stiffness = max(law.slope(depth), law.slope(chatter))
    stiff = 2.0 / math.sqrt(2.0 * weight * stiffness) if stiffness > 0.0 else math.inf

    def impulse(power: float) -> float:
        step = 2.0**power
        return step * weight * law.force(min(speed * step, depth)) - small

    longest = math.log2(depth / speed)
    if impulse(longest) <= 0.0:
        return stiff, math.inf
    from scipy.optimize import brentq

    return stiff, float(2.0 ** brentq(impulse, longest - MOST_HALVINGS, longest))


def explicit_warnings(problem: Problem, record: Record) -> Warnings:
    """Return warnings if an explicit method has a step that is too long for `problem`, or if the contacts chatter."""
    found = []
    limit = stable_step(problem.chain, problem.velocity, TRUSTED_ERROR)
    if problem.step > limit:
        sentence = (
            f"{problem.method} with step {problem.step:.3g} s is past its limit of about {limit:.2g} s on this chain: "
            "take a smaller step, or method 'conserving' or 'accurate'"
        )
        found.append(CodedWarning(WarningCode.STEP_LIMIT, sentence, {"step": problem.step, "limit": limit}))
    short = short_switches(record, CHATTER_STEPS * problem.step)
    if short > MOST_CHATTER:
        sentence = (
            f"contacts chatter: {short} switches within {CHATTER_STEPS} steps of {problem.method}; take method "
            "'conserving' or 'accurate', for which touching is a state of its own"
        )
        found.append(CodedWarning(WarningCode.CHATTER, sentence, {"switches": short}))
    return tuple(found)


def returning_warnings(problem: Problem, record: Record) -> Warnings:
    """Return a warning if contacts close again so often that the errors of fixed steps may have become large.

    Each collision multiplies the errors of earlier collisions. The limit was measured with 480 random chains (``python
    -m benchmarks conserving --errors``). Four runs have errors above 1e-3 of the closing speed at the default step, and
    four at four times the default step. Seven of these eight runs have the warning, and so do 29 other runs. Chains
    with friction or loss are excluded, because their errors decay together with the motion.
    """
    again = int(np.maximum(np.bincount(record.switch_contact) - 2, 0).sum()) // 2
    if again <= MOST_RETURNS or problem.chain.dissipative or problem.chain.piecewise:
        return ()
    sentence = (
        f"contacts closed again {again} times: each collision multiplies the errors of the ones before, and velocities by "
        f"{problem.method} may be off by more than 1e-3: compare with half the step, or take method 'accurate'"
    )
    return (CodedWarning(WarningCode.RETURNS, sentence, {"returns": again}),)


def coarse_warnings(problem: Problem) -> Warnings:
    """Return a warning if the step of an unconditionally stable method is too long to resolve the shortest contact."""
    speed = speed_scale(problem.chain, problem.velocity, problem.duration)
    limit = shortest_contact(problem.chain, speed, problem.velocity) / LEAST_STEPS
    if problem.step <= limit:
        return ()
    sentence = (
        f"{problem.method} with step {problem.step:.3g} s is past its limit of about {limit:.2g} s on this chain: a contact "
        "may be over within a few steps; energy holds, velocities may be off: take a smaller step, or method 'accurate'"
    )
    return (CodedWarning(WarningCode.COARSE_STEP, sentence, {"step": problem.step, "limit": limit}),)


def short_switches(record: Record, span: float) -> int:
    """Return the number of contact switches that come less than `span` [s] after the previous switch of the same
    contact.
    """
    order = np.argsort(record.switch_contact, kind="stable")
    contact, time = record.switch_contact[order], record.switch_time[order]
    return int(np.count_nonzero((np.diff(contact) == 0) & (np.diff(time) < span)))
