"""Method "auto": the cheapest method and step or tolerance that hold a wanted error on a chain, and the reason in a sentence.

The error of each method is estimated from the chain (below), the cost of a step is measured once a machine
(:mod:`softcradle.physics.advice.step_cost`). The estimates are of the largest error of a final velocity, relative to the closing
speed; they were calibrated on the cases of `softcradle chart`, and tests/physics/advice/ holds them:

    verlet       exponents >= 1, h omega = x:    0.1 x**2
    yoshida4     the same:                       0.02 x**(1+a) + 0.06 x**4
    verlet       exponents below 1:              3 n times the `error` of `stable_step`, which grows with depth
    conserving   exponents below 1 or preload:   a tenth of the `error` of `stable_step`; else 0.15 x**2
    conserving   bed friction or loss:           a tenth of the step in units of the shortest contact time, or the above
    accurate     its tolerance, within a factor of 3
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.advice.stability_limits import stable_step
from softcradle.physics.advice.step_cost import SOFT, Costs, costs, kind_of
from softcradle.physics.chain import Chain, mass_shares
from softcradle.physics.scales import contact_scales

Array = NDArray[np.float64]

FINEST = 1e-13  # tolerance: double precision has no room for a finer one
LEAST_STEPS = 20  # of a fixed-step method in the shortest contact time, so that it resolves every contact
MOST_STEPS = 20_000_000  # of a fixed-step method: one that needs more is no candidate
LOOSE = 1e-5  # wanted error from which on `accurate` on soft contacts is five times as exact as its tolerance
LEAST_UNCHECKED = 1e-9  # tolerance from which on a run that bounces a few times needs no finer run to check it
# tolerance taken instead of one between the two: below 4e-10 such a run is checked by a finer one
ALWAYS_CHECKED = 3.9e-10
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
        seconds: predicted cost.
        reason: the choice, and the candidates that it was made from, in a sentence.
    """

    method: str
    step: float
    tolerance: float
    seconds: float
    reason: str = ""


def choose(
    chain: Chain, velocity: ArrayLike, duration: float | None, error: float, known: Costs | None = None
) -> Choice:
    """The cheapest candidate for `error`, relative to the closing speed; with `known` costs instead of this machine's.

    Raises:
        ValueError: the chain is dissipative and no method holds the error on it.
    """
    price = costs() if known is None else known
    near = not chain.dissipative and nearly_yields(chain, velocity)
    found = sorted(_candidates(chain, velocity, duration, error, price, near), key=lambda choice: choice.seconds)
    if not found:
        raise ValueError(
            f"no method holds an error of {error:g} with friction or loss: ask for a tolerance of 1e-5 or more"
        )
    best = found[0]
    compared = ", ".join(f"{choice.method} {_time(choice.seconds)}" for choice in found)
    fineness = f"step {best.step:.3g} s" if best.step else f"tolerance {best.tolerance:.1g}"
    excluded = _excluded(chain, duration, near)
    reason = f"{best.method}, {fineness}, for a wanted error of {error:g}; expected cost: {compared}{excluded}"
    return Choice(best.method, best.step, best.tolerance, best.seconds, reason)


def _candidates(
    chain: Chain, velocity: ArrayLike, duration: float | None, error: float, price: Costs, near: bool
) -> Iterator[Choice]:
    """The methods that can hold `error`, each at its longest step or loosest tolerance; `near` a critical speed."""
    contacts, kind = chain.contacts, kind_of(chain.power_laws)
    collision = collision_time(chain, velocity)
    span = collision if duration is None else duration
    if chain.dissipative:
        step = _dissipative_step(chain, velocity, error)
        if span / step <= MOST_STEPS / contacts:
            yield Choice("conserving", step, 0.0, price["conserving", kind].of(span / step, contacts))
        return
    if near:
        tolerance = max(min(0.5 * error, NEAR_CRITICAL), FINEST)
        yield Choice("radau", 0.0, tolerance, price["accurate", SOFT].of(accurate_steps(chain, tolerance), contacts))
        return
    tolerance = accurate_tolerance(chain, error)
    steps = accurate_steps(chain, tolerance) * max(min(1.0, span / collision), 0.05)
    gears = all(law.preload > 0.0 for law in chain.power_laws)  # most of them touch, and are one linear system to radau
    yield Choice("radau" if gears else "accurate", 0.0, tolerance, price["accurate", kind].of(steps, contacts))
    if duration is None or not is_single_collision(chain):
        return
    for method, step in _fixed_steps(chain, velocity, span, error):
        count = max(span / step, 1.0)
        if math.isfinite(count) and count <= MOST_STEPS:
            yield Choice(method, step, 0.0, price[method, kind].of(count, contacts))


