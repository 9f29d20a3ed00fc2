"""Every method against answers in quadruple precision: what an explicit step must reach, what a tolerance promises."""

import math

import numpy as np
import pytest
from softcradle.physics import simulate

from tests.helpers.relations import ADAPTIVE, FIXED_STEP, PROMISE, closing_speed, simulate_quietly
from tests.helpers.truth import ELASTIC, GEARS

CASES = ELASTIC + GEARS
STEPS = 3000  # of a fixed-step method in the striker's contact
# Error of a fixed step: each onset or loss is off by its order at impacts; 30 for up to 5 contacts of up to 3 chatters
# each. One number for all methods and cases.
SAFETY = 30.0
# dop853 alone takes explicit steps across the singular openings of contacts with exponents below 1, for which `accurate`
# hands over to radau: there its estimate of the error falls short by another 10, and it follows every swing of such a contact,
# which at a finer tolerance would take more steps than it may
SOFT_PROMISE, SOFT_TOLERANCE = 100.0, 1e-6
TOLERANCE = 1e-8


def impact_order(method, truth):
    """min(order, 1 + a) where a force begins as d**a, and 1 where it begins with a jump."""
    return 1.0 if truth in GEARS else min(method.order, 1.0 + truth.least_exponent)


def impedance(truth, bound):
    """(T, n) force error [N] for an error of 1 m/s in the rate: sqrt(mu df/dd), which is unbounded where a < 1 opens.

    The slope is that at the overlap, or at its error where that is larger.
    """
    _, stiffness, exponent = truth.chain.parameters.law.T
    overlap = np.maximum(np.abs(truth.overlap), bound * truth.largest_overlap)
    slope = exponent * stiffness * overlap ** (exponent - 1.0)
    return np.sqrt(slope / truth.chain.inverse_reduced_mass)


@pytest.mark.parametrize("truth", CASES, ids=lambda truth: truth.name)
@pytest.mark.parametrize("method", FIXED_STEP, ids=lambda method: method.name)
def test_fixed_steps(method, truth):
    step = truth.contact_time / STEPS
    # explicit steps leave set-valued contacts chattering for ever: the end of the collision is set
    end = 1.1 * max(float(np.nanmax(truth.opened)), truth.contact_time)
    found = simulate(truth.chain, truth.start, end, method.name, step, samples=2)
    bound = SAFETY * STEPS ** -impact_order(method, truth)
    assert np.abs(found.final_velocity - truth.final).max() < bound * closing_speed(truth.start)
    closed, opened = found.contact_intervals[truth.struck][0]
    assert opened - closed == pytest.approx(truth.contact_time, rel=SAFETY / STEPS)


@pytest.mark.parametrize("truth", CASES, ids=lambda truth: truth.name)
@pytest.mark.parametrize("method", ADAPTIVE, ids=lambda method: method.name)
def test_tolerances(method, truth):
    swings = method.name == "dop853" and truth.least_exponent < 1.0
    promised, tolerance = (SOFT_PROMISE, SOFT_TOLERANCE) if swings else (PROMISE, TOLERANCE)
    bound, speed = promised * tolerance, closing_speed(truth.start)
    end = 1.1 * max(float(np.nanmax(truth.opened)), truth.time[-1])
    times = np.union1d(truth.time, np.linspace(0.0, end, 21 if method.name == "scipy" else 201))
    rows = np.searchsorted(times, truth.time)
    found = simulate_quietly(truth.chain, truth.start, method=method.name, samples=times, tolerance=tolerance)
    assert np.abs(found.final_velocity - truth.final).max() < bound * speed
    assert np.abs(found.velocity[rows] - truth.velocity).max() < bound * speed
    assert np.abs(found.overlap[rows] - truth.overlap).max() < bound * truth.largest_overlap.max()
    assert np.abs(found.ledger / found.ledger[0] - 1.0).max() < 10.0 * tolerance
    if not swings:  # a soft contact beside others swings about its force
        stiff = truth.peak_force.max() + impedance(truth, bound) * speed
        assert (np.abs(found.force[rows] - truth.force) < bound * stiff).all()
    assert not found.warnings or (swings and found.velocity_error.max() > PROMISE * tolerance * speed)
    if method.name == "scipy":
        assert (found.step, found.tolerance) == (0.0, tolerance)
        assert 0 < found.steps < found.evaluations
        if truth not in GEARS:  # the digits of the paper's case, and more
            assert found.final_velocity == pytest.approx(truth.final, abs=2e-10)
    openings_are_located(found, truth, bound * speed, PROMISE * tolerance)


def openings_are_located(found, truth, allowed, part):
    """As overlaps: a contact whose beads part slowly is the later found open, the slower they part."""
    pushed = np.nanmax(truth.opened)  # a contact that only touches passes the push on for as long as there is one
    for opened, rate, intervals in zip(truth.opened, np.diff(truth.final), found.contact_intervals, strict=True):
        if math.isnan(opened):
            assert intervals[-1][1] == pytest.approx(pushed, rel=part)
        else:
            assert abs(intervals[-1][1] - opened) * rate < allowed * pushed
    struck = found.contact_intervals[truth.struck]
    assert struck[0][0] == pytest.approx(0.0, abs=1e-12)
    assert struck[0][1] == pytest.approx(truth.contact_time, rel=part)
