"""Orders of convergence, fitted over all fixed-step methods: on smooth motion their own, at a touch the force's."""

import numpy as np
import pytest
from softcradle.physics import Chain, Contact, State, advance, draft_gear, hertz, hooke, power_law, simulate, step_force

from tests.helpers.relations import ADAPTIVE, FIXED_STEP

SMOOTH = {
    "Hertz": Chain([1.0, 2.0, 0.7, 1.5], hertz(2.0)),
    "mixed": Chain([1.0, 2.0, 0.7, 1.5], [Contact(0.5, 1.0, 0.5), hooke(3.0), power_law(1.0, 0.3)]),
}
DURATION = 0.5
TOUCHES = [power_law(1.0, 0.1), power_law(1.0, 0.5), hooke(1.0), hertz(1.0), draft_gear(1.0, 0.5), step_force(1.0)]


def compressed(chain):
    """A start at which every contact is loaded, and stays so for the duration."""
    state = State.at_start(chain, [1.0, 0.8, 0.5, 0.2])
    state.overlap[:] = 0.5, 0.6, 0.4
    return state


def slope(counts, errors):
    return -float(np.polyfit(np.log(counts), np.log(errors), 1)[0])


def moved(chain, method, **fineness):
    state = compressed(chain)
    advance(chain, state, DURATION, method, **fineness)
    return np.concatenate((state.overlap, state.rate, state.position(chain), state.velocity(chain)))


@pytest.mark.parametrize("case", SMOOTH)
@pytest.mark.parametrize("method", FIXED_STEP, ids=lambda method: method.name)
def test_order_on_smooth_motion(method, case):
    chain, counts = SMOOTH[case], (16, 32, 64, 128)
    exact = moved(chain, "scipy", tolerance=1e-10)
    assert exact[:3].min() > 0.1  # still loaded: no touch spoils the order
    errors = [np.abs(moved(chain, method.name, step=DURATION / count) - exact).max() for count in counts]
    assert slope(counts, errors) == pytest.approx(method.order, abs=0.1)


@pytest.mark.parametrize("law", TOUCHES, ids=str)
@pytest.mark.parametrize("method", FIXED_STEP, ids=lambda method: method.name)
def test_order_at_a_touch(method, law):
    """min(order, 1 + a), 1 with a preload: root mean square over the phase of the step at which the beads meet.

    A method of mean forces (set-valued) integrates the onset exactly and keeps its order on a single contact.
    """
    after, counts, phases = 0.25, (64, 128, 256, 512), (np.arange(8) + 0.5) / 8
    exact = simulate(Chain([1, 1], law), [1, 0], after, "scipy", samples=2, tolerance=1e-10).final_velocity
    errors = []
    for count in counts:
        gaps = phases / count  # the striker runs into the target at any point of a step
        ends = [
            simulate(Chain([1, 1], law, gap), [1, 0], gap + after, method.name, 1.0 / count, 2).final_velocity
            for gap in gaps
        ]
        errors.append(np.sqrt(np.mean((np.array(ends) - exact) ** 2)))
    onset = 1.0 if law.preload else 1.0 + law.exponent
    expected = method.order if method.set_valued else min(method.order, onset)
    assert slope(counts, errors) == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize("loss", [0.1, 0.5, 0.9])
def test_order_where_contacts_with_loss_reverse(loss):
    """2 for mean forces, over the phase of the step at which the first contact turns from pressing in to coming out."""
    chain, counts = Chain([1.0, 1.0, 1.0], Contact(1.0, 1e3, 1.5, loss)), (25, 50, 100, 200, 400)
    exact = simulate(chain, [1, 0, 0], 0.5, "scipy", samples=2, tolerance=1e-10).final_velocity
    errors = []
    for count in counts:
        steps = 0.5 / count * (1.0 - 0.04 * np.arange(12))
        ends = [simulate(chain, [1, 0, 0], 0.5, "conserving", step, 2).final_velocity for step in steps]
        errors.append(np.sqrt(np.mean((np.array(ends) - exact) ** 2)))
    assert slope(counts, errors) == pytest.approx(2.0, abs=0.15)


@pytest.mark.parametrize("case", SMOOTH)
@pytest.mark.parametrize("method", ADAPTIVE, ids=lambda method: method.name)
def test_adaptive_error_follows_the_tolerance(method, case):
    exact = moved(SMOOTH[case], "yoshida4", step=DURATION / 8192)
    for tolerance in (1e-3, 1e-5, 1e-7, 1e-9):
        assert np.abs(moved(SMOOTH[case], method.name, tolerance=tolerance) - exact).max() < max(10 * tolerance, 1e-12)


@pytest.mark.parametrize("method", ADAPTIVE, ids=lambda method: method.name)
def test_adaptive_cost_grows_slowly_with_the_digits(method):
    evaluations = [
        simulate(Chain([1.0] * 5, hertz(1.0)), [1, 0, 0, 0, 0], 3.0, method.name, tolerance=tolerance).evaluations
        for tolerance in (1e-4, 1e-8)
    ]
    assert evaluations[0] < evaluations[1] < 10 * evaluations[0]  # a fixed step of order 2 would need 100 times as many


def test_a_default_step_resolves_the_shortest_contact():
    stiff = Chain([1, 1, 1], [hooke(1.0), hooke(1e4)])
    found = simulate(stiff, [1, 0, 0], samples=2)
    assert found.step == pytest.approx(simulate(Chain([1, 1], hooke(1e4)), [1, 0], samples=2).step)
    exact = simulate(stiff, [1, 0, 0], method="scipy", samples=2)
    assert found.final_velocity == pytest.approx(exact.final_velocity, abs=1e-4)
