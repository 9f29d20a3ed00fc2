"""Tests of the curve of a contact law in implicit steps. The tests check values, slopes, and the moves of Newton's
method along the curve.
"""

import math
from itertools import product

import numpy as np
import pytest
from softcradle.physics import Chain, Contact, Coupler, OwnLaw, State, hooke
from softcradle.physics.adaptive.corner_search import halves, stage_cubic
from softcradle.physics.kernel_records import graphs_of
from softcradle.physics.numerics import law_curve
from softcradle.physics.numerics.law_curve import NODES, SMALLEST, care, flow_into, slope_at
from softcradle.physics.numerics.records import FROM, NO_GRAPHS

from tests.helpers.plain_kernels import only_plain, row_matrix, signed_force

pytestmark = only_plain
LAWS = list(product((0.0, 0.3, 2.0), (1.0, 40.0), (1 / 30, 0.1, 0.5, 1.0, 1.5, 2.0, 3.0)))


def move_along(preload, stiffness, exponent, *moves):
    """Return the overlap and the force after a move along the curve of a power law."""
    return law_curve.move_along(np.array([[preload, stiffness, exponent]]), NO_GRAPHS, 0, *moves)


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_the_curve_its_continuation_and_its_slope(law):
    preload, stiffness, exponent = law
    continued = preload > 0.0 or exponent == 1.0
    for overlap in (1e-9, 0.2, 1.0, 3.0):
        force = preload + stiffness * overlap**exponent
        assert signed_force(*law, overlap) == pytest.approx(force, rel=1e-15)
        assert signed_force(*law, -overlap) == pytest.approx(2.0 * preload - force if continued else 0.0, rel=1e-14)
    assert signed_force(*law, 0.0) == preload
    for overlap in (-3.0, -0.2, 0.2, 1.0, 3.0):
        nudge = 1e-6 * abs(overlap)
        rise = signed_force(*law, overlap + nudge) - signed_force(*law, overlap - nudge)
        found = slope_at(*law, overlap, signed_force(*law, overlap))
        assert found == pytest.approx(rise / (2.0 * nudge), rel=1e-6, abs=1e-12)
    for overlap in (1e-6, 1e-12, 1e-33, 1e-200):  # At these overlaps the force equals the preload up to round-off.
        slope = exponent * stiffness * overlap ** (exponent - 1.0)
        assert slope_at(*law, overlap, signed_force(*law, overlap)) == pytest.approx(slope, rel=1e-8)
    at_zero = stiffness if exponent == 1.0 else math.inf if exponent < 1.0 else 0.0
    assert slope_at(*law, 0.0, preload) == slope_at(*law, 0.5 * SMALLEST, preload) == at_zero


def test_the_weight_of_an_error():
    assert care(1.0, 5.0, 9.0) == care(1.5, 5.0, 9.0) == 1.0
    assert care(0.5, 0.25, 9.0) == 1.0 + 0.25 * 3.0
    assert care(0.1, 7.0, 9.0) == 1.0 + 3.0
    assert care(0.1, 1.0, 1e30) == 1.0 + law_curve.MOST_CARE


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_newton_reaches_the_one_point_whatever_it_begins_from(law):
    """Solve d + weight f = s with the moves that the method radau uses. Each move must stay on the curve, and few moves
    must be enough.
    """
    exponent = law[2]
    for weight in (1e-6, 1e-2, 1.0, 1e3):
        for wanted in (1e-12, 1e-4, 0.1, 2.0):
            s = wanted + weight * signed_force(*law, wanted)
            for start in (1e-9, 1e-3, 0.5, 20.0):
                reached, moves = newton(law, weight, s, start)
                assert reached + weight * signed_force(*law, reached) == pytest.approx(s, rel=1e-9)
                assert moves <= (40 if exponent > 2.0 else 30), (weight, wanted, start)


