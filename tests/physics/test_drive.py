"""A steady force on beads, and contacts pressed from the start (a gap below 0): every method knows both, and ledgers close."""

import numpy as np
import pytest
from softcradle.physics import METHODS, Chain, State, advance, hertz, hooke, one_on, power_law, simulate
from softcradle.physics.adaptive.adaptive_loop import integrate
from softcradle.physics.fixed_step.step_loop import march
from softcradle.physics.scales import speed_scale

from softcradle import scenes
from tests.helpers.relations import fineness

PUSHED = Chain([1.0, 2.0, 1.0, 0.5], power_law(1.0, 0.2), drive=[1.0, 0.0, 0.0, 0.0])
REST = [0.0] * 4
SPRUNG = Chain([1.0, 3.0], hooke(4.0), gap=-0.5)  # energy 1/2, reduced mass 3/4


@pytest.fixture(scope="module")
def reference():
    return simulate(PUSHED, REST, 2.0, method="scipy", tolerance=1e-9)


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
def test_every_method_drives(method, reference):
    found = simulate(PUSHED, REST, 2.0, method=method.name, **fineness(method.name, 1e-4))
    np.testing.assert_allclose(found.final_velocity, reference.final_velocity, atol=2e-4)
    np.testing.assert_allclose(found.momentum, found.impulse, atol=1e-10)
    energy = found.kinetic_energy + found.contact_energy
    np.testing.assert_allclose(energy, found.work, atol=1e-3 * energy.max())


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
def test_advance_drives_and_adds_the_push(method):
    step = fineness(method.name, 1e-3)
    alone = State.at_start(PUSHED, REST)
    half = Chain(PUSHED.mass, PUSHED.contact, drive=[0.5, 0.0, 0.0, 0.0])
    split = State.at_start(half, REST)
    split.push = np.array([0.5, 0.0, 0.0, 0.0])
    advance(PUSHED, alone, 0.5, method=method.name, **step)
    advance(half, split, 0.5, method=method.name, **step)
    assert alone.velocity(PUSHED)[0] > 0.1
    # an adaptive method may choose other steps, and then agrees to its tolerance
    np.testing.assert_allclose(split.velocity(half), alone.velocity(PUSHED), rtol=1e-9, atol=1e-8 * method.adaptive)


def test_zero_drive_is_none():
    assert Chain(PUSHED.mass, PUSHED.contact, drive=[0.0] * 4).drive is None


def test_kernels_see_one_type_of_force_from_outside():
    """A read-only array is another type to them: all of a method would be compiled once more, in the middle of play."""
    chain = Chain([1.0, 1.0], power_law(1.0, 0.1), drive=[1.0, 0.0])
    state = State.at_start(chain, [0.0, 0.0])
    force, types = state.external(chain), []
    assert force.flags.writeable
    assert not np.shares_memory(force, chain.drive_force)
    for moved in (Chain(chain.mass, chain.contact), chain):
        for method in ("conserving", "radau"):
            advance(moved, state.copy(), 1e-3, method=method)
        types.append([len(getattr(kernel, "signatures", ())) for kernel in (march, integrate)])
    assert types[0] == types[1]


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
def test_a_pressed_spring_gives_its_energy_to_both_ends(method):
    found = simulate(SPRUNG, [0.0, 0.0], method=method.name, **fineness(method.name, 1e-4))
    relative = (2.0 * 0.5 / 0.75) ** 0.5
    np.testing.assert_allclose(found.final_velocity, [-0.75 * relative, 0.25 * relative], atol=2e-4)
    assert found.force[0, 0] == 2.0
    assert found.contact_energy[0] == pytest.approx(0.5)
    ((closed, opened),) = found.contact_intervals[0]
    assert (closed, opened) == (0.0, pytest.approx(0.5 * np.pi / np.sqrt(4.0 / 0.75), abs=3e-4))


@pytest.mark.parametrize("method", ["conserving", "radau", "accurate", "scipy"])
def test_a_pressed_row_at_rest_under_its_press_stays(method):
    contact = power_law(1.0, 0.1)
    gap = -float(contact.overlap(0.75))
    found = simulate(Chain([1.0] * 4, contact, gap, drive=[0.75, 0.0, 0.0, -0.75]), [0.0] * 4, 5.0, method)
    np.testing.assert_allclose(found.overlap, -gap, rtol=1e-9)
    np.testing.assert_allclose(found.velocity, 0.0, atol=1e-10)


def test_accurate_agrees_with_the_reference_on_a_row_let_go():
    chain = Chain([1.0, 2.0, 1.0, 0.5], [hertz(3.0), power_law(1.0, 0.5), hooke(2.0)], [-0.3, -0.1, 0.2])
    ours, reference = (simulate(chain, [0.0] * 4, 6.0, method, tolerance=1e-9) for method in ("accurate", "scipy"))
    np.testing.assert_allclose(ours.final_velocity, reference.final_velocity, atol=1e-8)
    assert np.ptp(ours.final_velocity) > 0.5


def test_speed_scale_knows_the_press():
    assert speed_scale(SPRUNG, [0.0, 0.0]) == pytest.approx((2.0 * 0.5 / 0.75) ** 0.5)
    assert speed_scale(one_on(2, hooke(1.0)), [0.0, 0.0, 0.0]) == 1.0


@pytest.mark.parametrize("name", ["stiff-springs", "prestressed"])
def test_the_contrast_scenes_begin_at_rest_under_their_press(name):
    chain = scenes.load(name).lanes[1].chain()
    found = simulate(chain, [0.0] * (chain.contacts + 1), 1.0, "conserving")
    assert found.overlap[0, 1:].min() > 0.0
    np.testing.assert_allclose(found.velocity, 0.0, atol=1e-9)
