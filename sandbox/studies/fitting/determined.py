"""Error bars of a fit, and sentences that describe which values the data cannot determine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.motion import Array
from softcradle.sandbox.studies.fitting.parameters import FreeValue

# Error bar of a coordinate from which on its value counts as undetermined. The error bar is relative for positive
# values, and in units of the scale for other values. For larger errors, linear error propagation is not a good
# approximation.
WIDE = 0.4
# Limit of the singular values of the Jacobian after its columns were scaled to norm 1. If one is smaller, the free
# values are not separately determined. The errors of the finite differences are of this size.
SMALLEST_SINGULAR = 1e-5
# The data may leave one direction of the coordinates undetermined. A value is named in the statement about this
# direction if its component, relative to the largest component, is at least this number.
PART = 0.1
# Correlation from which on two values are reported as determined together.
STRONG = 0.99
# A value lies on a bound if its distance from the bound is at most this number, in error bars or relative to the coordinate.
ON_BOUND = 1e-3
# Residuals are not random if the autocorrelation of neighbouring residuals exceeds this multiple of its standard
# deviation. The standard deviation is that of random residuals.
NOT_RANDOM = 5.0


@dataclass(frozen=True)
class Determined:
    """Error bars of the coordinates of a fit.

    Attributes:
        errors: (p,) standard deviations of the coordinates; inf if undetermined, NaN at a bound.
        correlation: (p, p) correlations; NaN for values without an error bar.
        known: (p,) True for values that the data determine.
        singular: singular values of the Jacobian after its columns were scaled to norm 1.
        statements: sentences for the user.
    """

    errors: Array
    correlation: Array
    known: NDArray[np.bool_]
    singular: Array
    statements: tuple[str, ...]


def determine(free: Sequence[FreeValue], z: Array, jacobian: Array, variance: float, floor: float) -> Determined:
    """Return the error bars at the coordinates `z`.

    `jacobian` (N, p) contains the derivatives of the weighted residuals with respect to the coordinates. `variance` is
    the variance of a weighted residual. A column with a norm below `floor` is only an error of the finite differences.
    """
    p = len(free)
    norm = np.linalg.norm(jacobian, axis=0)
    errors, correlation = np.full(p, math.inf), np.full((p, p), math.nan)
    statements = list[str]()
    spread = math.sqrt(variance)
    # Without noise, the residuals consist of the errors of the simulations.
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
    """Return the bound on which the coordinate z lies as text. The text is empty if z does not lie on a bound."""
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
    """Return True if neighbouring residuals of a column are more alike than random residuals would be."""
    products = squares = 0.0
    count = 0
    for k in np.unique(which).tolist():
        own = residuals[which == k]
        products += float(own[1:] @ own[:-1])
        squares += float(own @ own)
        count += own.size - 1
    return count > 0 and squares > 0.0 and products / squares * math.sqrt(count) > NOT_RANDOM
