"""Validation of numbers from users: converted to floats and arrays, or rejected with a sentence about allowed and given
values.
"""

from __future__ import annotations

import math
import operator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Range of a mass, speed, force etc. Products of numbers beyond it would leave the range of floats.
SMALLEST, LARGEST = 1e-30, 1e30


def real_number(what: str, value: object) -> float:
    """Return `value` as a float. Raise ValueError if it is not a number."""
    if not isinstance(value, (str, bytes)):
        try:
            return float(value)  # type: ignore[arg-type]  # what it cannot take is refused below
        except (TypeError, ValueError, OverflowError):
            pass
    raise ValueError(f"{what} must be a number, not {shown(value)}")


def magnitude(what: str, value: object, zero: bool = False) -> float:
    """Return `value` as a float > 0, or >= 0 if `zero`. Raise ValueError if it is not, or beyond the range SMALLEST to
    LARGEST.
    """
    number = real_number(what, value)
    if (zero and number == 0.0) or SMALLEST <= number <= LARGEST:
        return number
    if number <= 0.0 or not math.isfinite(number):
        raise ValueError(f"{what} must be a finite number {'>=' if zero else '>'} 0, not {shown(value)}")
    raise ValueError(f"{what} must be from {SMALLEST:g} to {LARGEST:g}, not {shown(value)}: choose other units")


def number_array(what: str, value: ArrayLike) -> NDArray[np.float64]:
    """Return `value` as an array of floats of any shape. Raise ValueError if that is not possible."""
    try:
        found = np.asarray(value)
        if found.dtype.kind in "biufO":
            return np.asarray(found, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        pass
    raise ValueError(f"{what} must be a number or a list of numbers, not {shown(value)}")


def whole_number(what: str, value: object) -> int:
    """Return `value` as an int. Raise ValueError if it is not a whole number."""
    try:
        return operator.index(value)  # type: ignore[arg-type]  # what it cannot take is refused below
    except TypeError:
        raise ValueError(f"{what} must be a whole number, not {shown(value)}") from None


def require_kind(what: str, value: object, kind: type) -> None:
    """Raise ValueError if `value` is not an instance of `kind`."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        raise ValueError(f"{what} must be {article} {kind.__name__}, not {shown(value)}")


def finite_or_none(value: Any) -> float | None:
    """Return `value` as a float, or None if it is not finite."""
    return float(value) if math.isfinite(value) else None


def shown(value: Any) -> str:
    """Return `value` as text for a message: numbers without their NumPy type, long texts shortened."""
    plain = value.item() if isinstance(value, np.generic) else value
    text = " ".join(repr(plain).split())
    return text if len(text) <= 60 else f"{text[:57]}..."