def newton(law, weight, s, overlap):
    """Return the overlap that Newton's method reaches, and the number of its moves."""
    force = signed_force(*law, overlap)
    for move in range(200):
        lacks = s - overlap - weight * force
        if abs(lacks) <= 1e-12 * abs(s):
            return overlap, move
        slope = slope_at(*law, overlap, force)
        along = 0.0 if math.isinf(slope) else 1.0 / (1.0 + weight * slope)
        across = 1.0 / weight if math.isinf(slope) else slope * along
        overlap, force = move_along(*law, weight, overlap, force, along * lacks, across * lacks)
        if overlap > SMALLEST:
            assert force == pytest.approx(signed_force(*law, overlap), rel=1e-9)
    return overlap, 200


SOFT, GEAR = (0.0, 2.0, 0.5), (1.0, 2.0, 0.5)
VERTICAL = 1e-295  # Overlap [m] at which the curve of a soft contact is practically vertical.
SMALL = 2.0 * math.sqrt(1e-5)  # Force [N] of the law SOFT at the overlap 1e-5 m.
# Each entry contains a law, a weight, an overlap, and the changes of overlap and force that Newton's method requests.
# The last number is the overlap after the move.
MOVED = [
    # Moves toward overlap 0 that are determined by the requested force. A soft contact gets the overlap that belongs to
    # this force. A negative force opens the contact.
    (SOFT, 1.0, 0.25, -0.1, -0.4, 0.09), (GEAR, 3.0, 0.25, -0.1, -0.4, 0.09), (GEAR, 1e-9, 0.25, -0.3, -1.4, -0.04),
    (SOFT, 1.0, 0.25, -0.5, -1.0, -0.25), (SOFT, 1.0, 0.25, -0.5, -2.0, -0.25), (SOFT, 1.0, 0.25, -0.1, -2.0, -SMALLEST),
    (GEAR, 1e-9, 0.25, -0.3, -1.0, 0.0), (SOFT, 1.0, 0.0, 0.0, 1.0, 0.25), (SOFT, 1.0, VERTICAL, 0.0, 1.0, 0.25),
    ((0.0, 2.0, 1.5), 1.0, 1.0, -0.75, -5.0, 0.25),
    # Moves away from overlap 0 that are determined by the requested overlap, or by a small force.
    (SOFT, 1e-3, 1.0, 1.25, 1.25, 2.25), ((0.0, 2.0, 0.1), 1.0, 1e-20, 1e-19, 0.02, 0.02**10),
    # Contacts whose overlap is small compared with weight times force. The product is the distance by which the force
    # moves the beads.
    (SOFT, 100.0, 1e-4, 2e-4, 0.02, 4e-4),
    (SOFT, 0.01, 1e-5, 2e-5 * (0.04 / SMALL - 1.0), 0.04 - SMALL, 2e-5 * 0.04 / SMALL - 1e-5),
    # Moves in both directions that are determined by the requested overlap, because the contact is not soft. Newton's
    # method does not overshoot on such a curve.
    ((0.0, 5.0, 1.5), 1e3, 0.01, 1.0, 0.75, 1.01), ((0.0, 5.0, 2.0), 1e3, 0.01, 1.0, 0.75, 1.01),
    ((1.0, 2.0, 1.5), 0.01, 1.0, -0.98, -1.0, 0.02), ((1.0, 2.0, 2.0), 0.01, 1.0, -0.98, -1.0, 0.02),
    # Moves far beyond the solution are limited. After the limited move, d + weight f has the value that the move
    # requests. One of the two terms accounts for the whole value.
    (GEAR, 0.01, 4.0, -3.999, -1.0, 4.04 - 1.005 * 3.999), (GEAR, 0.9, 4.0, -3.9, -1.0, ((7.6 - 1.45 * 3.9) / 1.8) ** 2),
]  # fmt: skip


@pytest.mark.parametrize(("law", "weight", "overlap", "by_overlap", "by_force", "wanted"), MOVED)
def test_a_move_stays_on_the_curve(law, weight, overlap, by_overlap, by_force, wanted):
    moved = move_along(*law, weight, overlap, signed_force(*law, overlap), by_overlap, by_force)
    assert moved == pytest.approx((wanted, signed_force(*law, wanted)), rel=1e-6, abs=0.0)


