"""Conversion of numbers into text with the decimal mark of the current language. The module writes tick labels, powers
of ten and units. The module also moves labels apart that would overlap.
"""

import math
import re
from collections.abc import Sequence

from softcradle.sandbox.languages import localized

MINUS, TIMES = "\N{MINUS SIGN}", "\N{MULTIPLICATION SIGN}"
FORCE_UNITS = ((1e6, "MN"), (1e3, "kN"), (1.0, "N"), (1e-3, "mN"), (1e-6, "µN"))
ROUND_OFF = 1e-12  # Largest absolute value of a result that is shown as 0. Such small results are rounding errors.
MOST_DECIMALS = 4  # Largest number of decimals on an axis. Numbers with more decimals are written with a power of ten.
LARGEST_PLAIN = 1e4  # Largest number on an axis without a metric prefix.
# Numbers of this size and more are written with a power of ten, because no prefix of PREFIXES makes them short.
LARGEST_PREFIXED = 1e13
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_SUBSCRIPTS = str.maketrans("-0123456789", "₋₀₁₂₃₄₅₆₇₈₉")


def power_of_ten(exponent: int) -> str:
    """Return 10 raised to `exponent` as text."""
    return "10" + str(exponent).translate(_SUPERSCRIPTS)


def subscript(*numbers: int) -> str:
    """Return `numbers` as a subscript. For example, the contact of beads 1 and 2 has the subscript 12. If a number has
    two digits, the numbers are separated by a minus sign.
    """
    return ("-" if max(numbers) > 9 else "").join(map(str, numbers)).translate(_SUBSCRIPTS)


def signed(number: str) -> str:
    """Return `number` with a true minus sign and the decimal mark of the current language. `number` is a number as
    text.
    """
    return localized(number.replace("-", MINUS))


def fixed(value: float, decimals: int) -> str:
    """Return `value` with `decimals` digits after the decimal mark. Zero is written without a minus sign."""
    text = f"{value:.{decimals}f}"
    if float(text) == 0.0:
        text = text.lstrip("-")
    return signed(text)


def scientific(value: float, digits: int = 1) -> str:
    """Return `value` as a number with `digits` decimals times a power of ten. Values from 0.01 to 1000 are written
    without the power.
    """
    if value == 0.0 or not math.isfinite(value):
        return "0" if value == 0.0 else "?"
    if 0.01 <= abs(value) < 1000.0:
        return fixed(value, max(0, digits + 1 - math.floor(math.log10(abs(value))) - 1))
    mantissa, exponent = f"{value:.{digits}e}".split("e")
    return f"{signed(mantissa)}·{power_of_ten(int(exponent))}"


def plain(value: float, digits: int = 3) -> str:
    """Return `value` with `digits` significant digits in ordinary notation, such as 1500 or 0.25.

    If the absolute value is below 1e-4, or 1e15 or more, it is written with a power of ten.
    """
    if value and not 1e-4 <= abs(value) < 1e15:
        return scientific(value, digits - 1)
    return signed(f"{float(f'{value:.{digits}g}'):.15g}")


PREFIXES = {1e9: "G", 1e6: "M", 1e3: "k"}


def prefixed(value: float, digits: int = 3) -> str:
    """Return `value` with `digits` significant digits and a metric prefix. For example, 1250000 becomes 1.25 M. Values
    of 1e13 and more are written with a power of ten.
    """
    if abs(value) >= LARGEST_PREFIXED:
        return scientific(value, digits - 1)
    size, prefix = next(((s, p) for s, p in PREFIXES.items() if abs(value) >= 0.9995 * s), (1.0, ""))
    return f"{plain(value / size, digits)} {prefix}".strip()


def axis_prefix(largest: float) -> tuple[float, str]:
    """Return (size, prefix) of the unit of an axis. `largest` is the largest value on the axis. For 253 000, the result
    is (1e3, "k").

    The prefix is empty if `largest` is below LARGEST_PLAIN. The prefix is also empty if no prefix makes the numbers
    short.
    """
    if not LARGEST_PLAIN <= largest < LARGEST_PREFIXED:
        return 1.0, ""
    return next((size, prefix) for size, prefix in PREFIXES.items() if largest >= size)


def with_prefix(title: str, prefix: str) -> str:
    """Return the `title` of an axis with `prefix` in front of its unit, for example "contact force (kN)"."""
    return re.sub(r"\((?=[^()]*\)[^()]*$)", f"({prefix}", title) if prefix else title


