"""Powers of arrays outside of kernels, digit for digit those of kernels: NumPy's depend on the processor.

They are the source of `elementary`, run on whole arrays: its sums and products are NumPy's, which rounds them as kernels do.
"""

from __future__ import annotations

from functools import cache
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

FEW = 12  # numbers that take less time one by one


def powers(base: ArrayLike, exponent: ArrayLike) -> Array:
    """``base**exponent`` for base >= 0 or NaN and an exponent that is not 0, broadcast together."""
    from softcradle.physics.numerics import (
        elementary,  # it imports numba, which chains that are only looked at do not need
    )

    b, a = np.broadcast_arrays(np.asarray(base, dtype=np.float64), np.asarray(exponent, dtype=np.float64))
    if b.size <= FEW:
        pairs = list(zip(b.ravel().tolist(), a.ravel().tolist(), strict=True))
        different = {pair: _named("power", False)(*pair) for pair in dict.fromkeys(pairs)}
        return np.array([different[pair] for pair in pairs]).reshape(b.shape)
    usual = (b >= elementary.LEAST) & (b <= elementary.MOST)
    x, more = _named("times_log", True)(a.copy(), np.where(usual, b, 1.0), 0)
    usual &= np.abs(x + more) < elementary.USUAL
    x, more = np.where(usual, x, 0.0), np.where(usual, more, 0.0)
    factor, rest = _named("reduced", True)(x + more, x, more)
    found = np.where(b == 0.0, np.where(a > 0.0, 0.0, np.inf), factor + factor * rest)
    for k in np.argwhere((~usual & (b != 0.0)) | (a == 1.0) | (a == 1.5)).tolist():
        found[tuple(k)] = _named("power", False)(float(b[tuple(k)]), float(a[tuple(k)]))
    return found


@cache
def _named(name: str, arrays: bool) -> Any:
    """A function of `elementary` as plain Python, for arrays or for numbers."""
    from softcradle.physics.numerics import elementary

    kernel = getattr(elementary, name)
    source = getattr(kernel, "py_func", kernel)
    return FunctionType(source.__code__, _names(arrays), name, source.__defaults__)


@cache
def _names(arrays: bool) -> dict[str, Any]:
    """What the functions of `elementary` call."""
    from softcradle.physics.numerics import elementary

    found: dict[str, Any] = dict(vars(elementary))
    for name, value in vars(elementary).items():
        if (
            isinstance(source := getattr(value, "py_func", value), FunctionType)
            and source.__module__ == elementary.__name__
        ):
            found[name] = FunctionType(source.__code__, found, name, source.__defaults__)
        elif hasattr(value, "py_func"):
            found[name] = value.py_func
    if arrays:
        tables = ("INVERSE", "LOG_HEAD", "LOG_TAIL", "POWER", "POWER_TAIL")
        found |= {name: np.array([_plain(name)(k) for k in range(128)]).take for name in tables}
        found |= {"bits_of": lambda number: number.view(np.int64), "float_of": lambda bits: bits.view(np.float64)}
    return found


def _plain(name: str) -> Any:
    """A table as a function of plain Python."""
    from softcradle.physics.numerics import elementary_tables

    table = getattr(elementary_tables, name)
    return getattr(table, "py_func", table)
