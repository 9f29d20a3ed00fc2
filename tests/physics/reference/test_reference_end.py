"""The reference in extended precision: quadruple-precision truths, closed forms of every kind of switch, its own error."""

import math

import numpy as np
import pytest
from softcradle.physics import (
    Chain,
    Contact,
    draft_gear,
    hertz,
    hooke,
    one_on,
    power_law,
    simulate,
    step_force,
)
from softcradle.physics.chain import GRAVITY
from softcradle.physics.reference.extended_precision import ReferenceGaveUpError
from softcradle.physics.reference.reference_end import reference_end

from tests.helpers.truth import ELASTIC, GEARS

pytestmark = pytest.mark.slow  # extended precision takes seconds

INFINITE = math.inf
LOSSY = {
    "Hertz": hertz(3.0, 0.3),
    "gear": draft_gear(3.0, 0.1, 0.3),
    "soft": power_law(1.0, 0.05, 0.3),
    "step": step_force(2.0, 0.3),
    "preload and root": Contact(0.5, 2.0, 0.5, 0.3),
}


@pytest.mark.parametrize("truth", ELASTIC + GEARS, ids=lambda truth: truth.name)
def test_truths_in_quadruple_precision(truth):
    found = reference_end(truth.chain, truth.start, tolerance=1e-12)
    error = float(np.abs(found.velocity - truth.final).max())
    assert error < 1e-12 * float(np.ptp(truth.start))
    assert error < found.error + 1e-16


def test_finer_is_nearer():
    truth = next(truth for truth in ELASTIC if truth.name == "one on 4, alpha 1/10")
    errors = [
        np.abs(reference_end(truth.chain, truth.start, tolerance=t).velocity - truth.final).max() for t in (1e-8, 1e-13)
    ]
    assert errors[1] < errors[0] < 1e-7
    assert errors[1] < 1e-14


@pytest.mark.parametrize("law", LOSSY)
def test_loss_takes_its_part_of_the_energy(law):
    """Restitution sqrt(1 - loss), whatever the law and the masses."""
    restitution = math.sqrt(0.7)
    found = reference_end(Chain([1.0, 2.0], LOSSY[law]), [1.0, 0.0], tolerance=1e-12)
    assert found.velocity == pytest.approx([1 / 3 - restitution * 2 / 3, (1 + restitution) / 3], abs=2e-12)


def test_friction_brings_a_bead_to_rest():
    chain = Chain([1.0, 2.0], hertz(3.0), gap=100.0, friction=0.3)
    assert reference_end(chain, [1.0, 0.0], 0.1).velocity == pytest.approx([1.0 - 0.03 * GRAVITY, 0.0], abs=1e-13)
    found = reference_end(chain, [1.0, 0.0])
    assert found.velocity.tolist() == [0.0, 0.0]
    assert found.time == pytest.approx(1.0 / (0.3 * GRAVITY), rel=1e-12)


def test_a_bead_slides_after_it_stuck():
    """The bed holds a bead until a gear, pressed slowly by the next bead, pushes with more than friction."""
    chain = Chain([1.0, 1.0], hooke(10.0), drive=[1.2 * 0.2 * GRAVITY, 0.0], friction=0.2)
    still = reference_end(Chain([1.0, 1.0], hooke(10.0), drive=[0.99 * 0.2 * GRAVITY, 0.0], friction=0.2), [0, 0], 3.0)
    assert still.velocity.tolist() == [0.0, 0.0]
    found = reference_end(chain, [0.0, 0.0], 3.0)
    # one bead swings about its balance under the spring alone, from rest to rest: it never pushes with 2 * 0.2 mu g
    frequency, force = math.sqrt(10.0), 0.2 * 0.2 * GRAVITY
    assert found.velocity[1] == 0.0
    turn = math.pi / frequency
    assert turn < 3.0
    assert reference_end(chain, [0.0, 0.0], turn / 2).velocity[0] == pytest.approx(force / frequency, abs=1e-12)
    assert found.velocity[0] == 0.0  # friction holds it where it turns


