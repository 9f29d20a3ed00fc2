"""Tests of the positions of beads on a friction bed. If a step continues past the opening of a contact, the contact
must not move its beads.
"""

import numpy as np
import pytest
from softcradle.physics import Chain, TimedForce, power_law, simulate
from softcradle.physics.chain import GRAVITY

# The two beads overlap by 32.4 mm, which gives a force of 2.2e-4 N. Friction holds the first bead with up to 7.1 N. The
# second bead slides away.
MASS, LAW, GAP, FRICTION, SPEED = [0.27, 0.67], power_law(6.57, 3.0), -0.0324, 2.7, 1.363


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("method", ["accurate", "radau"])
def test_a_bead_that_the_bed_holds_stays_where_it_is(method, tolerance):
    found = simulate(Chain(MASS, LAW, GAP, friction=FRICTION), [0.0, SPEED], 1.0, method, tolerance=tolerance)
    way = SPEED**2 / (2.0 * FRICTION * GRAVITY)  # The contact force increases this distance by only 2e-7 m.
    assert found.position[:, 0] == pytest.approx(0.0, abs=1e-14)
    assert found.position[-1, 1] == pytest.approx(GAP + way, abs=3e-7)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
def test_a_later_push_finds_the_beads_where_they_stopped(tolerance):
    """Push the first bead across the gap of 2.7 mm. The expected velocity and positions were computed with the method
    `scipy`.
    """
    push = TimedForce(0, [0.5, 0.7, 0.7], [9.0, 9.0, 0.0])
    chain = Chain(MASS, LAW, GAP, friction=FRICTION, forces=push)
    found = simulate(chain, [0.0, SPEED], 0.6, tolerance=tolerance)
    assert found.final_velocity == pytest.approx([0.68552788, 0.0], abs=20.0 * tolerance + 1e-8)
    assert found.position[-1] == pytest.approx([0.03427678, 0.00268153], abs=10.0 * tolerance + 1e-8)


# Each entry contains exponent, stiffness, masses, friction, gap and speed. The final positions and contact times were
# computed with the method `scipy`.
STRUCK = [
    (3.0, 1.99, [2.81, 2.06], 0.0459, 0.0246, 1.569, (1.38526517, 1.79166218), (0.0157141976, 2.7452448374)),
    (2.0, 1.723, [2.54, 2.62], 0.0499, 0.0205, 1.886, (1.42138992, 1.69662293), (0.0108849362, 2.9973055680)),
    (2.0, 2.67, [0.618, 0.3627], 0.1102, 0.0556, 1.674, (0.78944395, 0.90736059), (0.0335777917, 1.5579591707)),
]


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize(("exponent", "stiffness", "mass", "friction", "gap", "speed", "position", "times"), STRUCK)
def test_beads_that_part_before_they_stop_stay_apart(
    exponent, stiffness, mass, friction, gap, speed, position, times, tolerance
):
    chain = Chain(mass, power_law(stiffness, exponent), gap, friction=friction)
    found = simulate(chain, [speed, 0.0], 5.0, tolerance=tolerance)
    assert found.position[-1] == pytest.approx(position, abs=tolerance * speed + 1e-8)
    assert found.contact_intervals[0][0] == pytest.approx(times, abs=tolerance * speed + 1e-9)
    assert (np.abs(found.position[-1] - position) <= found.position_error[-1] + 1e-8).all()


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_the_estimated_error_of_positions_remains_when_the_beads_stop(tolerance):
    """Check the estimated errors after the beads have stopped. The velocities are then exact. The errors of the
    positions remain, because earlier velocities had errors.
    """
    found = simulate(Chain(MASS, LAW, GAP, friction=FRICTION), [0.0, SPEED], 1.0, tolerance=tolerance)
    exact = simulate(Chain(MASS, LAW, GAP, friction=FRICTION), [0.0, SPEED], 1.0, tolerance=1e-12)
    # The beads separate, so only the stored energy determines their closing speed.
    assert 0.0 < found.speed_scale < SPEED
    assert found.position_error == pytest.approx(tolerance * found.speed_scale * found.time, rel=1e-2)
    assert np.abs(found.position - exact.position).max() <= found.position_error[-1]