@pytest.mark.parametrize("exponent", [0.02, 0.1, 0.5, 0.99])
@pytest.mark.parametrize("part", [-4.99e-4, -1e-6, 1e-9, 4.99e-4])
def test_a_short_move_of_a_soft_contact_needs_no_power(exponent, part):
    """Check a short move of a soft contact, which is computed from a series. The series must equal the contact law to
    the last digits, so the contact stays on its curve.
    """
    law, overlap = (0.0, 2.0, exponent), 3e-7
    force = signed_force(*law, overlap)
    moved, pushes = move_along(*law, 1.0, overlap, force, part * overlap, exponent * part * force)
    assert moved == overlap + part * overlap
    assert pushes == pytest.approx(signed_force(*law, moved), rel=3e-15, abs=0.0)


def test_forces_flow_as_the_matrix_of_the_chain_says():
    draw = np.random.default_rng(3)
    inverse_mass, force = draw.uniform(0.1, 2.0, 5), draw.uniform(0.0, 3.0, 4)
    matrix = row_matrix(Chain(1.0 / inverse_mass, hooke(1.0)))
    assert [flow_into(i, inverse_mass, force) for i in range(4)] == pytest.approx(matrix @ force)


def test_nodes_and_cubic():
    """Check that quadrature at Radau's nodes is exact up to the fourth power. Also check that the cubic polynomial
    passes through its given values.
    """
    weights = np.linalg.solve(np.vander(NODES, increasing=True).T, [1.0, 1.0 / 2.0, 1.0 / 3.0])
    assert weights @ NODES**3 == pytest.approx(1.0 / 4.0)
    assert weights @ NODES**4 == pytest.approx(1.0 / 5.0)
    wanted = np.polynomial.Polynomial([0.3, -1.1, 0.7, 2.0])
    for x in (0.0, 0.1, 0.4, 1.0):
        assert halves(x, stage_cubic(wanted(0.0), *wanted(NODES)))[0][5] == pytest.approx(wanted(x), abs=1e-13)


POWERS = [(0.0, 2.0, 0.5), (1.0, 2.0, 0.5), (0.0, 3.0, 1.0), (0.0, 5.0, 1.5), (0.7, 5.0, 2.0)]


def with_its_table(law):
    """Return the parameters of a power law and the table of the same law as a user-defined law."""
    preload, stiffness, exponent = law
    chain = Chain([1.0] * 3, [Contact(9.0, 0.0, 1.0), OwnLaw(lambda overlap: preload + stiffness * overlap**exponent)])
    return np.array([[9.0, 0.0, 1.0], law]), graphs_of(chain, State.at_start(chain, [0.0] * 3))


@pytest.mark.parametrize("law", POWERS, ids=str)
def test_a_law_of_ones_own_that_is_a_power_law_is_followed_as_one(law):
    row, graph = with_its_table(law)
    preload, stiffness, exponent = law
    assert graph.segment[1, FROM] < 1e-3
    for overlap in (-2.0, -0.2, 0.0, 0.2, 1.0, 3.0):
        force = signed_force(*law, overlap)
        assert law_curve.curve_force(row, graph, 1, overlap) == pytest.approx(force, rel=1e-12)
        slope = law_curve.curve_slope(row, NO_GRAPHS, 1, overlap, force)
        assert law_curve.curve_slope(row, graph, 1, overlap, force) == pytest.approx(slope, rel=1e-9)
    for overlap in (0.2, 1.0, 3.0):
        force = law_curve.pressed_force(row, NO_GRAPHS, 1, overlap)
        assert law_curve.pressed_force(row, graph, 1, overlap) == pytest.approx(force, rel=1e-12)
        assert law_curve.local_exponent(row, graph, 1, overlap, force) == pytest.approx(exponent, rel=1e-9)
        assert law_curve.local_exponent(row, graph, 1, overlap, preload) == exponent
        for part in (0.3, 2.0):
            reached = law_curve.curve_overlap(row, graph, 1, part * (force - preload), part)
            assert reached == pytest.approx(overlap, rel=1e-9)
        energy = (preload + stiffness * overlap**exponent / (1.0 + exponent)) * overlap
        assert law_curve.curve_depth(row, graph, 1, energy) == pytest.approx(overlap, rel=1e-9)
    for _, weight, overlap, by_overlap, by_force, _ in MOVED:
        given = weight, overlap, law_curve.curve_force(row, NO_GRAPHS, 1, overlap), by_overlap, by_force
        moved = law_curve.move_along(row, NO_GRAPHS, 1, *given)[0]
        crosses, continued = moved * overlap < 0.0 and by_overlap * overlap <= 0.0, preload or exponent == 1.0
        if crosses and continued and exponent >= 1.0:
            moved = 0.0  # A user-defined law is not extrapolated below overlap 0.
        reached = law_curve.move_along(row, graph, 1, *given)
        assert reached[0] == pytest.approx(moved, rel=1e-9), given
        assert reached[1] == pytest.approx(signed_force(*law, moved), rel=1e-9, abs=1e-12), given


