"""Validation of numbers from users.

Valid numbers are converted to floats and arrays. For other values, the error message contains the allowed values and
the given value.
"""

from __future__ import annotations

import math
import operator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.messages import InputError

# Smallest and largest valid mass, speed, force etc. Products of numbers outside this range could overflow or underflow.
SMALLEST, LARGEST = 1e-30, 1e30


def real_number(what: str, value: object) -> float:
    """Return `value` as a float. Raise ValueError if it is not a number."""
    if not isinstance(value, (str, bytes)):
        try:
            return float(value)  # type: ignore[arg-type]  # what it cannot take is refused below
        except (TypeError, ValueError, OverflowError):
            pass
    raise InputError("number", "{what} must be a number, not {given}", what=what, given=shown(value))


def magnitude(what: str, value: object, zero: bool = False) -> float:
    """Return `value` as a float > 0, or >= 0 if `zero` is True.

    Raise ValueError if the value has a wrong sign or lies outside the range from SMALLEST to LARGEST.
    """
    number = real_number(what, value)
    if (zero and number == 0.0) or SMALLEST <= number <= LARGEST:
        return number
    if number <= 0.0 or not math.isfinite(number):
        raise InputError(
            "sign",
            "{what} must be a finite number {sign} 0, not {given}",
            what=what,
            sign=">=" if zero else ">",
            given=shown(value),
        )
    raise InputError(
        "range",
        "{what} must be from {least:g} to {most:g}, not {given}: choose other units",
        what=what,
        least=SMALLEST,
        most=LARGEST,
        given=shown(value),
    )


def number_array(what: str, value: ArrayLike) -> NDArray[np.float64]:
    """Return `value` as an array of floats of any shape. Raise ValueError if it cannot be converted."""
    try:
        found = np.asarray(value)
        if found.dtype.kind in "biufO":
            return np.asarray(found, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(
        "numbers", "{what} must be a number or a list of numbers, not {given}", what=what, given=shown(value)
    )


def whole_number(what: str, value: object) -> int:
    """Return `value` as an int. Raise ValueError if it is not a whole number."""
    try:
        return operator.index(value)  # type: ignore[arg-type]  # what it cannot take is refused below
    except TypeError:
        raise InputError(
            "whole_number", "{what} must be a whole number, not {given}", what=what, given=shown(value)
        ) from None


def require_kind(what: str, value: object, kind: type) -> None:
    """Raise ValueError if `value` is not an instance of `kind`."""
    if not isinstance(value, kind):
        raise InputError(
            "kind", "{what} must be a {kind}, not {given}", what=what, kind=kind.__name__, given=shown(value)
        )


def finite_or_none(value: Any) -> float | None:
    """Return `value` as a float, or None if it is not finite."""
    return float(value) if math.isfinite(value) else None


def shown(value: Any) -> str | float:
    """Return `value` for use in a message.

    A NumPy number becomes a plain number. Other values become text, and long texts are shortened.
    """
    plain = value.item() if isinstance(value, np.generic) else value
    if isinstance(plain, float):
        return plain
    text = " ".join(repr(plain).split())
    return text if len(text) <= 60 else f"{text[:57]}..."
