"""A steady external force on beads: every method knows it, its work and impulse balance, and bad ones are refused."""

import numpy as np
import pytest
from softcradle.physics import METHODS, Chain, State, advance, power_law, simulate
from softcradle.physics.adaptive.adaptive_loop import integrate
from softcradle.physics.fixed_step.step_loop import march

from tests.helpers.relations import fineness

PUSHED = Chain([1.0, 2.0, 1.0, 0.5], power_law(1.0, 0.2), drive=[1.0, 0.0, 0.0, 0.0])
REST = [0.0] * 4


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
    force = state.external(chain)
    assert force.flags.writeable
    assert not np.shares_memory(force, chain.drive_force)
    for method in ("conserving", "radau"):
        advance(Chain([1.0, 1.0], power_law(1.0, 0.1)), State.at_start(chain, [0.0, 0.0]), 1e-3, method=method)
    before = [_signatures(kernel) for kernel in (march, integrate)]
    for method in ("conserving", "radau"):
        advance(chain, State.at_start(chain, [0.0, 0.0]), 1e-3, method=method)
    assert [_signatures(kernel) for kernel in (march, integrate)] == before


def _signatures(kernel: object) -> int:
    """Types that `kernel` is compiled for; 0 where it runs as plain Python."""
    return len(getattr(kernel, "signatures", ()))
