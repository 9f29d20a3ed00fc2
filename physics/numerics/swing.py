"""Motion of beads on strings between contacts: overlaps and positions are sines of the time.

For small angles, a string of length l pulls each bead back to its place of rest with the acceleration omega² x,
omega² = g / l. All beads of a row have the same omega, so each overlap d swings about its value r at rest without regard to
the others:

    d - r = (d0 - r) cos(omega t) + (w0 / omega) sin(omega t)
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.elementary import HALF_TURN, sine_cosine, turning_angle
from softcradle.physics.numerics.graph_kernels import pulls_below
from softcradle.physics.numerics.jit import inlined, jit


@inlined
def string_pull(chain, i, overlap):
    """Return the acceleration [m/s²] of contact i at this overlap by the strings of its beads.

    If i is the number of contacts, return that of the anchor bead at this position. Only for a chain with strings.
    """
    return chain.strings.square * (chain.strings.rest[i] - overlap)


@jit
def spread_time(time, chain):
    """Return the displacement [m] per velocity error [m/s] after free motion of length `time` [s].

    Without strings this is the time itself. On strings a displacement returns to 0 after each half period.
    """
    if chain.strings.rest.size == 0:
        return time
    root = math.sqrt(chain.strings.square)
    sine, _ = sine_cosine(min(abs(root * time), 1e5))
    return abs(sine) / root


@inlined
def swung(value, rate, rest, root, sine, versine):
    """Return a value and its rate after it has swung about `rest` by an angle with this sine and versine (1 - cosine)."""
    y = value - rest
    return value + (sine * (rate / root) - versine * y), rate - (sine * (root * y) + versine * rate)


@jit
def swing(passed, chain, motion):
    """Move all overlaps and the anchor bead of a chain on strings by `passed` [s] of free motion.

    Steady external forces shift the places of rest. An overlap that reaches 0 so slowly that it does not count stops there.
    """
    n, root, external = motion.overlap.size, math.sqrt(chain.strings.square), chain.external
    # whole periods first, because the angle must stay small; the versine by half of the angle, without cancellation
    period = 2.0 * HALF_TURN / root
    angle = root * (passed - period * math.floor(passed / period)) if abs(passed) > period else root * passed
    sine, cosine = sine_cosine(0.5 * abs(angle))
    versine = 2.0 * sine * sine
    sine = 2.0 * sine * cosine if angle >= 0.0 else -2.0 * sine * cosine
    for i in range(n):
        rest, before = chain.strings.rest[i], motion.overlap[i]
        if external.size:
            rest += external[i] / chain.strings.square
        after, motion.rate[i] = swung(before, motion.rate[i], rest, root, sine, versine)
        motion.overlap[i] = min(after, max(before, 0.0))
    rest = chain.strings.rest[n]
    if external.size:
        rest += external[n] / chain.strings.square
    motion.anchor[0], motion.anchor[1] = swung(motion.anchor[0], motion.anchor[1], rest, root, sine, versine)


@jit
def swing_time(overlap, rate, rest, root, still):
    """Return the time [s] until an overlap <= 0 that swings about `rest` becomes positive; inf if it never does.

    A contact that would close at no more than `still` [m/s] does not count, unless strings or forces press it together at
    overlap 0 (`rest` > 0). `root` is omega [1/s].
    """
    # phase plane: displacement y from rest and v = rate / omega; the motion turns (v, y) towards y
    y, v, least = overlap - rest, rate / root, still / root if rest <= 0.0 else 0.0
    if overlap >= 0.0 and (rate > still or (rate >= 0.0 and rest > 0.0)):
        return 0.0
    # the square of v at overlap 0, without cancellation of y² and rest²
    square = v * v + overlap * (overlap - 2.0 * rest)
    if square <= least * least:
        return math.inf
    # the angle between (v, y) and (speed, -rest), without cancellation if the contact closes soon
    speed = math.sqrt(square)
    if v > 0.0:
        sine = -overlap * (speed - rest * (overlap - 2.0 * rest) / (v + speed))
    else:
        sine = -rest * (v - speed) - speed * overlap
    return turning_angle(sine, v * speed - rest * y) / root


@inlined
def flight_on_strings(chain, motion, still):
    """Return the time [s] until the first contact of a chain on strings closes or pulls in free motion.

    Contacts that close at no more than `still` [m/s] do not count.
    """
    first, root = math.inf, math.sqrt(chain.strings.square)
    for i in range(motion.overlap.size):
        overlap, rate, rest = motion.overlap[i], motion.rate[i], chain.strings.rest[i]
        first = min(first, swing_time(overlap, rate, rest, root, still))
        # in its slack a coupler swings towards its pull as well
        slack = pulls_below(chain.graph, i) if chain.graph.kind.size else -math.inf
        if slack > -math.inf:
            first = min(first, swing_time(slack - overlap, -rate, slack - rest, root, still))
    return first
