"""Tests of closed forms against quadrature, reference solutions and simulated motions."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from softcradle.physics import cluster_on_cluster, one_on, simulate
from softcradle.physics.analysis import closed_forms
from softcradle.physics.analysis.closed_forms import critical_speed, one_on_one, rigid_collision
from softcradle.physics.contact import draft_gear, hertz, hooke, power_law, step_force

from tests.helpers.relations import SET_VALUED
from tests.helpers.truth import CRITICAL_SPEEDS, GEAR

LAWS = [power_law(1.0, 0.1), power_law(2.0, 1 / 14), hooke(3.0), hertz(2.0), draft_gear(2.0, 0.3), step_force(1.5)]
LAWS += [hertz(2.0, loss=0.3), draft_gear(2.0, 0.3, loss=0.6), step_force(1.5, loss=0.9)]


@pytest.mark.parametrize("law", LAWS, ids=str)
@pytest.mark.parametrize("speed", [0.3, 2.0])
def test_one_on_one_is_energy_and_quadrature(law, speed):
    mass = 0.7
    depth, time, force = one_on_one(law, mass, speed)
    energy = 0.5 * mass * speed**2
    assert (law.energy(depth), law.force(depth)) == pytest.approx((energy, force), rel=1e-13)

    def inverse_rate(u: float, part: float) -> float:
        """Return dt/du for the overlap d = depth (1 - u**2). This function is smooth at the turning point u = 0. The
        argument `part` is the fraction of the contact force that acts.
        """
        d = depth * (1.0 - u * u)
        # Compute (E(depth) - E(d)) / u**2 without cancellation near u = 0.
        left = (energy - law.energy(d)) / (u * u) if u > 1e-4 else force * depth
        return 2.0 * depth / math.sqrt(2.0 * part * left / mass)

    ways = [quad(inverse_rate, 0.0, 1.0, part, epsabs=0, epsrel=1e-10)[0] for part in (1.0, 1.0 - law.loss)]
    assert sum(ways) == pytest.approx(time, rel=1e-7)


@pytest.mark.parametrize("name", CRITICAL_SPEEDS)
def test_critical_speeds(name):
    strikers, targets = map(int, name.split("-on-"))
    found = critical_speed(GEAR, [0.396] * (strikers + targets), strikers)
    assert found == pytest.approx(CRITICAL_SPEEDS[name], rel=1e-14)
    assert critical_speed(GEAR, [1.0, 2.0], 1) == math.inf


@pytest.mark.parametrize(("strikers", "targets"), [(1, 2), (1, 5), (2, 2), (2, 3), (3, 1)])
@pytest.mark.parametrize("method", SET_VALUED, ids=lambda method: method.name)
def test_both_sides_of_the_critical_speed(strikers, targets, method):
    mass = np.linspace(0.9, 1.2, strikers + targets)
    chain = cluster_on_cluster(strikers, targets, draft_gear(5.0, 0.2), mass)
    critical = critical_speed(draft_gear(5.0, 0.2), mass, strikers)
    struck = strikers - 1
    for factor, rigid in ((0.999, True), (1.01, False)):
        speed = factor * critical
        found = simulate(chain, np.repeat([speed, 0.0], [strikers, targets]), method=method.name, samples=401)
        inner = np.delete(found.overlap, struck, axis=1)[found.force[:, struck] > 0.0]
        assert (inner.max() <= 0.0) == rigid
        error = np.abs(found.final_velocity - rigid_collision(mass, strikers, speed)).max() / speed
        assert error < 1e-9 if rigid else error > 1e-9


def test_a_long_linear_chain_returns_a_bessel_number():
    kept, time = closed_forms.long_linear_chain()
    assert (kept, time) == pytest.approx((-0.1322795, 2.56781), rel=2e-6)
    found = simulate(one_on(40, hooke(1.0)), np.eye(41)[0], 3.0, tolerance=1e-12)
    ((_, opened),) = found.contact_intervals[0]
    assert (found.final_velocity[0], opened) == pytest.approx((kept, time), rel=1e-10)
    assert closed_forms.long_linear_chain(4.0, 9.0) == pytest.approx((kept, time * 2 / 3))
