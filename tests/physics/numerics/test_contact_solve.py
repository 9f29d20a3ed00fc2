"""Tests of parts of the contact force solver: the resolvents and mean forces of contacts and couplers, and the distance
to the next breakpoint.
"""

import numpy as np
import pytest
from softcradle.physics import Chain, Coupler, State, draft_gear, hertz, hooke
from softcradle.physics.fixed_step.discrete_gradient import WORK_ROWS
from softcradle.physics.numerics import contact_solve
from softcradle.physics.numerics.contact_solve import BEAD_ROWS, DIAGONAL, UNKNOWN, distance_to_bend
from softcradle.physics.numerics.graph_kernels import graph_fall, graph_force, graph_mean, graph_resolvent
from softcradle.physics.numerics.records import NO_GRAPHS, NOTHING, ChainData, Dissipation
from softcradle.physics.numerics.resolvent import mean_force, resolvent, touching

from tests.helpers.plain_kernels import only_plain, records_of

pytestmark = only_plain
SLACK = 0.1
COUPLERS = {
    "springs": Coupler(hooke(5.0), pull=hooke(3.0), slack=SLACK),
    "gears with loss": Coupler(draft_gear(5.0, 0.2, loss=0.4), pull=draft_gear(4.0, 0.1, loss=0.6), slack=SLACK),
    "a solid stop": Coupler(hertz(5.0, loss=0.3), pull=hertz(2.0, loss=0.5), slack=SLACK, travel=0.05, stop=200.0),
}
STARTS = (0.0, 0.03, 0.2, -0.04, -SLACK, -0.3)


def test_a_very_soft_contact_takes_any_push_without_a_guess():
    """Check the first guess of the overlap of a very soft contact. The overlap at which the contact alone balances the
    push is 1e350 m, a number that overflows in plain Python.
    """
    overlap, force, _ = resolvent(NO_GRAPHS, 0, 0.0, 1e-3, 0.02, 0.0, 0.0, 1e-4, 1.0, 0.0)
    assert overlap + 1e-4 * force == pytest.approx(1.0, rel=1e-15)
    assert force == pytest.approx(1e-3 * overlap**0.02 / 1.02, rel=1e-12)


def test_a_touching_contact_carries_pushes_but_no_pulls():
    assert touching(2.0, 0.5) == (0.0, 0.25, 0.5)
    assert touching(2.0, 3.0) == (0.0, 1.5, 0.5)
    assert touching(2.0, -0.5) == (-0.5, 0.0, 0.0)
    assert touching(2.0, 0.0) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("exponent", [0.1, 0.5, 1.0, 1.5, 3.0])
@pytest.mark.parametrize("part", [0.0, 1e-9, -1e-9, 1e-6, 1e-3, -0.1])
def test_the_mean_force_of_a_short_way_and_its_slope(part, exponent):
    """Compare the mean force with a series. Over a distance x d, the mean of the force K d**a is K d**a (1 + a x/2 + a
    (a-1) x²/6 + ...).
    """
    start, stiffness = 0.3, 2.0
    force = stiffness * start**exponent
    found, slope = mean_force(0.5, stiffness, exponent, start, start**exponent, start * (1.0 + part))
    mean = 1.0 + exponent * part * (0.5 + (exponent - 1.0) * part * (1.0 / 6.0 + (exponent - 2.0) * part / 24.0))
    bend = (exponent - 1.0) * part * (1.0 / 3.0 + (exponent - 2.0) * part / 8.0)
    assert found == pytest.approx(0.5 + force * mean, rel=1e-12 + abs(part) ** 4)
    assert slope == pytest.approx(force * exponent / start * (0.5 + bend), rel=1e-4 + 2.0 * abs(part) ** 3)


