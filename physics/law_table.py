"""Table of a user-defined contact law: piecewise polynomials for the force, and their integrals for the energy.

    f(d) = sum_k force_k u^k,   E(d) = sum_k energy_k u^k,   u = (2 d - d_j - d_(j+1)) / (d_(j+1) - d_j) on piece j

Here f is the force, E the energy and d the overlap. Each piece interpolates the force at Chebyshev points, including
both ends. The force is therefore continuous, and the energy is its integral. The initial pieces extend from one power
of two to the next. Each piece is halved until the polynomial agrees with the force between the points. At a kink or a
step of the force, the last piece has a negligible width.
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

# The table begins at 2 to the power of this exponent. Overlaps below 1e-283 m count as 0 in every method.
LEAST_POWER = -940
# The table ends at 2 to the power of this exponent, 1e25 m. Contacts with a larger overlap cannot be simulated.
MOST_POWER = 84
# Degree of the polynomials. From d to 1.4 d, they represent powers of the overlap with an error of the size of
# round-off.
DEGREE = 12
WANTED = 2e-14  # Wanted error of the polynomial, as a fraction of the largest force of the piece.
# Largest ratio of the forces in a piece. At the beginning of the piece, at most three digits are lost relative to the
# largest force.
MOST_RISE = 1e3
# Number of halvings of a piece after which its force counts as noise if it still varies by more than MOST_RISE.
STEEP = 8
MOST_HALVINGS = 48  # Largest number of halvings. The last piece at a kink then has a width of the size of round-off.
MOST_FORCE = 1e280  # Largest force [N]. Sums of larger forces would overflow.
# Width of a piece, relative to the overlap at its end, below which the piece contains a kink or a step of the force.
NO_WIDTH = 1e-6
DIGITS = 1e-9  # Largest relative error of a piece that counts as accurate to some digits.
# Relative difference of force or slope between two neighbouring pieces that counts as a kink or a step.
BENT = 1e-5
NARROWEST = 2.0**-53  # Width at which a bisection inside a piece ends. The coordinate inside a piece runs from -1 to 1.
# Fraction of the error of a piece. If both halves have a larger error, halving does not help, and the force is noise.
NOISE = 0.25

POINTS: Array = -np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)  # Chebyshev points of a piece, in the interval [-1, 1].
# Points at which the polynomial is compared with the force.
BETWEEN: Array = -np.cos(np.pi * (np.arange(DEGREE) + 0.5) / DEGREE)
_TO_CHEBYSHEV = np.linalg.inv(chebyshev.chebvander(POINTS, DEGREE))
_COMPARED = chebyshev.chebvander(BETWEEN, DEGREE) @ _TO_CHEBYSHEV
_TO_POWERS = np.array([np.pad(chebyshev.cheb2poly(row), (0, DEGREE - k)) for k, row in enumerate(np.eye(DEGREE + 1))]).T


class LawTable(NamedTuple):
    """Table of the polynomial pieces of a user-defined contact law.

    Attributes:
        edge: (K+1,) overlaps [m] at which the pieces begin and end, ascending from 0.
        force: (K, DEGREE+1) coefficients of the force [N].
        energy: (K, DEGREE+2) coefficients of the energy [J].
        error: (K,) largest error of the force in each piece, relative to the largest force of the piece.
        bend: (B, 3) overlap [m] of each kink or step, with the change of the force [N] and the change of its slope
            [N/m].
    """

    edge: Array
    force: Array
    energy: Array
    error: Array
    bend: Array

    def values(self, coefficients: Array, overlaps: Array) -> Array:
        """Return the force or the energy at overlaps (k,) >= 0. The result is NaN beyond the last edge.

        `coefficients` are those of the force or of the energy.
        """
        piece = np.clip(np.searchsorted(self.edge, overlaps, side="right") - 1, 0, len(self.force) - 1)
        low, high = self.edge[piece], self.edge[piece + 1]
        # coordinate from -1 to 1 within the piece
        place = (2.0 * overlaps - low - high) / (high - low)
        found = polyval(place, coefficients[piece].T, tensor=False)
        return np.where(overlaps <= self.edge[-1], found, np.nan)

    def overlap(self, coefficients: Array, value: float) -> float:
        """Return the overlap [m] at which the force or the energy reaches `value`.

        `coefficients` are those of the force or of the energy. If the value is never reached, return inf. If the law is
        undefined beyond the last edge, return the last edge.
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
    """Return the table of `force`. The table ends at the overlap above which the force is not finite.

    The function `force` takes an array of overlaps > 0. The function returns NaN for overlaps at which it cannot be
    evaluated.
    """
    edges = np.concatenate(([0.0], 2.0 ** np.arange(LEAST_POWER, MOST_POWER + 1.0)))
    start, end = edges[:-1], edges[1:]
    found: list[tuple[Array, Array, Array, Array]] = []
    before = np.full(start.size, np.inf)
    for depth in range(MOST_HALVINGS + 1):
        # sample all pending pieces at once
        values, error = _sampled(force, start, end)
        finite = np.isfinite(values).all(axis=1) & np.isfinite(error)
        # A piece is noisy if both halves have nearly the same error as the whole piece.
        noisy = (
            (error > NOISE * before).reshape(-1, 2).all(axis=1).repeat(2) if depth else np.zeros(start.size, dtype=bool)
        )
        level = values.max(axis=1) / MOST_RISE <= values.min(axis=1)
        noisy &= level | (depth > STEEP)
        # Accept a piece that is accurate, or that further halving cannot improve.
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
    """Return the forces at the Chebyshev points of pieces (k,), and the largest error between these points.

    The error is relative to the largest force of each piece.
    """
    middle, half = 0.5 * (start + end)[:, None], 0.5 * (end - start)[:, None]
    at = np.concatenate((np.maximum(middle + half * POINTS, start[:, None]), middle + half * BETWEEN), axis=1)
    at[:, DEGREE], at[:, 0] = end, np.where(start > 0.0, start, 0.5 * end)  # A law may be undefined at overlap 0.
    found = force(at.ravel()).reshape(at.shape)
    values, between = found[:, : DEGREE + 1], found[:, DEGREE + 1 :]
    with np.errstate(all="ignore"):
        error = np.abs(values @ _COMPARED.T - between).max(axis=1) / np.abs(found).max(axis=1)
    return values, np.where(np.isnan(error) & (found == 0.0).all(axis=1), 0.0, error)


