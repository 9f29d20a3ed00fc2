"""Tests of the project's own powers, exponentials, logarithms and matrices. The tests check errors and special values.
The results must be bitwise equal on every machine.
"""

import math
from decimal import Decimal, localcontext

import numpy as np
import pytest
from softcradle.physics.numerics import elementary
from softcradle.physics.numerics.exact_matrices import exact_inverse, exact_product
from softcradle.physics.numerics.jit import jit
from softcradle.physics.numerics.plain_kernels import FEW, plain, powers

from tests.helpers.own_process import python
from tools import elementary_tables

COUNT = 400


def within(low, high):
    return lambda draw: draw.uniform(low, high, COUNT)


def sizes(low, high):
    return lambda draw: 10.0 ** draw.uniform(low, high, COUNT)


def either_sign(low, high):
    return lambda draw: draw.choice((-1.0, 1.0), COUNT) * sizes(low, high)(draw)


# Each entry contains a kernel, the exact function, arguments, and the allowed error in units of the last place.
FUNCTIONS = {
    "exp": (elementary.exp, Decimal.exp, [within(-690.0, 690.0)], 0.51),
    "expm1": (elementary.expm1, lambda x: x.exp() - 1, [within(-2.0, 2.0)], 1.55),
    "expm1 of small numbers": (elementary.expm1, lambda x: x.exp() - 1, [either_sign(-12.0, -2.0)], 1.55),
    "log": (elementary.log, Decimal.ln, [sizes(-300.0, 300.0)], 0.51),
    "log1p": (elementary.log1p, lambda x: (1 + x).ln(), [within(-0.5, 1.0)], 0.51),
    "log1p of small numbers": (elementary.log1p, lambda x: (1 + x).ln(), [either_sign(-12.0, -2.0)], 0.76),
    "powers, overlaps of soft contacts": (elementary.power, pow, [sizes(-30.0, 0.0), within(0.02, 0.2)], 0.51),
    "powers, all sizes": (elementary.power, pow, [sizes(-100.0, 100.0), within(0.005, 3.0)], 0.55),
    "powers, near 1": (elementary.power, pow, [sizes(-1e-3, 1e-3), within(0.005, 3.0)], 0.55),
    "powers, large exponents": (elementary.power, pow, [sizes(-9.0, 9.0), within(3.0, 30.0)], 0.8),
    "powers, falling": (elementary.power, pow, [sizes(-30.0, 30.0), within(-3.0, -0.02)], 0.55),
    "powers, numbers without all bits": (elementary.power, pow, [sizes(-323.0, -308.0), within(0.02, 0.9)], 0.55),
}


@pytest.mark.parametrize(("kernel", "truth", "arguments", "allowed"), FUNCTIONS.values(), ids=FUNCTIONS)
def test_functions_are_right_to_about_a_unit_of_the_last_place(kernel, truth, arguments, allowed):
    draw, function = np.random.default_rng(len(arguments)), plain(kernel)
    given = zip(*(drawn(draw).tolist() for drawn in arguments), strict=True)
    with localcontext(prec=40, Emin=-999999, Emax=999999):
        pairs = ((Decimal(function(*x)), truth(*map(Decimal, x))) for x in given)
        worst = max(abs(found - true) / Decimal(math.ulp(float(true))) for found, true in pairs)
    assert 0.4 < worst < allowed