@pytest.mark.parametrize("up", [True, False])
@pytest.mark.parametrize("resting", [0.0, 3.0])
def test_the_distance_to_the_next_event_is_exact(up, resting):
    """Check the distance to the next event of a held contact. The contact yields outside the range of 2 N to 5 N. The
    beads are on friction beds of 1 and 4 m/s² and can slip earlier.
    """
    h, weight, s = 0.1, 0.02, resting * 0.02 + 0.05 * 0.6
    mass, bed, free = np.array([2.0, 0.5]), np.array([1.0, 4.0]), np.array([0.04, -0.1])
    beads, work = np.zeros((BEAD_ROWS, 2)), np.zeros((WORK_ROWS, 1))
    beads[contact_solve.FREE_VELOCITY] = free
    work[UNKNOWN], work[contact_solve.LEAST_AT_HOLD], work[contact_solve.FORCE_AT_HOLD] = s, 2.0, 5.0
    work[DIAGONAL] = 2.0 * weight / h**2
    law = np.array([[0.3, 1.0, 1.0]])
    chain = ChainData(law, 1.0 / mass, NOTHING, NOTHING, 0, dissipation=Dissipation(np.zeros(1), bed))
    found = distance_to_bend(h, 0, chain, 0.6, up, beads, work)
    by_contact = weight * (5.0 - resting if up else resting - 2.0)
    turn = 1.0 if up else -1.0  # A larger force brakes the left bead and accelerates the right bead.
    by_beads = weight * (h * bed + turn * free * [1.0, -1.0]) * mass / h
    assert found == pytest.approx(turn * max(min(by_contact, *by_beads), 0.0), rel=1e-8, abs=1e-15)


@pytest.fixture(params=COUPLERS.values(), ids=COUPLERS.keys())
def graph(request):
    chain = Chain([1.0, 1.0], request.param)
    return records_of(chain, State.at_start(chain, [0.0, 0.0]))[0].graph


@pytest.mark.parametrize("start", STARTS)
def test_the_mean_force_times_the_distance_is_the_work(graph, start):
    """Check the work of a coupler. While the coupler is pushed in, the pushing parts store all of the work. The pulling
    parts return the work reduced by their loss. While the coupler is pulled out, the roles are exchanged.
    """
    for moved in (0.01, 0.3, -0.02, -0.5):
        force, _ = graph_mean(graph, 0, start, moved, moved > 0.0)
        fall = graph_fall(graph, 0, start, start + moved, False) - graph_fall(graph, 0, start, start + moved, True)
        assert force * moved == pytest.approx(-fall, rel=1e-9, abs=1e-12)
    for side in (1.0, -1.0):
        force, slope = graph_mean(graph, 0, start, 0.0, side > 0.0)
        assert slope >= 0.0
        if start not in (0.0, -SLACK):  # At the overlap at which a preload begins, the force depends on the direction.
            assert force == pytest.approx(graph_force(graph, 0, start, 0.0, side > 0.0), rel=1e-12)


@pytest.mark.parametrize("start", STARTS)
def test_the_resolvent_solves_its_equation_whichever_way_it_goes(graph, start):
    draw = np.random.default_rng(5)
    for _ in range(200):
        weight, ahead = 10.0 ** draw.uniform(-3, 1), draw.choice([0.0, 0.2, -0.2]) * draw.random()
        s = draw.choice([-1.0, 1.0]) * 10.0 ** draw.uniform(-3, 1)
        ends = (graph_mean(graph, 0, start, ahead, up)[0] for up in (False, True))
        moved, force, slope = graph_resolvent(graph, 0, start, ahead, *ends, weight, s)
        assert moved + weight * force == pytest.approx(s, rel=1e-9, abs=1e-12)
        least, _ = graph_mean(graph, 0, start, moved, False)
        most, _ = graph_mean(graph, 0, start, moved, True)
        if moved not in (0.0, ahead):
            assert force == pytest.approx(most if moved > ahead else least, rel=1e-7, abs=1e-9)
        elif moved == ahead:
            assert least - 1e-9 <= force <= most + 1e-9
        assert 0.0 <= slope <= 1.0 / weight * (1.0 + 1e-12)
