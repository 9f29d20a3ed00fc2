"""Resolvent of one contact: (d1, g) with d1 + weight g(d1) = s, where g is the mean force from d0 to d1.

`g = (E(d1) - E(d0)) / (d1 - d0)` rises with d1 for every law, including maximal monotone graphs with vertical pieces.
So there is exactly one solution for every s. It has a closed form if the law is linear or the contact opens; otherwise
a safeguarded scalar Newton iteration finds it. This module covers contacts with one segment from overlap 0 on, a power
law or a table. `softcradle.physics.numerics.graph_kernels` has the resolvent of a graph with several segments.
"""

from __future__ import annotations

import math

from softcradle.physics.numerics.elementary import exp, expm1, log1p, power
from softcradle.physics.numerics.jit import inlined
from softcradle.physics.numerics.law_kernels import EPSILON, MOST_SCALAR
from softcradle.physics.numerics.table_kernels import has_table, table_mean, table_value

# Overlaps [m] and energies [J] below this value count as 0, because quantities computed from them would be subnormal.
SMALLEST = 1e-280


@inlined
def mean_force(preload, stiffness, exponent, start, start_power, overlap):
    """Return the mean force g = (E(d1)-E(d0))/(d1-d0) and its slope dg/dd1 for d1 > 0, without cancellation if d1 is near d0.

    `start_power` is d0**a, used if d0 > 0. Near d0, with e = expm1(a log1p(x)), r = 1 + x and p = 1 + a, the formula is
    (r**p - 1)/(p (r - 1)) = (e + x (1 + e)) / (p x).
    """
    p = 1.0 + exponent
    if start > 0.0:
        # relative change of the overlap
        x = (overlap - start) / start
        if -0.5 < x < 1.0:
            scale = stiffness * start_power
            # first terms of the series in x
            if abs(x) < 1e-7:
                return preload + scale * (1.0 + 0.5 * exponent * x), 0.5 * scale * exponent / start
            above = expm1(exponent * log1p(x))
            mean = (above + x * (1.0 + above)) / (p * x)
            slope = ((1.0 + above) - mean) / x if abs(x) > 1e-4 else 0.5 * exponent
            return preload + scale * mean, scale * slope / start
        # far from d0 the difference of the energies is free of cancellation
        end_power = power(overlap, exponent)
        mean = stiffness * (overlap * end_power - start * start_power) / (p * (overlap - start))
        return preload + mean, (stiffness * end_power - mean) / (overlap - start)
    # The contact was open at the start: its stored energy is 0, and the force acts on the part of the way with d > 0
    # only.
    end_power = power(overlap, exponent)
    mean = (preload + stiffness * end_power / p) * (overlap / (overlap - start))
    return mean, (preload + stiffness * end_power - mean) / (overlap - start)


@inlined
def quadratic_root(a, b, c):
    """Return the root x > 0 of a x² + b x + c = 0 for a > 0 and c <= 0, without cancellation."""
    root = math.sqrt(b * b - 4.0 * a * c)
    return -2.0 * c / (b + root) if b > 0.0 else (root - b) / (2.0 * a)


@inlined
def mean_of_law(graph, i, preload, stiffness, exponent, start, start_power, overlap):
    """Return `mean_force` of contact i, which has a power law or a table."""
    if has_table(graph, i):
        return table_mean(graph, graph.first[i], start, overlap)
    return mean_force(preload, stiffness, exponent, start, start_power, overlap)


@inlined
def mean_on_opening(graph, i, preload, stiffness, exponent, start, start_power):
    """Return the mean force [N] of contact i between an overlap `start` > 0 and 0."""
    if has_table(graph, i):
        return table_value(graph, graph.energy, graph.first[i], start) / start
    return preload + stiffness * start_power / (1.0 + exponent)


