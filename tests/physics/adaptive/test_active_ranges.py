"""Ranges of a chain that move apart from each other are stepped apart; inactive contacts between them are not stepped."""

import numpy as np
import pytest
from softcradle.physics import hertz, one_on, simulate

ROUND_OFF = 2.3e-16


@pytest.mark.parametrize("tolerance", [1e-4, 1e-7, 1e-10])
def test_two_impacts_on_one_chain_do_what_each_does_alone(tolerance):
    """Struck at both ends, before the waves meet: the left half is that of a chain struck once, the right its mirror."""
    chain, options = one_on(40, hertz(1.0)), {"method": "accurate", "tolerance": tolerance}
    both = simulate(chain, np.r_[1.0, np.zeros(39), -1.0], 15.0, **options)
    alone = simulate(chain, np.r_[1.0, np.zeros(40)], 15.0, **options)
    end = both.final_velocity
    np.testing.assert_allclose(end, -end[::-1], atol=2.0 * tolerance)
    np.testing.assert_allclose(end[:18], alone.final_velocity[:18], atol=2.0 * tolerance)
    assert abs(end.sum()) <= 1e-12


@pytest.mark.parametrize("method", ["accurate", "dop853"])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-8, 1e-10])
@pytest.mark.parametrize("n", [50, 150])
def test_a_wave_that_has_left_is_over(n, tolerance, method):
    """Behind it contacts are left that move less than the tolerance can tell; for them a run once went on to 1e20 s."""
    found = simulate(one_on(n, hertz(1.0)), np.eye(1, n + 1)[0], method=method, tolerance=tolerance, samples=2)
    assert not found.warnings
    assert n < found.time[-1] < 1.5 * n
    assert (np.diff(found.final_velocity) > -tolerance).all()
    assert abs((found.final_velocity**2).sum() - 1.0) < 10.0 * tolerance
    assert abs(found.final_velocity.sum() - 1.0) < ROUND_OFF * n * n  # each velocity is a sum of up to n rates


@pytest.mark.parametrize(("n", "unequal", "tolerance"), [(60, 1e-2, 1e-6), (80, 1e-6, 1e-6), (120, 1e-9, 1e-8)])
def test_what_a_wave_leaves_behind_collides_for_long(n, unequal, tolerance):
    """Beads that part at 1e-8 m/s meet again after 1e6 s; those that come slower than the tolerance tells did not stop at
    each other, and pressed far in: energy grew to 250 times what there was."""
    contacts = [hertz(1.0 + unequal * (-1.0) ** i) for i in range(n)]
    found = simulate(one_on(n, contacts), np.eye(1, n + 1)[0], tolerance=tolerance, samples=2)
    assert not found.warnings
    assert abs((found.final_velocity**2).sum() - 1.0) < 10.0 * tolerance
    assert abs(found.final_velocity.sum() - 1.0) < ROUND_OFF * n * n  # each velocity is a sum of up to n rates
    assert (np.diff(found.final_velocity) > -10.0 * tolerance).all()
