"""Matrices of coefficients: rounded once, the same on every processor."""

import numpy as np
import pytest
from softcradle.physics.adaptive import dop853_tableau, radau
from softcradle.physics.numerics.exact_matrices import exact_inverse, exact_product

from tests.helpers.own_process import python

LAST_DIGIT = 2.3e-16
CORES = ("Prescott", "Haswell", "SkylakeX", "Zen")  # processors whose routines the linear algebra library has

PRINTED = """
import hashlib
from softcradle.physics.adaptive import dop853_tableau as d, radau as r
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


def test_gamma_is_the_reciprocal_of_the_eigenvalue_of_the_radau_method():
    """Of det(1 - z A) = 1 - 3/5 z + 3/20 z² - z³/60, whose root in 1/z is the eigenvalue (Hairer & Wanner, IV.8)."""
    eigenvalue = 1.0 / radau.GAMMA
    assert eigenvalue == pytest.approx(3.0 + 9.0 ** (1 / 3) - 3.0 ** (1 / 3), rel=1e-15)
    assert eigenvalue**3 - 9.0 * eigenvalue**2 + 36.0 * eigenvalue == pytest.approx(60.0, rel=1e-15)
    assert pytest.approx(1.0 / np.linalg.eigvals(radau.INVERSE).real.max(), rel=1e-12) == radau.GAMMA


def test_coefficients_do_not_depend_on_the_processor():
    assert len({python("-c", PRINTED, OPENBLAS_CORETYPE=core).stdout for core in CORES}) == 1


def test_products_of_the_tableaus_are_those_that_their_steps_need():
    assert pytest.approx(np.linalg.matrix_power(dop853_tableau._TABLEAU, 2), abs=1e-12) == dop853_tableau.SQUARE
    assert dop853_tableau.WEIGHTS_SQUARE.sum() == pytest.approx(0.5, rel=1e-14)  # of d'' = 1: h²/2
    assert exact_product(radau.INVERSE, radau.TABLEAU) == pytest.approx(np.eye(3), abs=1e-15)
