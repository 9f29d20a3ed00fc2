"""Tests of the mode-coupling model: its equations, overlaps and accuracy, and the collisions for which it is exact."""

import math

import numpy as np
import pytest
from scipy.special import beta
from softcradle.physics import Chain, cluster_on_cluster, one_on, simulate
from softcradle.physics.analysis.measures import depth_law, response_times, time_scale_separation
from softcradle.physics.analysis.mode_coupling import Reduction, mode_coupling
from softcradle.physics.contact import hertz, hooke, power_law

LAWS = [power_law(f0, 1 / k) for f0, k in ((1.2, 9), (0.8, 11), (1.4, 13), (0.6, 10))]
MIXED = Chain([1.3, 0.7, 1.1, 0.9, 1.6], LAWS)
HIT = [1.0, 0.0, 0.0, 0.0, 0.0]


def test_the_modes_solve_the_equations_of_the_paper():
    """Compare the modes with Eq. (A3), where M = m2 + ... + mn. The right-hand sides of this equation must equal the
    second derivatives of Phi and psi.
    """
    times = np.linspace(0.3, 1.1, 161)
    found = mode_coupling(MIXED, HIT, 1.2, samples=times, tolerance=1e-10)
    m0, m1, *rest = MIXED.mass
    f01, f12 = (np.asarray(MIXED.contact[i].force(mode)) for i, mode in enumerate((found.phi, found.psi)))
    np.testing.assert_allclose(found.acceleration[:, 0], -(1 / m0 + 1 / m1) * f01 + f12 / m1, atol=1e-12)
    np.testing.assert_allclose(found.acceleration[:, 1], f01 / m1 - (1 / m1 + 1 / sum(rest)) * f12, atol=1e-12)
    second = np.diff((found.phi, found.psi), 2) / (times[1] - times[0]) ** 2
    np.testing.assert_allclose(second.T, found.acceleration[1:-1], atol=2e-4)
    assert found.psi_bar is None
    assert mode_coupling(cluster_on_cluster(4, 1, power_law(1.0, 0.1)), [1.0] * 4 + [0.0], 1.2).psi is None


def test_inner_beads_have_one_acceleration():
    """Compare the accelerations of the inner beads with Eq. (A1) and with Eq. (7), its homogeneous case. Eq. (5)
    follows from the equal accelerations.
    """
    found = mode_coupling(MIXED, HIT)
    psi, mass = np.maximum(found.psi, 0.0), MIXED.mass
    for i in (2, 3):
        alpha, f0 = MIXED.contact[i].exponent, MIXED.contact[i].stiffness
        share = sum(mass[i + 1 :]) * MIXED.contact[1].stiffness / (sum(mass[2:]) * f0)
        expected = share ** (1 / alpha) * psi ** (MIXED.contact[1].exponent / alpha)
        np.testing.assert_allclose(found.trajectory.overlap[:, i], expected, rtol=1e-12)
    model = found.trajectory
    net = model.force[:, 1:] - np.column_stack((model.force[:, 2:], np.zeros(model.time.size)))
    acceleration = net / np.array(MIXED.mass[2:])
    np.testing.assert_allclose(acceleration[:, 1:], acceleration[:, :1].repeat(2, axis=1), atol=1e-14)
    forces = np.column_stack([c.force(d) for c, d in zip(MIXED.contact, model.overlap.T, strict=True)])
    np.testing.assert_allclose(forces, model.force, atol=1e-9)
    assert model.momentum[-1] == pytest.approx(MIXED.mass[0], rel=0.05)
    same = mode_coupling(one_on(5, power_law(1.0, 0.1)), [1.0] + [0.0] * 5)
    ratio = same.trajectory.overlap[100, 1:] / same.psi[100]
    np.testing.assert_allclose(ratio, depth_law(5, 0.1), rtol=1e-12)


def test_rates_are_the_slopes_of_the_overlaps():
    times = np.linspace(0.4, 1.2, 401)
    model = mode_coupling(MIXED, HIT, 1.3, samples=times, tolerance=1e-10).trajectory
    np.testing.assert_allclose(np.gradient(model.overlap, times, axis=0)[1:-1], model.rate[1:-1], atol=1e-6)