def test_edges():
    power, exp = plain(elementary.power), plain(elementary.exp)
    bases, exponents = (0.0, math.inf, 1e300, 1e-300, 1.0, math.inf), (0.1, 0.1, 2.0, 2.0, 2.7, -1.0)
    assert list(map(power, bases, exponents)) == [0.0, math.inf, math.inf, 0.0, 1.0, 0.0]
    assert math.isnan(power(math.nan, 0.3))
    assert [power(2.5, 1.0), power(2.5, 1.5)] == [2.5, 2.5 * math.sqrt(2.5)]
    assert power(1e-200, 1.55) == pytest.approx(1e-310, rel=1e-13)
    assert [exp(0.0), exp(-1000.0), exp(1000.0), exp(-math.inf), exp(math.inf)] == [1.0, 0.0, math.inf, 0.0, math.inf]
    assert math.isnan(exp(math.nan))
    assert [plain(elementary.expm1)(0.0), plain(elementary.log1p)(0.0), plain(elementary.log)(1.0)] == [0.0, 0.0, 0.0]
    base = np.array([0.0, 1.0, 4.0, 1e-310, np.inf, np.nan, 1e300, 1e-300] * 3)
    for exponent in (0.1, 1.0, 1.5, 2.0, -0.5):
        of_zero = 0.0 if exponent > 0.0 else np.inf
        one_by_one = [power(b, exponent) if b else of_zero for b in base.tolist()]
        np.testing.assert_array_equal(powers(base, exponent), one_by_one)
    assert powers(np.full((2, 1), 4.0), [0.5, 1.0, 2.0]).tolist() == [[2.0, 4.0, 16.0]] * 2


@jit
def _all_of_them(x, exponent, found):
    for i in range(len(x)):
        found[0, i] = elementary.power(x[i], exponent[i])
        found[1, i] = elementary.exp(x[i])
        found[2, i] = elementary.expm1(min(x[i], 600.0))
        found[3, i] = elementary.log1p(min(x[i], 1.0))
        found[4, i] = elementary.log(x[i])


def test_compiled_and_plain_functions_have_the_same_digits():
    draw = np.random.default_rng(3)
    x, exponent = 10.0 ** draw.uniform(-12.0, 3.0, 3000), draw.choice([1.0, 1.5, 0.1, 2.3, 40.0, -0.7], 3000)
    compiled, plainly = np.empty((5, 3000)), np.empty((5, 3000))
    with np.errstate(all="ignore"):
        _all_of_them(x, exponent, compiled)
    plain(_all_of_them)(x.tolist(), exponent.tolist(), plainly)
    assert compiled.tobytes() == plainly.tobytes()
    assert powers(x, exponent).tobytes() == plainly[0].tobytes()
    assert powers(x[:FEW], exponent[:FEW]).tobytes() == plainly[0, :FEW].tobytes()


def test_tables_are_those_that_their_command_writes():
    assert elementary_tables.FILE.read_text(encoding="utf-8") == elementary_tables.text()


LAST_DIGIT = 2.3e-16
# Processors for which the linear algebra library has special routines.
CORES = ("Prescott", "Haswell", "SkylakeX", "Zen")

PRINTED = """
import hashlib
from softcradle.physics.adaptive import dop853 as d, radau as r
arrays = (r.INVERSE, r.SQUARE_INVERSE, r.EMBEDDED, r.COARSE, d.SQUARE, d.WEIGHTS_SQUARE, d.THIRD_SQUARE, d.FIFTH_SQUARE)
print(hashlib.sha256(b"".join(array.tobytes() for array in arrays)).hexdigest())
"""


def test_products_and_inverses_are_those_of_long_doubles():
    draw = np.random.default_rng(3)
    for size in (1, 2, 3, 5):
        left, right = draw.normal(size=(size, size)), draw.normal(size=(size, size))
        wanted = left.astype(np.longdouble) @ right.astype(np.longdouble)
        assert np.abs(exact_product(left, right) / wanted - 1.0).max() <= LAST_DIGIT
        assert np.abs(exact_product(left[0], right) / wanted[0] - 1.0).max() <= LAST_DIGIT
        there_and_back = exact_product(exact_inverse(left), left)
        assert np.abs(there_and_back - np.eye(size)).max() < 1e-13
    with pytest.raises(ZeroDivisionError):
        exact_inverse(np.ones((2, 2)))


def test_coefficients_do_not_depend_on_the_processor():
    assert len({python("-c", PRINTED, OPENBLAS_CORETYPE=core).stdout for core in CORES}) == 1
