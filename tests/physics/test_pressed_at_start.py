"""Contacts pressed from the start (a gap below 0): every method lets them go, or keeps them where they are at rest."""

import numpy as np
import pytest
from softcradle.physics import METHODS, Chain, hertz, hooke, one_on, power_law, simulate
from softcradle.physics.scales import speed_scale

from softcradle import scenes
from tests.helpers.relations import fineness

SPRUNG = Chain([1.0, 3.0], hooke(4.0), gap=-0.5)  # energy 1/2, reduced mass 3/4


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
