"""Table of a user-defined contact law: piecewise polynomials for the force, and their integrals for the energy.

    f(d) = sum_k force_k u^k,   E(d) = sum_k energy_k u^k,   u = (2 d - d_j - d_(j+1)) / (d_(j+1) - d_j) on piece j

Each piece interpolates the force at Chebyshev points, including its ends, so that the force is continuous and the
energy is its integral. The first pieces reach from one power of two to the next. The pieces are halved until the
polynomial agrees with the force between the points. At a kink or a step of the force this ends with a piece of
negligible width.
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

# Exponent of the power of two at which the table begins. Overlaps below 1e-283 m count as 0 in every method.
LEAST_POWER = -940
# Exponent of the power of two at which the table ends, 1e25 m. A contact that can be computed is never pressed further.
MOST_POWER = 84
DEGREE = 12  # Degree of the force on a piece: from d to 1.4 d it represents powers of the overlap to round-off.
WANTED = 2e-14  # Wanted error of the polynomial, as a fraction of the largest force of the piece.
# Largest ratio of the forces on a piece. At its beginning at most three digits are lost relative to the largest force.
MOST_RISE = 1e3
STEEP = 8  # Number of halvings. If the forces on a piece still differ by more than MOST_RISE, they count as noise.
MOST_HALVINGS = 48  # Largest number of halvings. The last piece around a kink is then as narrow as round-off.
MOST_FORCE = 1e280  # Largest force [N]: sums of larger forces overflow.
NO_WIDTH = 1e-6  # Fraction of its end. A narrower piece contains a kink or a step of the force.
DIGITS = 1e-9  # Largest relative error of a piece whose force has significant digits.
# Fraction of the force or slope. If two neighbouring pieces differ by more at their common end, there is a kink or
# step.
BENT = 1e-5
NARROWEST = 2.0**-53  # Width at which a bisection inside a piece, in its coordinate [-1, 1], ends.
# If both halves of a piece have more than this fraction of its error, halving does not help: the force is noise.
NOISE = 0.25

POINTS: Array = -np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)  # Chebyshev points of a piece, on [-1, 1].
# Points at which the polynomial is compared with the force.
BETWEEN: Array = -np.cos(np.pi * (np.arange(DEGREE) + 0.5) / DEGREE)
_TO_CHEBYSHEV = np.linalg.inv(chebyshev.chebvander(POINTS, DEGREE))
_COMPARED = chebyshev.chebvander(BETWEEN, DEGREE) @ _TO_CHEBYSHEV
_TO_POWERS = np.array([np.pad(chebyshev.cheb2poly(row), (0, DEGREE - k)) for k, row in enumerate(np.eye(DEGREE + 1))]).T


class LawTable(NamedTuple):
    """The polynomial pieces of a user-defined contact law.

    Attributes:
        edge: (K+1,) overlaps [m] between which the pieces lie, ascending from 0.
        force: (K, DEGREE+1) coefficients of the force [N].
        energy: (K, DEGREE+2) coefficients of the energy [J].
        error: (K,) largest error of the force that was found, relative to the largest force of each piece.
        bend: (B, 3) overlap [m] of each kink or step, and by how much the force [N] and its slope [N/m] change there.
    """

    edge: Array
    force: Array
    energy: Array
    error: Array
    bend: Array

    def values(self, coefficients: Array, overlaps: Array) -> Array:
        """Return the force or the energy, given its `coefficients`, at overlaps (k,) >= 0; NaN beyond the last edge."""
        piece = np.clip(np.searchsorted(self.edge, overlaps, side="right") - 1, 0, len(self.force) - 1)
        low, high = self.edge[piece], self.edge[piece + 1]
        # coordinate from -1 to 1 within the piece
        place = (2.0 * overlaps - low - high) / (high - low)
        found = polyval(place, coefficients[piece].T, tensor=False)
        return np.where(overlaps <= self.edge[-1], found, np.nan)

    def overlap(self, coefficients: Array, value: float) -> float:
        """Return the overlap [m] at which the force or the energy, given its `coefficients`, reaches `value`.

        If it does not, return inf, or the last edge if the law has no values beyond it.
        """
        piece = int(np.searchsorted(coefficients.sum(axis=1), value))
        if piece == len(coefficients):
            return math.inf if self.edge[-1] >= 2.0**MOST_POWER else float(self.edge[-1])
        # bisection, with Horner's rule for the polynomial
        row, low, high = coefficients[piece, ::-1].tolist(), -1.0, 1.0
        while high - low > NARROWEST:
            middle, found = 0.5 * (low + high), 0.0
            for number in row:
                found = found * middle + number
            low, high = (middle, high) if found < value else (low, middle)
        begin, end = self.edge[piece : piece + 2].tolist()
        return float(0.5 * (begin + end + high * (end - begin)))


def law_table(force: Force) -> LawTable:
    """Return the table of `force`, up to the overlap beyond which the force is not finite.

    `force` takes an array of overlaps > 0 and returns NaN if it cannot be evaluated.
    """
    edges = np.concatenate(([0.0], 2.0 ** np.arange(LEAST_POWER, MOST_POWER + 1.0)))
    start, end = edges[:-1], edges[1:]
    found: list[tuple[Array, Array, Array, Array]] = []
    before = np.full(start.size, np.inf)
    for depth in range(MOST_HALVINGS + 1):
        # sample all pending pieces at once
        values, error = _sampled(force, start, end)
        finite = np.isfinite(values).all(axis=1) & np.isfinite(error)
        # a piece is noisy if both halves have nearly the error of the whole
        noisy = (
            (error > NOISE * before).reshape(-1, 2).all(axis=1).repeat(2) if depth else np.zeros(start.size, dtype=bool)
        )
        level = values.max(axis=1) / MOST_RISE <= values.min(axis=1)
        noisy &= level | (depth > STEEP)
        # accept a piece that is accurate, or that more halvings cannot improve
        settled = finite & ((level & (error <= WANTED)) | noisy | (depth == MOST_HALVINGS))
        found.append((start[settled], end[settled], values[settled], error[settled]))
        # the table ends at the first piece with a force that is not finite
        pending = ~settled & (start <= start[~finite].min(initial=np.inf))
        start, end, before = start[pending], end[pending], error[pending]
        if not start.size:
            break
        # halve the remaining pieces
        middle = 0.5 * (start + end)
        start, end = np.column_stack((start, middle)).ravel(), np.column_stack((middle, end)).ravel()
        before = before.repeat(2)
    return _joined(*(np.concatenate(rows) for rows in zip(*found, strict=True)))


def _sampled(force: Force, start: Array, end: Array) -> tuple[Array, Array]:
    """Return the forces at the points of pieces (k,), and the largest error between the points, relative to the largest force."""
    middle, half = 0.5 * (start + end)[:, None], 0.5 * (end - start)[:, None]
    at = np.concatenate((np.maximum(middle + half * POINTS, start[:, None]), middle + half * BETWEEN), axis=1)
    at[:, DEGREE], at[:, 0] = end, np.where(start > 0.0, start, 0.5 * end)  # at overlap 0 itself a law may be undefined
    found = force(at.ravel()).reshape(at.shape)
    values, between = found[:, : DEGREE + 1], found[:, DEGREE + 1 :]
    with np.errstate(all="ignore"):
        error = np.abs(values @ _COMPARED.T - between).max(axis=1) / np.abs(found).max(axis=1)
    return values, np.where(np.isnan(error) & (found == 0.0).all(axis=1), 0.0, error)


def _joined(start: Array, end: Array, values: Array, error: Array) -> LawTable:
    """Return the table of the pieces, up to the first gap between them."""
    order = np.argsort(start)
    start, end, values, error = (row[order] for row in (start, end, values, error))
    # neighbouring pieces must share their ends, and their forces must not overflow in sums
    holds = np.append(end[:-1] == start[1:], False) & (np.abs(values).max(axis=1) < MOST_FORCE)
    whole = int(np.argmin(holds)) + 1
    start, end, values, error = (row[:whole] for row in (start, end, values, error))
    # two products one after the other, because their combined matrix would lose four digits
    force = values @ _TO_CHEBYSHEV.T @ _TO_POWERS.T
    return table_of(np.append(start, end[-1]), force, error, _bends(start, end, values, force, error))


def table_of(edge: Array, force: Array, error: Array, bend: Array) -> LawTable:
    """Return the table with these fields. Its energy is the integral of its force."""
    # integrate each piece, then choose the constants so that the energy is continuous and 0 at overlap 0
    energy = np.zeros((len(force), DEGREE + 2))
    energy[:, 1:] = 0.5 * np.diff(edge)[:, None] * force / np.arange(1, DEGREE + 2)
    signs = (-1.0) ** np.arange(DEGREE + 2)
    gained = energy.sum(axis=1) - energy @ signs
    energy[:, 0] = np.append(0.0, np.cumsum(gained[:-1])) - energy @ signs
    return LawTable(edge, force, energy, error, bend)


def _bends(start: Array, end: Array, values: Array, force: Array, error: Array) -> Array:
    """Return the kinks and steps of the force: places where two consecutive accurate pieces differ at their common end.

    Pieces of negligible width, and pieces without significant digits, are skipped.
    """
    wide = np.flatnonzero((end - start > NO_WIDTH * end) & (error < DIGITS) & (start > 0.0))
    left, right, order = wide[:-1], wide[1:], np.arange(DEGREE + 1)
    half = 0.5 * (end - start)
    # slopes at the right end of each piece and at the left end of the next one
    slope_before = (force[left] @ order) / half[left]
    slope_after = (force[right] @ (order * (-1.0) ** (order + 1))) / half[right]
    # step of the force and of its slope, corrected for the distance between the two pieces
    rise, turn = values[right, 0] - values[left, -1], slope_after - slope_before
    apart = start[right] - end[left]
    rise -= 0.5 * apart * (slope_before + slope_after)
    # compare with the larger of the two slopes, or with the mean slope from overlap 0
    largest = np.maximum(np.maximum(np.abs(slope_before), np.abs(slope_after)), values[right, 0] / end[left])
    bent = (np.abs(turn) > BENT * largest) | (np.abs(rise) > BENT * values[right, 0])
    near = apart <= (STEEP + 1) * NO_WIDTH * end[left]
    found = np.column_stack((0.5 * (end[left] + start[right]), np.abs(rise), np.abs(turn)))
    return found[bent & near]
