"""Statements on one collision: Secs. I and II, Figs. 1b to 1d."""

from __future__ import annotations

import numpy as np
from softcradle.physics.analysis.measures import rigidity
from softcradle.sandbox.studies.claims import Claim, judged
from softcradle.sandbox.studies.figures.rigidity_figure import outcome
from softcradle.sandbox.studies.figures.solved_cases import ALPHA, SOFTER, N, soft, solved, start


def rigid_like() -> Claim:
    """Figs. 1c, 1d."""
    spreads = {alpha: float(rigidity(outcome(N, alpha)[1:])) for alpha in (ALPHA, SOFTER, 1.0 / 20.0)}
    falls = bool((np.diff(list(spreads.values())) < 0.0).all())
    return Claim(
        "rigid-like",
        "the velocities of the targets differ after the collision, the less the smaller alpha",
        "Sec. I, Figs. 1c, 1d",
        "largest less smallest target velocity over the mean: "
        + ", ".join(f"{value:.3g} at 1/{1 / alpha:.0f}" for alpha, value in spreads.items()),
        f"one on {N}, velocities when every contact is open",
        judged(falls and min(spreads.values()) > 0.0),
        {f"1/{1 / alpha:.0f}": value for alpha, value in spreads.items()},
    )


def first_target() -> Claim:
    """Figs. 1c, 1d: the bead that is hit."""
    first, rest = {}, {}
    for alpha in (ALPHA, SOFTER):
        velocity = outcome(N, alpha)[1:]
        first[alpha], rest[alpha] = float(velocity[1:].mean() - velocity[0]), float(np.ptp(velocity[1:]))
    stands_out = all(first[alpha] > 10.0 * rest[alpha] for alpha in first)
    return Claim(
        "first-target",
        "v1 shows well-visible deviations from the remaining targets, which decrease with alpha",
        "caption of Fig. 1",
        f"v1 is {first[ALPHA]:.3f} below the others at 1/10 and {first[SOFTER]:.3f} at 1/14; these differ among "
        f"themselves by {rest[ALPHA]:.4f} and {rest[SOFTER]:.5f}",
        f"one on {N}, velocities when every contact is open",
        judged(stands_out and first[SOFTER] < first[ALPHA]),
        {"first 1/10": first[ALPHA], "first 1/14": first[SOFTER], "rest 1/10": rest[ALPHA], "rest 1/14": rest[SOFTER]},
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
        f"2**(-1/alpha) "
        f"from 1/8 on, but not steadily: it rises in {rises} of {len(inverse) - 1} steps of 0.5 in 1/alpha, as the "
        f"inner "
        "contact comes back in or out of step with the striker leaving",
        "one on two, 1/alpha = 3 ... 20.5",
        judged(bounded and rises == 0, bounded),
        {"last": float(spreads[-1]), "rises": rises, "envelope": float(envelope[inverse >= 8].max())},
    )


def velocity_scales_out() -> Claim:
    """Footnote of Sec. II."""
    chain = soft(N, ALPHA)
    unit = solved(chain, start(chain), samples=2).final_velocity
    off = 0.0
    for speed in (1e-3, 30.0):
        fast = solved(chain, tuple(speed * v for v in start(chain)), samples=2).final_velocity / speed
        off = max(off, float(np.abs(fast - unit).max()))
    return Claim(
        "velocity-scales-out",
        "in a uniform chain the velocity of the striker only sets the unit of time: there is no linear regime",
        "footnote of Sec. II",
        f"velocities after the collision, over that of the striker, differ by {off:.0e} between 1e-3, 1 and 30",
        f"one on {N}, alpha = 1/10",
        judged(off < 1e-7),
        {"largest difference": off},
    )


def after_detachment() -> Claim:
    """Sec. IV, rigid body during and after the collision."""
    chain = soft(N, ALPHA)
    found = solved(chain, start(chain))
    leaves, ends = found.contact_intervals[0][0][1], max(span[0][1] for span in found.contact_intervals)
    during = (found.time > 0.0) & (found.time < leaves)
    after = (found.time > leaves) & (found.time < ends)
    spread = np.ptp(found.velocity[:, 1:], axis=1)
    pushing = after & (found.time < found.contact_intervals[1][0][1])
    falls = bool((np.diff(found.velocity[pushing, 1]) < 0.0).all())
    turns = int((np.diff(np.sign(np.diff(spread[after]))) != 0).sum())
    return Claim(
        "after-detachment",
        "once the striker has left, the overlaps left behind drive the targets apart without oscillation",
        "Sec. IV",
        f"the spread of the targets' velocities is at most {spread[during].max():.3f} while the striker pushes and "
        f"{spread[-1]:.3f} at the end; on the way v1 falls steadily and the spread turns {turns} times",
        f"one on {N}, alpha = 1/10, from t = {leaves:.3f} to {ends:.3f}",
        judged(falls and turns <= 1 and spread[-1] > spread[during].max()),
        {"during": float(spread[during].max()), "end": float(spread[-1]), "turns": turns, "falls": float(falls)},
    )


CLAIMS = (rigid_like, first_target, spread_vanishes, velocity_scales_out, after_detachment)
