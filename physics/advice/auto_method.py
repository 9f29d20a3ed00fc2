"""Method "auto": choose a method and its step or tolerance for a chain and a wanted error. Give the reason.

The choice depends only on the chain and the error, not on the machine. Results are therefore bitwise reproducible. The
desktop window uses the same step.

    wanted error >= 1e-3, one collision of known       conserving, 64 steps per shortest contact time at an error
    duration, and few enough steps                     of 1e-3, otherwise scaled as 1/sqrt(error)
    only contacts with preload, or a contact near      radau: most contacts touch, and radau solves them as
    its yield                                          one linear system
    all other cases                                    accurate

The error is the largest error of a final velocity, relative to the closing speed. The tests in tests/physics/advice/
accept three times the wanted error. These tests cover the cases of the table above, chains with other masses and
contact laws, critical speeds, friction and loss.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from softcradle.physics.chain import Chain, mass_shares
from softcradle.physics.scales import scales_at, shortest_contact, speed_scale

# Smallest wanted error for which a single collision uses fixed steps, relative to the closing speed. This error
# corresponds to about one pixel of a plot.
LIVE_ERROR = 1e-3
# Steps of `conserving` per shortest contact time. This number of steps keeps the error below LIVE_ERROR. The error
# falls with the square of the number of steps.
LIVE_STEPS = 64
# Largest number of steps of `conserving` per contact in a collision. With more steps, `conserving` would need several
# times the evaluations of `accurate`.
MOST_LIVE_STEPS = 500
FINEST = 1e-13  # Smallest tolerance that is possible in double precision.
# Tolerance of radau near a critical speed. With a larger tolerance, the steps are so long that they miss a contact that
# yields briefly.
NEAR_CRITICAL = 1e-7
LEAST_RATIO = 0.9  # Ratio of the speed to a critical speed below which no contact inside a cluster yields.
# Ratio of the speed to a critical speed above which the contact yields so long that steps cannot miss it.
MOST_RATIO = 1.15


@dataclass(frozen=True)
class Choice:
    """Method that `simulate` uses for "auto".

    Attributes:
        method: a name from METHODS.
        step: time step [s] of a fixed-step method; 0 for an adaptive one.
        tolerance: tolerance of an adaptive method; 0 for a fixed-step one.
        reason: sentence with the choice and its reason.
    """

    method: str
    step: float
    tolerance: float
    reason: str


def choose(chain: Chain, velocity: ArrayLike, duration: float | None, error: float) -> Choice:
    """Choose the method that simulates `chain` with a wanted `error`, relative to the closing speed.

    `velocity` (n+1,) contains the start velocities [m/s].
    """
    if chain.piecewise:
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
    """Return the time step [s] for the method `conserving` in one collision at the closing speed `speed` [m/s].

    With this step the velocity errors should stay below `error`, relative to the closing speed. `start` has the same
    meaning as in :func:`softcradle.physics.scales.shortest_contact`.
    """
    return shortest_contact(chain, speed, start) / LIVE_STEPS * math.sqrt(error / LIVE_ERROR)


def _collision_time(chain: Chain, speed: float, duration: float | None) -> float:
    """Estimate the time [s] during which contacts push in one collision at the closing speed `speed` [m/s]."""
    return min(math.inf if duration is None else duration, float(scales_at(chain, speed)[1].sum()))


def _why_not_fixed(single: bool, duration: float | None, error: float) -> str:
    """Return the reason why a fixed step is not suitable, as the end of a sentence. `single` is True for a single
    collision.
    """
    if error < LIVE_ERROR:
        return f"below {LIVE_ERROR:g} its steps are fewer than fixed ones"
    if duration is None:
        return "without a duration fixed steps may never see the end"
    if single:
        return "its shortest contact asks for far more fixed steps than the collision for adaptive ones"
    return "gaps, walls, drives and friction make collision after collision, which add up the errors of fixed steps"


def is_single_collision(chain: Chain) -> bool:
    """Return True if the beads touch at the start and are free of drive, friction, loss and walls.

    Otherwise the beads can collide again, and a second collision multiplies the errors of the first.
    """
    return not chain.walls and not chain.driven and not chain.dissipative and not any(chain.gap)


def nearly_yields(chain: Chain, velocity: ArrayLike) -> bool:
    """Return True if a preloaded contact inside a cluster may yield for a moment, because its force comes close to its
    preload.

    The struck contact s pushes with at most ``sqrt(F_s**2 + K_s mu v**2)``. F is the preload, K the stiffness, mu the
    reduced mass of the two sides and v the closing speed. Contact i inside a cluster transmits the share r_i of this
    force (:func:`softcradle.physics.chain.mass_shares`). At the critical speed, this share equals F_i. Above this speed
    the contact yields.
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