def test_two_targets_need_no_reduction():
    chain, velocity = Chain([1.5, 0.7, 1.0], [hooke(2.0), power_law(0.6, 0.07)]), [1.0, 0.0, 0.0]
    full, model = simulate(chain, velocity, method="radau"), mode_coupling(chain, velocity, method="radau")
    np.testing.assert_array_equal(model.trajectory.overlap, full.overlap)
    np.testing.assert_array_equal(model.trajectory.final_velocity, full.final_velocity)


@pytest.mark.parametrize("alpha", [1 / 10, 1 / 30])
def test_start_is_the_series(alpha):
    """Compare the start of the motion with the series Phi ~ t, psi ~ t**(2 + alpha) / ((1 + alpha)(2 + alpha)). The
    times begin at 1e-30.
    """
    times = np.logspace(-30, -20, 11)
    found = mode_coupling(one_on(4, power_law(1.0, alpha)), HIT, 1.0, samples=times)
    np.testing.assert_allclose(found.phi, times, rtol=1e-9)
    # The next term of the series is smaller by the factor t**(alpha (1 + alpha)). The forces of the model are accurate
    # to a few 1e-3.
    slack = alpha * 2.0 * times ** (alpha * (1 + alpha)) + 3e-3
    series = times ** (2 + alpha) / ((1 + alpha) * (2 + alpha))
    assert (np.abs((found.psi / series) ** alpha - 1.0) < slack).all()


def test_cluster_on_cluster_has_a_mode_on_either_side():
    found = mode_coupling(cluster_on_cluster(3, 3, power_law(1.0, 1 / 14)), [1.0] * 3 + [0.0] * 3)
    assert found.reduction.modes == (1, 2, 3)
    np.testing.assert_allclose(found.psi, found.psi_bar, rtol=1e-7, atol=1e-12)
    np.testing.assert_allclose(found.trajectory.overlap, found.trajectory.overlap[:, ::-1], rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize(("n", "alpha"), [(2, 0.1), (4, 0.1), (5, 0.2)])
def test_driven_cluster_has_the_closed_period_and_amplitude(n, alpha):
    force = 0.8
    chain = Chain([1.0] * n, power_law(1.0, alpha), drive=[force] + [0.0] * (n - 1))
    amplitude = ((1 + alpha) * force * (n - 1) / n) ** (1 / alpha)
    period = math.sqrt(2 * amplitude / force) * beta(0.5 / alpha, 0.5) / alpha
    found = mode_coupling(chain, [0.0] * n, 2 * period, "conserving", period / 20000, 41)
    assert found.phi is None
    assert found.psi.max() == pytest.approx(amplitude, rel=1e-5)
    assert found.psi[[20, 40]].max() < 1e-5 * amplitude
    np.testing.assert_allclose(found.psi[:21], found.psi[20:], atol=1e-4 * amplitude)


@pytest.mark.parametrize("driven", [0, 1])
def test_beads_that_are_modes_may_be_driven(driven):
    drive = 0.3 * np.eye(5)[driven]
    chain = Chain([1.0] * 5, power_law(1.0, 1 / 20), drive=drive)
    full = simulate(chain, HIT, 1.2, samples=np.linspace(0.1, 1.2, 50))
    model = mode_coupling(chain, HIT, 1.2, samples=full.time)
    assert Reduction.of(chain, HIT).reduced.drive == (*drive[:2], 0.0)
    np.testing.assert_allclose(model.trajectory.force, full.force, atol=5e-4)


def test_the_response_time_is_that_of_small_oscillations():
    """Check the response time of two unit beads on a linear contact with omega**2 = 2 k. The response time is 0 for a
    contact that never loads.
    """
    found = simulate(Chain([1.0, 1.0, 1.0], [hooke(8.0), hertz(8.0)], gap=[0.0, 9.0]), [1.0, 0.0, 0.0], 1.0)
    assert response_times(found) == pytest.approx([1.0 / 4.0, 0.0])
    assert time_scale_separation(found) == pytest.approx([1.0 / math.pi**2, 0.0])
    with pytest.raises(ValueError, match="does not close and open again"):
        time_scale_separation(found, struck=1)
