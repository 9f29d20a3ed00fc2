"""Ranges of a chain that move apart from each other are stepped apart; inactive contacts between them are not stepped."""

from __future__ import annotations

import numpy as np
import pytest
from softcradle.physics import Chain, hertz, one_on, simulate
from softcradle.physics.adaptive.active_ranges import next_range
from softcradle.physics.adaptive.constants import MARGIN
from softcradle.physics.adaptive.event_location import closes_inactive
from softcradle.physics.numerics.records import LOADED, OPEN, ChainData, Motion

N = 60
NOTHING = np.zeros(0)
ROUND_OFF = 2.3e-16


def _chain(law, external=NOTHING):
    law = np.array(law)
    return ChainData(law, np.ones(len(law) + 1), external, external, 0)


def _active(motion, inactive=1e-9, external=NOTHING):
    chain, found, last = _chain([[0.0, 1.0, 1.5]] * N, external), [], 0
    while last < N:
        first, last = next_range(last, 0.1, inactive, chain, motion)
        if first < N:
            found.append((first, last))
    return found


def _pushing(*contacts):
    mode, overlap, force = np.full(N, OPEN, dtype=np.int8), np.full(N, -1.0), np.zeros(N)
    for i in contacts:
        mode[i], overlap[i], force[i] = LOADED, 0.01, 0.001
    return Motion(overlap, np.zeros(N), np.zeros(2), force, np.zeros(4), mode, np.zeros(N, dtype=np.int8))


def test_contacts_that_push_far_apart_have_ranges_of_their_own():
    assert _active(_pushing(10, 12, 40)) == [(10 - MARGIN, 13 + MARGIN), (40 - MARGIN, 41 + MARGIN)]


def test_near_ones_share_a_range_and_margins_never_overlap():
    assert _active(_pushing(2, 2 + 2 * MARGIN)) == [(0, 3 + 3 * MARGIN)]
    (_, end), (begin, _) = _active(_pushing(2, 4 + 2 * MARGIN))
    assert end <= begin


def test_inactive_contacts_are_left_out_unless_something_pushes_from_outside():
    motion = _pushing(30)
    assert _active(motion, inactive=0.1) == []
    motion.rate[30] = 0.2
    assert _active(motion, inactive=0.1) == [(30 - MARGIN, 31 + MARGIN)]
    assert _active(_pushing(), external=np.zeros(N + 1)) == [(0, N)]


@pytest.mark.parametrize(
    ("preload", "exponent", "rate", "overlap", "passed_over"),
    [
        (0.0, 1.5, 1e-7, 1e-7, True),
        (0.0, 1.5, 1e-5, 1e-7, False),  # too fast
        (0.0, 1.5, 1e-7, 1e-3, False),  # too deep
        (0.0, 0.1, 1e-7, 1e-7, False),  # a soft contact holds more energy at the same depth
        (1.0, 1.5, 1e-7, 1e-13, False),  # gears come to rest by an event
        (0.0, 1.5, 1e-7, 0.0, False),  # and back again
    ],
)
def test_only_closings_of_no_consequence_are_passed_over(preload, exponent, rate, overlap, passed_over):
    chain = _chain([[preload, 1.0, exponent]])
    assert closes_inactive(chain, 0, 1e-6, rate, rate, overlap) is passed_over


@pytest.mark.parametrize("tolerance", [1e-4, 1e-7, 1e-10])
def test_two_impacts_on_one_chain_do_what_each_does_alone(tolerance):
    """Struck at both ends, before the waves meet: the left half is that of a chain struck once, the right its mirror."""
    both = simulate(
        Chain(np.ones(41), [hertz(1.0)] * 40),
        np.r_[1.0, np.zeros(39), -1.0],
        15.0,
        method="accurate",
        tolerance=tolerance,
    )
    alone = simulate(one_on(40, hertz(1.0)), np.r_[1.0, np.zeros(40)], 15.0, method="accurate", tolerance=tolerance)
    end = both.final_velocity
    np.testing.assert_allclose(end, -end[::-1], atol=2.0 * tolerance)
    np.testing.assert_allclose(end[:18], alone.final_velocity[:18], atol=2.0 * tolerance)
    assert abs(end.sum()) <= 1e-12


@pytest.mark.parametrize("method", ["accurate", "dop853"])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-8, 1e-10])
@pytest.mark.parametrize("n", [50, 150])
def test_a_wave_that_has_left_is_over(n, tolerance, method):
    """Behind it contacts are left that move less than the tolerance can tell; for them a run once went on to 1e20 s."""
    found = simulate(one_on(n, hertz(1.0)), np.eye(1, n + 1)[0], method=method, tolerance=tolerance, samples=2)
    assert not found.warnings
    assert n < found.time[-1] < 1.5 * n
    assert (np.diff(found.final_velocity) > -tolerance).all()
    assert abs((found.final_velocity**2).sum() - 1.0) < 10.0 * tolerance
    assert abs(found.final_velocity.sum() - 1.0) < ROUND_OFF * n * n  # each velocity is a sum of up to n rates


def test_an_inactive_contact_is_active_in_a_step_that_would_press_it():
    motion = _pushing(30)
    motion.overlap[30], motion.force[30], motion.rate[30] = 1e-12, 0.0, 1e-10
    chain = _chain([[0.0, 1.0, 1.5]] * N)
    for h, found in ((1.0, N), (1e12, 30 - MARGIN)):
        first, _ = next_range(0, h, 1e-9, chain, motion)
        assert first == found


@pytest.mark.parametrize(("n", "unequal", "tolerance"), [(60, 1e-2, 1e-6), (80, 1e-6, 1e-6), (120, 1e-9, 1e-8)])
def test_what_a_wave_leaves_behind_collides_for_long(n, unequal, tolerance):
    """Beads that part at 1e-8 m/s meet again after 1e6 s; those that come slower than the tolerance tells did not stop at
    each other, and pressed far in: energy grew to 250 times what there was."""
    contacts = [hertz(1.0 + unequal * (-1.0) ** i) for i in range(n)]
    found = simulate(one_on(n, contacts), np.eye(1, n + 1)[0], tolerance=tolerance, samples=2)
    assert not found.warnings
    assert abs((found.final_velocity**2).sum() - 1.0) < 10.0 * tolerance
    assert abs(found.final_velocity.sum() - 1.0) < ROUND_OFF * n * n  # each velocity is a sum of up to n rates
    assert (np.diff(found.final_velocity) > -10.0 * tolerance).all()
