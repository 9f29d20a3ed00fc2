"""Kernels run as plain Python with bitwise the same results: for single numbers, and for powers of arrays.

NumPy's own powers depend on the processor. Powers of arrays run the source of `elementary` on whole arrays instead: its
sums and products are then NumPy's, which rounds them as the compiled kernels do.
"""

from __future__ import annotations

import sys
from functools import cache
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

FEW = 12  # Number of values up to which it is faster to compute them one by one.

_names: dict[str, dict[str, Any]] = {}


@cache
def plain(kernel: Any) -> Any:
    """Return the source of `kernel` as a plain Python function, which calls only plain Python functions."""
    source = getattr(kernel, "py_func", None)
    if source is None:
        return kernel
    return FunctionType(
        source.__code__, _plain_names(source.__module__), source.__name__, source.__defaults__, source.__closure__
    )


def _plain_names(module: str) -> dict[str, Any]:
    """Return the names of a module, with plain functions in place of its kernels."""
    if module not in _names:
        found = _names[module] = dict(vars(sys.modules[module]))
        found.update({name: plain(value) for name, value in list(found.items()) if hasattr(value, "py_func")})
    return _names[module]


def powers(base: ArrayLike, exponent: ArrayLike) -> Array:
    """Return ``base**exponent``, broadcast together, for base >= 0 or NaN and exponents other than 0."""
    from softcradle.physics.numerics import (
        elementary,  # Imported here because it imports numba, which is not needed if chains are only inspected.
    )

    b, a = np.broadcast_arrays(np.asarray(base, dtype=np.float64), np.asarray(exponent, dtype=np.float64))
    power = plain(elementary.power)
    # few values: each different pair once
    if b.size <= FEW:
        pairs = list(zip(b.ravel().tolist(), a.ravel().tolist(), strict=True))
        different = {pair: power(*pair) for pair in dict.fromkeys(pairs)}
        return np.array([different[pair] for pair in pairs]).reshape(b.shape)
    # the usual range on whole arrays, with the steps of `elementary.usual_power`
    of_arrays = _of_arrays()
    usual = (b >= elementary.LEAST) & (b <= elementary.MOST)
    x, more = of_arrays["times_log"](a.copy(), np.where(usual, b, 1.0), 0)
    usual &= np.abs(x + more) < elementary.USUAL
    x, more = np.where(usual, x, 0.0), np.where(usual, more, 0.0)
    factor, rest = of_arrays["reduced"](x + more, x, more)
    # special cases: base 0, then each value outside the usual range by itself
    found = np.where(b == 0.0, np.where(a > 0.0, 0.0, np.inf), factor + factor * rest)
    for k in np.argwhere((~usual & (b != 0.0)) | (a == 1.0) | (a == 1.5)).tolist():
        found[tuple(k)] = power(float(b[tuple(k)]), float(a[tuple(k)]))
    return found


@cache
def _of_arrays() -> dict[str, Any]:
    """Return the names of `elementary` as plain Python, with tables and bit operations that accept arrays."""
    from softcradle.physics.numerics import elementary

    found: dict[str, Any] = dict(vars(elementary))
    # the functions of `elementary` call each other through this dictionary
    for name, value in vars(elementary).items():
        source = getattr(value, "py_func", value)
        if isinstance(source, FunctionType) and source.__module__ == elementary.__name__:
            found[name] = FunctionType(source.__code__, found, name, source.__defaults__)
    # tables as arrays, and bits by reinterpreting the memory
    for name in ("INVERSE", "LOG_HEAD", "LOG_TAIL", "POWER", "POWER_TAIL"):
        found[name] = np.array([plain(found[name])(k) for k in range(128)]).take
    found |= {"bits_of": lambda number: number.view(np.int64), "float_of": lambda bits: bits.view(np.float64)}
    return found
