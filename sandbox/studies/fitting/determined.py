"""Error bars of a fit, and a plain statement of what the data cannot determine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.motion import Array
from softcradle.sandbox.studies.fitting.parameters import FreeValue

# Error bar of a coordinate (relative for positive values, in units of the scale for others) from which on a value counts as
# undetermined. Linear error propagation is then no longer a good approximation.
WIDE = 0.4
# Singular value of the Jacobian with columns of norm 1, below which the free values are not separately determined. The
# errors of the finite differences are of this size.
SMALLEST_SINGULAR = 1e-5
# Share of a coordinate in a direction that the data do not determine, relative to the largest, from which on the value is
# part of this statement.
PART = 0.1
# Correlation from which on two values are reported as determined together.
STRONG = 0.99
# Distance from a bound, in error bars or relative to the coordinate, at which a value lies on the bound.
ON_BOUND = 1e-3
# Autocorrelation of neighbouring residuals, in units of its standard deviation for random residuals, from which on the
# residuals are not random.
NOT_RANDOM = 5.0


@dataclass(frozen=True)
class Determined:
    """Error bars of the coordinates.

    Attributes:
        errors: (p,) standard deviations of the coordinates; inf if undetermined, NaN at a bound.
        correlation: (p, p); NaN for values without an error bar.
        known: (p,) True for values that the data determine.
        singular: singular values of the Jacobian with columns of norm 1.
        statements: sentences for the user.
    """

    errors: Array
    correlation: Array
    known: NDArray[np.bool_]
    singular: Array
    statements: tuple[str, ...]


def determine(free: Sequence[FreeValue], z: Array, jacobian: Array, variance: float, floor: float) -> Determined:
    """Return the error bars at the coordinates `z`.

    `jacobian` (N, p) contains derivatives of the weighted residuals by the coordinates, `variance` is that of a weighted
    residual, and `floor` is the norm below which a column is only an error of the finite differences.
    """
    p = len(free)
    norm = np.linalg.norm(jacobian, axis=0)
    errors, correlation = np.full(p, math.inf), np.full((p, p), math.nan)
    statements = list[str]()
    spread = math.sqrt(variance)
    # Without noise the residuals are the errors of the runs.
    alone = max(spread, 1e-30) / np.maximum(norm, 1e-300)
    at_bound = np.zeros(p, dtype=bool)
    for k, one in enumerate(free):
        side = _bound(one, float(z[k]), float(alone[k]))
        if side:
            at_bound[k] = True
            errors[k] = math.nan
            whose = "its bound" if one.given else "the limit of the search"
            statements.append(f"{one.name} is at {whose}, {side}: the data do not determine it between the bounds")
    flat = ~at_bound & ((norm <= floor) | (alone > WIDE))
    for k in np.flatnonzero(flat).tolist():
        statements.append(f"the data hardly depend on {free[k].name}: they do not determine it")
    used = np.flatnonzero(~at_bound & ~flat)
    singular = np.zeros(0)
    if used.size:
        columns = jacobian[:, used] / norm[used]
        _left, singular, right = np.linalg.svd(columns, full_matrices=False)
        lost = np.zeros(used.size, dtype=bool)
        for row in np.flatnonzero(singular < SMALLEST_SINGULAR).tolist():
            direction = np.abs(right[row] / norm[used])
            parts = direction > PART * direction.max()
            lost |= parts
            together = " and ".join(free[used[k]].name for k in np.flatnonzero(parts).tolist())
            statements.append(f"the data determine only a combination of {together}, not each of them")
        kept = singular >= SMALLEST_SINGULAR
        inverse = (right[kept].T / singular[kept] ** 2) @ right[kept]
        covariance = variance * inverse / np.outer(norm[used], norm[used])
        own = np.sqrt(np.diag(covariance))
        errors[used] = np.where(lost, math.inf, own)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = covariance / np.outer(own, own)
        found[lost, :] = found[:, lost] = math.nan
        correlation[np.ix_(used, used)] = found
        for k in np.flatnonzero(~lost & (own > WIDE)).tolist():
            one = free[used[k]]
            size = f"{own[k]:.0%} of its value" if one.logarithmic else f"{own[k] * one.scale:.2g}"
            statements.append(f"the data do not determine {one.name}: its error bar is {size}")
        statements += _pairs(free, used, found)
    known = np.isfinite(errors) & (errors <= WIDE)
    return Determined(errors, correlation, known, singular, tuple(statements))


def _bound(one: FreeValue, z: float, error: float) -> str:
    """Return the bound on which the coordinate z lies as text, or an empty text."""
    low, high = one.bounds
    near = ON_BOUND * min(max(error, 1e-6), 1.0)
    if z - low <= near:
        return f"{one.low:.6g}"
    if high - z <= near:
        return f"{one.high:.6g}"
    return ""


def _pairs(free: Sequence[FreeValue], used: NDArray[np.int64], correlation: Array) -> list[str]:
    """Return a sentence for each pair of strongly correlated values."""
    found = []
    for i, j in zip(*np.triu_indices(used.size, 1), strict=True):
        if abs(correlation[i, j]) > STRONG:
            names = f"{free[used[i]].name} and {free[used[j]].name}"
            found.append(f"{names} are determined mainly together: their correlation is {correlation[i, j]:.4f}")
    return found


def not_random(residuals: Array, which: NDArray[np.int64]) -> bool:
    """Return True if neighbouring residuals of a column agree more often than random ones would."""
    products = squares = 0.0
    count = 0
    for k in np.unique(which).tolist():
        own = residuals[which == k]
        products += float(own[1:] @ own[:-1])
        squares += float(own @ own)
        count += own.size - 1
    return count > 0 and squares > 0.0 and products / squares * math.sqrt(count) > NOT_RANDOM
