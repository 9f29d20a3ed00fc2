"""Radau IIA collocation of any order in extended precision. The module computes nodes, coefficients and polynomials.

    V_p = v + h sum_q A_pq v'_q,   D_p = d + c_p h w + h**2 sum_q (A**2)_pq w'_q        (stages p = 1 ... s)

The last stage is the end of the step. The order is 2 s - 1, and an infinitely stiff force is damped at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

# Type of numbers in extended precision. The type has a mantissa of 64 bits on x86, and of 113 bits on ARM with Linux.
# If it is only double precision, the reference is not more precise.
Extended = np.longdouble
Array = NDArray[np.longdouble]
EPSILON = float(np.finfo(Extended).eps)


@dataclass(frozen=True)
class Tableau:
    """Coefficients of Radau IIA with `stages` stages on [0, 1].

    Attributes:
        node: (s,) nodes c. The last node is 1.
        once: (s, s) matrix A: integrals, up to each node, of the polynomial through the values at the nodes.
        twice: (s, s) A**2.
        legendre: (s, s) matrix from values at the nodes to coefficients of shifted Legendre polynomials.
        bernstein: (s+2, s) matrix from second derivatives at the nodes to Bernstein coefficients of their double
            integral.
        bernstein_once: (s+1, s) matrix from first derivatives at the nodes to Bernstein coefficients of their integral.
        bernstein_value: (s, s) matrix from values at the nodes to Bernstein coefficients of the polynomial.
    """

    stages: int
    node: Array
    once: Array
    twice: Array
    legendre: Array
    bernstein: Array
    bernstein_once: Array
    bernstein_value: Array


@cache
def tableau(stages: int) -> Tableau:
    """Return the Tableau of the method with `stages` stages."""
    node = _nodes(stages)
    value = _legendre(2.0 * node - 1.0, stages)
    weight = node / (stages**2 * value[stages - 1] ** 2)
    degree = np.arange(stages)
    legendre = (2 * degree + 1)[:, None] * weight * value[:stages]
    once = _integrals(value, node, stages).T @ legendre
    power = _powers(stages) @ legendre  # Matrix from values at the nodes to coefficients of 1, t, t**2, ...
    first = power / (degree + 1)[:, None]
    second = first / (degree + 2)[:, None]
    zero = np.zeros((1, stages), dtype=Extended)
    return Tableau(
        stages, node, once, once @ once, legendre,
        _to_bernstein(np.vstack((zero, zero, second))), _to_bernstein(np.vstack((zero, first))), _to_bernstein(power),
    )  # fmt: skip


def _legendre(x: Array, most: int) -> Array:
    """Return the Legendre polynomials of degrees 0 to `most` at x in [-1, 1], (most+1, ...)."""
    found = [np.ones_like(x), x]
    for k in range(1, most):
        found.append(((2 * k + 1) * x * found[k] - k * found[k - 1]) / Extended(k + 1))
    return np.array(found[: most + 1])


def _nodes(stages: int) -> Array:
    """Return the (s,) roots of P_s - P_(s-1), scaled to [0, 1].

    Newton's iteration improves roots that are computed in double precision.
    """
    series = np.zeros(stages + 1)
    series[stages], series[stages - 1] = 1.0, -1.0
    x = np.sort(np.polynomial.legendre.legroots(series).real).astype(Extended)
    x[-1] = 1.0
    for _ in range(4):  # Each iteration doubles the number of correct digits of the inner nodes.
        inner = x[:-1]
        value = _legendre(inner, stages)
        slope = _legendre_slope(value, inner, stages) - _legendre_slope(value, inner, stages - 1)
        x[:-1] = inner - (value[stages] - value[stages - 1]) / slope
    return (x + 1.0) / 2.0


def _legendre_slope(value: Array, x: Array, degree: int) -> Array:
    if degree == 0:
        return np.zeros_like(x)
    found: Array = degree * (x * value[degree] - value[degree - 1]) / (x**2 - 1.0)
    return found


def _integrals(value: Array, node: Array, stages: int) -> Array:
    """Return the (s, s) integrals of the shifted Legendre polynomials from 0 to each node."""
    rows = [node]
    rows += [(value[k + 1] - value[k - 1]) / Extended(2 * (2 * k + 1)) for k in range(1, stages)]
    return np.array(rows)


def _powers(stages: int) -> Array:
    """Return the (s, s) coefficients of 1, t, t**2, ... of the shifted Legendre polynomials.

    Column k belongs to the polynomial of degree k.
    """
    found = np.zeros((stages, stages), dtype=Extended)
    found[0, 0] = 1.0
    if stages > 1:
        found[0, 1], found[1, 1] = -1.0, 2.0
    for k in range(1, stages - 1):
        shifted = np.roll(found[:, k], 1)
        shifted[0] = 0.0
        found[:, k + 1] = ((2 * k + 1) * (2.0 * shifted - found[:, k]) - k * found[:, k - 1]) / Extended(k + 1)
    return found


def _to_bernstein(power: Array) -> Array:
    """Convert coefficients of powers (k+1, ...) to Bernstein coefficients of the same degree k."""
    degree = power.shape[0] - 1
    choose = [[Extended(_binomial(i, j)) / _binomial(degree, j) for j in range(degree + 1)] for i in range(degree + 1)]
    return np.array(choose) @ power


def _binomial(n: int, k: int) -> int:
    found = 1
    for j in range(k):
        found = found * (n - j) // (j + 1)
    return found if k <= n else 0
