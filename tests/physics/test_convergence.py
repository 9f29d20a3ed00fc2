"""Tests of the orders of convergence. The tests also compare every adaptive method with quadruple-precision solutions."""

import math

import numpy as np
import pytest
from softcradle.physics import Chain, Contact, State, advance, draft_gear, hertz, hooke, power_law, simulate, step_force

from tests.helpers.relations import ADAPTIVE, FIXED_STEP, PROMISE, closing_speed, simulate_quietly
from tests.helpers.truth import ELASTIC, GEARS

SMOOTH = {
    "Hertz": Chain([1.0, 2.0, 0.7, 1.5], hertz(2.0)),
    "mixed": Chain([1.0, 2.0, 0.7, 1.5], [Contact(0.5, 1.0, 0.5), hooke(3.0), power_law(1.0, 0.3)]),
}
DURATION = 0.5
TOUCHES = [power_law(1.0, 0.1), power_law(1.0, 0.5), hooke(1.0), hertz(1.0), draft_gear(1.0, 0.5), step_force(1.0)]


def slope(counts, errors):
    return -float(np.polyfit(np.log(counts), np.log(errors), 1)[0])


def moved(chain, method, **fineness):
    """Return the final state of a motion in which every contact stays loaded."""
    state = State.at_start(chain, [1.0, 0.8, 0.5, 0.2])
    state.overlap[:] = 0.5, 0.6, 0.4
    advance(chain, state, DURATION, method, **fineness)
    return np.concatenate((state.overlap, state.rate, state.position(chain), state.velocity(chain)))


@pytest.mark.parametrize("case", SMOOTH)
@pytest.mark.parametrize("method", FIXED_STEP, ids=lambda method: method.name)
def test_order_on_smooth_motion(method, case):
    chain, counts = SMOOTH[case], (16, 32, 64, 128)
    exact = moved(chain, "scipy", tolerance=1e-10)
    assert exact[:3].min() > 0.1  # All contacts are still loaded, so no opening reduces the order.
    errors = [np.abs(moved(chain, method.name, step=DURATION / count) - exact).max() for count in counts]
    assert slope(counts, errors) == pytest.approx(method.order, abs=0.1)


@pytest.mark.parametrize("law", TOUCHES, ids=str)
@pytest.mark.parametrize("method", FIXED_STEP, ids=lambda method: method.name)
def test_order_at_a_touch(method, law):
    """Check the order of convergence when beads meet. The expected order is min(order, 1 + a) without a preload, and 1
    with a preload. The error is the root mean square over different times within a step at which the beads meet.

    A set-valued method uses mean forces. Such a method integrates the beginning of the contact exactly and keeps its
    order on a single contact.
    """
    after, counts, phases = 0.25, (64, 128, 256, 512), (np.arange(8) + 0.5) / 8
    exact = simulate(Chain([1, 1], law), [1, 0], after, "scipy", samples=2, tolerance=1e-10).final_velocity
    errors = []
    for count in counts:
        gaps = phases / count  # The first bead reaches the other bead at different times within a step.
        runs = (simulate(Chain([1, 1], law, gap), [1, 0], gap + after, method.name, 1.0 / count, 2) for gap in gaps)
        errors.append(np.sqrt(np.mean([(run.final_velocity - exact) ** 2 for run in runs])))
    onset = 1.0 if law.preload else 1.0 + law.exponent
    expected = method.order if method.set_valued else min(method.order, onset)
    assert slope(counts, errors) == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize("case", SMOOTH)
@pytest.mark.parametrize("method", ADAPTIVE, ids=lambda method: method.name)
def test_adaptive_error_follows_the_tolerance(method, case):
    exact = moved(SMOOTH[case], "yoshida4", step=DURATION / 8192)
    for tolerance in (1e-3, 1e-5, 1e-7, 1e-9):
        assert np.abs(moved(SMOOTH[case], method.name, tolerance=tolerance) - exact).max() < max(10 * tolerance, 1e-12)