def test_a_contact_beside_a_law_of_ones_own_keeps_its_row():
    row, graph = with_its_table((0.0, 2.0, 0.5))
    assert law_curve.curve_force(row, graph, 0, 0.3) == 9.0
    assert law_curve.curve_depth(row, graph, 0, 4.5) == 0.5
    assert law_curve.local_exponent(row, graph, 0, 0.3, 9.0) == 1.0


@pytest.mark.parametrize("push", [Contact(1.0, 2.0, 1.5), Contact(0.0, 2.0, 1.0), Contact(3.0, 0.5, 2.0)], ids=str)
def test_the_segments_of_a_coupler_are_its_graph(push):
    link = Coupler(push, pull=Contact(0.5, 20.0, 1.5), slack=0.5, travel=1.0, stop=1000.0)
    assert len(link.segments) == 4
    graph = graphs_of(Chain([1.0, 1.0], link), State.at_start(Chain([1.0, 1.0], link), [0.0, 0.0]))
    for side, origin, preload, stiffness, exponent, _loss, length, before, stop, *_ in link.segments:
        row = np.array([[preload, stiffness, exponent, before, stop, side]])
        for way in (0.01, 0.3, 0.9, 1.7):
            if way < length:
                force = law_curve.curve_force(row, graph, 0, side * way)
                assert force == pytest.approx(link.force(origin + side * way), rel=1e-12)
                low, high = (law_curve.curve_force(row, graph, 0, side * way + nudge) for nudge in (-1e-6, 1e-6))
                slope = law_curve.curve_slope(row, graph, 0, side * way, force)
                assert slope == pytest.approx(0.5e6 * (high - low), rel=1e-6)
        if not before:  # Beyond its origin the segment is an odd function. In this part only the stop has a slope.
            both = law_curve.curve_force(row, graph, 0, 0.2) + law_curve.curve_force(row, graph, 0, -0.2)
            assert both == pytest.approx(2.0 * side * preload)
            assert law_curve.curve_force(row, graph, 0, 0.0) == side * preload
            assert law_curve.segment_slope(row, 0, 0.0) == (stiffness if exponent == 1.0 else 0.0) + stop
    # Without a preload, the contact is open beyond the origin of the segment.
    soft = np.array([[0.0, 2.0, 0.5, 0.0, 0.0, -1.0]])
    assert [law_curve.curve_force(soft, graph, 0, way) for way in (0.25, -0.25)] == [0.0, -1.0]


def test_the_depth_of_a_stored_energy_is_bounded():
    for exponent in (0.1, 1.0, 1.5):
        by_stiffness = (0.2 * (1.0 + exponent) / 0.5) ** (1.0 / (1.0 + exponent))
        assert law_curve.depth_at(0.0, 0.5, exponent, 0.2) == pytest.approx(by_stiffness)
        assert law_curve.depth_at(4.0, 0.5, exponent, 0.2) == pytest.approx(min(0.05, by_stiffness))
    assert law_curve.depth_at(4.0, 0.0, 1.0, 0.2) == 0.05


def test_the_larger_of_two_errors_is_nan_if_either_is_nan():
    assert law_curve.larger(1.0, 2.0) == law_curve.larger(2.0, 1.0) == 2.0
    assert math.isnan(law_curve.larger(math.nan, 1.0))
    assert math.isnan(law_curve.larger(1.0, math.nan))