def _fixed_steps(chain: Chain, velocity: ArrayLike, span: float, error: float) -> Iterator[tuple[str, float]]:
    """Each fixed-step method that suits the chain, and the step [s] at which it is expected to hold `error`."""
    preload, _, exponent = chain.parameters.law.T
    most = float(contact_scales(chain, velocity)[1].min()) / LEAST_STEPS
    if (preload == 0.0).all() and (exponent >= 1.0).all():
        omega, power = _largest_rate(chain, velocity), 1.0 + float(exponent.min())
        cut = span < collision_time(chain, velocity)  # errors of phase count where a run ends amid the motion
        late = 1.0 + (0.1 * omega * span if cut else 0.0)
        high_order = min((error / (0.04 * late)) ** (1 / power), (error / (0.12 * late)) ** 0.25)
        yield "verlet", min(most, math.sqrt(error / (0.1 * late)) / omega)
        yield "yoshida4", min(most, high_order / omega)
        yield "conserving", min(most, math.sqrt(error / (0.15 * late)) / omega)
        return
    if (preload == 0.0).all():
        yield "verlet", min(most, stable_step(chain, velocity, error / (3.0 * chain.contacts)))
    yield "conserving", min(most, stable_step(chain, velocity, min(10.0 * error, 0.1)))


def nearly_yields(chain: Chain, velocity: ArrayLike) -> bool:
    """Whether a preloaded contact inside a cluster comes so near its preload that it may yield for a moment only.

    The struck contact s pushes with at most ``sqrt(F_s**2 + K_s mu v**2)``, and contact i inside a cluster passes on the share
    r_i of it (:func:`softcradle.physics.chain.mass_shares`). It yields above the speed at which this equals F_i.
    """
    preload, stiffness, _ = chain.parameters.law.T
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


def _dissipative_step(chain: Chain, velocity: ArrayLike, error: float) -> float:
    """Step [s] of `conserving` with friction or loss: a step in which a contact reverses is of first order."""
    contact_time = float(contact_scales(chain, velocity)[1].min())
    limit = stable_step(chain, velocity, min(10.0 * error, 0.1))
    return min(contact_time / LEAST_STEPS, 10.0 * error * contact_time, limit)


def is_single_collision(chain: Chain) -> bool:
    """Whether the beads touch at the start and nothing else acts on them, as the estimates of fixed steps suppose.

    A second collision multiplies the errors of the first, and a wall sends every bead back.
    """
    return not chain.walls and not chain.driven and not chain.dissipative and not any(chain.gap)


def _excluded(chain: Chain, duration: float | None, near: bool) -> str:
    """Why other methods are no candidates, as the end of a sentence; empty where all are."""
    if chain.dissipative:
        return "; with friction or loss the others cost more"
    if near:
        return "; the others step over a contact that yields for a moment, as it may near this critical speed"
    if duration is None:
        return "; fixed steps are left out: without a duration they may never see the end"
    if not is_single_collision(chain):
        return "; fixed steps are left out: gaps, walls and drives make collision after collision"
    if any(law.preload > 0.0 for law in chain.power_laws):
        return "; explicit steps are left out: a contact with preload chatters"
    return ""


def accurate_tolerance(chain: Chain, error: float) -> float:
    """Tolerance at which `accurate` is expected to hold `error`.

    Soft contacts that bounce three to six times are checked by a finer run at tolerances below 4e-10 alone; up to 1e-9 one
    run in some hundred of one on 5 at alpha = 1/14 misses by 10 to 30 tolerances.
    """
    soft = all(law.preload == 0.0 and law.exponent < 1.0 for law in chain.power_laws)
    factor = 2.0 if soft and error >= LOOSE else 0.5
    tolerance = max(factor * error, FINEST)
    return ALWAYS_CHECKED if ALWAYS_CHECKED < tolerance < LEAST_UNCHECKED else tolerance


def accurate_steps(chain: Chain, tolerance: float) -> float:
    """Steps that `accurate` is expected to take for one collision."""
    if any(law.preload == 0.0 and law.exponent < 1.0 for law in chain.power_laws):
        return (15.0 + 2.0 * chain.contacts) * (tolerance / 1e-2) ** -0.16
    return (5.0 + 1.6 * chain.contacts) * (tolerance / 1e-3) ** -0.135


def collision_time(chain: Chain, velocity: ArrayLike) -> float:
    """Time [s] that a collision is expected to take: a wave crosses the chain, or a rigid-like cluster turns back."""
    preload, _, exponent = chain.parameters.law.T
    contact_time = float(contact_scales(chain, velocity)[1].max())
    waves = ((preload == 0.0) & (exponent >= 1.0)).mean() * (chain.contacts - 1)
    return contact_time * (1.5 + float(waves))


def _largest_rate(chain: Chain, velocity: ArrayLike) -> float:
    """Largest rate [1/s] of a contact pressed alone to the depth that the closing speed allows: sqrt(L_ii a K d**(a-1))."""
    _, stiffness, exponent = chain.parameters.law.T
    depth = contact_scales(chain, velocity)[0]
    squares = chain.inverse_reduced_mass * exponent * stiffness * depth ** (exponent - 1.0)
    return float(np.sqrt(squares).max())


def _time(seconds: float) -> str:
    return f"{1e3 * seconds:.2g} ms" if seconds < 1.0 else f"{seconds:.2g} s"
