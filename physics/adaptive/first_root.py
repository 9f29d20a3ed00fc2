"""The first root of a quintic in Bernstein form: where all coefficients have one sign, the polynomial has no root.

A guard of an event is such a polynomial over one step, positive while nothing switches. The convex hull of its coefficients
gives a time before which it cannot vanish, so the search moves on from there and never passes a root.
"""

from __future__ import annotations

from softcradle.physics.adaptive.constants import FIRST_PART, MOST_MOVES, ROUND_OFF
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.law_curve import NODES

NONE = 2.0  # in place of a part of the step: there is no root


@piece
def hermite_quintic(h, y0, v0, a0, y1, v1, a1):
    """Bernstein coefficients of the quintic through values, rates and accelerations of both ends of a step of length h."""
    return (
        y0,
        y0 + h * v0 / 5.0,
        y0 + h * (0.4 * v0 + 0.05 * h * a0),
        y1 - h * (0.4 * v1 - 0.05 * h * a1),
        y1 - h * v1 / 5.0,
        y1,
    )


@piece
def hermite_cubic(h, y0, v0, y1, v1):
    """Bernstein coefficients, of degree 5, of the cubic through values and rates of both ends of a step of length h."""
    b1, b2 = y0 + h * v0 / 3.0, y1 - h * v1 / 3.0
    return elevated(y0, b1, b2, y1)


@inlined
def elevated(b0, b1, b2, b3):
    """The coefficients of degree 5 of a cubic."""
    return (
        b0,
        0.4 * b0 + 0.6 * b1,
        0.1 * b0 + 0.6 * b1 + 0.3 * b2,
        0.3 * b1 + 0.6 * b2 + 0.1 * b3,
        0.6 * b2 + 0.4 * b3,
        b3,
    )


@piece
def stage_cubic(y0, y1, y2, y3):
    """Bernstein coefficients, of degree 5, of the cubic through the start and the stages of a step."""
    c1, c2 = NODES[0], NODES[1]
    first, second, third = (y1 - y0) / c1, (y2 - y1) / (c2 - c1), (y3 - y2) / (1.0 - c2)
    left, right = (second - first) / c2, (third - second) / (1.0 - c1)
    bend = right - left
    slope = first - c1 * left + c1 * c2 * bend
    b1 = y0 + slope / 3.0
    b2 = b1 + (slope + left - (c1 + c2) * bend) / 3.0
    return elevated(y0, b1, b2, y3)


@inlined
def halves(x, b):
    """Coefficients of the parts [0, x] and [x, 1] by de Casteljau's scheme."""
    b0, b1, b2, b3, b4, b5 = b
    c0, c1, c2, c3, c4 = (
        b0 + x * (b1 - b0),
        b1 + x * (b2 - b1),
        b2 + x * (b3 - b2),
        b3 + x * (b4 - b3),
        b4 + x * (b5 - b4),
    )
    d0, d1, d2, d3 = c0 + x * (c1 - c0), c1 + x * (c2 - c1), c2 + x * (c3 - c2), c3 + x * (c4 - c3)
    e0, e1, e2 = d0 + x * (d1 - d0), d1 + x * (d2 - d1), d2 + x * (d3 - d2)
    f0, f1 = e0 + x * (e1 - e0), e1 + x * (e2 - e1)
    g = f0 + x * (f1 - f0)
    return (b0, c0, d0, e0, f0, g), (g, f1, e2, d3, c4, b5)


@inlined
def hull_crossing(c, points):
    """Where the convex hull of the first control `points` of c first reaches 0; 1 where it does not."""
    found = 1.0
    for k in range(1, points):
        if c[k] < 0.0:
            for j in range(k):
                if c[j] >= 0.0:
                    found = min(found, (j + (k - j) * c[j] / (c[j] - c[k])) / (points - 1))
    return found


@inlined
def safe_move(b):
    """A part of the interval within which the polynomial does not turn negative; b0 >= 0."""
    if b[0] > 0.0:
        return hull_crossing(b, 6)
    if b[1] > 0.0:  # the root at 0 is divided out
        return hull_crossing((b[1], b[2] / 2.0, b[3] / 3.0, b[4] / 4.0, b[5] / 5.0, 0.0), 5)
    return 0.0 if b[1] < 0.0 or b[2] < 0.0 else FIRST_PART


@piece
def first_root(b):
    """The first part x in [0, 1] at which the quintic with coefficients `b` turns from positive to negative; NONE without."""
    if min(b[1], b[2], b[3], b[4], b[5]) >= 0.0:
        return NONE
    left, width = 0.0, 1.0
    b = (max(b[0], 0.0), b[1], b[2], b[3], b[4], b[5])
    for _ in range(MOST_MOVES):
        if min(b[1], b[2], b[3], b[4], b[5]) >= 0.0:
            return NONE
        move = safe_move(b)
        if move * width <= ROUND_OFF and (b[1] < 0.0 or width <= ROUND_OFF):
            return left
        _, b = halves(move, b)
        b = (max(b[0], 0.0), b[1], b[2], b[3], b[4], b[5])
        left += move * width
        width *= 1.0 - move
        for part in (0.5, min(0.5, max(2.0 * move, ROUND_OFF))):
            near, far = halves(part, b)
            if near[5] < 0.0:
                b, width = near, part * width
            elif min(near[1], near[2], near[3], near[4], near[5]) >= 0.0:
                b, left, width = far, left + part * width, (1.0 - part) * width
    return NONE
