"""Kernels that run as plain Python with bitwise the same results. Kernels accept single numbers. Powers are also
available for arrays.

The last digit of NumPy's own powers depends on the processor. Therefore, powers of arrays are computed by the source of
`elementary`, applied to whole arrays. NumPy rounds sums and products in the same way as the compiled kernels.
"""

from __future__ import annotations

import sys
from functools import cache
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

FEW = 12  # Largest number of values for which computing one value after the other is faster than using arrays.

_names: dict[str, dict[str, Any]] = {}


@cache
def plain(kernel: Any) -> Any:
    """Return `kernel` as a plain Python function. Kernels that it calls are plain Python functions as well."""
    source = getattr(kernel, "py_func", None)
    if source is None:
        return kernel
    return FunctionType(
        source.__code__, _plain_names(source.__module__), source.__name__, source.__defaults__, source.__closure__
    )


def _plain_names(module: str) -> dict[str, Any]:
    """Return all names of a module as a dictionary. Its kernels are replaced by plain Python functions."""
    if module not in _names:
        found = _names[module] = dict(vars(sys.modules[module]))
        found.update({name: plain(value) for name, value in list(found.items()) if hasattr(value, "py_func")})
    return _names[module]


def powers(base: ArrayLike, exponent: ArrayLike) -> Array:
    """Return ``base**exponent``. Both arguments are broadcast together.

    The base must be >= 0 or NaN, and the exponent must not be 0.
    """
    from softcradle.physics.numerics import (
        # This import loads numba. The import is inside the function because inspecting a chain does not need numba.
        elementary,
    )

    b, a = np.broadcast_arrays(np.asarray(base, dtype=np.float64), np.asarray(exponent, dtype=np.float64))
    power = plain(elementary.power)
    # For few values, compute each different pair once.
    if b.size <= FEW:
        pairs = list(zip(b.ravel().tolist(), a.ravel().tolist(), strict=True))
        different = {pair: power(*pair) for pair in dict.fromkeys(pairs)}
        return np.array([different[pair] for pair in pairs]).reshape(b.shape)
    # For values in the usual range, apply the steps of `elementary.usual_power` to whole arrays.
    of_arrays = _of_arrays()
    usual = (b >= elementary.LEAST) & (b <= elementary.MOST)
    x, more = of_arrays["times_log"](a.copy(), np.where(usual, b, 1.0), 0)
    usual &= np.abs(x + more) < elementary.USUAL
    x, more = np.where(usual, x, 0.0), np.where(usual, more, 0.0)
    factor, rest = of_arrays["reduced"](x + more, x, more)
    # Special cases: base 0, then each value outside the usual range, one after the other.
    found = np.where(b == 0.0, np.where(a > 0.0, 0.0, np.inf), factor + factor * rest)
    for k in np.argwhere((~usual & (b != 0.0)) | (a == 1.0) | (a == 1.5)).tolist():
        found[tuple(k)] = power(float(b[tuple(k)]), float(a[tuple(k)]))
    return found


@cache
def _of_arrays() -> dict[str, Any]:
    """Return the names of `elementary` as plain Python functions. The tables and bit operations accept arrays."""
    from softcradle.physics.numerics import elementary

    found: dict[str, Any] = dict(vars(elementary))
    # The functions of `elementary` find each other in this dictionary.
    for name, value in vars(elementary).items():
        source = getattr(value, "py_func", value)
        if isinstance(source, FunctionType) and source.__module__ == elementary.__name__:
            found[name] = FunctionType(source.__code__, found, name, source.__defaults__)
    # Provide the tables as arrays, and obtain the bits of numbers by reinterpreting the memory.
    for name in ("INVERSE", "LOG_HEAD", "LOG_TAIL", "POWER", "POWER_TAIL"):
        found[name] = np.array([plain(found[name])(k) for k in range(128)]).take
    found |= {"bits_of": lambda number: number.view(np.int64), "float_of": lambda bits: bits.view(np.float64)}
    return found
