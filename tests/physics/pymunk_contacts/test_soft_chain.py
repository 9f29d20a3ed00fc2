"""SoftChain in a user's own Space: energy and momentum at sixty steps a second, whatever the contacts."""

import itertools
import math

import numpy as np
import pymunk
import pytest
from softcradle.physics import Chain, Contact, draft_gear, hertz, hooke, power_law, simulate, step_force

from tests.helpers.spaces import FRAME, LAWS, chain_row, momentum, run, total_energy


@pytest.mark.parametrize("gap", [0.0, 0.3])
@pytest.mark.parametrize("law", [*LAWS, power_law(1.0, 1 / 14), hertz(1e6), hooke(1e9)], ids=str)
def test_a_collision_in_steps_of_a_frame_keeps_energy_and_momentum(law, gap):
    """After a flight the energy in the contacts is that of the bodies alone, at x = X + (step/2) V."""
    space, bodies, chain = chain_row(law, gap)
    largest = 0.0
    for _ in range(600):
        space.step(FRAME)
        assert total_energy(bodies, chain) == pytest.approx(0.5, rel=1e-10)
        assert momentum(bodies) == pytest.approx(1.0, abs=1e-12)
        places = [body.position.x + 0.5 * FRAME * body.velocity.x for body in bodies]
        stored = sum(law.energy(1.0 - (b - a)) for a, b in itertools.pairwise(places))
        assert stored == pytest.approx(chain.energy, abs=5e-11) or gap == 0.0
        largest = max(largest, chain.energy)
    assert bodies[4].velocity.x > 0.2
    assert largest > 0.0 or law.stiffness > 1e5, "energy went through the contacts"


@pytest.mark.parametrize("law", [power_law(1.0, 0.1), power_law(1.0, 1 / 30), hertz(20.0), step_force(1.0)], ids=str)
def test_moves_as_method_conserving(law):
    """The same equations from bodies as from overlaps, overlaps included that no position resolves."""
    step = 0.01
    read_out = 0.5 * step  # bodies are half a step behind their velocities
    space, bodies, chain = chain_row(law, gap=0.3 + read_out, beads=8, masses=[1.0] * 8)
    model = Chain([1.0] * 8, law, [0.3, 0, 0, 0, 0, 0, 0])
    expected = simulate(model, [1.0] + [0.0] * 7, 1.5, "conserving", step, samples=step * np.arange(1, 151))
    for row in range(150):
        space.step(step)
        np.testing.assert_allclose(chain.overlaps, expected.overlap[row], rtol=1e-6, atol=1e-13)
        np.testing.assert_allclose([body.velocity.x for body in bodies], expected.velocity[row], rtol=0, atol=1e-11)
    if law.exponent < 0.05:
        assert 0.0 < expected.overlap[60].min() < 1e-18
        np.testing.assert_allclose(chain.overlaps, expected.overlap[-1], rtol=1e-6)


@pytest.mark.parametrize("direction", [(0.6, 0.8), (0.0, -1.0)])
def test_a_row_in_any_direction(direction):
    straight = chain_row(hertz(1e3), gap=0.3)
    turned = chain_row(hertz(1e3), gap=0.3, direction=direction)
    for space, _, _ in (straight, turned):
        run(space, FRAME, 180)
    for body, other in zip(straight[1], turned[1], strict=True):
        assert other.velocity.dot(direction) == pytest.approx(body.velocity.x, abs=1e-9)
        assert other.velocity.cross(direction) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("law", [hooke(100.0), hertz(1e5), power_law(1.0, 0.1)], ids=str)
