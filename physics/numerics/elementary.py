"""Powers, exponentials, logarithms, sines and arc tangents that are bitwise reproducible on every machine and in every browser.

    ln x = k ln 2 - ln v + ln(1 + r),   x = 2**k z,  r = z v - 1:  v has few bits, one value for each 128th of an octave
    e**x = 2**k 2**(j/128) e**r,        r = x - (128 k + j) ln(2)/128
    b**a = e**(a ln b),                 ln b and a ln b as sums of two floats

The C libraries of different systems round these functions differently, and so do processors with fused multiply-add.
Here each operation is one of IEEE 754, in a fixed order. Largest errors in units of the last place (``python -m
tools.elementary_errors``): exp, and log near 1: 0.51 and 0.75; log1p 0.75; expm1 1.5. Powers: 0.51 for exponents below
3, 0.7 below 30, and 1.7 if the result is near the largest or the smallest float. Sine, cosine and arc tangent: 0.8, with the
polynomials of fdlibm (k_sin.c, k_cos.c and s_atan.c, Sun Microsystems, 1993).
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

# pi as a float; as a sum of two floats, half of it is the sum of QUARTER_HEAD and QUARTER_TAIL.
HALF_TURN = 3.141592653589793
# pi/2 as a sum of two floats. The first has 33 significant bits, so its product with a small integer is exact.
QUARTER_HEAD, QUARTER_TAIL = 1.57079632673412561417e00, 6.07710050650619224932e-11
# Coefficients of sin x = x + x³ (S1 + S2 x² + ...) and cos x = 1 - x²/2 + x⁴ (C1 + C2 x² + ...) for abs(x) <= pi/4.
S1, S2, S3 = -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04
S4, S5, S6 = 2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10
C1, C2, C3 = 4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05
C4, C5, C6 = -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11
# Coefficients of atan x = x - x (T0 x² + T1 x⁴ + ...) for abs(x) <= 7/16.
T0, T1, T2 = 3.33333333333329318027e-01, -1.99999999998764832476e-01, 1.42857142725034663711e-01
T3, T4, T5 = -1.11111104054623557880e-01, 9.09088713343650656196e-02, -7.69187620504482999495e-02
T6, T7, T8 = 6.66107313738753120669e-02, -5.83357013379057348645e-02, 4.97687799461593236017e-02
T9, T10 = -3.65315727442169155270e-02, 1.62858201153657823623e-02
# atan(1/2) and atan(1), each as a sum of two floats.
HALF_HEAD, HALF_TAIL = 4.63647609000806093515e-01, 2.26987774529616870924e-17
ONE_HEAD, ONE_TAIL = 7.85398163397448278999e-01, 3.06161699786838301793e-17


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


@jit
def sine_cosine(x):
    """Return sin x and cos x for 0 <= x <= 1e5."""
    # x = n pi/2 + r + more, with the remainder as a sum of two floats
    n = math.floor(x / (QUARTER_HEAD + QUARTER_TAIL) + 0.5)
    head, tail = x - n * QUARTER_HEAD, n * QUARTER_TAIL
    r = head - tail
    more = (head - r) - tail
    z = r * r
    # the sine and the cosine of the remainder
    p = S2 + z * (S3 + z * (S4 + z * (S5 + z * S6)))
    sine = r - ((z * (0.5 * more - z * r * p) - more) - z * r * S1)
    q = z * (C1 + z * (C2 + z * C3)) + (z * z) * (z * z) * (C4 + z * (C5 + z * C6))
    half = 0.5 * z
    main = 1.0 - half
    cosine = main + (((1.0 - main) - half) + (z * q - r * more))
    # the quadrant
    quadrant = int(n) & 3
    if quadrant & 1:
        sine, cosine = cosine, -sine
    if quadrant & 2:
        sine, cosine = -sine, -cosine
    return sine, cosine


@jit
def arc_tangent(x):
    """Return atan x for 0 <= x <= 1."""
    # reduce the argument by the addition theorem, about 1/2 or 1
    head, tail, t = 0.0, 0.0, x
    if x >= 0.6875:
        head, tail, t = ONE_HEAD, ONE_TAIL, (x - 1.0) / (x + 1.0)
    elif x >= 0.4375:
        head, tail, t = HALF_HEAD, HALF_TAIL, (2.0 * x - 1.0) / (2.0 + x)
    z = t * t
    w = z * z
    odd = z * (T0 + w * (T2 + w * (T4 + w * (T6 + w * (T8 + w * T10)))))
    even = w * (T1 + w * (T3 + w * (T5 + w * (T7 + w * T9))))
    return head - ((t * (odd + even) - tail) - t)


@jit
def turning_angle(sine, cosine):
    """Return the angle from 0 to 2 pi whose sine and cosine are in the ratio of the arguments."""
    a, b = abs(sine), abs(cosine)
    # the angle in the first quadrant, from the smaller ratio
    angle = arc_tangent(a / b) if a <= b else 2.0 * ONE_HEAD + (2.0 * ONE_TAIL - arc_tangent(b / a))
    if cosine < 0.0:
        angle = 4.0 * ONE_HEAD + (4.0 * ONE_TAIL - angle)
    if sine < 0.0:
        angle = 8.0 * ONE_HEAD + (8.0 * ONE_TAIL - angle)
    return angle