@pytest.mark.parametrize("method", ADAPTIVE, ids=lambda method: method.name)
def test_adaptive_cost_grows_slowly_with_the_digits(method):
    chain, start = Chain([1.0] * 5, hertz(1.0)), [1, 0, 0, 0, 0]
    loose, fine = (simulate(chain, start, 3.0, method.name, tolerance=each).evaluations for each in (1e-4, 1e-8))
    assert loose < fine < 10 * loose  # A method of order 2 with fixed steps would need 100 times as many steps.


def test_a_default_step_resolves_the_shortest_contact():
    stiff = Chain([1, 1, 1], [hooke(1.0), hooke(1e4)])
    found = simulate(stiff, [1, 0, 0], method="conserving", samples=2)
    alone = simulate(Chain([1, 1], hooke(1e4)), [1, 0], method="conserving", samples=2)
    assert found.step == pytest.approx(alone.step)
    assert found.step > 0.0
    exact = simulate(stiff, [1, 0, 0], method="scipy", samples=2)
    assert found.final_velocity == pytest.approx(exact.final_velocity, abs=1e-4)


CASES = ELASTIC + GEARS
# The method `dop853` takes explicit steps across the singular openings of contacts with exponents below 1. (At these
# openings, `accurate` uses radau.) At the opening of such a contact, the error estimate of dop853 is too small by
# another factor of 10. The method also resolves every oscillation, so a finer tolerance would exceed the step limit.
SOFT_PROMISE, SOFT_TOLERANCE = 100.0, 1e-6
TOLERANCE = 1e-8


SOFT = [truth for truth in ELASTIC if truth.least_exponent < 1.0]
LONG = {("scipy", truth.name) for truth in SOFT if truth.name not in ("one on 1, alpha 1/10", "one on 4, alpha 1/10")}
HELD = [
    pytest.param(method, truth, id=f"{method.name}-{truth.name}", marks=pytest.mark.slow if given in LONG else ())
    for method in ADAPTIVE for truth in CASES for given in [(method.name, truth.name)]
]  # fmt: skip


@pytest.mark.parametrize(("method", "truth"), HELD)
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
    if not swings:  # The force of a soft contact between other contacts oscillates about its mean.
        # Force error [N] for a velocity error of 1 m/s in the rate: sqrt(mu df/dd), as an array of shape (T, n). The
        # force error is unbounded when a contact with an exponent below 1 opens. The slope is taken at the overlap or
        # at the error of the overlap, whichever is larger.
        _, stiffness, exponent = truth.chain.power_law_rows.T
        overlap = np.maximum(np.abs(truth.overlap), bound * truth.largest_overlap)
        slopes = exponent * stiffness * overlap ** (exponent - 1.0)
        stiff = truth.peak_force.max() + np.sqrt(slopes / truth.chain.inverse_reduced_mass) * speed
        assert (np.abs(found.force[rows] - truth.force) < bound * stiff).all()
    assert not found.warnings or (swings and found.velocity_error.max() > PROMISE * tolerance * speed)
    if method.name == "scipy":
        assert (found.step, found.tolerance) == (0.0, tolerance)
        assert 0 < found.steps < found.evaluations
        if truth not in GEARS:  # Compare all digits of the example in the paper, and some more digits.
            assert found.final_velocity == pytest.approx(truth.final, abs=2e-10)
    # The overlap determines the time of an opening. The more slowly the beads of a contact separate, the later the
    # opening is found.
    part = PROMISE * tolerance
    pushed = np.nanmax(truth.opened)  # A contact at overlap 0 transmits the push for as long as the push lasts.
    for opened, rate, intervals in zip(truth.opened, np.diff(truth.final), found.contact_intervals, strict=True):
        if math.isnan(opened):
            assert intervals[-1][1] == pytest.approx(pushed, rel=part)
        else:
            assert abs(intervals[-1][1] - opened) * rate < bound * speed * pushed
    struck = found.contact_intervals[truth.struck]
    assert struck[0][0] == pytest.approx(0.0, abs=1e-12)
    assert struck[0][1] == pytest.approx(truth.contact_time, rel=part)
