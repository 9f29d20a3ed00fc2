"""The judge of the scan, collocation in extended precision: its order, known truths, and method `scipy` beside it."""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, draft_gear, hertz, hooke, one_on, power_law
from softcradle.physics.simulation import solve

from benchmarks.scan.collocation import EPSILON, Extended, tableau
from benchmarks.scan.extended_precision import ReferenceGaveUpError, reference_end
from benchmarks.scan.families import motion
from tests.helpers.truth import ELASTIC, GEARS

pytestmark = pytest.mark.slow  # extended precision takes seconds

STAGES = [1, 3, 5, 7]


@pytest.mark.parametrize("stages", STAGES)
def test_the_last_stage_has_order_of_twice_the_stages_less_one(stages):
    found = tableau(stages)
    errors = [abs(found.once[-1] @ found.node**k - Extended(1) / (k + 1)) for k in range(2 * stages)]
    assert max(errors[:-1]) < 20 * EPSILON
    assert errors[-1] > 1e3 * EPSILON


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


@pytest.mark.parametrize("truth", ELASTIC + GEARS, ids=lambda truth: truth.name)
def test_truths_in_quadruple_precision(truth):
    found = reference_end(truth.chain, truth.start, tolerance=1e-12)
    error = float(np.abs(found.velocity - truth.final).max())
    assert error < 1e-12 * float(np.ptp(truth.start))
    assert error < found.error + 1e-16


def test_finer_is_nearer():
    truth = next(truth for truth in ELASTIC if truth.name == "one on 4, alpha 1/10")
    errors = [
        np.abs(reference_end(truth.chain, truth.start, tolerance=t).velocity - truth.final).max() for t in (1e-8, 1e-13)
    ]
    assert errors[1] < errors[0] < 1e-7
    assert errors[1] < 1e-14


def test_a_contact_that_never_closes_changes_nothing():
    ends = [
        reference_end(
            Chain([100.0, 0.01, 1.0, 1.0], [hooke(1e4), hooke(1e4), hooke(k)], [0.05, 0.05, 50.0], friction=0.3),
            [2.0, 2.0, 0.0, 0.0], 0.03, 1e-9,
        ).velocity
        for k in (1e4, 1e-4)
    ]  # fmt: skip
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)


def test_forces_that_nothing_determines_do_not_stop_it():
    between_walls = Chain([math.inf, 1.0, math.inf], draft_gear(1.0, 1.0))
    assert reference_end(between_walls, [0, 0, 0], 1.0).velocity.tolist() == [0.0, 0.0, 0.0]
    cluster = Chain([1.0] * 5, draft_gear(100.0, 0.5), friction=0.5)
    assert np.abs(reference_end(cluster, [0.3, 0, 0, 0, 0], tolerance=1e-10).velocity).max() < 1e-11


def test_soft_clusters_to_an_exponent_of_a_fiftieth():
    found = reference_end(one_on(3, power_law(1.0, 0.02)), [1, 0, 0, 0], tolerance=1e-9)
    assert found.error < 1e-7
    assert found.velocity @ found.velocity == pytest.approx(1.0, abs=1e-8)
    assert found.velocity.sum() == pytest.approx(1.0, abs=1e-11)


def test_it_says_that_it_gives_up():
    with pytest.raises(ReferenceGaveUpError, match="after 30 steps"):
        reference_end(one_on(2, hertz(1.0)), [1, 0, 0], most_steps=30)


@pytest.mark.parametrize("family", ["gears", "walls", "driven", "loss", "friction", "timed", "couplers"])
@pytest.mark.parametrize("tolerance", [1e-6, 1e-8])
def test_method_scipy_ends_where_it_does(family, tolerance):
    """Within its tolerance; the largest error of some 140 chains of the scan was a hundredth of it."""
    compared = 0
    for seed in range(8):
        chosen = motion(family, seed)
        found = solve(chosen.chain, chosen.velocity, chosen.duration, "scipy", None, 2, tolerance, most_steps=3000)
        try:
            truth = reference_end(chosen.chain, chosen.velocity, float(found.time[-1]), 0.01 * tolerance, 400)
        except ReferenceGaveUpError:
            continue
        if not found.status.gave_up:
            compared += 1
            assert np.abs(found.final_velocity - truth.velocity).max() < tolerance * chosen.speed + truth.error, seed
    assert compared >= 4
