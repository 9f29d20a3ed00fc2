"""The distance of two walls, kept: the sums of overlaps and rates between them are known, and round-off of steps has a sign.

Walls would drift apart at a speed that grows with the number of steps, and the energy error with its square.
"""

from __future__ import annotations

from softcradle.physics.numerics.jit import inlined


@inlined
def exact_sum(values):
    """The sum as a number and what it lacks of being exact (Neumaier)."""
    total, rest = 0.0, 0.0
    for i in range(values.size):
        found = total + values[i]
        larger = abs(total) >= abs(values[i])
        rest += (total - found) + values[i] if larger else (values[i] - found) + total
        total = found
    return total, rest


@inlined
def keep_wall_distance(elapsed, motion, rates, overlaps):
    """Take what sums of rates and overlaps are off after `elapsed` [s] from the open contact that is slowest.

    `rates` and `overlaps` are their exact sums at the start.
    """
    overlap, rate, slowest = motion.overlap, motion.rate, -1
    for i in range(overlap.size):
        if overlap[i] < 0.0 and rate[i] != 0.0 and (slowest < 0 or abs(rate[i]) < abs(rate[slowest])):
            slowest = i
    if slowest >= 0:
        total, rest = exact_sum(rate)
        rate[slowest] -= (total - rates[0]) + (rest - rates[1])
        total, rest = exact_sum(overlap)
        overlap[slowest] -= (total - overlaps[0]) + (rest - overlaps[1]) - elapsed * (rates[0] + rates[1])
