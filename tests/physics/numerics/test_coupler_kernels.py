"""Couplers one by one inside kernels: forces, their means and energies, the resolvent."""

import numpy as np
import pytest
from softcradle.physics import Chain, Coupler, State, draft_gear, hertz, hooke
from softcradle.physics.numerics.coupler_kernels import joint_fall, joint_force, joint_mean_force, joint_resolvent

from tests.helpers.plain_kernels import only_plain, records_of

pytestmark = only_plain
SLACK = 0.1
COUPLERS = {
    "springs": Coupler(hooke(5.0), pull=hooke(3.0), slack=SLACK),
    "gears with loss": Coupler(draft_gear(5.0, 0.2, loss=0.4), pull=draft_gear(4.0, 0.1, loss=0.6), slack=SLACK),
    "a solid stop": Coupler(hertz(5.0, loss=0.3), pull=hertz(2.0, loss=0.5), slack=SLACK, travel=0.05, stop=200.0),
}
STARTS = (0.0, 0.03, 0.2, -0.04, -SLACK, -0.3)


@pytest.fixture(params=COUPLERS.values(), ids=COUPLERS.keys())
def joints(request):
    chain = Chain([1.0, 1.0], request.param)
    return records_of(chain, State.at_start(chain, [0.0, 0.0]))[0].joints


@pytest.mark.parametrize("start", STARTS)
def test_the_mean_force_is_what_the_energy_rises_by_and_of_no_way_the_force(joints, start):
    """On the way in pushing parts store all of it, pulling ones give back what their loss leaves; outward the other way."""
    for moved in (0.01, 0.3, -0.02, -0.5):
        force, _ = joint_mean_force(joints, 0, start, moved, moved > 0.0)
        fall = joint_fall(joints, 0, start, start + moved, False) - joint_fall(joints, 0, start, start + moved, True)
        assert force * moved == pytest.approx(-fall, rel=1e-9, abs=1e-12)
    for side in (1.0, -1.0):
        force, slope = joint_mean_force(joints, 0, start, 0.0, side > 0.0)
        assert slope >= 0.0
        if start not in (0.0, -SLACK):  # where a preload begins the force depends on the side
            assert force == pytest.approx(joint_force(joints, 0, start, side), rel=1e-12)


@pytest.mark.parametrize("start", STARTS)
def test_the_resolvent_solves_its_equation_whichever_way_it_goes(joints, start):
    draw = np.random.default_rng(5)
    for _ in range(200):
        weight, ahead = 10.0 ** draw.uniform(-3, 1), draw.choice([0.0, 0.2, -0.2]) * draw.random()
        s = draw.choice([-1.0, 1.0]) * 10.0 ** draw.uniform(-3, 1)
        moved, force, slope = joint_resolvent(joints, 0, start, ahead, weight, s)
        assert moved + weight * force == pytest.approx(s, rel=1e-9, abs=1e-12)
        least, _ = joint_mean_force(joints, 0, start, moved, False)
        most, _ = joint_mean_force(joints, 0, start, moved, True)
        if moved not in (0.0, ahead):
            assert force == pytest.approx(most if moved > ahead else least, rel=1e-7, abs=1e-9)
        elif moved == ahead:
            assert least - 1e-9 <= force <= most + 1e-9
        assert 0.0 <= slope <= 1.0 / weight * (1.0 + 1e-12)
