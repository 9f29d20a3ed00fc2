"""Powers, exponentials and logarithms that are bitwise reproducible on every machine and in every browser.

    ln x = k ln 2 - ln v + ln(1 + r),   x = 2**k z,  r = z v - 1:  v has few bits, one value for each 128th of an octave
    e**x = 2**k 2**(j/128) e**r,        r = x - (128 k + j) ln(2)/128
    b**a = e**(a ln b),                 ln b and a ln b as sums of two floats

The C libraries of different systems round these functions differently, and so do processors with fused multiply-add.
Here each operation is one of IEEE 754, in a fixed order. Largest errors in units of the last place (``python -m
tools.elementary_errors``): exp, and log near 1: 0.51 and 0.75; log1p 0.75; expm1 1.5. Powers: 0.51 for exponents below
3, 0.7 below 30, and 1.7 if the result is near the largest or the smallest float.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.elementary_tables import (
    INVERSE,
    LN2_HEAD,
    LN2_TAIL,
    LOG_HEAD,
    LOG_TAIL,
    OFFSET,
    P0,
    P1,
    P2,
    P3,
    P4,
    P5,
    PARTS_BY_LN2,
    POWER,
    POWER_TAIL,
    Q0,
    Q1,
    Q2,
    Q3,
    STEP_HEAD,
    STEP_TAIL,
)
from softcradle.physics.numerics.float_bits import bits_of, float_of
from softcradle.physics.numerics.jit import jit

# Mask that keeps the upper 21 significant bits of a float, and half a unit of the last of them, for rounding.
UPPER, HALF = -(1 << 32), 1 << 31
HEAD = -(1 << 27)  # Mask that keeps the upper 26 significant bits: the product of two such floats is exact.
LEAST, MOST = 2.0**-1022, 1.7976931348623157e308  # Smallest and largest float with full precision (normal floats).
LIFT = 2.0**54  # Factor that turns a subnormal float into a normal one.
ROUND = 1.5 * 2.0**52  # Adding this number rounds to the nearest integer, which then stands in the last bits.
# bits of ROUND: subtracting them leaves that integer
ROUND_BITS = 0x4338000000000000
USUAL = 700.0  # Largest exponent of e for which neither the result nor an intermediate factor overflows or underflows.


@jit
def curved(r):
    """Return r - ln(1 + r) for small r, by a polynomial."""
    r2 = r * r
    return r2 * (((P0 + r * P1) + r2 * (P2 + r * P3)) + (r2 * r2) * (P4 + r * P5))


@jit
def log(x):
    """Return ln x of a normal float x > 0. Values above the largest float count as the largest."""
    # x = 2**k z with z near 1, and v close to 1/z from the table: r = z v - 1 is small
    bits = bits_of(min(x, MOST))
    k, part = (bits - OFFSET) >> 52, ((bits - OFFSET) >> 45) & 127
    z, v = float_of(bits - (k << 52)), INVERSE(part)
    # z is split so that both products with v are exact
    upper = float_of((bits_of(z) + HALF) & UPPER)
    head, tail = upper * v - 1.0, (z - upper) * v  # both exact
    # sum the small terms first
    rest = ((k * LN2_TAIL + LOG_TAIL(part)) + tail) - curved(head + tail)
    return (k * LN2_HEAD + LOG_HEAD(part)) + head + rest


@jit
def log1p(x):
    """Return ln(1 + x) for -0.5 <= x <= 1."""
    # u is 1 + x rounded, and `lost` is the rounding error
    u = 1.0 + x
    lost = x - (u - 1.0)
    # the rest as in `log`, with `lost` carried along in the lower part
    bits = bits_of(u)
    k, part = (bits - OFFSET) >> 52, ((bits - OFFSET) >> 45) & 127
    if k != 0:
        u, lost = (0.5 * u, 0.5 * lost) if k > 0 else (2.0 * u, 2.0 * lost)
    v = INVERSE(part)
    upper = float_of((bits_of(u) + HALF) & UPPER)
    head, tail = upper * v - 1.0, ((u - upper) + lost) * v
    rest = ((k * LN2_TAIL + LOG_TAIL(part)) + tail) - curved(head + tail)
    return (k * LN2_HEAD + LOG_HEAD(part)) + head + rest


@jit
def reduced(about, x, more):
    """Return a factor f = 2**(n/128) and e**(x + more) / f - 1, for abs(x + more) <= USUAL. `about` is the rounded sum."""
    # n is the integer nearest to 128 (x + more) / ln 2
    shifted = about * PARTS_BY_LN2 + ROUND
    number = shifted - ROUND
    n = bits_of(shifted) - ROUND_BITS
    head, tail = x - number * STEP_HEAD, number * STEP_TAIL - more  # the first difference is exact
    r = head - tail
    r2 = r * r
    # 2**(n/128) = 2**(n // 128) times a value from the table, and e**r by a polynomial
    part = n & 127
    factor = POWER(part) * float_of(((n >> 7) + 1023) << 52)
    return factor, head + ((POWER_TAIL(part) - tail) + r2 * ((Q0 + r * Q1) + r2 * (Q2 + r * Q3)))


@jit
def unusual_exp(about, x, more):
    """Return e**(x + more) for any x: 0 below the smallest float, infinity above the largest. `about` is the rounded sum."""
    if not abs(about) < 2.0 * USUAL:
        return 0.0 if about < 0.0 else math.inf if about > 0.0 else about
    # the square of e**(x/2), because the factor of e**x itself might overflow or underflow
    factor, rest = reduced(0.5 * about, 0.5 * x, 0.5 * more)
    root = factor + factor * rest
    return root * root


@jit
def exp(x):
    """Return e**x: 0 below the smallest float, infinity above the largest."""
    if not -USUAL <= x <= USUAL:
        return unusual_exp(x, x, 0.0)
    factor, rest = reduced(x, x, 0.0)
    return factor + factor * rest


@jit
def expm1(x):
    """Return e**x - 1 for abs(x) <= USUAL."""
    factor, rest = reduced(x, x, 0.0)
    return (factor - 1.0) + factor * rest


@jit
def times_log(exponent, base, lifted):
    """Return ``exponent ln(2**-lifted base)`` as a sum of two floats, the first exact, for a normal float `base`."""
    bits = bits_of(base)
    k, part = (bits - OFFSET) >> 52, ((bits - OFFSET) >> 45) & 127
    # the logarithm as in `log`, as a sum `main` + `rest`
    z, v = float_of(bits - (k << 52)), INVERSE(part)
    upper = float_of((bits_of(z) + HALF) & UPPER)
    head, tail = upper * v - 1.0, (z - upper) * v  # both exact
    k -= lifted
    main = k * LN2_HEAD + LOG_HEAD(part)  # 27 significant bits
    rest = head + (((k * LN2_TAIL + LOG_TAIL(part)) + tail) - curved(head + tail))
    short = float_of(bits_of(exponent) & HEAD)
    return short * main, (exponent - short) * main + exponent * rest


# the leading 26 bits of the exponent times the 27 bits of `main` are exact


@jit
def usual_power(base, lifted, exponent):
    """Return ``(2**-lifted base)**exponent`` for a normal float `base`."""
    x, more = times_log(exponent, base, lifted)
    about = x + more
    if not -USUAL < about < USUAL:
        return unusual_exp(about, x, more)
    factor, rest = reduced(about, x, more)
    return factor + factor * rest


@jit
def power(base, exponent):
    """Return ``base**exponent`` for base >= 0 and an exponent other than 0. The exponents 1 and 3/2 need no logarithm."""
    if exponent == 1.0:
        return base
    if exponent == 1.5:
        return base * math.sqrt(base)
    if LEAST <= base <= MOST:
        return usual_power(base, 0, exponent)
    if 0.0 < base < LEAST:
        return usual_power(base * LIFT, 54, exponent)
    return base if exponent > 0.0 or math.isnan(base) else 1.0 / base
