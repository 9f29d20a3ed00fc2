"""Products and inverses of small matrices of coefficients, each entry rounded once.

NumPy's take what the linear algebra library does on this processor, whose last digits differ from one processor to another.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def exact_product(left: Array, right: Array) -> Array:
    """The product of `left` (m, k) or (k,) and `right` (k, n)."""
    columns = [_fractions(column) for column in right.T]
    rows = [_fractions(row) for row in np.atleast_2d(left)]
    found = [
        [float(sum(a * b for a, b in zip(row, column, strict=True) if a and b)) for column in columns] for row in rows
    ]
    return np.array(found).reshape(*left.shape[:-1], right.shape[1])


def exact_inverse(matrix: Array) -> Array:
    """The inverse of `matrix` (n, n), by elimination; ZeroDivisionError where there is none or a pivot is 0."""
    size = len(matrix)
    rows = [_fractions(row) + [Fraction(int(i == k)) for k in range(size)] for i, row in enumerate(matrix)]
    for i in range(size):
        rows[i] = [value / rows[i][i] for value in rows[i]]
        for k in range(size):
            if k != i:
                rows[k] = [value - rows[k][i] * pivot for value, pivot in zip(rows[k], rows[i], strict=True)]
    return np.array([[float(value) for value in row[size:]] for row in rows])


def _fractions(row: Array) -> list[Fraction]:
    return [Fraction(value) for value in row.tolist()]
