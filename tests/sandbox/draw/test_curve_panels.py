"""Names beside curves: moved apart where they would overlap, and no further."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from softcradle.sandbox.draw.curve_panels import ticks_apart
from softcradle.sandbox.label_places import spread


@given(
    st.lists(st.floats(-50, 250, allow_nan=False), min_size=1, max_size=12), st.floats(1, 16), st.floats(100.0, 300.0)
)
def test_names_beside_curves_keep_order_and_distance(places, gap, high):
    moved = spread(places, gap, 0.0, high)
    order = sorted(range(len(places)), key=lambda k: places[k])
    steps = np.diff([moved[k] for k in order])
    assert (steps >= min(gap, high / max(1, len(places) - 1)) - 1e-6).all()
    assert min(moved) >= -1e-6
    assert max(moved) <= high + 1e-6


def test_names_with_room_stay_where_they_are():
    assert spread([10.0, 50.0, 90.0], 12.0, 0.0, 100.0) == [10.0, 50.0, 90.0]
    assert spread([50.0, 50.0], 12.0, 0.0, 100.0) == [44.0, 56.0]


def test_more_names_than_fit_share_the_room():
    assert np.ptp(spread([0.0] * 100, 0.05, 0.0, 1.0)) == pytest.approx(1.0)


def test_ticks_of_a_low_axis_are_fewer():
    ticks = [(-1.0, "-1"), (0.0, "0"), (1.0, "1"), (2.0, "2"), (3.0, "3")]
    assert ticks_apart(ticks, 12.0, 12.0) == ticks_apart(ticks, -12.0, 12.0) == ticks
    assert [value for value, _ in ticks_apart(ticks, 7.0, 12.0)] == [0.0, 2.0]
    assert [value for value, _ in ticks_apart(ticks, 1.0, 12.0)] == [0.0]
    assert ticks_apart(ticks[:1], 1.0, 12.0) == ticks[:1]
