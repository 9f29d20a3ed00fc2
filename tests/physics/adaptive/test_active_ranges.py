"""Ranges of a chain that are stepped apart, and beads that touch each other from one wall to another.

A force through all beads between two walls moves nothing, and is not determined.
"""

import numpy as np
import pytest
from softcradle.physics import Chain, Contact, hertz, one_on, simulate
from softcradle.physics.status import Status

from tests.helpers.relations import EPSILON, KERNELS, struck


@pytest.mark.parametrize("tolerance", [1e-4, 1e-7, 1e-10])
def test_two_impacts_on_one_chain_do_what_each_does_alone(tolerance):
    """Struck at both ends, before the waves meet: the left half is that of a chain struck once, the right its mirror."""
    chain, options = one_on(40, hertz(1.0)), {"method": "accurate", "tolerance": tolerance}
    both = simulate(chain, np.r_[1.0, np.zeros(39), -1.0], 15.0, **options)
    alone = simulate(chain, np.r_[1.0, np.zeros(40)], 15.0, **options)
    end = both.final_velocity
    np.testing.assert_allclose(end, -end[::-1], atol=2.0 * tolerance)
    np.testing.assert_allclose(end[:18], alone.final_velocity[:18], atol=2.0 * tolerance)
    assert abs(end.sum()) <= 1e-12


WAVES = [(n, 0.0, 10.0**-k, method) for method in ("accurate", "dop853") for k in (3, 5, 8, 10) for n in (50, 150)]
COLLIDE_FOR_LONG = [(60, 1e-2, 1e-6, "accurate"), (80, 1e-6, 1e-6, "accurate"), (120, 1e-9, 1e-8, "accurate")]


@pytest.mark.parametrize(("n", "unequal", "tolerance", "method"), WAVES + COLLIDE_FOR_LONG)
def test_a_wave_through_a_row_keeps_energy_momentum_and_the_order_of_its_beads(n, unequal, tolerance, method):
    """Contacts behind it move less than the tolerance can tell: a run once went on for them to 1e20 s. Of unequal ones beads that
    part at 1e-8 m/s meet again after 1e6 s, and pressed far in: energy grew to 250 times what there was."""
    chain = one_on(n, [hertz(1.0 + unequal * (-1.0) ** i) for i in range(n)])
    found = simulate(chain, struck(chain), method=method, tolerance=tolerance, samples=2)
    assert not found.warnings
    assert unequal or n < found.time[-1] < 1.5 * n
    assert abs((found.final_velocity**2).sum() - 1.0) < 10.0 * tolerance
    assert abs(found.final_velocity.sum() - 1.0) < EPSILON * n * n  # each velocity is a sum of up to n rates
    assert (np.diff(found.final_velocity) > -(10.0 if unequal else 1.0) * tolerance).all()


def box(beads: int, contact: object, **more: object) -> Chain:
    return Chain([np.inf, *np.linspace(1.0, 3.0, beads), np.inf], contact, **more)


@pytest.mark.parametrize("method", [*KERNELS, "scipy"])
@pytest.mark.parametrize("beads", [1, 2, 5])
def test_a_box_at_rest_stays_at_rest(method, beads):
    found = simulate(box(beads, Contact(1.4, 3.0, 0.5)), np.zeros(beads + 2), 9.64, method=method, samples=5)
    assert found.status == Status.DONE
    assert not found.velocity.any()
    assert not found.overlap.any()
    assert (found.force >= 0.0).all()
    assert (found.force <= 1.4).all()
    assert np.ptp(found.force, axis=1) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("method", KERNELS)
@pytest.mark.parametrize("seed", range(8))
def test_a_box_that_is_driven_ends_as_by_conserving(method, seed):
    """Drives that the preload bears, and larger ones, by which contacts yield."""
    draw = np.random.default_rng(seed)
    beads, size = int(draw.integers(1, 6)), 10.0 ** draw.uniform(-1.0, 1.0)
    drive = [0.0, *(size * draw.uniform(-1.0, 1.0, beads)), 0.0]
    chain = box(beads, Contact(1.4, 3.0, float(draw.uniform(0.5, 1.5))), drive=drive)
    found = simulate(chain, np.zeros(beads + 2), 2.0, method=method, samples=5, tolerance=1e-9)
    fine = simulate(chain, np.zeros(beads + 2), 2.0, method="conserving", step=2e-4, samples=5)
    assert found.velocity == pytest.approx(fine.velocity, abs=1e-5 * size)
    assert found.overlap == pytest.approx(fine.overlap, abs=1e-5 * size)
    assert np.isfinite(found.force).all()


@pytest.mark.parametrize("method", KERNELS)
@pytest.mark.parametrize("contact", [Contact(1.4, 3.0, 0.5), hertz(5.0)], ids=["preload", "hertz"])
def test_a_full_box_that_is_struck_from_inside_keeps_its_energy(method, contact):
    found = simulate(box(3, contact), [0.0, 1.0, 0.0, 0.0, 0.0], 5.0, method=method, samples=21, tolerance=1e-9)
    assert found.ledger == pytest.approx(np.full(21, found.ledger[0]), rel=1e-6)
