"""Stretches of the chain that take part in a step of `dop853`; between them nothing pushes enough to matter."""

from __future__ import annotations

from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.law_curve import OPEN, TOUCHING, signed_force

MARGIN = 4  # contacts around those that push; a front runs one or two a step


@jit
def busy(i, h, idle, law, inverse_mass, mode, overlap, rate, force):
    """False for a contact that comes no faster than `idle` [m/s], and neither now nor at the end of the step, if it goes on
    so, holds more energy or changes velocities by more. Those that touch pass on what pushes them at once, as far as they go."""
    if mode[i] == OPEN:
        return False
    if mode[i] == TOUCHING:
        return True
    reach = overlap[i] + max(rate[i], 0.0) * h
    end = signed_force(law[i, 0], law[i, 1], law[i, 2], reach) if reach > 0.0 else 0.0
    push = (inverse_mass[i] + inverse_mass[i + 1]) * max(force[i], law[i, 0], end)
    return rate[i] > idle or push * h > idle or push * max(reach, 0.0) > idle * idle


@jit
def stretch(after, h, idle, law, inverse_mass, external, mode, overlap, rate, force):
    """The next range [first, last) from contact `after` on of those that are busy, and a margin; (n, n) where none is."""
    n = mode.size
    if external.size:
        return after, n
    first = after
    while first < n and not busy(first, h, idle, law, inverse_mass, mode, overlap, rate, force):
        first += 1
    if first == n:
        return n, n
    last = first + 1
    for i in range(first + 1, n):
        if i >= last + 2 * MARGIN:
            break
        if busy(i, h, idle, law, inverse_mass, mode, overlap, rate, force):
            last = i + 1
    return max(first - MARGIN, after), min(last + MARGIN, n)
