"""Numbers of axes as text, with the decimal mark of the language in use: ticks, powers of ten, units; labels moved apart."""

import math
import re
from collections.abc import Sequence

from softcradle.sandbox.languages import localized

MINUS, TIMES = "\N{MINUS SIGN}", "\N{MULTIPLICATION SIGN}"
FORCE_UNITS = ((1e6, "MN"), (1e3, "kN"), (1.0, "N"), (1e-3, "mN"), (1e-6, "µN"))
ROUND_OFF = 1e-12  # smaller results are shown as 0
MOST_DECIMALS = 4  # of a number on an axis; smaller ones have a power of ten
LARGEST_PLAIN = 1e4  # greater numbers are written with the prefix of a unit
LARGEST_PREFIXED = 1e13  # greater ones have a power of ten: no prefix here makes them short
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_SUBSCRIPTS = str.maketrans("-0123456789", "₋₀₁₂₃₄₅₆₇₈₉")


def power_of_ten(exponent: int) -> str:
    """10 raised to `exponent`, as text."""
    return "10" + str(exponent).translate(_SUPERSCRIPTS)


def subscript(*numbers: int) -> str:
    """A subscript: 12 for the contact of beads 1 and 2, with a minus between them if either has two digits."""
    return ("-" if max(numbers) > 9 else "").join(map(str, numbers)).translate(_SUBSCRIPTS)


def signed(number: str) -> str:
    """A number as text with a true minus sign and the decimal mark of the language in use."""
    return localized(number.replace("-", MINUS))


def fixed(value: float, decimals: int) -> str:
    """`value` with `decimals`, a true minus sign, and no minus before zero."""
    text = f"{value:.{decimals}f}"
    if float(text) == 0.0:
        text = text.lstrip("-")
    return signed(text)


def scientific(value: float, digits: int = 1) -> str:
    """`value` with `digits` decimals times a power of ten; without the power between 0.01 and 1000."""
    if value == 0.0 or not math.isfinite(value):
        return "0" if value == 0.0 else "?"
    if 0.01 <= abs(value) < 1000.0:
        return fixed(value, max(0, digits + 1 - math.floor(math.log10(abs(value))) - 1))
    mantissa, exponent = f"{value:.{digits}e}".split("e")
    return f"{signed(mantissa)}·{power_of_ten(int(exponent))}"


def plain(value: float, digits: int = 3) -> str:
    """`value` to so many digits, as people write it: 1500, 0.25; a tiny or huge one with a power of ten."""
    if value and not 1e-4 <= abs(value) < 1e15:
        return scientific(value, digits - 1)
    return signed(f"{float(f'{value:.{digits}g}'):.15g}")


PREFIXES = {1e9: "G", 1e6: "M", 1e3: "k"}


def prefixed(value: float, digits: int = 3) -> str:
    """`value` to so many digits with the prefix of a unit: 1.25 M for 1250000; beyond all prefixes a power of ten."""
    if abs(value) >= LARGEST_PREFIXED:
        return scientific(value, digits - 1)
    size, prefix = next(((s, p) for s, p in PREFIXES.items() if abs(value) >= 0.9995 * s), (1.0, ""))
    return f"{plain(value / size, digits)} {prefix}".strip()


def axis_prefix(largest: float) -> tuple[float, str]:
    """Return (size, prefix) of the unit of an axis whose values reach `largest`: (1e3, "k") for 253 000.

    Up to LARGEST_PLAIN, and where no prefix makes the numbers short, the unit has none.
    """
    if not LARGEST_PLAIN <= largest < LARGEST_PREFIXED:
        return 1.0, ""
    return next((size, prefix) for size, prefix in PREFIXES.items() if largest >= size)


def with_prefix(title: str, prefix: str) -> str:
    """Return the `title` of an axis with `prefix` before its unit: "contact force (kN)"."""
    return re.sub(r"\((?=[^()]*\)[^()]*$)", f"({prefix}", title) if prefix else title


def beside(value: float, greatest: float) -> str:
    """`value` with the digits that the `greatest` of its kind needs: 0.24 beside 1.08, 60 beside 240.

    It is in the unit of :func:`axis_prefix`, which the axis or the sentence names.
    """
    size = axis_prefix(greatest)[0]
    decimals = max(0, 2 - math.floor(math.log10(greatest / size)))
    if decimals > MOST_DECIMALS or greatest >= LARGEST_PREFIXED:
        return scientific(value / size)
    return fixed(value / size, decimals)


def factor(value: float) -> str:
    """A magnification with a times sign before it, as in "x 0.5", "x 20", "x 5·10⁶"."""
    if 0.01 <= value < 100.0:
        return f"{TIMES}{plain(value)}"
    if 100.0 <= value < 100000.0:
        return f"{TIMES}{value:,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}")
    return f"{TIMES}{scientific(value, 0).removeprefix('1·')}"


def round_step(span: float, most: int) -> float:
    """The smallest of 1, 2, 5 times a power of ten that cuts `span` > 0 into at most `most` parts."""
    power = 10.0 ** math.floor(math.log10(span / most))
    return next(k * power for k in (1.0, 2.0, 5.0, 10.0, 20.0) if span <= k * power * most * (1.0 + 1e-9))


def round_down(value: float) -> float:
    """The greatest of 1, 2, 5 times a power of ten that is at most `value` > 0."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(k * power for k in (0.5, 1.0, 2.0, 5.0, 10.0) if k * power <= value * (1.0 + 1e-9))


def ticks(low: float, high: float, most: int) -> list[tuple[float, str]]:
    """At most `most` + 1 round values inside [low, high] with labels that differ.

    Large ones have the prefix of a unit, tiny ones a power of ten.
    """
    step, large = round_step(high - low, most), max(abs(low), abs(high)) >= LARGEST_PLAIN
    place = math.floor(math.log10(step) + 1e-9)  # of the digit in which neighbours differ

    def text(value: float) -> str:
        digits = math.floor(math.log10(abs(value) or 1.0) + 1e-9) - place
        if large:
            return prefixed(value, max(3, 1 + digits))
        return scientific(value, digits) if place < -MOST_DECIMALS else fixed(value, max(0, -place))

    return [(k * step, text(k * step)) for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def decades(low: int, high: int, most: int) -> list[tuple[float, str]]:
    """At most `most` + 1 whole exponents inside [low, high], labelled as powers of ten."""
    step = max(1, math.ceil((high - low) / most))
    return [(float(k), power_of_ten(k)) for k in range(high, low - 1, -step)]


def time_unit(span: float) -> tuple[float, str]:
    """(seconds in the unit, its name) that suits times up to `span` [s]."""
    return next(((size, name) for size, name in ((1.0, "s"), (1e-3, "ms")) if span >= 0.2 * size), (1e-6, "µs"))


def force_unit(largest: float) -> tuple[float, str]:
    """(newtons in the unit, its name) that suits forces up to `largest` [N]."""
    return next((unit for unit in FORCE_UNITS if largest >= 0.1 * unit[0]), FORCE_UNITS[-1])


def number_text(value: float | None) -> str:
    """A result in a table: up to five digits; 0 for round-off, a dash for what is not defined. A count is whole."""
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
    """`places` moved apart to at least `gap`, in the same order and inside [low, high], by the smallest sum of squared moves."""
    order = sorted(range(len(places)), key=lambda k: places[k])
    gap = min(gap, (high - low) / max(1, len(places) - 1))
    groups: list[tuple[float, int]] = []  # of places that are `gap` apart: the mean of place - rank * gap, and how many
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
