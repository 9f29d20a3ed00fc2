"""Radau collocation in extended precision: what its coefficients integrate, and what its polynomials tell."""

import numpy as np
import pytest
from softcradle.physics.reference.collocation import EPSILON, Extended, tableau

STAGES = [1, 3, 5, 7, 9]


@pytest.mark.parametrize("stages", STAGES)
def test_powers_are_integrated_to_each_node(stages):
    found = tableau(stages)
    for k in range(stages):
        exact = found.node ** (k + 1) / (k + 1)
        assert np.abs(found.once @ found.node**k - exact).max() < 20 * EPSILON


@pytest.mark.parametrize("stages", STAGES)
def test_the_last_stage_has_order_of_twice_the_stages_less_one(stages):
    found = tableau(stages)
    errors = [abs(found.once[-1] @ found.node**k - Extended(1) / (k + 1)) for k in range(2 * stages)]
    assert max(errors[:-1]) < 20 * EPSILON
    assert errors[-1] > 1e3 * EPSILON


def test_two_known_tableaus():
    assert tableau(1).once == pytest.approx(np.ones((1, 1)))
    root = np.sqrt(6.0)
    assert tableau(3).node.astype(float) == pytest.approx([(4 - root) / 10, (4 + root) / 10, 1.0], abs=1e-16)


def test_bernstein_coefficients_enclose_the_polynomial():
    found, draw = tableau(5), np.random.default_rng(3)
    for _ in range(50):
        value = draw.normal(size=5).astype(Extended)
        series = found.legendre @ value
        time = np.linspace(0.0, 1.0, 101)
        curve = np.polynomial.legendre.legval(2.0 * time - 1.0, series.astype(float))
        bound = (found.bernstein_value @ value).astype(float)
        assert bound.min() - 1e-12 <= curve.min()
        assert curve.max() <= bound.max() + 1e-12
        assert bound[[0, -1]] == pytest.approx(curve[[0, -1]], abs=1e-12)


def test_bernstein_coefficients_of_integrals_end_where_the_coefficients_do():
    found, value = tableau(7), np.random.default_rng(4).normal(size=7).astype(Extended)
    once, twice = found.bernstein_once @ value, found.bernstein @ value
    assert once[0] == 0.0
    assert float(once[-1]) == pytest.approx(float(found.once[-1] @ value), abs=1e-15)
    assert float(twice[-1]) == pytest.approx(float(found.twice[-1] @ value), abs=1e-15)
