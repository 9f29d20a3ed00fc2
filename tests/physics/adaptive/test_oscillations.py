"""Contacts that stay closed and oscillate: what many turns make of errors, and steps across a turn at all but no overlap."""

import numpy as np
import pytest
from softcradle.physics import Chain, hertz, hooke, power_law, simulate

from tests.helpers.relations import simulate_quietly


def pressed_bead(law, push: float, mass: float) -> tuple[Chain, float]:
    """A bead at rest that a steady force pushes against a wall from zero overlap on, and its period [s] by quadrature.

    Its energy is that of the contact less the work of the force, so at overlap d it is as fast as the difference of the two.
    """
    chain = Chain([mass, np.inf], law, drive=[push, 0.0])
    deepest = (push * (law.exponent + 1.0) / law.stiffness) ** (1.0 / law.exponent)
    # d = deepest * sin(q)**2 takes the square roots at both ends away
    nodes, weights = np.polynomial.legendre.leggauss(200)
    q = 0.25 * np.pi * (nodes + 1.0)
    d = deepest * np.sin(q) ** 2
    speed = np.sqrt(2.0 / mass * (push * d - law.stiffness * d ** (law.exponent + 1.0) / (law.exponent + 1.0)))
    half = 0.25 * np.pi * np.sum(weights * 2.0 * deepest * np.sin(q) * np.cos(q) / speed)
    return chain, 2.0 * half


@pytest.mark.parametrize("seed", range(12))
def test_a_bead_that_comes_back_to_zero_overlap_is_as_exact_as_the_tolerance(seed):
    """Steps across such a turn saw a smooth force: one in ten was off by 12 to 40 tolerances."""
    draw = np.random.default_rng(seed)
    law = hertz(float(10.0 ** draw.uniform(-1, 2)))
    chain, period = pressed_bead(law, float(10.0 ** draw.uniform(-1, 0)), float(10.0 ** draw.uniform(-1, 1)))
    for part in (1.25, 1.5, 2.3):
        wanted = simulate(chain, [0, 0], part * period, method="radau", tolerance=1e-12, samples=2).final_velocity[0]
        if part == 1.5:
            assert wanted == pytest.approx(0.0, abs=1e-7)  # the deepest point, known by quadrature
        for tolerance in 10.0 ** np.arange(-5.0, -9.1, -0.5):
            found = simulate(chain, [0.0, 0.0], part * period, method="dop853", tolerance=tolerance, samples=2)
            speed = max(np.ptp(found.velocity), 1e-3)
            assert found.final_velocity[0] == pytest.approx(wanted, abs=10.0 * tolerance * max(speed, 1.0))


@pytest.mark.parametrize("method", ["radau", "accurate"])
@pytest.mark.parametrize("seed", range(4))
def test_the_stated_error_of_many_oscillations(method, seed):
    """Errors of a phase add up: they were stated as those of steps that know nothing of each other."""
    draw = np.random.default_rng(seed)
    stiff = [hertz, hooke][seed % 2](float(10.0 ** draw.uniform(3, 4)))
    masses = 10.0 ** draw.uniform(-0.5, 1.0, 3)
    chain = Chain(masses, [stiff, power_law(1e-2, 0.2)])
    velocity = [1.0, 0.9, 0.0]  # the stiff contact rings as long as the soft one pushes
    truth = simulate_quietly(chain, velocity, 20.0, method=method, tolerance=1e-11, samples=2)
    for tolerance in (1e-4, 1e-5, 1e-6):
        found = simulate_quietly(chain, velocity, 20.0, method=method, tolerance=tolerance, samples=2)
        apart = np.abs(found.final_velocity - truth.final_velocity)
        assert (apart <= np.maximum(found.velocity_error, 10.0 * tolerance)).all()
