"""Beads that touch each other from one wall to another: a force through all of them moves nothing, and is not determined."""

import numpy as np
import pytest
from softcradle.physics import METHODS, Chain, Contact, hertz, simulate
from softcradle.physics.methods import Family
from softcradle.physics.status import Status

ADAPTIVE = [method.name for method in METHODS if method.family is Family.ADAPTIVE]


def box(beads: int, contact: object, **more: object) -> Chain:
    return Chain([np.inf, *np.linspace(1.0, 3.0, beads), np.inf], contact, **more)


@pytest.mark.parametrize("method", [*ADAPTIVE, "scipy"])
@pytest.mark.parametrize("beads", [1, 2, 5])
def test_a_box_at_rest_stays_at_rest(method, beads):
    found = simulate(box(beads, Contact(1.4, 3.0, 0.5)), np.zeros(beads + 2), 9.64, method=method, samples=5)
    assert found.status == Status.DONE
    assert not found.velocity.any()
    assert not found.overlap.any()
    assert (found.force >= 0.0).all()
    assert (found.force <= 1.4).all()
    assert np.ptp(found.force, axis=1) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("method", ADAPTIVE)
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


@pytest.mark.parametrize("method", ADAPTIVE)
@pytest.mark.parametrize("contact", [Contact(1.4, 3.0, 0.5), hertz(5.0)], ids=["preload", "hertz"])
def test_a_full_box_that_is_struck_from_inside_keeps_its_energy(method, contact):
    found = simulate(box(3, contact), [0.0, 1.0, 0.0, 0.0, 0.0], 5.0, method=method, samples=21, tolerance=1e-9)
    assert found.ledger == pytest.approx(np.full(21, found.ledger[0]), rel=1e-6)
