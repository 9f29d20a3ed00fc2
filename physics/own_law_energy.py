"""The energy that a contact stores, integrated from its force once: nodes close enough for one Gauss formula between two.

    E(d) = E(d_k) + sum_q weight_q f(d_k + (d - d_k) node_q) (d - d_k),      d_k the last node below d

Nodes are powers of two, and where the force bends between them, halves of halves, until the formula over a whole interval
and over its two halves agree. So the energy is exact to round-off wherever the force has no jump.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Scalar = Callable[[float], float]

LEAST_POWER = -940  # of two: overlaps below 1e-283 m count as 0 in every method
MOST_POWER = 84  # of two: no contact that is computed is pressed further than 1e25 m
POINTS = 10  # of the formula: on an interval from d to 2 d it is exact to round-off for powers of the overlap
AGREES = 4e-16  # of the energy so far: what a whole interval and its halves may differ by
MOST_HALVINGS = 48  # one in another: what is left around a bend then is no more than round-off
MOST_PARTS = 64  # between two powers of two: a force that bends more often there is noise, and is taken as it is

_points, _weights = np.polynomial.legendre.leggauss(POINTS)
NODES: Array = 0.5 * (_points + 1.0)  # on [0, 1]
WEIGHTS: Array = 0.5 * _weights


class StoredEnergy(NamedTuple):
    """Overlaps [m], ascending from 0, and the energies [J] stored at them."""

    overlap: Array
    energy: Array


def integrate(force: Callable[[Array], Array]) -> StoredEnergy:
    """Integrate `force`, which takes an array of overlaps > 0 and gives nan where it cannot, as far up as it is finite."""
    edges = np.concatenate(([0.0], 2.0 ** np.arange(LEAST_POWER, MOST_POWER + 1)))
    whole, halves = _parts(force, edges[:-1], edges[1:])
    overlaps, energies = [0.0], [0.0]
    for k in range(edges.size - 1):
        pending, parts = [(float(edges[k]), float(edges[k + 1]), float(whole[k]), float(halves[k]), 0)], 1
        while pending:
            start, end, once, twice, depth = pending.pop()
            stops = depth == MOST_HALVINGS or parts == MOST_PARTS
            if stops and not math.isfinite(twice):
                return StoredEnergy(np.array(overlaps), np.array(energies))
            if stops or abs(once - twice) <= AGREES * (energies[-1] + abs(twice)) + math.ulp(0.0):
                overlaps.append(end)
                energies.append(energies[-1] + twice)
                continue
            parts += 1
            middle = 0.5 * (start + end)
            left, right = np.array([start, middle]), np.array([middle, end])
            (a, b), (c, d) = _parts(force, left, right)
            pending += [(middle, end, float(b), float(d), depth + 1), (start, middle, float(a), float(c), depth + 1)]
    return StoredEnergy(np.array(overlaps), np.array(energies))


def _parts(force: Callable[[Array], Array], start: Array, end: Array) -> tuple[Array, Array]:
    """Integrals over intervals (k,), by one formula each and by one over either half."""
    middle = 0.5 * (start + end)
    return _formula(force, start, end), _formula(force, start, middle) + _formula(force, middle, end)


def _formula(force: Callable[[Array], Array], start: Array, end: Array) -> Array:
    width = end - start
    overlaps = start[:, None] + width[:, None] * NODES
    values = force(overlaps.ravel()).reshape(overlaps.shape)
    with np.errstate(over="ignore", invalid="ignore"):
        found: Array = (values @ WEIGHTS) * width
    return found


def energy_function(force: Scalar, stored: StoredEnergy) -> Scalar:
    """The energy [J] at one overlap > 0 from the nodes; nan beyond the last. Compiled, or as plain Python."""
    overlaps, energies, nodes, weights = *stored, NODES, WEIGHTS
    last = float(overlaps[-1])

    def energy(overlap: float) -> float:
        if not overlap <= last:
            return math.nan
        low, high = 0, overlaps.size
        while high - low > 1:
            middle = (low + high) // 2
            if overlaps[middle] <= overlap:
                low = middle
            else:
                high = middle
        start = overlaps[low]
        width, mean = overlap - start, 0.0
        for q in range(nodes.size):
            mean += weights[q] * force(start + width * nodes[q])
        return energies[low] + width * mean

    return energy