@inlined
def solve_loaded(graph, i, preload, stiffness, exponent, start, start_power, weight, s, guess):
    """Solve d1 + weight g(d1) = s for d1 > 0 by Newton's method with a bracket. Return d1, g and dg/dd1.

    Moves to smaller d1 use the logarithm of d1 as the variable, moves to larger d1 use d1 itself. So this search has its
    own bracket and does not use `newton_in_bracket`: the overlap of a soft contact can be many decades smaller than s.
    """
    low, high = 0.0, s
    overlap = guess if 0.0 < guess < s else 0.5 * s
    # a relative change this small is round-off; for a < 1 the overlap is more sensitive than the force
    precision = 4.0 * EPSILON * max(1.0, 1.0 / exponent)
    force, slope = 0.0, 0.0
    for _ in range(MOST_SCALAR):
        force, slope = mean_of_law(graph, i, preload, stiffness, exponent, start, start_power, overlap)
        # the left side rises with d1: its sign shows which end of the bracket moves
        excess = overlap + weight * force - s
        if excess > 0.0:
            high = overlap
        else:
            low = overlap
        move = -excess / (1.0 + weight * slope)
        if abs(move) <= 1e-9 * overlap:  # The error after this move is its square: the new point is exact to round-off.
            overlap += move
            return overlap, (s - overlap) / weight if weight * slope > 1.0 else force + slope * move, slope
        following = overlap + move if move > 0.0 else overlap * exp(max(move / overlap, -200.0))
        # outside the bracket: halve it, in the logarithm if its ends have different magnitudes
        if not low <= following <= high:
            following = math.sqrt(low * high) if low > 0.0 and high > 4.0 * low else 0.5 * (low + high)
        if abs(following - overlap) <= precision * overlap:
            break
        overlap = following
        # The overlap is too small to be represented, but the force is not: the contact counts as touching.
        if overlap < SMALLEST:
            return 0.0, s / weight, math.inf
    return overlap, force, slope


@inlined
def touching(weight, s):
    """Return d1, g and dg/ds if the stored energy at the start is negligible: pressed at d1 = 0, or open."""
    return (0.0, s / weight, 1.0 / weight) if s > 0.0 else (s, 0.0, 0.0)


@inlined
def resolvent_slope(slope, weight):
    """Return dg/ds = 1 / (1/slope + weight) for the slope dg/dd1 in [0, inf]."""
    return 1.0 / (1.0 / slope + weight) if slope > 0.0 else 0.0


@inlined
def resolvent(graph, i, preload, stiffness, exponent, start, start_power, weight, s, guess):
    """Return the unique (d1, g) of contact i with d1 + weight g = s, and dg/ds.

    `start` is d0, and `guess` is a first approximation of d1. The numbers of the law are arguments, because hysteretic loss
    makes them differ from the row of the chain.
    """
    if abs(start) < SMALLEST:
        start = 0.0
    # loaded at the start
    if start > 0.0:
        mean = mean_on_opening(graph, i, preload, stiffness, exponent, start, start_power)
        # The contact opens within the step: g = E(d0) / (d0 - d1), which gives a quadratic equation for d0 - d1.
        if s <= weight * mean:
            energy = mean * start
            if weight * energy < SMALLEST:
                return touching(weight, s)
            apart = quadratic_root(1.0, s - start, -weight * energy)
            return start - apart, energy / apart, 1.0 / (apart * apart / energy + weight)
    # open or touching at the start: it stays open if s < 0
    elif s < 0.0:
        return s, 0.0, 0.0
    # a touching contact stays at d1 = 0 while its force is at most the preload
    elif start == 0.0 and s <= weight * preload:
        return 0.0, s / weight, 1.0 / weight
    # At the kink the slope of the closed side is used, so that a single Newton step reaches a whole cluster.
    elif s == 0.0:
        return 0.0, 0.0, 1.0 / weight if start == 0.0 and exponent < 1.0 else 0.0
    table = has_table(graph, i)
    # linear law: closed form
    if not table and exponent == 1.0:
        half = 0.5 * stiffness
        if start >= 0.0:
            overlap = max((s - weight * (preload + half * start)) / (1.0 + weight * half), 0.0)
        else:
            overlap = quadratic_root(1.0 + weight * half, weight * preload - start - s, s * start)
        force, slope = mean_force(preload, stiffness, exponent, start, start_power, overlap)
        return overlap, force, resolvent_slope(slope, weight)
    if s < SMALLEST:
        return 0.0, 0.0, 0.0
    # without a useful guess start from the overlap at which the power law alone gives s, if that is below s
    if not table and not 0.0 < guess < s:
        reach = (s / weight - preload) * (1.0 + exponent) / stiffness
        guess = power(reach, 1.0 / exponent) if 0.0 < reach < power(s, exponent) else 0.5 * s
    overlap, force, slope = solve_loaded(graph, i, preload, stiffness, exponent, start, start_power, weight, s, guess)
    return overlap, force, resolvent_slope(slope, weight)
