"""Statements on one collision: Secs. I and II, Figs. 1b to 1d."""

from __future__ import annotations

import numpy as np
from softcradle.physics.analysis.measures import rigidity
from softcradle.sandbox.studies.claims.claim import Claim, verdict_of
from softcradle.sandbox.studies.claims.turning_points import turning_points
from softcradle.sandbox.studies.figures.rigidity_figure import outcome
from softcradle.sandbox.studies.figures.solved_cases import (
    ALPHA,
    SOFTER_ALPHA,
    N,
    full_motion,
    full_one_on,
    soft_chain,
    start_velocity,
)


def rigid_like() -> Claim:
    """Figs. 1c, 1d: the spread of the target velocities."""
    spreads = {alpha: float(rigidity(outcome(N, alpha)[1:])) for alpha in (ALPHA, SOFTER_ALPHA, 1.0 / 20.0)}
    falls = bool((np.diff(list(spreads.values())) < 0.0).all())
    return Claim(
        "rigid-like",
        "the velocities of the targets differ after the collision, the less the smaller alpha",
        "Sec. I, Figs. 1c, 1d",
        "largest less smallest target velocity over the mean: "
        + ", ".join(f"{value:.3g} at 1/{1 / alpha:.0f}" for alpha, value in spreads.items()),
        f"one on {N}, velocities when every contact is open",
        verdict_of(falls and min(spreads.values()) > 0.0),
        {f"1/{1 / alpha:.0f}": value for alpha, value in spreads.items()},
    )


def first_target() -> Claim:
    """Caption of Fig. 1: the target that is hit."""
    first, rest = {}, {}
    for alpha in (ALPHA, SOFTER_ALPHA):
        velocity = outcome(N, alpha)[1:]
        first[alpha], rest[alpha] = float(velocity[1:].mean() - velocity[0]), float(np.ptp(velocity[1:]))
    stands_out = all(first[alpha] > 10.0 * rest[alpha] for alpha in first)
    return Claim(
        "first-target",
        "v1 shows well-visible deviations from the remaining targets, which decrease with alpha",
        "caption of Fig. 1",
        f"v1 is {first[ALPHA]:.3f} below the others at 1/10 and {first[SOFTER_ALPHA]:.3f} at 1/14; these differ "
        f"among themselves by {rest[ALPHA]:.4f} and {rest[SOFTER_ALPHA]:.5f}",
        f"one on {N}, velocities when every contact is open",
        verdict_of(stands_out and first[SOFTER_ALPHA] < first[ALPHA]),
        {
            "first 1/10": first[ALPHA],
            "first 1/14": first[SOFTER_ALPHA],
            "rest 1/10": rest[ALPHA],
            "rest 1/14": rest[SOFTER_ALPHA],
        },
    )


def spread_vanishes() -> Claim:
    """Fig. 3 of the letter, as the caption of Fig. 1 describes it."""
    inverse = np.arange(3.0, 21.0, 0.5)
    spreads = np.array([float(rigidity(outcome(2, 1.0 / k)[1:])) for k in inverse])
    rises = int((np.diff(spreads) > 0.0).sum())
    envelope = spreads * 2.0**inverse
    bounded = bool(spreads[-1] < 1e-5 and envelope[inverse >= 8].max() < 10.0)
    return Claim(
        "spread-vanishes",
        "for n = 2 the deviation decreases with alpha and vanishes as alpha -> 0",
        "caption of Fig. 1, Fig. 3 of ref. [1]",
        f"it vanishes ({spreads[-1]:.1e} at 1/{inverse[-1]:g}), below {envelope[inverse >= 8].max():.1f} * "
        f"2**(-1/alpha) from 1/8 on, but not steadily: it rises in {rises} of {len(inverse) - 1} steps of 0.5 in "
        "1/alpha, as the inner contact comes back in or out of step with the striker leaving",
        "one on two, 1/alpha = 3 ... 20.5",
        verdict_of(bounded and rises == 0, bounded),
        {"last": float(spreads[-1]), "rises": rises, "envelope": float(envelope[inverse >= 8].max())},
    )


def velocity_scales_out() -> Claim:
    """Footnote of Sec. II: the unit of time."""
    chain = soft_chain(N, ALPHA)
    unit = full_motion(chain, start_velocity(chain), samples=2).final_velocity
    difference = 0.0
    for speed in (1e-3, 30.0):
        scaled = full_motion(chain, tuple(speed * v for v in start_velocity(chain)), samples=2).final_velocity / speed
        difference = max(difference, float(np.abs(scaled - unit).max()))
    return Claim(
        "velocity-scales-out",
        "in a uniform chain the velocity of the striker only sets the unit of time: there is no linear regime",
        "footnote of Sec. II",
        f"velocities after the collision, over that of the striker, differ by {difference:.0e} between 1e-3, 1 and 30",
        f"one on {N}, alpha = 1/10",
        verdict_of(difference < 1e-7),
        {"largest difference": difference},
    )


def after_detachment() -> Claim:
    """Sec. IV: the targets after the detachment of the striker."""
    found = full_one_on(N, ALPHA)
    openings = [intervals[0][1] for intervals in found.contact_intervals]
    detachment, end = openings[0], max(openings)
    during = (found.time > 0.0) & (found.time < detachment)
    after = (found.time > detachment) & (found.time < end)
    spread = np.ptp(found.velocity[:, 1:], axis=1)
    pushing = after & (found.time < openings[1])
    falls = bool((np.diff(found.velocity[pushing, 1]) < 0.0).all())
    turns = turning_points(spread[after])
    return Claim(
        "after-detachment",
        "once the striker has left, the overlaps left behind drive the targets apart without oscillation",
        "Sec. IV",
        f"the spread of the targets' velocities is at most {spread[during].max():.3f} while the striker pushes and "
        f"{spread[-1]:.3f} at the end; in between v1 falls steadily and the spread has {turns} turning points",
        f"one on {N}, alpha = 1/10, from t = {detachment:.3f} to {end:.3f}",
        verdict_of(falls and turns <= 1 and spread[-1] > spread[during].max()),
        {"during": float(spread[during].max()), "end": float(spread[-1]), "turns": turns, "falls": float(falls)},
    )


MEASUREMENTS = (rigid_like, first_target, spread_vanishes, velocity_scales_out, after_detachment)
