"""Contacts with laws of one's own inside kernels: force, mean force and energy from the tables of these laws.

A kernel gets the tables as a record, or None in its place where all contacts are power laws.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.numerics.jit import inlined, jit
from softcradle.physics.numerics.law_kernels import EPSILON, MOST_SCALAR
from softcradle.physics.numerics.law_kernels import force as power_force

Array = NDArray[np.float64]

NEAR = 0.05  # of the overlap at the start: nearer ends take the mean of forces, for the difference of energies cancels
SAME = 1e-9  # of the overlap: from there to an end so near the force is a straight line
DOUBT = 8.0 * EPSILON  # of the energy: round-off of its difference; the mean of forces must agree to that

_points, _weights = np.polynomial.legendre.leggauss(4)
NODES: Array = 0.5 * (_points + 1.0)  # of the mean of forces: to a distance of NEAR it is exact to round-off
WEIGHTS: Array = 0.5 * _weights


class OwnLaws(NamedTuple):
    """Which contacts have laws of their own, and the tables of these laws, one after another: see `own_law_table`."""

    number: NDArray[np.int64]  # (n,) number of the law of each contact; -1: its row of the law table
    first: NDArray[np.int64]  # (laws+1,) first piece of each law
    edge: Array  # (pieces,) overlaps [m] at which pieces begin; 0 where a law does
    end: Array  # (laws,) overlaps [m] beyond which there is no number
    onset: Array  # (laws, 2) overlap [m] below which the law is what it begins like, and the force there above its preload [N]
    force: Array  # (pieces, degree+1) coefficients
    energy: Array  # (pieces, degree+2)
    first_bend: NDArray[np.int64]  # (laws+1,) first bend of each law
    bend: Array  # (bends, 3) overlap [m] of a bend, and by how much the force [N] and its slope [N/m] jump there


@jit
def piece_of(own, number, overlap):
    """The piece of law `number` in which an overlap > 0 lies, and where it ends."""
    low, high = own.first[number], own.first[number + 1]
    while high - low > 1:
        middle = (low + high) // 2
        if own.edge[middle] <= overlap:
            low = middle
        else:
            high = middle
    return low, end_of(own, number, low)


@inlined
def end_of(own, number, piece):
    """Where a piece of law `number` ends."""
    return own.edge[piece + 1] if piece + 1 < own.first[number + 1] else own.end[number]


@inlined
def polynomial(row, place):
    """The value of a polynomial at `place` in [-1, 1]."""
    value = row[row.size - 1]
    for k in range(row.size - 2, -1, -1):
        value = value * place + row[k]
    return value


@jit
def table_value(own, coefficients, number, overlap):
    """The polynomial of the piece of law `number` in which an overlap > 0 lies; nan beyond its table."""
    if not overlap <= own.end[number]:
        return math.nan
    piece, end = piece_of(own, number, overlap)
    begin = own.edge[piece]
    return polynomial(coefficients[piece], (2.0 * overlap - begin - end) / (end - begin))


@jit
def own_slope(own, number, overlap):
    """Slope df/dd >= 0 of law `number` at an overlap > 0; nan beyond its table."""
    if not overlap <= own.end[number]:
        return math.nan
    piece, end = piece_of(own, number, overlap)
    row, begin = own.force[piece], own.edge[piece]
    place, value = (2.0 * overlap - begin - end) / (end - begin), 0.0
    for k in range(row.size - 1, 0, -1):
        value = value * place + k * row[k]
    return max(2.0 * value / (end - begin), 0.0)


@jit
def own_inverse(own, coefficients, number, value):
    """The overlap at which the force or the energy of law `number` reaches `value`; inf where it does not."""
    low, high = own.first[number], own.first[number + 1]
    if not polynomial(coefficients[high - 1], 1.0) >= value:
        return math.inf
    while high - low > 1:  # the last piece that begins below the value, or the first
        middle = (low + high) // 2
        if polynomial(coefficients[middle], -1.0) < value:
            low = middle
        else:
            high = middle
    row, begin, end = coefficients[low], own.edge[low], end_of(own, number, low)
    left, right, place = -1.0, 1.0, 0.0
    for _ in range(MOST_SCALAR):
        lacks, slope = value - polynomial(row, place), 0.0
        if lacks > 0.0:
            left = place
        else:
            right = place
        for k in range(row.size - 1, 0, -1):
            slope = slope * place + k * row[k]
        following = place + lacks / slope if slope > 0.0 else right
        if not left < following < right:
            following = 0.5 * (left + right)
        if abs(following - place) <= EPSILON or not left < following < right:
            break
        place = following
    return 0.5 * (begin + end + following * (end - begin))


@inlined
def bend_passed(own, i, start, end):
    """The force [N] that contact i has at overlap `end` beyond what its law, without the bends on the way there, would have."""
    found = 0.0
    if own is not None and own.number[i] >= 0:
        for k in range(own.first_bend[own.number[i]], own.first_bend[own.number[i] + 1]):
            at = own.bend[k, 0]
            if min(start, end) < at < max(start, end):
                found = max(found, own.bend[k, 1] + own.bend[k, 2] * abs(end - at))
    return found


@inlined
def number_of(own, i):
    """The number of the law of contact i; -1 where it is the power law."""
    if own is None:
        return -1
    return own.number[i]


@inlined
def force_at(law, own, i, overlap):
    """Force of contact i at `overlap`, 0 where it is open."""
    if own is not None and own.number[i] >= 0:
        return table_value(own, own.force, own.number[i], overlap) if overlap > 0.0 else 0.0
    return power_force(law[i, 0], law[i, 1], law[i, 2], overlap)


@jit
def own_mean_force(own, number, start, overlap):
    """Mean force g = (E(d1)-E(d0))/(d1-d0) and slope dg/dd1 for d1 > 0, without cancellation where d1 is near d0."""
    distance = overlap - start
    if start > 0.0 and abs(distance) < SAME * start:
        middle = 0.5 * (start + overlap)
        return table_value(own, own.force, number, middle), 0.5 * own_slope(own, number, middle)
    end = table_value(own, own.energy, number, overlap)
    begin = table_value(own, own.energy, number, start) if start > 0.0 else 0.0
    mean = (end - begin) / distance
    if start > 0.0 and abs(distance) < NEAR * start:
        smooth = 0.0
        for q in range(NODES.size):
            smooth += WEIGHTS[q] * table_value(own, own.force, number, start + distance * NODES[q])
        if abs(smooth - mean) * abs(distance) <= DOUBT * max(begin, end):
            mean = smooth
    return mean, max((table_value(own, own.force, number, overlap) - mean) / distance, 0.0)
