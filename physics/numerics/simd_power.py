"""Powers of many numbers at once: a power without branches and calls, which the compiler turns into vector code.

    d = 2**k m,  m in [sqrt(1/2), sqrt(2)):   log2 d = k + 2/(3 ln 2) s (3 + s**2 + R),   s = (m-1)/(m+1)
    R = 3 (s**4/5 + s**6/7 + ...),            d**a = 2**e 2**f,   e + f = a log2 d,   |f| <= 1/2

The logarithm is a sum of two numbers; the first has 26 bits, so that its products with another such are exact (as in
the pow of fdlibm, Sun 1993). Largest error 2 units in the last place, shown by tests/physics/numerics/test_simd_power.py.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.float_bits import bits_of, float_of
from softcradle.physics.numerics.jit import fused, jit

HEAD = -(1 << 27)  # keeps 26 significant bits of a float
HALF_ROOT = 0x3FE6A09E667F3BCD  # bits of sqrt(1/2)
SCALE = 0.9617966939259756  # 2/(3 ln 2) ...
SCALE_HEAD = 0.9617966860532761  # ... its first 26 bits ...
SCALE_TAIL = 7.872699542894897e-09  # ... and the rest
TINY, LIFT = 2.0**-1022, 54  # below TINY floats lose bits: they are lifted by 2**LIFT first
LEAST, MOST = -1100.0, 1030.0  # exponents of two beyond which every float is 0 or infinite
ROUND = 1.5 * 2.0**52  # added, it leaves the nearest integer in the last bits
ROUND_BITS = 0x4338000000000000
BIAS = 1023
INFINITE = math.inf

R1, R2, R3, R4, R5, R6, R7, R8, R9, R10 = (3.0 / (2 * k + 3) for k in range(1, 11))
# ln(2)**k / k!
E1, E2, E3, E4, E5, E6, E7, E8, E9, E10, E11, E12, E13 = (
    0.6931471805599453,
    0.24022650695910072,
    0.05550410866482158,
    0.009618129107628477,
    0.0013333558146428443,
    0.0001540353039338161,
    1.5252733804059841e-05,
    1.321548679014431e-06,
    1.01780860092397e-07,
    7.054911620801123e-09,
    4.4455382718708116e-10,
    2.5678435993488206e-11,
    1.3691488853904128e-12,
)


@fused
def head(number):
    """The first 26 significant bits of a float."""
    return float_of(bits_of(number) & HEAD)


@fused
def plain_power(base, exponent):
    """``base**exponent`` for 0 < base < inf and exponent >= 0, without a branch."""
    small = base < TINY
    bits = bits_of(base * 2.0**LIFT if small else base)
    k = (bits - HALF_ROOT) >> 52
    m = float_of(bits - (k << 52))
    turns = float(k) - (float(LIFT) if small else 0.0)
    # s = s_head + s_tail
    v = 1.0 / (m + 1.0)
    s = (m - 1.0) * v
    s_head = head(s)
    sum_head = head(m + 1.0)
    s_tail = v * (((m - 1.0) - s_head * sum_head) - s_head * (m - (sum_head - 1.0)))
    # R by pairs: a short chain of dependent operations
    q = s * s
    q2 = q * q
    q4 = q2 * q2
    r = ((R1 + R2 * q) + (R3 + R4 * q) * q2) + ((R5 + R6 * q) + (R7 + R8 * q) * q2) * q4 + (R9 + R10 * q) * (q4 * q4)
    r = r * q2 + s_tail * (s_head + s)
    # s (3 + s**2 + R) = p_head + p_tail
    square = s_head * s_head
    t_head = head(3.0 + square + r)
    t_tail = r - ((t_head - 3.0) - square)
    p_head = head(s_head * t_head + (s_tail * t_head + t_tail * s))
    p_tail = (s_tail * t_head + t_tail * s) - (p_head - s_head * t_head)
    # log2 d = log_head + log_tail; a log2 d = whole + rest
    z_head = SCALE_HEAD * p_head
    z_tail = SCALE_TAIL * p_head + p_tail * SCALE
    log_head = head((z_head + z_tail) + turns)
    log_tail = z_tail - ((log_head - turns) - z_head)
    a_head = head(exponent)
    y_head = a_head * log_head
    y_tail = (exponent - a_head) * log_head + exponent * log_tail
    shifted = min(max(y_head + y_tail, LEAST), MOST) + ROUND
    whole = bits_of(shifted) - ROUND_BITS
    f = min(max((y_head - (shifted - ROUND)) + y_tail, -1.0), 1.0)  # beyond, the result is 0 or infinite anyway
    e = E9 + f * (E10 + f * (E11 + f * (E12 + f * E13)))
    e = 1.0 + f * (E1 + f * (E2 + f * (E3 + f * (E4 + f * (E5 + f * (E6 + f * (E7 + f * (E8 + f * e))))))))
    half = whole >> 1  # in two factors: their product may be below the least or above the largest float
    return e * float_of((half + BIAS) << 52) * float_of((whole - half + BIAS) << 52)


@jit
def powers(base, exponent, result):
    """``result[i] = base[i]**exponent[i]`` (n,) for base > 0 and exponent >= 0; 0 where base <= 0; NaN stays NaN."""
    for i in range(result.size):
        d = base[i]
        usual = 0.0 < d < INFINITE
        p = plain_power(d if usual else 1.0, exponent[i])
        result[i] = p if usual else (0.0 if d <= 0.0 else d)


@jit
def forces(law, overlap, force):
    """``force[i]`` (n,) = F + K d**a of contacts `law` (n, 3) where d = overlap[i] > 0, else 0."""
    n = force.size
    hooke, hertz, pressed = True, True, False
    for i in range(n):
        hooke &= law[i, 2] == 1.0
        hertz &= law[i, 2] == 1.5
        pressed |= not overlap[i] <= 0.0
    if not pressed:
        for i in range(n):
            force[i] = 0.0
    elif hooke:
        for i in range(n):
            force[i] = 0.0 if overlap[i] <= 0.0 else law[i, 0] + law[i, 1] * overlap[i]
    elif hertz:
        for i in range(n):
            d = max(overlap[i], 0.0)
            force[i] = 0.0 if overlap[i] <= 0.0 else law[i, 0] + law[i, 1] * (d * math.sqrt(d))
    else:
        for i in range(n):
            force[i] = law[i, 2]
        for i in range(n):
            d = overlap[i]
            usual = 0.0 < d < INFINITE
            p = plain_power(d if usual else 1.0, force[i])
            force[i] = p if usual else d
        for i in range(n):
            force[i] = 0.0 if overlap[i] <= 0.0 else law[i, 0] + law[i, 1] * force[i]
