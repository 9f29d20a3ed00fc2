"""Products and inverses of small coefficient matrices in rational arithmetic, each entry rounded once.

NumPy's linear algebra depends on the library and the processor, so its last digits differ between machines.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def exact_product(left: Array, right: Array) -> Array:
    """Return the product of `left`, (m, k) or (k,), and `right` (k, n)."""
    # fractions are exact, so each sum is rounded only once, by float()
    columns = [_fractions(column) for column in right.T]
    rows = [_fractions(row) for row in np.atleast_2d(left)]
    found = [
        [float(sum(a * b for a, b in zip(row, column, strict=True) if a and b)) for column in columns] for row in rows
    ]
    return np.array(found).reshape(*left.shape[:-1], right.shape[1])


def exact_inverse(matrix: Array) -> Array:
    """Return the inverse of `matrix` (n, n), by Gauss-Jordan elimination without pivoting.

    Raises ZeroDivisionError if the matrix is singular or a pivot is 0.
    """
    size = len(matrix)
    # matrix and unit matrix side by side
    rows = [_fractions(row) + [Fraction(int(i == k)) for k in range(size)] for i, row in enumerate(matrix)]
    # scale row i by its pivot, then subtract it from all other rows
    for i in range(size):
        rows[i] = [value / rows[i][i] for value in rows[i]]
        for k in range(size):
            if k != i:
                rows[k] = [value - rows[k][i] * pivot for value, pivot in zip(rows[k], rows[i], strict=True)]
    return np.array([[float(value) for value in row[size:]] for row in rows])


def _fractions(row: Array) -> list[Fraction]:
    return [Fraction(value) for value in row.tolist()]
