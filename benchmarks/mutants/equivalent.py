"""Mutants that no test can tell from the source, and why."""

from __future__ import annotations

from typing import NamedTuple

from benchmarks.mutants.operators import Mutant

CURVE = "physics/numerics/law_curve.py"
RADAU, GUESS = "physics/adaptive/radau.py", "physics/adaptive/radau_guess.py"
EVENTS, ROOT = "physics/adaptive/event_location.py", "physics/adaptive/first_root.py"
SOLVE, RESOLVENT = "physics/numerics/contact_solve.py", "physics/numerics/resolvent.py"
GRADIENT = "physics/fixed_step/discrete_gradient.py"


class Equivalent(NamedTuple):
    """Mutants of `source` in a line that holds `line`, whose changed text is `before` (any where empty), and the reason."""

    source: str
    line: str
    before: str
    reason: str


EQUIVALENT = (
    Equivalent(
        CURVE, "by_overlap < 0.0 and overlap > 0.0:", "by_overlap < 0.0", "at 0 the bound is not below the overlap"
    ),
    Equivalent(CURVE, "towards_zero = ", "overlap > 0.0", "an overlap of 0 is asked for beside it"),
    Equivalent(RADAU, "if slope > HUGE:", "slope > HUGE", "1e200 is as vertical as any slope near it"),
    Equivalent(
        RADAU, "= 1.0 / (1.0 + weight * slope)", "", "length of a direction; the correction along it is divided by it"
    ),
    Equivalent(RADAU, "if not abs(stage_overlap", "", "1e200 is as far off as any overlap near it"),
    Equivalent(RADAU, "free = mode[i] == TOUCHING", "0", "all stages of a contact that touches have one direction"),
    Equivalent(EVENTS, "BEFORE, AFTER = ", "", "any rows of the work array that nothing else takes"),
    Equivalent(EVENTS, "before = motion.force[i - 1]", "True", "the polynomial tells the same, at more cost"),
    Equivalent(EVENTS, "before = motion.force[i - 1]", "i > 0", "the polynomial tells the same, at more cost"),
    Equivalent(EVENTS, "return before and (motion.force", "True", "the polynomial tells the same, at more cost"),
    Equivalent(GUESS, "NO_GUESS = -1.0", "1.0", "any negative number says it"),
    Equivalent(
        GUESS,
        "if force[i] - preload < MOST_GUESSED * excess",
        "force[i] - preload < MOST_GUESSED * excess < MOST_GUESSED * MOST_GUESSED * (force[i] - preload)",
        "a guess just at its bound",
    ),
    Equivalent(ROOT, "NONE = 2.0", "2.0", "any part beyond 1 says it"),
    Equivalent(
        ROOT, "move * width <= ROUND_OFF", "b[1] < 0.0 or width <= ROUND_OFF", "the same root, some moves later"
    ),
    Equivalent(GRADIENT, "kept = full if rate[i] > 0.0", "rate[i] > 0.0", "a rate of 0 is left out before"),
    Equivalent(GRADIENT, "return used, 1.0", "1.0", "any part from 1 on says that there is no cut"),
    Equivalent(GRADIENT, "failed |= used < 0", "0", "a solver that converges takes an iteration at least"),
    Equivalent(
        SOLVE, "if low == high or (low < s[i]", "high == s[i]", "low is never above high, and equal is asked for"
    ),
    Equivalent(SOLVE, "break", "break", "what follows repeats the same row until its bisections are used up"),
    Equivalent(SOLVE, "slope[i - 1] if i > 0 else 0.0", "i > 0", "what it is multiplied by is 0 there"),
    Equivalent(SOLVE, "pivot = 1.0 - (lower", "i > 0", "lower is 0 there"),
    Equivalent(SOLVE, "shift[i - 1] if i > 0", "i > 0", "lower is 0 there"),
    Equivalent(SOLVE, "best, least, damping = ", "1.0", "only the length of the first move of Newton's iteration"),
    Equivalent(SOLVE, "pressed = 0.0", "0.0", "only where Newton's iteration begins anew"),
    Equivalent(SOLVE, "total >= best", "total >= best", "two equal sums of residuals, to the last digit"),
    Equivalent(
        RESOLVENT, "overlap = guess if 0.0 < guess < s", "0.0 < guess < s", "only where Newton's iteration begins"
    ),
    Equivalent(RESOLVENT, "if not 0.0 < guess < s:", "0.0 < guess < s", "only where Newton's iteration begins"),
    Equivalent(RESOLVENT, "reach = (s / weight", "1.0", "only where Newton's iteration begins"),
    Equivalent(RESOLVENT, "precision = 4.0 * EPSILON", "4.0", "round-off, in any case"),
    Equivalent(RESOLVENT, "if excess > 0.0:", "excess > 0.0", "an excess of 0 is the root"),
    Equivalent(RESOLVENT, "if move > 0.0 else", "move > 0.0", "a move of 0 ends the iteration"),
    Equivalent(
        RESOLVENT,
        "if not low <= following <= high:",
        "low <= following <= high",
        "the root lies between, not at an end",
    ),
    Equivalent(RESOLVENT, "if abs(x) < 1e-7:", "abs(x) < 1e-7", "the two formulas agree there"),
    Equivalent(RESOLVENT, "math.sqrt(low * high) if low > 0.0", "4.0", "where a bracket is divided; it holds the root"),
    Equivalent(
        RESOLVENT, "math.sqrt(low * high) if low > 0.0", "4.0 * low", "where a bracket is divided; it holds the root"
    ),
    Equivalent(RESOLVENT, "reach = (s / weight", "s / weight", "only where Newton's iteration begins"),
    Equivalent(RESOLVENT, "if overlap < SMALLEST:", "overlap < SMALLEST", "1e-280 is as small as any overlap near it"),
    Equivalent(RESOLVENT, "if start >= 0.0:", "start >= 0.0", "from 0 the quadratic has the same root"),
)


def reason_of(source: str, line: str, mutant: Mutant) -> str:
    """Why `mutant`, in that line of `source`, changes nothing that can be seen; empty where it is not known to be so."""
    before = " ".join(mutant.before.split())
    found = (one for one in EQUIVALENT if one.source == source and one.line in line and one.before in ("", before))
    return next((one.reason for one in found), "")
