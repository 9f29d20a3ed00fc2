"""Largest errors of `physics/numerics/elementary.py` for random arguments, in units of the last place.

    python -m tools.elementary_errors [COUNT]      1e8 of each kind by default; a minute for every 1e7

The true values are computed with 64 significant bits, which x86 processors support.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.numerics import elementary
from softcradle.physics.numerics.jit import jit

Array = NDArray[Any]
Long = np.longdouble

CHUNK = 1_000_000
EXP, EXPM1, LOG, LOG1P = range(4)
TRUTH = (np.exp, np.expm1, np.log, np.log1p)
Draw = Callable[[np.random.Generator, int], Array]


def within(low: float, high: float) -> Draw:
    """Return a generator of random numbers between two limits."""
    return lambda draw, count: draw.uniform(low, high, count)


def powers_of_ten(low: float, high: float) -> Draw:
    """Return a generator of random numbers of all magnitudes between two powers of ten."""
    return lambda draw, count: 10.0 ** draw.uniform(low, high, count)


def small(low: float, high: float) -> Draw:
    """Return a generator of positive and negative random numbers with magnitudes between two powers of ten."""
    return lambda draw, count: draw.choice((-1.0, 1.0), count) * 10.0 ** draw.uniform(low, high, count)


FUNCTIONS: dict[str, tuple[int, Draw]] = {
    "exp, |x| < 690": (EXP, within(-690.0, 690.0)),
    "expm1, |x| < 2": (EXPM1, within(-2.0, 2.0)),
    "expm1, 1e-12 < |x| < 1e-2": (EXPM1, small(-12.0, -2.0)),
    "log1p, -0.5 < x < 1": (LOG1P, within(-0.5, 1.0)),
    "log1p, 1e-12 < |x| < 1e-2": (LOG1P, small(-12.0, -2.0)),
    "log, all sizes": (LOG, powers_of_ten(-300.0, 300.0)),
    "log, near 1": (LOG, lambda draw, count: 1.0 + small(-12.0, -1.0)(draw, count)),
}
POWERS: dict[str, tuple[Draw, Draw]] = {
    "power, overlaps of soft contacts": (powers_of_ten(-30.0, 0.0), within(0.02, 0.2)),
    "power, all sizes, exponents to 3": (powers_of_ten(-300.0, 100.0), within(0.005, 3.0)),
    "power, near 1, exponents to 3": (powers_of_ten(-1e-3, 1e-3), within(0.005, 3.0)),
    "power, exponents 3 to 30": (powers_of_ten(-9.0, 9.0), within(3.0, 30.0)),
    "power, below the least float with all bits": (powers_of_ten(-323.0, -308.0), within(0.02, 0.9)),
}


@jit
def values(function, x, found):
    """Evaluate a function at each argument x."""
    for i in range(x.size):
        if function == EXP:
            found[i] = elementary.exp(x[i])
        elif function == EXPM1:
            found[i] = elementary.expm1(x[i])
        elif function == LOG:
            found[i] = elementary.log(x[i])
        else:
            found[i] = elementary.log1p(x[i])


@jit
def powers(base, exponent, found):
    """Evaluate ``base**exponent`` for each pair of arguments."""
    for i in range(base.size):
        found[i] = elementary.power(base[i], exponent[i])


def worst(found: Array, truth: Array) -> float:
    """Return the largest error in units of the last place. Results outside the range of normal floats are ignored."""
    usual = (np.abs(truth) > elementary.LEAST) & (np.abs(truth) < elementary.MOST)
    found, truth = found[usual], truth[usual]
    return float((np.abs(found - truth) / np.spacing(np.abs(truth).astype(np.float64))).max())


def errors(count: int) -> Iterator[tuple[str, float]]:
    """Yield each kind of arguments with the largest error for `count` random arguments."""
    draw = np.random.default_rng(1)
    chunks = [min(CHUNK, count - done) for done in range(0, count, CHUNK)]
    for kind, (function, arguments) in FUNCTIONS.items():
        most = 0.0
        for size in chunks:
            x, found = arguments(draw, size), np.empty(size)
            values(function, x, found)
            most = max(most, worst(found, TRUTH[function](x.astype(Long))))
        yield kind, most
    for kind, (bases, exponents) in POWERS.items():
        most = 0.0
        for size in chunks:
            base, exponent, found = bases(draw, size), exponents(draw, size), np.empty(size)
            powers(base, exponent, found)
            with np.errstate(over="ignore", under="ignore"):
                most = max(most, worst(found, np.power(base.astype(Long), exponent.astype(Long))))
        yield kind, most


def main() -> int:
    """Print the largest errors of all functions."""
    if np.finfo(Long).nmant < 63:
        print("the floats of this machine have too few bits to say what is right")
        return 2
    count = int(float(sys.argv[1])) if len(sys.argv) > 1 else 10**8
    for kind, most in errors(count):
        print(f"{kind:45} {most:.3f} units of the last place", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
