"""Tables and coefficients of `physics/numerics/elementary.py`, computed with 50 digits.

    python -m tools.elementary_tables

writes `physics/numerics/elementary_tables.py`.

    ln x   = k ln 2 - ln v + ln(1 + r),   r = z v - 1,   x = 2**k z:  a v of few bits for each 128th of an octave of z
    e**x   = 2**(n/128) e**r,             r = x - n ln(2)/128:        2**(j/128) for each of 128 j
    ln(1 + r) = r - r**2 P(r),   e**r = 1 + r + r**2 Q(r):    P and Q are interpolated at Chebyshev nodes
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from decimal import Decimal, getcontext
from itertools import pairwise
from pathlib import Path
from textwrap import wrap

getcontext().prec = 50

FILE = Path(__file__).parents[1] / "physics" / "numerics" / "elementary_tables.py"
# Number of parts of an octave, and number of bits of a float below the bits that select its part.
PARTS, PART_BITS = 128, 45
# Binary representation of the smallest z. The number 1 is in the middle of its part, and the v of this part is 1.
OFFSET = 0x3FE6900000000000
# Number of bits of v after the binary point. The product z v - 1 is exact for z with at most 43 bits.
INVERSE_BITS = 10
# Number of bits of logarithms after the binary point. Together with k ln 2 they have 27 bits. The product with 26 other
# bits is exact.
HEAD_BITS = 17
EXP_HEAD_BITS = 41  # Number of bits of ln(2)/128 after the binary point. The product of this number with n is exact.
# Numbers of coefficients. The counts are the smallest numbers with errors far below a unit of the last place.
P_COUNT, Q_COUNT = 6, 4
# Largest |r| for the logarithm and for the exponential function.
WIDEST_LOG, WIDEST_EXP = Decimal("0.0055"), Decimal(2).ln() / 256
WIDTH = 116  # Number of characters in a row of a table.

HEAD = '''"""Tables and coefficients of `elementary.py`, written by ``python -m tools.elementary_tables``."""

from __future__ import annotations

from softcradle.physics.numerics.float_bits import table

# fmt: off
'''


def float_at(bits: int) -> Decimal:
    """Return the float whose binary representation is `bits` (64 bits)."""
    return Decimal(struct.unpack("<d", struct.pack("<q", bits))[0])


def head_and_tail(number: Decimal, bits: int) -> tuple[float, float]:
    """Return `number` rounded to `bits` bits after the binary point, and the remainder."""
    head = round(number * 2**bits) / Decimal(2**bits)
    return float(head), float(number - head)


def logarithms() -> list[tuple[float, float, float]]:
    """Return v and the two parts of -ln v for each part of an octave."""
    found = []
    for part in range(PARTS):
        low, high = (float_at(OFFSET + (k << PART_BITS)) for k in (part, part + 1))
        inverse = round(2 / (low + high) * 2**INVERSE_BITS) / Decimal(2**INVERSE_BITS)
        if low < 1 < high:
            inverse = Decimal(1)
        assert max(1 - low * inverse, high * inverse - 1) < WIDEST_LOG
        found.append((float(inverse), *head_and_tail(-inverse.ln(), HEAD_BITS)))
    return found


def exponentials() -> list[tuple[float, float]]:
    """Return 2**(j/128) as a float, and the relative error of its rounding."""
    found = []
    for j in range(PARTS):
        exact = Decimal(2) ** (Decimal(j) / PARTS)
        found.append((float(exact), float(exact / Decimal(float(exact)) - 1)))
    return found


def of_logarithm(r: Decimal) -> Decimal:
    """Return P(r), the function in the formula for ln(1 + r)."""
    return sum(((-r) ** k / (k + 2) for k in range(16)), Decimal(0))


def of_exponential(r: Decimal) -> Decimal:
    """Return Q(r), the function in the formula for e**r."""
    return sum((r**k / math.factorial(k + 2) for k in range(16)), Decimal(0))


def interpolated(function: Callable[[Decimal], Decimal], count: int, widest: Decimal) -> list[float]:
    """Return the coefficients, lowest first, of the polynomial through `function` at the Chebyshev nodes of [-widest,
    widest].
    """
    nodes = [widest * Decimal(round(math.cos(math.pi * (k + 0.5) / count), 12)) for k in range(count)]
    values = [function(node) for node in nodes]
    for order in range(1, count):  # Compute the divided differences of the interpolation.
        for k in range(count - 1, order - 1, -1):
            values[k] = (values[k] - values[k - 1]) / (nodes[k] - nodes[k - order])
    found = [Decimal(0)] * count
    for k in range(count - 1, -1, -1):
        shifted = [below - nodes[k] * at for below, at in pairwise(found)]
        found = [values[k] - nodes[k] * found[0], *shifted]
    return [float(value) for value in found]


def text() -> str:
    """Return the source text of the module that contains the tables."""
    ln2 = Decimal(2).ln()
    numbers = {
        "OFFSET": hex(OFFSET),
        "LN2_HEAD, LN2_TAIL": head_and_tail(ln2, HEAD_BITS),
        "PARTS_BY_LN2": float(PARTS / ln2),
        "STEP_HEAD, STEP_TAIL": head_and_tail(ln2 / PARTS, EXP_HEAD_BITS),
    }
    for name, function, count, widest in (
        ("P", of_logarithm, P_COUNT, WIDEST_LOG),
        ("Q", of_exponential, Q_COUNT, WIDEST_EXP),
    ):
        numbers |= {f"{name}{k}": value for k, value in enumerate(interpolated(function, count, widest))}
    lines = [f"{name} = {str(value).strip('()[]')}" for name, value in numbers.items()]
    inverse, log_head, log_tail = zip(*logarithms(), strict=True)
    power, power_tail = zip(*exponentials(), strict=True)
    tables = {"INVERSE": inverse, "LOG_HEAD": log_head, "LOG_TAIL": log_tail, "POWER": power, "POWER_TAIL": power_tail}
    for name, values in tables.items():
        rows = wrap(", ".join(map(repr, values)) + ",", WIDTH, break_on_hyphens=False)
        lines += [f"{name} = table((", *(f"    {row}" for row in rows), "))"]
    return HEAD + "\n".join(lines) + "\n"


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
