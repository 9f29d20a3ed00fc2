"""Kernels for segments whose force and energy are tables of polynomials: value, slope, inverse and mean force.

Each function takes the Graphs and the row p of the segment. `softcradle.physics.law_table` builds the tables.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.law_kernels import EPSILON, MOST_SCALAR, newton_in_bracket
from softcradle.physics.numerics.records import TABLE

Array = NDArray[np.float64]

# Distance between the ends of a step, as a fraction of the overlap at its start. Below it the mean force is a
# quadrature of the force, because the difference of the energies would cancel.
NEAR = 0.05
# Fraction of the overlap. For a shorter step the force between both ends is treated as a straight line.
SAME = 1e-9
# Round-off of the difference of two energies, as a fraction of the larger one. If the quadrature of the force differs
# by more, a breakpoint lies between the ends of the step.
DOUBT = 8.0 * EPSILON

_points, _weights = np.polynomial.legendre.leggauss(4)
# Nodes and weights of the Gauss-Legendre quadrature on [0, 1]. Up to a distance of NEAR it is exact to round-off.
NODES: Array = 0.5 * (_points + 1.0)
WEIGHTS: Array = 0.5 * _weights


@inlined
def has_table(graph, i):
    """Return True if the graph of contact i is a table."""
    return graph.kind.size > 0 and graph.kind[i] == TABLE


@jit
def piece_of(graph, p, overlap):
    """Return the index of the piece of segment p that contains an overlap > 0, by binary search."""
    low, high = graph.table[p, 0], graph.table[p, 1]
    while high - low > 1:
        middle = (low + high) // 2
        if graph.edge[middle, 0] <= overlap:
            low = middle
        else:
            high = middle
    return low


@inlined
def polynomial(row, place):
    """Return the value of a polynomial at `place` in [-1, 1], by Horner's rule."""
    value = row[row.size - 1]
    for k in range(row.size - 2, -1, -1):
        value = value * place + row[k]
    return value


@inlined
def polynomial_slope(row, place):
    """Return the derivative of a polynomial at `place`."""
    slope = 0.0
    for k in range(row.size - 1, 0, -1):
        slope = slope * place + k * row[k]
    return slope


@inlined
def end_of(graph, p):
    """Return the overlap [m] at which the table of segment p ends."""
    return graph.edge[graph.table[p, 1] - 1, 1]


@jit
def table_value(graph, coefficients, p, overlap):
    """Return the value of the table of segment p at an overlap > 0, or NaN beyond the end of the table."""
    if not overlap <= end_of(graph, p):
        return math.nan
    piece = piece_of(graph, p, overlap)
    begin, end = graph.edge[piece, 0], graph.edge[piece, 1]
    return polynomial(coefficients[piece], (2.0 * overlap - begin - end) / (end - begin))


@jit
def table_slope(graph, p, overlap):
    """Return the slope df/dd >= 0 [N/m] at an overlap > 0, or NaN beyond the end of the table."""
    if not overlap <= end_of(graph, p):
        return math.nan
    piece = piece_of(graph, p, overlap)
    begin, end = graph.edge[piece, 0], graph.edge[piece, 1]
    place = (2.0 * overlap - begin - end) / (end - begin)
    return max(2.0 * polynomial_slope(graph.force[piece], place) / (end - begin), 0.0)


@jit
def table_inverse(graph, coefficients, p, value):
    """Return the overlap [m] at which the force or the energy of segment p reaches `value`; inf if it does not reach it."""
    low, high = graph.table[p, 0], graph.table[p, 1]
    # the last piece does not reach the value
    if not polynomial(coefficients[high - 1], 1.0) >= value:
        return math.inf
    while high - low > 1:  # binary search for the last piece that begins below the value, or the first piece
        middle = (low + high) // 2
        if polynomial(coefficients[middle], -1.0) < value:
            low = middle
        else:
            high = middle
    row, begin, end = coefficients[low], graph.edge[low, 0], graph.edge[low, 1]
    # Newton's method with a bracket, in the coordinate [-1, 1] of the piece
    left, right, place, following = -1.0, 1.0, 0.0, 0.0
    for _ in range(MOST_SCALAR):
        excess, slope = polynomial(row, place) - value, polynomial_slope(row, place)
        following, left, right = newton_in_bracket(place, excess, slope, left, right)
        if abs(following - place) <= EPSILON or not left < following < right:
            break
        place = following
    return 0.5 * (begin + end + following * (end - begin))


@inlined
def breakpoint_force(graph, i, start, end):
    """Return the part of the force [N] at overlap `end` that comes from breakpoints of the table between `start` and `end`."""
    found = 0.0
    if has_table(graph, i):
        p = graph.first[i]
        for k in range(graph.table[p, 2], graph.table[p, 3]):
            # a step of the force contributes fully, a change of slope in proportion to the distance
            at = graph.breakpoint[k, 0]
            if min(start, end) < at < max(start, end):
                found = max(found, graph.breakpoint[k, 1] + graph.breakpoint[k, 2] * abs(end - at))
    return found


@jit
def table_mean(graph, p, start, overlap):
    """Return the mean force (E(d1)-E(d0))/(d1-d0) and its derivative by d1 > 0, without cancellation if d1 is near d0."""
    # a step of negligible length: force and slope in its middle
    distance = overlap - start
    if start > 0.0 and abs(distance) < SAME * start:
        middle = 0.5 * (start + overlap)
        return table_value(graph, graph.force, p, middle), 0.5 * table_slope(graph, p, middle)
    # the difference of the energies is right, but loses digits if the ends are near each other
    end = table_value(graph, graph.energy, p, overlap)
    begin = table_value(graph, graph.energy, p, start) if start > 0.0 else 0.0
    mean = (end - begin) / distance
    # the quadrature has more digits, unless a breakpoint lies between the ends: then both disagree
    if start > 0.0 and abs(distance) < NEAR * start:
        smooth = 0.0
        for q in range(NODES.size):
            smooth += WEIGHTS[q] * table_value(graph, graph.force, p, start + distance * NODES[q])
        if abs(smooth - mean) * abs(distance) <= DOUBT * max(begin, end):
            mean = smooth
    return mean, max((table_value(graph, graph.force, p, overlap) - mean) / distance, 0.0)