def test_a_bent_row(law):
    """Twenty degrees at every body: forces couple by the cosine; lines that turn cost second-order in the step."""
    lost = []
    for parts in (1, 10):
        space, bodies, chain = chain_row(law, beads=6, masses=[1.0] * 6)
        for i in range(5):
            bodies[i + 1].position = bodies[i].position + pymunk.Vec2d(1.0, 0.0).rotated(0.35 * (i + 1))
        start = bodies[0].velocity = pymunk.Vec2d(1.0, 0.0).rotated(0.35)
        run(space, FRAME / parts, 240 * parts)
        total = sum((body.velocity for body in bodies), pymunk.Vec2d(0.0, 0.0))
        assert total == pytest.approx(start, abs=1e-12)
        assert bodies[5].velocity.length > 0.1
        lost.append(abs(1.0 - total_energy(bodies, chain) / 0.5))
    assert lost[0] < 1e-3
    assert lost[1] < 0.05 * lost[0]


def test_a_wall_that_moves():
    """A kinematic body drives the row: bodies leave an elastic wall of speed u at 2 u."""
    space, bodies, chain = chain_row(hertz(1e5), beads=2, masses=[math.inf, 1.0], gap=0.5)
    run(space, FRAME, 120)
    assert bodies[0].velocity.x == 1.0
    assert bodies[1].velocity.x == pytest.approx(2.0, rel=1e-9)
    assert chain.energy == 0.0


@pytest.mark.parametrize("law", [hertz(1e6), power_law(200.0, 0.1), draft_gear(1e4, 0.02)], ids=str)
def test_a_column_bounces_without_loss_under_gravity(law):
    space, bodies, chain = chain_row(law, gap=0.5, beads=4, direction=(0, 1), masses=[math.inf, 1, 1, 1], speed=0)
    space.gravity = 0.0, -10.0
    energy = 10.0 * (1.5 + 2.5 + 3.5)
    heights = []
    for _ in range(600):
        space.step(FRAME)
        found = total_energy(bodies[1:], chain) + 10.0 * sum(place.y for place in chain.positions[1:])
        assert found == pytest.approx(energy, abs=0.5 * 3 * 10.0 * 10.0 * FRAME**2 / 4)
        heights.append(found)
    assert np.ptp(heights) < 1e-9, "after the first half step it stays"


@pytest.mark.parametrize("step", [1 / 480, 1 / 120, 1 / 30])
@pytest.mark.parametrize("loss", [0.3, 0.75])
def test_a_column_that_loses_comes_to_rest(loss, step):
    """Bounces shorter than a step would else turn round with each step, for ever."""
    law = Contact(200.0, 1e4, 1.0, loss)
    space, bodies, chain = chain_row(law, beads=4, direction=(0, 1), masses=[math.inf, 1, 1.3, 1.6], speed=0)
    space.gravity, bodies[3].velocity = (0.0, -10.0), (0.0, -1.0)
    run(space, step, round(8.0 / step))
    assert np.abs([body.velocity.y for body in bodies]).max() < 1e-6
    assert chain.forces == pytest.approx([39.0, 29.0, 16.0], rel=1e-6)
    assert [body.position.y for body in bodies] == pytest.approx(range(4), abs=2e-3)


@pytest.mark.parametrize("step", [1 / 480, 1 / 120, 1 / 30])
def test_a_collision_shorter_than_a_step_has_its_restitution(step):
    space, bodies, chain = chain_row(Contact(1e4, 1e3, 1.0, loss=0.75), beads=2, masses=[1, 1])
    run(space, step, 10)
    assert [body.velocity.x for body in bodies] == pytest.approx([0.25, 0.75], abs=1e-9)
    assert chain.absorbed == pytest.approx(0.5 * 0.75 * 0.5, abs=1e-9)


def test_a_column_rests_on_its_preload():
    space, bodies, chain = chain_row(
        draft_gear(1e4, 0.02), beads=5, direction=(0, 1), masses=[math.inf] + [1.0] * 4, speed=0
    )
    space.gravity = 0.0, -10.0
    run(space, FRAME, 600)
    np.testing.assert_allclose([body.position.y for body in bodies], range(5), atol=1e-12)
    np.testing.assert_allclose(chain.forces, [40.0, 30.0, 20.0, 10.0], rtol=1e-9)
