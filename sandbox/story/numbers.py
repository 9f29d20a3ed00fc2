"""Numbers as text, with the decimal mark of the current language: tick labels, powers of ten, units. Also labels moved
apart.
"""

import math
import re
from collections.abc import Sequence

from softcradle.sandbox.languages import localized

MINUS, TIMES = "\N{MINUS SIGN}", "\N{MULTIPLICATION SIGN}"
FORCE_UNITS = ((1e6, "MN"), (1e3, "kN"), (1.0, "N"), (1e-3, "mN"), (1e-6, "µN"))
ROUND_OFF = 1e-12  # Smaller absolute results are shown as 0, because they are rounding errors.
MOST_DECIMALS = 4  # Most decimals of a number on an axis. Numbers that need more get a power of ten.
LARGEST_PLAIN = 1e4  # Larger numbers are written with a metric prefix.
LARGEST_PREFIXED = 1e13  # From here on, numbers get a power of ten, because no prefix of PREFIXES makes them short.
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_SUBSCRIPTS = str.maketrans("-0123456789", "₋₀₁₂₃₄₅₆₇₈₉")


def power_of_ten(exponent: int) -> str:
    """Return 10 raised to `exponent` as text."""
    return "10" + str(exponent).translate(_SUPERSCRIPTS)


def subscript(*numbers: int) -> str:
    """Return `numbers` as a subscript, such as 12 for the contact of beads 1 and 2. A minus separates them if one has
    two digits.
    """
    return ("-" if max(numbers) > 9 else "").join(map(str, numbers)).translate(_SUBSCRIPTS)


def signed(number: str) -> str:
    """Return a number as text with a true minus sign and the decimal mark of the current language."""
    return localized(number.replace("-", MINUS))


def fixed(value: float, decimals: int) -> str:
    """Return `value` with `decimals` digits after the decimal mark. Zero is written without a minus sign."""
    text = f"{value:.{decimals}f}"
    if float(text) == 0.0:
        text = text.lstrip("-")
    return signed(text)


def scientific(value: float, digits: int = 1) -> str:
    """Return `value` with `digits` decimals times a power of ten; without the power from 0.01 up to 1000."""
    if value == 0.0 or not math.isfinite(value):
        return "0" if value == 0.0 else "?"
    if 0.01 <= abs(value) < 1000.0:
        return fixed(value, max(0, digits + 1 - math.floor(math.log10(abs(value))) - 1))
    mantissa, exponent = f"{value:.{digits}e}".split("e")
    return f"{signed(mantissa)}·{power_of_ten(int(exponent))}"


def plain(value: float, digits: int = 3) -> str:
    """Return `value` with `digits` significant digits in ordinary notation, such as 1500 or 0.25.

    Absolute values below 1e-4 or from 1e15 on get a power of ten.
    """
    if value and not 1e-4 <= abs(value) < 1e15:
        return scientific(value, digits - 1)
    return signed(f"{float(f'{value:.{digits}g}'):.15g}")


PREFIXES = {1e9: "G", 1e6: "M", 1e3: "k"}


def prefixed(value: float, digits: int = 3) -> str:
    """Return `value` with `digits` significant digits and a metric prefix: 1.25 M for 1250000. Values from 1e13 on get
    a power of ten.
    """
    if abs(value) >= LARGEST_PREFIXED:
        return scientific(value, digits - 1)
    size, prefix = next(((s, p) for s, p in PREFIXES.items() if abs(value) >= 0.9995 * s), (1.0, ""))
    return f"{plain(value / size, digits)} {prefix}".strip()


def axis_prefix(largest: float) -> tuple[float, str]:
    """Return (size, prefix) of the unit of an axis whose values reach `largest`: (1e3, "k") for 253 000.

    The prefix is empty below LARGEST_PLAIN, and also if the numbers stay long with every prefix.
    """
    if not LARGEST_PLAIN <= largest < LARGEST_PREFIXED:
        return 1.0, ""
    return next((size, prefix) for size, prefix in PREFIXES.items() if largest >= size)