def _joined(start: Array, end: Array, values: Array, error: Array) -> LawTable:
    """Return the table of the given pieces, up to the first gap between two pieces."""
    order = np.argsort(start)
    start, end, values, error = (row[order] for row in (start, end, values, error))
    # Neighbouring pieces must have a common end. The forces of pieces must not overflow in sums.
    holds = np.append(end[:-1] == start[1:], False) & (np.abs(values).max(axis=1) < MOST_FORCE)
    whole = int(np.argmin(holds)) + 1
    start, end, values, error = (row[:whole] for row in (start, end, values, error))
    # Two consecutive products. A single product with the combined matrix would lose four digits.
    force = values @ _TO_CHEBYSHEV.T @ _TO_POWERS.T
    return table_of(np.append(start, end[-1]), force, error, _bends(start, end, values, force, error))


def table_of(edge: Array, force: Array, error: Array, bend: Array) -> LawTable:
    """Return the table with the given fields. Its energy is the integral of its force."""
    # Integrate each piece. Then choose the constants of integration: the energy is continuous, and 0 at overlap 0.
    energy = np.zeros((len(force), DEGREE + 2))
    energy[:, 1:] = 0.5 * np.diff(edge)[:, None] * force / np.arange(1, DEGREE + 2)
    signs = (-1.0) ** np.arange(DEGREE + 2)
    gained = energy.sum(axis=1) - energy @ signs
    energy[:, 0] = np.append(0.0, np.cumsum(gained[:-1])) - energy @ signs
    return LawTable(edge, force, energy, error, bend)


def _bends(start: Array, end: Array, values: Array, force: Array, error: Array) -> Array:
    """Return the kinks and steps of the force.

    At such an overlap, two consecutive accurate pieces differ at their common end. Pieces of negligible width, and
    pieces without significant digits, are skipped.
    """
    wide = np.flatnonzero((end - start > NO_WIDTH * end) & (error < DIGITS) & (start > 0.0))
    left, right, order = wide[:-1], wide[1:], np.arange(DEGREE + 1)
    half = 0.5 * (end - start)
    # slopes at the right end of each piece and at the left end of the next one
    slope_before = (force[left] @ order) / half[left]
    slope_after = (force[right] @ (order * (-1.0) ** (order + 1))) / half[right]
    # Step of the force and change of its slope, corrected for the distance between the two pieces.
    rise, turn = values[right, 0] - values[left, -1], slope_after - slope_before
    apart = start[right] - end[left]
    rise -= 0.5 * apart * (slope_before + slope_after)
    # Compare with the larger of the two slopes, or with the mean slope from overlap 0 to the step.
    largest = np.maximum(np.maximum(np.abs(slope_before), np.abs(slope_after)), values[right, 0] / end[left])
    bent = (np.abs(turn) > BENT * largest) | (np.abs(rise) > BENT * values[right, 0])
    near = apart <= (STEEP + 1) * NO_WIDTH * end[left]
    found = np.column_stack((0.5 * (end[left] + start[right]), np.abs(rise), np.abs(turn)))
    return found[bent & near]
