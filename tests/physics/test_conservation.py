"""Momentum to round-off in every method, energy bounded in all and exact where the method says so."""

from __future__ import annotations

import math

import numpy as np
import pytest
from softcradle.physics import (
    METHODS,
    Chain,
    State,
    advance,
    cluster_on_cluster,
    draft_gear,
    hertz,
    hooke,
    power_law,
    simulate,
)

from tests.helpers.relations import (
    EPSILON,
    FIXED_STEP,
    LIVE,
    NAMES,
    kinetic_energy,
    momentum,
    momentum_scale,
    total_energy,
)
from tests.helpers.truth import ELASTIC, GEARS

MIXED = Chain([1.0, 30.0, 0.2, 5.0, 1.0], [power_law(1.0, 0.1), hooke(3.0), draft_gear(2.0, 0.1), hertz(4.0)])
MIXED_START = [1.0, 0.0, 0.5, 0.0, -1.0]
TOLERANT = [method.name for method in METHODS if method.adaptive]
EXPLICIT = [method for method in FIXED_STEP if not method.set_valued]
EXACT = [method for method in FIXED_STEP if method.set_valued]


@pytest.mark.parametrize("method", NAMES)
def test_momentum_to_round_off_and_so_the_whole_moves_uniformly(method):
    found = simulate(MIXED, MIXED_START, 5.0, method)
    scale = momentum_scale(MIXED, MIXED_START) * math.sqrt(found.steps)  # rounding errors add up as a random walk
    assert np.abs(found.momentum - momentum(MIXED, MIXED_START)).max() < 20 * EPSILON * scale
    mass = np.array(MIXED.mass)
    centre = found.position @ mass / mass.sum()
    drift = momentum(MIXED, MIXED_START) / mass.sum()
    assert centre == pytest.approx(centre[0] + drift * found.time, abs=1e-12)


@pytest.mark.parametrize("method", [method.name for method in EXPLICIT])
def test_explicit_energy_stays_bounded(method):
    """Beads squeezed between two walls, hundreds of swings: the error of a symplectic step does not grow."""
    chain = Chain([math.inf, 1.0, 2.0, 0.5, math.inf], [hooke(1.0), hertz(2.0), hooke(3.0), hertz(1.0)])
    state = State.at_start(chain, [0.0, 0.2, -0.1, 0.2, 0.0])
    state.overlap[:] = 1.0, 0.8, 0.6, 1.1  # deep: no contact ever opens
    moving, start = kinetic_energy(chain, state.velocity(chain)), total_energy(chain, state)
    errors = []
    for _ in range(200):
        advance(chain, state, 7.3, method, step=0.05)
        errors.append(abs(total_energy(chain, state) - start))
        assert state.overlap.min() > 0.0
    assert max(errors) < 0.25 * moving
    assert max(errors[100:]) < 1.5 * max(errors[:100]) + 1e-11 * start


@pytest.mark.parametrize("truth", ELASTIC + GEARS, ids=lambda truth: truth.name)
@pytest.mark.parametrize("step", [1e-3, 0.03, 0.5])
@pytest.mark.parametrize("method", [method.name for method in EXACT])
def test_exact_energy_at_any_step(method, truth, step):
    found = simulate(truth.chain, truth.start, 3 * truth.contact_time, method, step * truth.contact_time)
    energy = found.kinetic_energy + found.contact_energy
    assert np.abs(energy / energy[0] - 1.0).max() < 1e-11
    assert momentum(truth.chain, found.final_velocity) == pytest.approx(momentum(truth.chain, truth.start), rel=1e-13)


@pytest.mark.parametrize("method", NAMES)
def test_motion_is_the_same_for_a_moving_observer(method):
    chain, start = cluster_on_cluster(2, 3, hertz(1.0), [1.0, 2.0, 1.0, 0.5, 1.0]), np.array([1.0, 1.0, 0, 0, 0])
    options = {"method": method, "duration": 3.0, "samples": 7} | ({} if method in TOLERANT else {"step": 0.01})
    here = simulate(chain, start, **options)
    there = simulate(chain, start + 0.75, **options)
    assert there.velocity == pytest.approx(here.velocity + 0.75, abs=1e-7)
    assert there.overlap == pytest.approx(here.overlap, abs=1e-7)


@pytest.mark.parametrize("method", NAMES)
def test_a_mirrored_chain_moves_as_its_mirror(method):
    chain = Chain([1.0, 2.0, 0.5], [hertz(1.0), hooke(2.0)], [0.0, 0.1])
    mirror = Chain([0.5, 2.0, 1.0], [hooke(2.0), hertz(1.0)], [0.1, 0.0])
    one = simulate(chain, [1.0, 0.0, -0.5], 2.0, method, samples=9)
    other = simulate(mirror, [0.5, 0.0, -1.0], 2.0, method, samples=9)
    assert other.velocity == pytest.approx(-one.velocity[:, ::-1], abs=1e-9)


@pytest.mark.parametrize("method", NAMES)
def test_a_wall_keeps_its_velocity_and_returns_the_bead(method):
    for wall_speed in (0.0, -0.5):
        chain = Chain([2.0, math.inf], hertz(3.0), 0.25)
        found = simulate(chain, [1.0, wall_speed], method=method, samples=5)
        assert (found.velocity[:, 1] == wall_speed).all()
        assert found.position[:, 1] == pytest.approx(0.25 + wall_speed * found.time, abs=1e-12)
        assert found.final_velocity[0] == pytest.approx(2 * wall_speed - 1.0, abs=1e-4)
        assert found.kinetic_energy[0] == kinetic_energy(chain, [1.0, wall_speed])


@pytest.mark.parametrize("method", [method.name for method in LIVE])
@pytest.mark.parametrize("force", [2.0, -2.0])
def test_a_push_accelerates_the_whole_by_newton(method, force):
    chain = Chain([1.0, 3.0, 2.0], hooke(50.0))
    state = State.at_start(chain, [0.0, 0.0, 0.0])
    state.push = np.array([force, 0.0, 0.0])
    advance(chain, state, 1.5, method, step=1e-3)
    assert momentum(chain, state.velocity(chain)) == pytest.approx(force * 1.5, rel=1e-12)
