"""Every method against answers in quadruple precision: what an explicit step must reach, what a tolerance promises."""

from __future__ import annotations

import math

import numpy as np
import pytest
from relations import ADAPTIVE, FIXED_STEP
from truth import ELASTIC, GEARS

from physics import METHODS, simulate

CASES = ELASTIC + GEARS
STEPS = 3000  # of a fixed-step method in the striker's contact
# Error of a fixed step: each onset or loss is off by its order at impacts; 30 for up to 5 contacts of up to 3 chatters
# each. One number for all methods and cases.
SAFETY = 30.0
TOLERANCE = 1e-8
PROMISE = 10.0  # an adaptive method's error is below this many tolerances


def impact_order(method, truth):
    """min(order, 1 + a) where a force begins as d**a, and 1 where it begins with a jump."""
    return 1.0 if truth in GEARS else min(method.order, 1.0 + truth.least_exponent)


def speed(truth):
    return float(np.ptp(truth.start))


@pytest.mark.parametrize("truth", CASES, ids=lambda truth: truth.name)
@pytest.mark.parametrize("method", FIXED_STEP, ids=lambda method: method.name)
def test_fixed_steps(method, truth):
    step = truth.contact_time / STEPS
    # explicit steps leave set-valued contacts chattering for ever: the end of the collision is set
    end = 1.1 * max(float(np.nanmax(truth.opened)), truth.contact_time)
    found = simulate(truth.chain, truth.start, end, method.name, step, samples=2)
    bound = SAFETY * STEPS ** -impact_order(method, truth)
    assert np.abs(found.final_velocity - truth.final).max() < bound * speed(truth)
    closed, opened = found.contact_intervals[truth.struck][0]
    assert opened - closed == pytest.approx(truth.contact_time, rel=SAFETY / STEPS)


@pytest.mark.parametrize("truth", CASES, ids=lambda truth: truth.name)
@pytest.mark.parametrize("method", ADAPTIVE, ids=lambda method: method.name)
def test_tolerances(method, truth):
    found = simulate(truth.chain, truth.start, method=method.name, samples=truth.time, tolerance=TOLERANCE)
    bound = PROMISE * TOLERANCE
    assert np.abs(found.final_velocity - truth.final).max() < bound * speed(truth)
    assert np.abs(found.velocity - truth.velocity).max() < bound * speed(truth)
    assert np.abs(found.overlap - truth.overlap).max() < bound * truth.largest_overlap.max()
    assert np.abs(found.force - truth.force).max() < bound * truth.peak_force.max()
    assert found.warnings == ()


@pytest.mark.parametrize("truth", CASES, ids=lambda truth: truth.name)
@pytest.mark.parametrize("method", ADAPTIVE, ids=lambda method: method.name)
def test_openings_are_located(method, truth):
    found = simulate(truth.chain, truth.start, method=method.name, tolerance=TOLERANCE, samples=2)
    pushed = np.nanmax(truth.opened)  # a contact that only touches passes the push on for as long as there is one
    for opened, intervals in zip(truth.opened, found.contact_intervals, strict=True):
        expected = pushed if math.isnan(opened) else opened
        assert intervals[-1][1] == pytest.approx(expected, rel=PROMISE * TOLERANCE)
    struck = found.contact_intervals[truth.struck]
    assert struck[0][0] == pytest.approx(0.0, abs=1e-12)
    assert struck[0][1] == pytest.approx(truth.contact_time, rel=PROMISE * TOLERANCE)


@pytest.mark.parametrize("method", ADAPTIVE, ids=lambda method: method.name)
@pytest.mark.parametrize("truth", CASES, ids=lambda truth: truth.name)
def test_a_smaller_tolerance_is_more_accurate(method, truth):
    errors = []
    for tolerance in (1e-4, 1e-6):
        found = simulate(truth.chain, truth.start, method=method.name, tolerance=tolerance, samples=2)
        errors.append(float(np.abs(found.final_velocity - truth.final).max()) / speed(truth))
        assert errors[-1] < PROMISE * tolerance
    assert errors[1] < max(errors[0], 1e-9)


@pytest.mark.parametrize("truth", ELASTIC, ids=lambda truth: truth.name)
def test_scipy_gives_the_digits_of_the_paper_case_and_more(truth):
    found = simulate(truth.chain, truth.start, method="scipy", samples=2)
    assert found.final_velocity == pytest.approx(truth.final, abs=2e-10)


def test_the_largest_overlaps_are_those_of_the_truth():
    truth = next(case for case in ELASTIC if case.name == "one on 4, alpha 1/10")
    found = simulate(truth.chain, truth.start, method="scipy", samples=20001)
    # between samples 1e-4 apart an overlap rises by less than its acceleration (about 1) times 1e-8
    assert found.overlap.max(axis=0) == pytest.approx(truth.largest_overlap, abs=1e-8, rel=1e-5)
    assert found.force.max(axis=0) == pytest.approx(truth.peak_force, rel=1e-6)


def test_every_method_is_tested():
    assert {method.name for method in FIXED_STEP + ADAPTIVE} == {method.name for method in METHODS}
