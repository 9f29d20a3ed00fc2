"""A law of one's own as a table: pieces of polynomials for its force, and their integrals for its energy.

    f(d) = sum_k force_k u^k,   E(d) = sum_k energy_k u^k,   u = (2 d - d_j - d_(j+1)) / (d_(j+1) - d_j) on piece j

A piece interpolates the force at Chebyshev points, its ends among them, so that the force is continuous and the energy is its
integral. Pieces are powers of two, halved until the force between the points agrees; around a bend that is a piece of no width.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

Array = NDArray[np.float64]
Force = Callable[[Array], Array]

LEAST_POWER = -940  # of two: overlaps below 1e-283 m count as 0 in every method
MOST_POWER = 84  # of two: no contact that is computed is pressed further than 1e25 m
DEGREE = 12  # of the force on a piece: from d to 1.4 d it is exact to round-off for powers of the overlap
WANTED = 2e-14  # of the largest force of a piece: what the polynomial may differ by
MOST_RISE = 1e3  # of the force on a piece: where it begins three digits of the largest are lost, and no more
STEEP = 8  # halvings after which a force that still rises by more does so by noise
MOST_HALVINGS = 48  # one in another: what is left around a bend then is no more than round-off
MOST_FORCE = 1e280  # [N] sums of larger ones overflow
NO_WIDTH = 1e-6  # of its end: a piece narrower than this is around a bend
DIGITS = 1e-9  # relative error of a piece whose force has digits
BENT = 1e-5  # of force or slope: two pieces that differ by more where they meet do so at a bend
NARROWEST = 2.0**-53  # of half a piece
NOISE = 0.25  # of the error of a piece: where both halves have more, the force has no more digits

POINTS: Array = -np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)  # of a piece, on [-1, 1]
BETWEEN: Array = -np.cos(np.pi * (np.arange(DEGREE) + 0.5) / DEGREE)  # where the polynomial is compared with the force
_TO_CHEBYSHEV = np.linalg.inv(chebyshev.chebvander(POINTS, DEGREE))
_COMPARED = chebyshev.chebvander(BETWEEN, DEGREE) @ _TO_CHEBYSHEV
_TO_POWERS = np.array([np.pad(chebyshev.cheb2poly(row), (0, DEGREE - k)) for k, row in enumerate(np.eye(DEGREE + 1))]).T


class LawTable(NamedTuple):
    """Pieces of a law.

    Attributes:
        edge: (K+1,) overlaps [m] between which the pieces lie, ascending from 0.
        force: (K, DEGREE+1) coefficients of the force [N].
        energy: (K, DEGREE+2) coefficients of the energy [J].
        error: (K,) largest error of the force that was seen, relative to the largest force of each piece.
        bend: (B, 3) overlap [m] of each bend or jump, and by how much the force [N] and its slope [N/m] jump there.
    """

    edge: Array
    force: Array
    energy: Array
    error: Array
    bend: Array

    def values(self, coefficients: Array, overlaps: Array) -> Array:
        """The force or the energy at overlaps (k,) >= 0 by its `coefficients`; nan beyond the last edge."""
        piece = np.clip(np.searchsorted(self.edge, overlaps, side="right") - 1, 0, len(self.force) - 1)
        low, high = self.edge[piece], self.edge[piece + 1]
        place = (2.0 * overlaps - low - high) / (high - low)
        found = polyval(place, coefficients[piece].T, tensor=False)
        return np.where(overlaps <= self.edge[-1], found, np.nan)

    def overlap(self, coefficients: Array, value: float) -> float:
        """The overlap [m] at which the force or the energy, by its `coefficients`, reaches `value`.

        Where it does not it is inf, or the last edge of a law that has no numbers beyond it.
        """
        piece = int(np.searchsorted(coefficients.sum(axis=1), value))
        if piece == len(coefficients):
            return math.inf if self.edge[-1] >= 2.0**MOST_POWER else float(self.edge[-1])
        row, low, high = coefficients[piece, ::-1].tolist(), -1.0, 1.0
        while high - low > NARROWEST:
            middle, found = 0.5 * (low + high), 0.0
            for number in row:
                found = found * middle + number
            low, high = (middle, high) if found < value else (low, middle)
        begin, end = self.edge[piece : piece + 2].tolist()
        return float(0.5 * (begin + end + high * (end - begin)))


def law_table(force: Force) -> LawTable:
    """The table of `force`, which takes an array of overlaps > 0 and gives nan where it cannot, as far up as it is finite."""
    edges = np.concatenate(([0.0], 2.0 ** np.arange(LEAST_POWER, MOST_POWER + 1.0)))
    start, end = edges[:-1], edges[1:]
    found: list[tuple[Array, Array, Array, Array]] = []
    before = np.full(start.size, np.inf)
    for depth in range(MOST_HALVINGS + 1):
        values, error = _sampled(force, start, end)
        finite = np.isfinite(values).all(axis=1) & np.isfinite(error)
        noisy = (
            (error > NOISE * before).reshape(-1, 2).all(axis=1).repeat(2) if depth else np.zeros(start.size, dtype=bool)
        )
        level = values.max(axis=1) / MOST_RISE <= values.min(axis=1)
        noisy &= level | (depth > STEEP)
        settled = finite & ((level & (error <= WANTED)) | noisy | (depth == MOST_HALVINGS))
        found.append((start[settled], end[settled], values[settled], error[settled]))
        # above a force that is no number there is no table
        pending = ~settled & (start <= start[~finite].min(initial=np.inf))
        start, end, before = start[pending], end[pending], error[pending]
        if not start.size:
            break
        middle = 0.5 * (start + end)
        start, end = np.column_stack((start, middle)).ravel(), np.column_stack((middle, end)).ravel()
        before = before.repeat(2)
    return _joined(*(np.concatenate(rows) for rows in zip(*found, strict=True)))


def _sampled(force: Force, start: Array, end: Array) -> tuple[Array, Array]:
    """Forces at the points of pieces (k,), and the error between them, relative to the largest."""
    middle, half = 0.5 * (start + end)[:, None], 0.5 * (end - start)[:, None]
    at = np.concatenate((np.maximum(middle + half * POINTS, start[:, None]), middle + half * BETWEEN), axis=1)
    at[:, DEGREE], at[:, 0] = end, np.where(start > 0.0, start, 0.5 * end)  # at 0 a law may have no number
    found = force(at.ravel()).reshape(at.shape)
    values, between = found[:, : DEGREE + 1], found[:, DEGREE + 1 :]
    with np.errstate(all="ignore"):
        error = np.abs(values @ _COMPARED.T - between).max(axis=1) / np.abs(found).max(axis=1)
    return values, np.where(np.isnan(error) & (found == 0.0).all(axis=1), 0.0, error)


def _joined(start: Array, end: Array, values: Array, error: Array) -> LawTable:
    """The table of pieces, up to the first place that none of them holds."""
    order = np.argsort(start)
    start, end, values, error = (row[order] for row in (start, end, values, error))
    holds = np.append(end[:-1] == start[1:], False) & (np.abs(values).max(axis=1) < MOST_FORCE)
    whole = int(np.argmin(holds)) + 1
    start, end, values, error = (row[:whole] for row in (start, end, values, error))
    force = values @ _TO_CHEBYSHEV.T @ _TO_POWERS.T  # at once the two would lose four digits
    return table_of(np.append(start, end[-1]), force, error, _bends(start, end, values, force, error))


def table_of(edge: Array, force: Array, error: Array, bend: Array) -> LawTable:
    """The table with these fields; its energy is the integral of its force."""
    energy = np.zeros((len(force), DEGREE + 2))
    energy[:, 1:] = 0.5 * np.diff(edge)[:, None] * force / np.arange(1, DEGREE + 2)
    signs = (-1.0) ** np.arange(DEGREE + 2)
    gained = energy.sum(axis=1) - energy @ signs
    energy[:, 0] = np.append(0.0, np.cumsum(gained[:-1])) - energy @ signs
    return LawTable(edge, force, energy, error, bend)


def _bends(start: Array, end: Array, values: Array, force: Array, error: Array) -> Array:
    """Bends and jumps between pieces that are wide, and have digits: where the ends of two that follow each other differ."""
    wide = np.flatnonzero((end - start > NO_WIDTH * end) & (error < DIGITS) & (start > 0.0))
    left, right, order = wide[:-1], wide[1:], np.arange(DEGREE + 1)
    half = 0.5 * (end - start)
    slope_before = (force[left] @ order) / half[left]
    slope_after = (force[right] @ (order * (-1.0) ** (order + 1))) / half[right]
    rise, turn = values[right, 0] - values[left, -1], slope_after - slope_before
    apart = start[right] - end[left]
    rise -= 0.5 * apart * (slope_before + slope_after)
    largest = np.maximum(np.maximum(np.abs(slope_before), np.abs(slope_after)), values[right, 0] / end[left])
    bent = (np.abs(turn) > BENT * largest) | (np.abs(rise) > BENT * values[right, 0])
    near = apart <= (STEEP + 1) * NO_WIDTH * end[left]
    found = np.column_stack((0.5 * (end[left] + start[right]), np.abs(rise), np.abs(turn)))
    return found[bent & near]