def with_prefix(title: str, prefix: str) -> str:
    """Return the `title` of an axis with `prefix` before its unit: "contact force (kN)"."""
    return re.sub(r"\((?=[^()]*\)[^()]*$)", f"({prefix}", title) if prefix else title


def beside(value: float, greatest: float) -> str:
    """Return `value` with as many decimals as `greatest`, the largest value of its kind, needs: 0.24 if `greatest` is
    1.08, 60 if it is 240.

    The number is in the unit of :func:`axis_prefix`. The axis or the sentence must name this unit.
    """
    size = axis_prefix(greatest)[0]
    decimals = max(0, 2 - math.floor(math.log10(greatest / size)))
    if decimals > MOST_DECIMALS or greatest >= LARGEST_PREFIXED:
        return scientific(value / size)
    return fixed(value / size, decimals)


def factor(value: float) -> str:
    """Return a magnification with a times sign before it, as in "x 0.5", "x 20", "x 5·10⁶"."""
    if 0.01 <= value < 100.0:
        return f"{TIMES}{plain(value)}"
    if 100.0 <= value < 100000.0:
        return f"{TIMES}{value:,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}")
    return f"{TIMES}{scientific(value, 0).removeprefix('1·')}"


def round_step(span: float, most: int) -> float:
    """Return the smallest of 1, 2, 5 times a power of ten that divides `span` > 0 into at most `most` parts."""
    power = 10.0 ** math.floor(math.log10(span / most))
    return next(k * power for k in (1.0, 2.0, 5.0, 10.0, 20.0) if span <= k * power * most * (1.0 + 1e-9))


def round_down(value: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is at most `value` > 0."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(k * power for k in (0.5, 1.0, 2.0, 5.0, 10.0) if k * power <= value * (1.0 + 1e-9))


def ticks(low: float, high: float, most: int) -> list[tuple[float, str]]:
    """Return at most `most` + 1 round values inside [low, high], each with a label that differs from the others.

    Large values have a metric prefix, tiny ones a power of ten.
    """
    step, large = round_step(high - low, most), max(abs(low), abs(high)) >= LARGEST_PLAIN
    place = math.floor(math.log10(step) + 1e-9)  # exponent of the digit in which neighbouring ticks differ

    def text(value: float) -> str:
        digits = math.floor(math.log10(abs(value) or 1.0) + 1e-9) - place
        if large:
            return prefixed(value, max(3, 1 + digits))
        return scientific(value, digits) if place < -MOST_DECIMALS else fixed(value, max(0, -place))

    return [(k * step, text(k * step)) for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def decades(low: int, high: int, most: int) -> list[tuple[float, str]]:
    """Return at most `most` + 1 whole exponents inside [low, high], labelled as powers of ten."""
    step = max(1, math.ceil((high - low) / most))
    return [(float(k), power_of_ten(k)) for k in range(high, low - 1, -step)]


def time_unit(span: float) -> tuple[float, str]:
    """Return (seconds in the unit, its name) of the unit that suits times up to `span` [s]."""
    return next(((size, name) for size, name in ((1.0, "s"), (1e-3, "ms")) if span >= 0.2 * size), (1e-6, "µs"))


def force_unit(largest: float) -> tuple[float, str]:
    """Return (newtons in the unit, its name) of the unit that suits forces up to `largest` [N]."""
    return next((unit for unit in FORCE_UNITS if largest >= 0.1 * unit[0]), FORCE_UNITS[-1])


def number_text(value: float | None) -> str:
    """Return the text of a result in a table.

    It has up to five digits. Rounding errors become 0, and a dash stands for an undefined value. Counts are whole
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
    """Return `places` moved apart to at least `gap`, in the same order and inside [low, high].

    The sum of the squared moves is as small as possible (isotonic regression by pooling adjacent violators).
    """
    order = sorted(range(len(places)), key=lambda k: places[k])
    gap = min(gap, (high - low) / max(1, len(places) - 1))
    # pooled places that are `gap` apart: (mean of place - rank * gap, number of places)
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