def beside(value: float, greatest: float) -> str:
    """Return `value` with the number of decimals that suits `greatest`, the largest value of the same kind.

    For example, 0.24 is written if `greatest` is 1.08, and 60 if `greatest` is 240. The number is in the unit of
    :func:`axis_prefix`. The axis or the sentence must name this unit.
    """
    size = axis_prefix(greatest)[0]
    decimals = max(0, 2 - math.floor(math.log10(greatest / size)))
    if decimals > MOST_DECIMALS or greatest >= LARGEST_PREFIXED:
        return scientific(value / size)
    return fixed(value / size, decimals)


def factor(value: float) -> str:
    """Return a magnification with a times sign in front, for example "x 0.5", "x 20" or "x 5·10⁶"."""
    if 0.01 <= value < 100.0:
        return f"{TIMES}{plain(value)}"
    if 100.0 <= value < 100000.0:
        return f"{TIMES}{value:,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}")
    return f"{TIMES}{scientific(value, 0).removeprefix('1·')}"


def round_step(span: float, most: int) -> float:
    """Return a round step that divides `span` > 0 into at most `most` parts. The step is the smallest such number of
    the form 1, 2 or 5 times a power of ten.
    """
    power = 10.0 ** math.floor(math.log10(span / most))
    return next(k * power for k in (1.0, 2.0, 5.0, 10.0, 20.0) if span <= k * power * most * (1.0 + 1e-9))


def round_down(value: float) -> float:
    """Return the largest round number that is at most `value` > 0. Round numbers are 1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(k * power for k in (0.5, 1.0, 2.0, 5.0, 10.0) if k * power <= value * (1.0 + 1e-9))


def ticks(low: float, high: float, most: int) -> list[tuple[float, str]]:
    """Return at most `most` + 1 round values from `low` to `high` with their labels. All labels are different.

    Large values have a metric prefix, and tiny values have a power of ten.
    """
    step, large = round_step(high - low, most), max(abs(low), abs(high)) >= LARGEST_PLAIN
    place = math.floor(math.log10(step) + 1e-9)  # exponent of the last digit in which neighbouring ticks differ

    def text(value: float) -> str:
        digits = math.floor(math.log10(abs(value) or 1.0) + 1e-9) - place
        if large:
            return prefixed(value, max(3, 1 + digits))
        return scientific(value, digits) if place < -MOST_DECIMALS else fixed(value, max(0, -place))

    return [(k * step, text(k * step)) for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def decades(low: int, high: int, most: int) -> list[tuple[float, str]]:
    """Return at most `most` + 1 whole exponents from `low` to `high`. The labels of the exponents are powers of ten."""
    step = max(1, math.ceil((high - low) / most))
    return [(float(k), power_of_ten(k)) for k in range(high, low - 1, -step)]


def time_unit(span: float) -> tuple[float, str]:
    """Return the unit that suits times up to `span` [s]. The result is (seconds in the unit, name of the unit)."""
    return next(((size, name) for size, name in ((1.0, "s"), (1e-3, "ms")) if span >= 0.2 * size), (1e-6, "µs"))


def force_unit(largest: float) -> tuple[float, str]:
    """Return the unit that suits forces up to `largest` [N]. The result is (newtons in the unit, name of the unit)."""
    return next((unit for unit in FORCE_UNITS if largest >= 0.1 * unit[0]), FORCE_UNITS[-1])


def number_text(value: float | None) -> str:
    """Return the text of a result in a table.

    The text has up to five digits. Rounding errors are written as 0, and undefined values as a dash. Counts are whole
    numbers.
    """
    if value is None:
        return "-"
    if isinstance(value, int):
        return str(value)
    if abs(value) < ROUND_OFF:
        return "0"
    if not 1e-3 <= abs(value) < LARGEST_PLAIN:
        return scientific(value, 2)
    return fixed(value, 4 if abs(value) < 1000.0 else 0)


def spread(places: Sequence[float], gap: float, low: float, high: float) -> list[float]:
    """Return `places` moved apart to distances of at least `gap`. The order is kept, and all places are between `low`
    and `high`.

    The sum of the squared moves is as small as possible (isotonic regression by pooling adjacent violators).
    """
    order = sorted(range(len(places)), key=lambda k: places[k])
    gap = min(gap, (high - low) / max(1, len(places) - 1))
    # Groups of places that are exactly `gap` apart. Each tuple contains the mean of (place - rank * gap) and the number
    # of places.
    groups: list[tuple[float, int]] = []
    for rank, k in enumerate(order):
        mean, count = places[k] - rank * gap, 1
        while groups and groups[-1][0] >= mean:
            before, more = groups.pop()
            mean, count = (mean * count + before * more) / (count + more), count + more
        groups.append((mean, count))
    starts = [mean for mean, count in groups for _ in range(count)]
    moved = [0.0] * len(places)
    for rank, k in enumerate(order):
        moved[k] = min(max(starts[rank], low), high - (len(order) - 1) * gap) + rank * gap
    return moved
