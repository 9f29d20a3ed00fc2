"""The first root of a guard, against dense sampling of random quintics."""

from math import comb

import numpy as np
import pytest
from softcradle.physics.adaptive.corner_search import NONE, first_root, hermite_cubic, hermite_quintic, stage_cubic
from softcradle.physics.numerics.law_curve import NODES, cubic

from tests.helpers.plain_kernels import only_plain

pytestmark = only_plain
PART = np.linspace(0.0, 1.0, 20001)


def value(b, x):
    """Of a quintic in Bernstein form."""
    return sum(b[k] * comb(5, k) * x**k * (1.0 - x) ** (5 - k) for k in range(6))


BASIS = np.array([value(one, PART) for one in np.eye(6)])


@pytest.mark.parametrize("seed", range(20))
def test_it_is_the_first_place_at_which_the_polynomial_turns_negative(seed):
    draw = np.random.default_rng(seed)
    for k in range(100):
        b = draw.normal(size=6)
        b[0] = abs(b[0])
        if k % 3 == 0:  # it begins at zero, and turns positive
            b[0], b[1] = 0.0, abs(b[1])
        values = b @ BASIS
        below = np.flatnonzero(values[1:] < -1e-9)
        found = first_root(tuple(b))
        if not below.size:
            assert found == NONE or values[int(found * 20000)] < 1e-6
        else:
            assert found <= PART[below[0] + 1] + 1e-9
            assert abs(values[int(found * 20000)]) < 1e-3


def test_a_touch_and_return_narrower_than_any_sampling_is_found():
    for width in (1e-3, 1e-5, 1e-7):
        middle = 0.371
        power = (middle**2 - width**2, -2.0 * middle, 1.0)  # (x - middle)² - width²
        b = tuple(sum(comb(k, j) / comb(5, j) * power[j] for j in range(3)) for k in range(6))
        assert first_root(b) == pytest.approx(middle - width, abs=1e-9 + 1e-15 / width)


def test_coefficients_that_vanish_do_not_hide_the_root():
    """100 (1-x)**5 = x**5, where four coefficients are 0."""
    assert first_root((100.0, 0.0, 0.0, 0.0, 0.0, -1.0)) == pytest.approx(1.0 / (1.0 + 100.0**-0.2), abs=1e-13)


def test_a_start_at_zero_counts_where_the_polynomial_leaves_it_downward():
    assert first_root((0.0, -1.0, 1.0, 1.0, 1.0, 1.0)) == 0.0  # negative at once by its slope
    assert first_root((0.0, 0.0, -1.0, 1.0, 1.0, 1.0)) == 0.0  # by its curvature
    assert first_root((0.0, 0.0, 1.0, 1.0, 1.0, 0.0)) == NONE
    falls = (0.0, 0.0, 1.0, 1.0, 1.0, -1.0)  # it begins with a double zero, rises, and falls
    found = first_root(falls)
    assert found > 0.5
    assert value(falls, found) == pytest.approx(0.0, abs=1e-12)


def test_the_forms_of_a_guard_are_the_polynomials_they_name():
    y = (0.3, -1.2, 0.7, 2.0)
    for x in (0.0, NODES[0], 0.4, NODES[1], 1.0):
        assert value(stage_cubic(*y), x) == pytest.approx(cubic(x, *y), abs=1e-13)

    path, h = np.polynomial.Polynomial([0.2, -1.5, 0.7, 2.0]), 0.8
    rate = path.deriv()
    quintic = hermite_quintic(h, path(0), rate(0), 1.4, path(h), rate(h), 1.4 + 12.0 * h)
    hermite = hermite_cubic(h, path(0), rate(0), path(h), rate(h))
    for x in (0.0, 0.25, 0.6, 1.0):
        assert value(quintic, x) == pytest.approx(path(h * x), abs=1e-13)
        assert value(hermite, x) == pytest.approx(path(h * x), abs=1e-13)
