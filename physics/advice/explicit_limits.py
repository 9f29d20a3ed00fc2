"""How far an explicit method can be trusted on a chain: an estimate of its step, and the signs of its failure."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.problem import Problem, Record
from softcradle.physics.scales import contact_scales, speed_scale
from softcradle.physics.status import CodedWarning, WarningCode, Warnings

Array = NDArray[np.float64]

TRUSTED_ERROR = 1e-2  # of the closing speed: what a step beyond `stable_step` may get wrong before it is reported
LEAST_STEPS = 6  # to the shortest contact, for `conserving`: at five its velocities are off by a hundredth
SHORT_STEPS = 8  # a contact that switches twice within so many steps chatters; a true bounce takes longer
MOST_SHORT = 10  # such switches a run may have unreported


def stable_step(chain: Chain, velocity: ArrayLike, error: float = 1e-3) -> float:
    """Longest step [s] at which euler, verlet and yoshida4 stay within `error` of the closing speed: an estimate.

    Explicit steps h have no strict limit of stability for an exponent a < 1: h² L a K d**(a-1) exceeds 4 as d -> 0, and
    the contact chatters at the overlap d where it does. Four things bound the step, of which the shortest is returned:

        stiffness    h = 2 / sqrt(2 L a K d**(a-1)) at the largest overlap, for a >= 1
        chatter      the same at the overlap whose energy gives the velocity `error`, for a < 1
        onset        the impulse of a step after the touch, h L K (v h)**a, is `error`
        preload      the impulse of a step, h L F, is `error`

    Arguments: `velocity` (n+1,) [m/s] at the start; `error` relative to the closing speed. It is within a factor of a few,
    and an error of the velocities, not of deep overlaps; a chain that collides many times adds its errors up.

    >>> from softcradle import hertz, one_on, stable_step
    >>> 0.001 < stable_step(one_on(4, hertz(1.0)), [1, 0, 0, 0, 0]) < 1.0
    True
    """
    preload, stiffness, exponent = chain.parameters.law.T
    inverse_mass = chain.parameters.inverse_mass
    weight = inverse_mass[:-1] + inverse_mass[1:]
    speed = speed_scale(chain, velocity)
    small = error * speed
    depth = contact_scales(chain, velocity)[0]
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        chatter = (small**2 / (2.0 * weight * stiffness)) ** (1.0 / (1.0 + exponent))
        at = np.where(exponent < 1.0, chatter, depth)
        stiff = 2.0 / np.sqrt(2.0 * weight * exponent * stiffness * at ** (exponent - 1.0))
        onset = (small / (weight * stiffness * speed**exponent)) ** (1.0 / (1.0 + exponent))
        push = small / (weight * preload)
    bounds = np.stack([stiff, np.where(stiffness > 0.0, onset, np.inf), push])
    return float(np.nanmin(bounds))


def explicit_warnings(problem: Problem, record: Record) -> Warnings:
    """What shows that an explicit method has failed on `problem`, with what to use instead."""
    found = []
    limit = stable_step(problem.chain, problem.state.velocity(problem.chain), TRUSTED_ERROR)
    if problem.step > limit:
        sentence = (
            f"{problem.method} with step {problem.step:.3g} s is past its limit of about {limit:.2g} s on this chain: "
            "take a smaller step, or method 'conserving' or 'accurate'"
        )
        found.append(CodedWarning(WarningCode.STEP_LIMIT, sentence, {"step": problem.step, "limit": limit}))
    short = short_switches(record, SHORT_STEPS * problem.step)
    if short > MOST_SHORT:
        sentence = (
            f"contacts chatter: {short} switches within {SHORT_STEPS} steps of {problem.method}; take method "
            "'conserving' or 'accurate', for which touching is a state of its own"
        )
        found.append(CodedWarning(WarningCode.CHATTER, sentence, {"switches": short}))
    return tuple(found)


def coarse_warnings(problem: Problem) -> Warnings:
    """A warning where a fixed step that is always stable is too long to see the shortest contact."""
    limit = float(contact_scales(problem.chain, problem.state.velocity(problem.chain))[1].min()) / LEAST_STEPS
    if problem.step <= limit:
        return ()
    sentence = (
        f"{problem.method} with step {problem.step:.3g} s is past its limit of about {limit:.2g} s on this chain: a contact "
        "may be over within a few steps; energy holds, velocities may be off: take a smaller step, or method 'accurate'"
    )
    return (CodedWarning(WarningCode.COARSE_STEP, sentence, {"step": problem.step, "limit": limit}),)


def short_switches(record: Record, span: float) -> int:
    """Switches that follow the one before of the same contact within `span` [s]."""
    order = np.argsort(record.switch_contact, kind="stable")
    contact, time = record.switch_contact[order], record.switch_time[order]
    return int(np.count_nonzero((np.diff(contact) == 0) & (np.diff(time) < span)))
