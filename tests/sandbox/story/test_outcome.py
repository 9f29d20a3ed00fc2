"""Tests of the outcome of a collision: which beads move together and which beads are nearly at rest.

The definitions of both terms are checked with known final velocities.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from softcradle.physics import Chain, hertz, power_law, simulate
from softcradle.sandbox.languages import use_language
from softcradle.sandbox.story.lane_story import first_hit, story_of
from softcradle.sandbox.story.outcome import MOVES, NEARLY_STILL, STILL, outcome_of
from softcradle.sandbox.story.sentences import describe, outcome_words, story_words

# Final velocities computed with quadruple precision. ONE_ON_FOUR is for alpha = 1/10, and ONE_ON_TEN is for alpha =
# 1/30.
ONE_ON_FOUR = (-0.567586, 0.173921, 0.454079, 0.469784, 0.469802)
ONE_ON_TEN = (-0.7833, -0.0673, 0.1696, 0.2067, 0.2104, 0.2106, 0.2106, 0.2106, 0.2106, 0.2106, 0.2106)
HERTZ_CRADLE = (-0.0711, -0.0303, -0.0145, 0.1270, 0.9888)
HOOKE_CRADLE = (-0.132279, -0.075329, -0.031011, 0.296218, 0.942402)


def strike(count: int) -> list[float]:
    """Return the start velocities of one striker with velocity 1 and `count` - 1 beads at rest."""
    return [1.0] + [0.0] * (count - 1)


def groups_of(velocity, start=None, mass=None) -> list[tuple[int, int, str]]:
    """Return the first bead, the last bead and the state of each group of beads."""
    found = outcome_of(mass or [1.0] * len(velocity), start or strike(len(velocity)), velocity)
    return [(group.first, group.last, group.state) for group in found.groups]


@pytest.mark.parametrize(
    ("velocity", "groups"),
    [
        (ONE_ON_FOUR, [(0, 0, MOVES), (1, 1, MOVES), (2, 4, MOVES)]),
        (ONE_ON_TEN, [(0, 0, MOVES), (1, 1, NEARLY_STILL), (2, 2, MOVES), (3, 10, MOVES)]),
        (HERTZ_CRADLE, [(0, 2, NEARLY_STILL), (3, 3, MOVES), (4, 4, MOVES)]),
        (HOOKE_CRADLE, [(0, 0, MOVES), (1, 2, NEARLY_STILL), (3, 3, MOVES), (4, 4, MOVES)]),
        ((0.0, 1.0), [(0, 0, STILL), (1, 1, MOVES)]),
        ((1.0, 0.0, 0.0), [(0, 0, MOVES), (1, 2, STILL)]),
    ],
)
def test_groups_of_known_collisions(velocity, groups):
    assert groups_of(velocity) == groups


@pytest.mark.parametrize("count", [3, 10, 49, 1000])
def test_rigid_cluster_that_carries_the_momentum_is_not_still(count):
    """Check the collision of one bead with a long rigid cluster.

    The cluster is slow, but it carries twice the momentum of the striker. Such a cluster must not count as nearly at
    rest.
    """
    speed = 2.0 / (count + 1)
    assert groups_of([speed - 1.0] + [speed] * count) == [(0, 0, MOVES), (1, count, MOVES)]


def test_one_on_49_soft_beads_moves():
    run = simulate(Chain([1.0] * 50, power_law(1.0, 1 / 100)), strike(50))
    last = story_of(run).outcome.groups[-1]
    assert (last.first, last.last, last.state) == (4, 49, MOVES)
    assert last.velocity == pytest.approx(run.final_velocity[4:].mean())
    assert "Beads 4 to 49 move right together at 0.048\u00a0m/s." in describe("", run)


def test_slow_beads_that_together_carry_the_momentum_are_not_still():
    """Check a hundred separate slow beads, such as a wave leaves behind.

    Each bead carries a fiftieth of the momentum. Beads that carry most of the momentum together must not count as
    nearly at rest.
    """
    velocity = [-0.98] + [0.02 * (0.5 + (k % 7) / 6) for k in range(99)]
    found = outcome_of([1.0] * 100, strike(100), velocity)
    still = [group for group in found.groups if not group.moves]
    assert sum(abs(group.velocity) * group.count for group in still) <= 0.1 * sum(map(abs, velocity))


@pytest.mark.parametrize("count", [2, 5, 10])
def test_last_bead_of_a_steel_cradle_leaves_alone(count):
    run = simulate(Chain([1.0] * count, hertz(1e3)), strike(count))
    last = story_of(run).outcome.groups[-1]
    assert (last.first, last.count, last.state) == (count - 1, 1, MOVES)


def test_light_bead_that_flies_off_is_not_still():
    assert groups_of([0.999, 1.9], mass=[1.0, 1e-3]) == [(0, 0, MOVES), (1, 1, MOVES)]


def test_heavy_bead_that_hardly_moves_is_not_still():
    assert groups_of([-0.98, 0.0198], mass=[1.0, 100.0]) == [(0, 0, MOVES), (1, 1, MOVES)]


def test_walls_are_groups_of_their_own_if_they_move():
    mass, start = [math.inf, 1.0, 1.0, math.inf], [0.0, 0.0, 0.0, 2.0]
    found = outcome_of(mass, start, [0.0, -1.0, -1.0, 2.0])
    said = "Beads 1 and 2 move left together at 1\u00a0m/s. Wall 3 moves right at 2\u00a0m/s."
    assert outcome_words(found) == said
    assert found.group_of(0) is None


def test_beads_at_rest_stand_still():
    assert outcome_words(outcome_of([1.0] * 2, [0.0] * 2, [0.0] * 2)) == "Beads 0 and 1 are at rest."
    assert outcome_words(outcome_of([1.0] * 2, [1.0, 0.0], [1e-3, 0.0])) == "Beads 0 and 1 are almost at rest."


def test_more_groups_are_counted():
    found = outcome_of([1.0] * 9, strike(9), np.linspace(0.1, 0.9, 9))
    assert outcome_words(found).endswith("And 3 more groups.")


@pytest.mark.parametrize("code", ["en", "de", "fr"])
def test_numbers_of_a_story_have_the_decimal_mark_of_the_language(code):
    use_language(code)
    run = simulate(Chain([1.0] * 5, power_law(1.0, 0.1)), strike(5))
    assert ("0.57\u00a0m/s" if code == "en" else "0,57\u00a0m/s") in story_words(story_of(run))


VELOCITY = st.floats(-1.0, 1.0).map(lambda value: round(value, 3))
ROWS = st.integers(2, 12).flatmap(
    lambda count: st.tuples(
        st.lists(VELOCITY, min_size=count, max_size=count), st.lists(VELOCITY, min_size=count, max_size=count)
    )
)


@given(ROWS, st.floats(-3.0, 3.0))
def test_groups_do_not_depend_on_the_frame_of_reference(rows, speed):
    """Check that the groups of beads are the same in every frame of reference.

    Only the beads that count as nearly at rest depend on the frame of reference.
    """

    def spans(start, velocity):
        found = outcome_of([1.0] * len(start), start, velocity)
        # Neighbouring groups at rest are reported as one group, so only moving groups are compared.
        return {(group.first, group.last) for group in found.groups if group.moves}

    start, velocity = (np.array(row) for row in rows)
    fast = 100.0 + speed  # In this frame of reference, no bead is at rest.
    assert spans(start, velocity) <= spans(start + fast, velocity + fast)


@given(ROWS)
def test_groups_of_the_mirror_image_are_mirrored(rows):
    start, velocity = rows
    mass = [1.0 + (k % 3) for k in range(len(start))]
    last = len(start) - 1
    found = outcome_of(mass, start, velocity).groups
    mirrored = outcome_of(mass[::-1], [-v for v in start[::-1]], [-v for v in velocity[::-1]]).groups
    expected = [(last - group.last, last - group.first, group.state) for group in found][::-1]
    assert [(group.first, group.last, group.state) for group in mirrored] == expected


@given(ROWS, st.sampled_from([1e-3, 7.0, 1e6]))
def test_groups_do_not_depend_on_units(rows, scale):
    start, velocity = rows
    mass = [1.0] * len(start)
    found = outcome_of(mass, start, velocity).groups
    scaled = outcome_of([scale * one for one in mass], [scale * v for v in start], [scale * v for v in velocity]).groups
    assert [(one.first, one.last, one.state) for one in scaled] == [(one.first, one.last, one.state) for one in found]


def test_first_hit_is_the_fastest_of_those_at_the_same_time():
    found = first_hit([(2.0, 3.0, 2), (1.0, 0.001, 0), (2.0, 0.5, 1)], [1.0] * 3 + [math.inf], 1.0)
    assert (found.time, found.speed, found.contact, found.walls) == (2.0, 3.0, 2, (False, True))
    assert first_hit([(1.0, 0.001, 0)], [1.0, 1.0], 1.0) is None
