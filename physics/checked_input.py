"""Numbers that users give: as floats and arrays, or refused in a sentence that says what is allowed and what was given."""

from __future__ import annotations

import math
import operator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

SMALLEST, LARGEST = 1e-30, 1e30  # a mass, speed, force ... beyond these would leave the range of floats when multiplied


def real_number(what: str, value: object) -> float:
    """`value` as a float. Raises ValueError where it is no number."""
    if not isinstance(value, (str, bytes)):
        try:
            return float(value)  # type: ignore[arg-type]  # what it cannot take is refused below
        except (TypeError, ValueError, OverflowError):
            pass
    raise ValueError(f"{what} must be a number, not {shown(value)}")


def magnitude(what: str, value: object, zero: bool = False) -> float:
    """`value` as a float > 0, or >= 0 if `zero`, in the range that can be computed with. Raises ValueError."""
    number = real_number(what, value)
    if (zero and number == 0.0) or SMALLEST <= number <= LARGEST:
        return number
    if number <= 0.0 or not math.isfinite(number):
        raise ValueError(f"{what} must be a finite number {'>=' if zero else '>'} 0, not {shown(value)}")
    raise ValueError(f"{what} must be from {SMALLEST:g} to {LARGEST:g}, not {shown(value)}: choose other units")


def number_array(what: str, value: ArrayLike) -> NDArray[np.float64]:
    """`value` as an array of floats of any shape. Raises ValueError where it is none."""
    try:
        found = np.asarray(value)
        if found.dtype.kind in "biufO":
            return np.asarray(found, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        pass
    raise ValueError(f"{what} must be a number or a list of numbers, not {shown(value)}")


def whole_number(what: str, value: object) -> int:
    """`value` as an int. Raises ValueError where it is no whole number."""
    try:
        return operator.index(value)  # type: ignore[arg-type]  # what it cannot take is refused below
    except TypeError:
        raise ValueError(f"{what} must be a whole number, not {shown(value)}") from None


def require_kind(what: str, value: object, kind: type) -> None:
    """Raise ValueError where `value` is no instance of `kind`."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        raise ValueError(f"{what} must be {article} {kind.__name__}, not {shown(value)}")


def finite_or_none(value: Any) -> float | None:
    """`value` as a float, None where it is no finite number."""
    return float(value) if math.isfinite(value) else None


def shown(value: Any) -> str:
    """`value` as it stands in a sentence: numbers without the type that NumPy adds, long texts cut."""
    plain = value.item() if isinstance(value, np.generic) else value
    text = " ".join(repr(plain).split())
    return text if len(text) <= 60 else f"{text[:57]}..."
