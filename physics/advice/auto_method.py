"""Method "auto": a rule from the chain and the wanted error to a method and its step or tolerance, with the reason in a sentence.

The same chain and error give the same choice, and so the same digits, on every machine. The window takes the same step.

    error >= 1e-3, one collision of known duration,    conserving, 64 steps to the shortest contact at 1e-3, more as 1/sqrt(error)
    and not too many steps of its shortest contact
    contacts with preload only, or near their yield     radau: most contacts touch, and are one linear system to it
    all else                                            accurate

Errors are the largest of a final velocity, relative to the closing speed. tests/physics/advice/ holds three times the wanted
error over the cases of the chart, chains of other masses and laws, critical speeds, friction and loss.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from softcradle.physics.chain import Chain, mass_shares
from softcradle.physics.scales import scales_at, shortest_contact, speed_scale

LIVE_ERROR = 1e-3  # of final velocities: about a pixel of a plot; from it on a collision takes fixed steps
LIVE_STEPS = 64  # of `conserving` in the shortest contact: they hold LIVE_ERROR, and their error falls as their square
# Steps of `conserving` for each contact of a collision. More take several times the evaluations of `accurate`.
MOST_LIVE_STEPS = 500
FINEST = 1e-13  # tolerance: double precision has no room for a finer one
NEAR_CRITICAL = 1e-7  # tolerance of radau near a critical speed: longer steps miss a contact that yields for a moment
LEAST_RATIO = 0.9  # of the speed to a critical speed: below it no contact inside a cluster yields
MOST_RATIO = 1.15  # of the speed to a critical speed: above it the contact yields for so long that no step misses it


@dataclass(frozen=True)
class Choice:
    """The method that `simulate` takes for "auto".

    Attributes:
        method: a name from METHODS.
        step: step [s] of a fixed-step method, 0 for an adaptive one.
        tolerance: tolerance of an adaptive method, 0 for a fixed-step one.
        reason: the choice and why, in a sentence.
    """

    method: str
    step: float
    tolerance: float
    reason: str


def choose(chain: Chain, velocity: ArrayLike, duration: float | None, error: float) -> Choice:
    """The method for `error`, relative to the closing speed, on `chain` from `velocity` (n+1,) [m/s]."""
    if chain.couplers:
        return _adaptive("accurate", error, error, "couplers close, yield and pull at events that it ends its steps at")
    if not (chain.dissipative or chain.own_laws) and nearly_yields(chain, velocity):
        return _adaptive(
            "radau", min(error, 2.0 * NEAR_CRITICAL), error, "a contact may yield for a moment near this critical speed"
        )
    single = duration is not None and is_single_collision(chain)
    if error >= LIVE_ERROR and single:
        speed = speed_scale(chain, velocity)
        step = conserving_step(chain, speed, error, velocity)
        if _collision_time(chain, speed, duration) <= MOST_LIVE_STEPS * chain.contacts * step:
            reason = f"conserving, step {step:.3g} s, for a wanted error of {error:g}: energy and momentum are exact at any step"
            return Choice("conserving", step, 0.0, reason)
    if all(law.preload > 0.0 for law in chain.contact):
        return _adaptive("radau", error, error, "contacts with preload touch, and are one linear system to it")
    return _adaptive("accurate", error, error, _why_not_fixed(single, duration, error))


def _adaptive(method: str, tolerance: float, error: float, why: str) -> Choice:
    tolerance = max(0.5 * tolerance, FINEST)
    return Choice(
        method, 0.0, tolerance, f"{method}, tolerance {tolerance:.1g}, for a wanted error of {error:g}: {why}"
    )


def conserving_step(chain: Chain, speed: float, error: float = LIVE_ERROR, start: ArrayLike | None = None) -> float:
    """Return the step [s] with which `conserving` should hold `error` in one collision at the closing speed `speed` [m/s].

    `start` as in :func:`softcradle.physics.scales.shortest_contact`.
    """
    return shortest_contact(chain, speed, start) / LIVE_STEPS * math.sqrt(error / LIVE_ERROR)


def _collision_time(chain: Chain, speed: float, duration: float | None) -> float:
    """Return an estimate of the time [s] in which contacts push, in one collision at the closing speed `speed` [m/s]."""
    return min(math.inf if duration is None else duration, float(scales_at(chain, speed)[1].sum()))


def _why_not_fixed(single: bool, duration: float | None, error: float) -> str:
    """Return why no fixed step is taken, as the end of a sentence. `single` is True for a single collision."""
    if error < LIVE_ERROR:
        return f"below {LIVE_ERROR:g} its steps are fewer than fixed ones"
    if duration is None:
        return "without a duration fixed steps may never see the end"
    if single:
        return "its shortest contact asks for far more fixed steps than the collision for adaptive ones"
    return "gaps, walls, drives and friction make collision after collision, which add up the errors of fixed steps"


def is_single_collision(chain: Chain) -> bool:
    """Whether the beads touch at the start and nothing else acts on them.

    A second collision multiplies the errors of the first, and a wall sends every bead back.
    """
    return not chain.walls and not chain.driven and not chain.dissipative and not any(chain.gap)


def nearly_yields(chain: Chain, velocity: ArrayLike) -> bool:
    """Whether a preloaded contact inside a cluster comes so near its preload that it may yield for a moment only.

    The struck contact s pushes with at most ``sqrt(F_s**2 + K_s mu v**2)``, and contact i inside a cluster passes on the share
    r_i of it (:func:`softcradle.physics.chain.mass_shares`). It yields above the speed at which this equals F_i.
    """
    preload, stiffness, _ = chain.law_rows.T
    speed = -np.diff(np.asarray(velocity, dtype=np.float64))
    struck = int(np.argmax(speed))
    if chain.walls or preload[struck] == 0.0 or stiffness[struck] == 0.0 or speed[struck] <= 0.0:
        return False
    first, second = sum(chain.mass[: struck + 1]), sum(chain.mass[struck + 1 :])
    above = stiffness[struck] * first * second / (first + second) * speed[struck] ** 2 / preload[struck] ** 2
    share = np.delete(mass_shares(chain.mass, struck), struck)
    needed = (np.delete(preload, struck) / (share * preload[struck])) ** 2 - 1.0
    ratio = np.sqrt(above / needed[needed > 0.0])
    return bool(((ratio > LEAST_RATIO) & (ratio < MOST_RATIO)).any())
