"""The closed forms against quadrature, the truth, and what the methods find."""

import math

import numpy as np
import pytest
from scipy import optimize
from scipy.integrate import quad
from softcradle.physics import Chain, cluster_on_cluster, simulate
from softcradle.physics.analysis import closed_forms
from softcradle.physics.analysis.closed_forms import critical_speed, one_on_one, rigid_collision
from softcradle.physics.contact import draft_gear, hertz, hooke, power_law, step_force

from tests.helpers.relations import SET_VALUED
from tests.helpers.truth import CRITICAL_SPEEDS, ELASTIC, GEAR, GEARS

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
        """dt/du with d = depth (1 - u**2), smooth at the turning point u = 0, with `part` of the force."""
        d = depth * (1.0 - u * u)
        # E(depth) - E(d) over u**2 without cancellation near u = 0
        left = (energy - law.energy(d)) / (u * u) if u > 1e-4 else force * depth
        return 2.0 * depth / math.sqrt(2.0 * part * left / mass)

    ways = [quad(inverse_rate, 0.0, 1.0, part, epsabs=0, epsrel=1e-10)[0] for part in (1.0, 1.0 - law.loss)]
    assert sum(ways) == pytest.approx(time, rel=1e-7)


def test_one_on_one_agrees_with_the_truth():
    truth = ELASTIC[0]
    stroke = one_on_one(power_law(1.0, 0.1), 0.5, 1.0)
    assert stroke == pytest.approx((truth.largest_overlap[0], truth.contact_time, truth.peak_force[0]), rel=1e-14)


@pytest.mark.parametrize("name", CRITICAL_SPEEDS)
def test_critical_speeds(name):
    strikers, targets = map(int, name.split("-on-"))
    found = critical_speed(GEAR, [0.396] * (strikers + targets), strikers)
    assert found == pytest.approx(CRITICAL_SPEEDS[name], rel=1e-14)
    assert critical_speed(GEAR, [1.0, 2.0], 1) == math.inf


@pytest.mark.parametrize("truth", [case for case in GEARS if "1.5vc" not in case.name], ids=lambda truth: truth.name)
def test_rigid_gears_are_two_rigid_bodies(truth):
    mass, speed = truth.chain.mass, truth.start[0]
    assert speed < critical_speed(GEAR, mass, 1)
    assert rigid_collision(mass, 1, speed) == pytest.approx(truth.final, rel=1e-14)
    stroke = closed_forms.rigid_stroke(GEAR, mass, 1, speed)
    assert stroke == pytest.approx((truth.largest_overlap[0], truth.contact_time, truth.peak_force[0]), rel=1e-13)


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


class LinearChain:
    """Beads joined by linear springs, solved by eigenmodes; a truncated Hooke chain until its first contact opens.

    ``M u'' = -B^T K B u``: with the modes of ``M^-1/2 B^T K B M^-1/2``, eigenvalues w_k^2, each mode is a sine in time,
    a uniform motion where w_k = 0.
    """

    def __init__(self, mass, stiffness, velocity):
        root = np.sqrt(np.asarray(mass, dtype=np.float64))
        n = root.size - 1
        difference = np.eye(n, n + 1) - np.eye(n, n + 1, 1)
        scaled = np.sqrt(np.broadcast_to(stiffness, (n,)))[:, None] * difference / root
        squares, modes = np.linalg.eigh(scaled.T @ scaled)
        self.frequency = np.sqrt(np.maximum(squares, 0.0))
        self.frequency[0] = 0.0  # the uniform motion, whose eigenvalue eigh finds to round-off
        self.shape = modes / root[:, None]
        self.amplitude = modes.T @ (root * np.asarray(velocity, dtype=np.float64))

    def velocity(self, time):
        phase = np.multiply.outer(time, self.frequency)
        return np.cos(phase) * self.amplitude @ self.shape.T

    def overlap(self, time):
        times = np.asarray(time, dtype=np.float64)
        phase = np.multiply.outer(times, self.frequency / np.pi)
        moved = times[..., None] * np.sinc(phase) * self.amplitude @ self.shape.T
        return moved[..., :-1] - moved[..., 1:]

    def first_opening(self, contact=0):
        """Time [s] at which `contact` first returns to overlap 0, to round-off; the closing itself left out."""
        grid = np.linspace(0.0, 4.0 * math.pi / self.frequency[-1], 400)[1:]
        while not (opened := self.overlap(grid)[1:, contact] <= 0.0).any():
            grid = grid * 2.0
        last = 1 + int(np.argmax(opened))
        ends = grid[last - 1 : last + 1]
        return optimize.brentq(lambda time: self.overlap(time)[contact], *ends, xtol=1e-14 * ends[1])


def test_eigenmodes_agree_with_the_truth():
    truth = next(case for case in ELASTIC if case.name == "one on 4, Hooke")
    chain = LinearChain(truth.chain.mass, 1.0, truth.start)
    assert chain.first_opening() == pytest.approx(truth.contact_time, rel=1e-14)
    assert chain.velocity(truth.contact_time)[0] == pytest.approx(truth.final[0], abs=1e-15)
    assert chain.overlap(truth.time) == pytest.approx(truth.overlap, abs=1e-14)
    assert chain.velocity(truth.time) == pytest.approx(truth.velocity, abs=1e-14)


def test_eigenmodes_of_unequal_beads_agree_with_the_reference():
    mass, stiffness = [1.0, 3.0, 0.5, 2.0], [1.0, 4.0, 0.7]
    modes = LinearChain(mass, stiffness, [1, 0, 0, 0])
    end = min(modes.first_opening(i) for i in range(3))
    found = simulate(Chain(mass, [hooke(k) for k in stiffness]), [1, 0, 0, 0], end, "scipy", samples=20)
    assert found.overlap == pytest.approx(modes.overlap(found.time), abs=1e-9)
    assert found.velocity == pytest.approx(modes.velocity(found.time), abs=1e-9)


def test_a_long_linear_chain_returns_a_bessel_number():
    kept, time = closed_forms.long_linear_chain()
    assert (kept, time) == pytest.approx((-0.1322795, 2.56781), rel=2e-6)
    modes = LinearChain(np.ones(40), 1.0, np.eye(40)[0])
    assert (modes.velocity(time)[0], modes.first_opening()) == pytest.approx((kept, time), rel=1e-12)
    assert closed_forms.long_linear_chain(4.0, 9.0) == pytest.approx((kept, time * 2 / 3))
