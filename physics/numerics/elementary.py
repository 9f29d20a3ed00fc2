"""Powers, exponentials and logarithms by sums, products and tables: the same digits on every machine and in every browser.

    ln x = k ln 2 - ln v + ln(1 + r),   x = 2**k z,  r = z v - 1:  v has few bits, one for each 128th of an octave
    e**x = 2**k 2**(j/128) e**r,        r = x - (128 k + j) ln(2)/128
    b**a = e**(a ln b),                 ln b and a ln b as sums of two floats

The C library of each system rounds them in its own way, and so does each processor with fused products; here every operation is
one of IEEE 754, in a fixed order. Largest errors in units of the last place (``python -m tools.elementary_errors``): exp and
log near 1 .51 and .75, log1p .75, expm1 1.5; powers .51 for exponents below 3, .7 below 30, 1.7 where a result is near the
largest or the least float.
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

UPPER, HALF = -(1 << 32), 1 << 31  # bits of a float that keep 21 significant ones; half of the last of them
HEAD = -(1 << 27)  # 26 significant ones: products of two such floats are exact
LEAST, MOST = 2.0**-1022, 1.7976931348623157e308  # floats with all their bits
LIFT = 2.0**54  # makes smaller ones such
ROUND = 1.5 * 2.0**52  # added, it leaves the nearest integer in the last bits
ROUND_BITS = 0x4338000000000000
USUAL = 700.0  # exponents up to which no factor of a result is too large or too small for a float


@jit
def curved(r):
    """r - ln(1 + r) for small r."""
    r2 = r * r
    return r2 * (((P0 + r * P1) + r2 * (P2 + r * P3)) + (r2 * r2) * (P4 + r * P5))


@jit
def log(x):
    """ln x for a float x > 0 that has all its bits; larger ones are taken as the largest."""
    bits = bits_of(min(x, MOST))
    k, part = (bits - OFFSET) >> 52, ((bits - OFFSET) >> 45) & 127
    z, v = float_of(bits - (k << 52)), INVERSE(part)
    upper = float_of((bits_of(z) + HALF) & UPPER)
    head, tail = upper * v - 1.0, (z - upper) * v  # both exact
    rest = ((k * LN2_TAIL + LOG_TAIL(part)) + tail) - curved(head + tail)
    return (k * LN2_HEAD + LOG_HEAD(part)) + head + rest


@jit
def log1p(x):
    """ln(1 + x) for -0.5 <= x <= 1."""
    u = 1.0 + x
    lost = x - (u - 1.0)
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
    """Factor f = 2**(n/128) and e**(x + more) / f - 1, for abs(x + more) <= USUAL; `about` is the rounded sum."""
    shifted = about * PARTS_BY_LN2 + ROUND
    number = shifted - ROUND
    n = bits_of(shifted) - ROUND_BITS
    head, tail = x - number * STEP_HEAD, number * STEP_TAIL - more  # the first is exact
    r = head - tail
    r2 = r * r
    part = n & 127
    factor = POWER(part) * float_of(((n >> 7) + 1023) << 52)
    return factor, head + ((POWER_TAIL(part) - tail) + r2 * ((Q0 + r * Q1) + r2 * (Q2 + r * Q3)))


@jit
def unusual_exp(about, x, more):
    """e**(x + more) for any x: below the least float 0, above the largest infinite; `about` is the rounded sum."""
    if not abs(about) < 2.0 * USUAL:
        return 0.0 if about < 0.0 else math.inf if about > 0.0 else about
    factor, rest = reduced(0.5 * about, 0.5 * x, 0.5 * more)
    root = factor + factor * rest
    return root * root


@jit
def exp(x):
    """e**x: 0 below the least float, infinite above the largest."""
    if not -USUAL <= x <= USUAL:
        return unusual_exp(x, x, 0.0)
    factor, rest = reduced(x, x, 0.0)
    return factor + factor * rest


@jit
def expm1(x):
    """e**x - 1 for abs(x) <= USUAL."""
    factor, rest = reduced(x, x, 0.0)
    return (factor - 1.0) + factor * rest


@jit
def times_log(exponent, base, lifted):
    """``exponent ln(2**-lifted base)`` as a sum of two floats, the first exact; the base has all its bits."""
    bits = bits_of(base)
    k, part = (bits - OFFSET) >> 52, ((bits - OFFSET) >> 45) & 127
    z, v = float_of(bits - (k << 52)), INVERSE(part)
    upper = float_of((bits_of(z) + HALF) & UPPER)
    head, tail = upper * v - 1.0, (z - upper) * v  # both exact
    k -= lifted
    main = k * LN2_HEAD + LOG_HEAD(part)  # of 27 bits
    rest = head + (((k * LN2_TAIL + LOG_TAIL(part)) + tail) - curved(head + tail))
    short = float_of(bits_of(exponent) & HEAD)
    return short * main, (exponent - short) * main + exponent * rest


@jit
def usual_power(base, lifted, exponent):
    """``(2**-lifted base)**exponent`` for a base with all its bits."""
    x, more = times_log(exponent, base, lifted)
    about = x + more
    if not -USUAL < about < USUAL:
        return unusual_exp(about, x, more)
    factor, rest = reduced(about, x, more)
    return factor + factor * rest


@jit
def power(base, exponent):
    """``base**exponent`` for base >= 0 and an exponent that is not 0; the exponents 1 and 3/2 take no logarithm."""
    if exponent == 1.0:
        return base
    if exponent == 1.5:
        return base * math.sqrt(base)
    if LEAST <= base <= MOST:
        return usual_power(base, 0, exponent)
    if 0.0 < base < LEAST:
        return usual_power(base * LIFT, 54, exponent)
    return base if exponent > 0.0 or math.isnan(base) else 1.0 / base