def test_steady_forces_bring_a_bead_back_to_a_wall():
    """It flies up, touches the ceiling for milliseconds and falls: energy and the swing in the spring give its end."""
    gravity, stiffness = 9.8, 1e6
    chain = Chain([1.0, INFINITE], hooke(stiffness), gap=4.9, drive=[-gravity, 0.0])
    found = reference_end(chain, [10.0, 0.0], 5.0)
    speed, frequency = math.sqrt(10.0**2 - 2 * gravity * 4.9), math.sqrt(stiffness)
    contact_time = 2 * math.atan(speed * frequency / gravity) / frequency
    fall = 5.0 - (10.0 - speed) / gravity - contact_time
    assert found.velocity[0] == pytest.approx(-speed - gravity * fall, abs=1e-11)


@pytest.mark.slow
def test_a_contact_that_never_closes_changes_nothing():
    ends = [
        reference_end(
            Chain([100.0, 0.01, 1.0, 1.0], [hooke(1e4), hooke(1e4), hooke(k)], [0.05, 0.05, 50.0], friction=0.3),
            [2.0, 2.0, 0.0, 0.0], 0.03, 1e-9,
        ).velocity
        for k in (1e4, 1e-4)
    ]  # fmt: skip
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)


def test_touching_contacts_are_pulled_apart():
    found = reference_end(Chain([1.0, 1.0], hooke(1.0), drive=[-1.0, 0.0]), [0.0, 0.0], 1.0)
    assert found.velocity == pytest.approx([-1.0, 0.0], abs=1e-15)


def test_forces_that_nothing_determines_do_not_stop_it():
    between_walls = Chain([INFINITE, 1.0, INFINITE], draft_gear(1.0, 1.0))
    assert reference_end(between_walls, [0, 0, 0], 1.0).velocity.tolist() == [0.0, 0.0, 0.0]
    cluster = Chain([1.0] * 5, draft_gear(100.0, 0.5), friction=0.5)
    found = reference_end(cluster, [0.3, 0, 0, 0, 0], tolerance=1e-10)
    assert np.abs(found.velocity).max() < 1e-11


@pytest.mark.slow
def test_soft_clusters_to_an_exponent_of_a_fiftieth():
    found = reference_end(one_on(3, power_law(1.0, 0.02)), [1, 0, 0, 0], tolerance=1e-9)
    assert found.error < 1e-7
    assert found.velocity @ found.velocity == pytest.approx(1.0, abs=1e-8)
    assert found.velocity.sum() == pytest.approx(1.0, abs=1e-11)


def test_it_says_that_it_gives_up():
    with pytest.raises(ReferenceGaveUpError, match="after 30 steps"):
        reference_end(one_on(2, hertz(1.0)), [1, 0, 0], most_steps=30)


def test_method_scipy_takes_friction_and_loss_by_it():
    """Its samples obey the ledger of energy, and its contacts close and open."""
    chain = Chain([1.0, 2.0, 1.0], [hertz(100.0, 0.3), draft_gear(50.0, 0.01, 0.5)], [0.1, 0.0], friction=0.1)
    found = simulate(chain, [1.0, 0.0, 0.0], method="scipy", samples=41)
    assert found.ledger == pytest.approx(np.full(41, found.ledger[0]), rel=1e-9)
    assert not found.velocity[-1].any()
    assert found.absorbed_by_contacts[-1] > 0.0
    assert len(found.contact_intervals[0]) >= 1
    fine = reference_end(chain, [1.0, 0.0, 0.0], found.time[20], 1e-12).velocity
    assert found.velocity[20] == pytest.approx(fine, abs=1e-8)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("friction", [0.01, 0.1, 1.0])
def test_soft_contacts_on_a_bed(friction, tolerance):
    """Contacts between beads that stick carried what round-off pressed them in by, to the power of a tenth."""
    chain = Chain([1.0] * 5, power_law(1.0, 0.1), friction=friction)
    found = reference_end(chain, [1, 0, 0, 0, 0], 0.3, tolerance)
    ours = simulate(chain, [1, 0, 0, 0, 0], 0.3, tolerance=1e-10, samples=2)
    assert found.error < 30.0 * tolerance
    assert ours.final_velocity == pytest.approx(found.velocity, abs=30.0 * tolerance + 1e-8)
