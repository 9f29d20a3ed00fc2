"""Ranges of the chain that take part in a step of `dop853`; between them no contact pushes enough to matter."""

from __future__ import annotations

from softcradle.physics.adaptive.constants import MARGIN
from softcradle.physics.numerics.jit import inlined, piece
from softcradle.physics.numerics.law_curve import curve_force
from softcradle.physics.numerics.records import OPEN, TOUCHING


@inlined
def is_active(i, h, inactive, chain, motion):
    """False for a contact that closes no faster than `inactive` [m/s], and neither now nor at the end of a step at this rate
    holds more energy or changes velocities by more. A contact that touches passes on at once what pushes it: it is active."""
    if motion.mode[i] == OPEN:
        return False
    if motion.mode[i] == TOUCHING:
        return True
    law, rate = chain.law, motion.rate[i]
    reach = motion.overlap[i] + max(rate, 0.0) * h
    end = curve_force(law, chain.own, i, reach) if reach > 0.0 else 0.0
    push = (chain.inverse_mass[i] + chain.inverse_mass[i + 1]) * max(motion.force[i], law[i, 0], end)
    return rate > inactive or push * h > inactive or push * max(reach, 0.0) > inactive * inactive


@piece
def next_range(after, h, inactive, chain, motion):
    """The next range [first, last) of active contacts from contact `after` on, with a margin; (n, n) where there is none."""
    n = motion.mode.size
    if chain.external.size:
        return after, n
    first = after
    while first < n and not is_active(first, h, inactive, chain, motion):
        first += 1
    if first == n:
        return n, n
    last = first + 1
    for i in range(first + 1, n):
        if i >= last + 2 * MARGIN:
            break
        if is_active(i, h, inactive, chain, motion):
            last = i + 1
    return max(first - MARGIN, after), min(last + MARGIN, n)
