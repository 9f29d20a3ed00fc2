"""Clusters that end at gaps, and the forces inside them if they were rigid."""

import math

import pytest
from softcradle.sandbox.draw.bodies import cluster_ends, has_marks, rigid_forces

MASSES = [1.0] * 5
CLOSED = [0.0] * 4


def test_rigid_forces_are_those_of_equation_5():
    ends = cluster_ends([-1.0, 0.0, 0.0, 0.0], [1, 0, 0, 0, 0], 1.0)
    assert ends == (True, False, False, False)
    assert rigid_forces(MASSES, ends, CLOSED, [0.8, 0.5, 0.3, 0.1], 1.0) == pytest.approx([0, 0.6, 0.4, 0.2])
    two = cluster_ends([0.0, -1.0, 0.0], [1, 1, 0, 0], 1.0)
    assert rigid_forces([1.0, 3.0, 2.0, 2.0], two, [0.0] * 3, [9, 1.0, 9], 1.0) == pytest.approx([0.25, 0, 0.5])


def test_beads_that_touch_already_meet_where_their_velocities_differ():
    assert cluster_ends(CLOSED, [1, 0, 0, 0, 0], 1.0) == (True, False, False, False)
    assert cluster_ends([0.0, -1e-17, 1e-30, 0.0], [0, 0, 0, 0, 1e-9], 1.0) == (False, False, False, True)


@pytest.mark.parametrize(("gap", "shares"), [(3, [0, 2 / 3, 1 / 3, 0]), (1, [0, 0, 0, 0]), (2, [0, 0.5, 0, 0])])
def test_a_cluster_ends_at_an_open_gap(gap, shares):
    """One bead strikes the row; the beads beyond a gap push nothing, and a gap has no mark."""
    overlap = [-1.0 if i in (0, gap) else 0.0 for i in range(4)]
    ends = cluster_ends(overlap, [1, 0, 0, 0, 0], 1.0)
    now = [-1.0 if i == gap else 0.0 for i in range(4)]
    force = [0.0 if i == gap else 1.0 for i in range(4)]
    assert rigid_forces(MASSES, ends, now, force, 1.0) == pytest.approx(shares)


def test_a_gap_on_the_left_of_what_is_struck_from_the_right():
    ends = cluster_ends([0.0, -0.5, 0.0, -1.0], [0, 0, 0, 0, -1], 1.0)
    assert rigid_forces(MASSES, ends, [0.0, -0.5, 0.0, 0.1], [0, 0, 0.7, 1.0], 1.0) == pytest.approx([0, 0, 0.5, 0])


def test_a_gap_that_has_closed_pushes_from_the_other_end():
    """Three beads are struck on the left with 3 N, and run into a fourth, which pushes back with 1 N."""
    ends = cluster_ends([-1.0, 0.0, 0.0, -1e-3], [1, 0, 0, 0, 0], 1.0)
    forces = rigid_forces(MASSES, ends, [0.1, 0.1, 0.1, 0.1], [3.0, 2.0, 2.0, 1.0], 1.0)
    assert forces == pytest.approx([0, 3 * 2 / 3 + 1 / 3, 3 / 3 + 2 / 3, 0])


def test_no_marks_beside_a_wall_without_a_blow_or_without_a_cluster():
    wall = [1.0, 1.0, math.inf]
    assert rigid_forces(wall, (True, False), [0.1, 0.1], [1.0, 1.0], 1.0) == [0.0, 0.0]
    assert not has_marks(cluster_ends([0.0, 0.0], [0, 0, 0], 1.0))
    assert not has_marks(cluster_ends([-1.0], [1, 0], 1.0))
    assert not has_marks(cluster_ends([-1.0, -1.0], [1, 0, 0], 1.0))
    assert has_marks(cluster_ends([-1.0, 0.0], [1, 0, 0], 1.0))
