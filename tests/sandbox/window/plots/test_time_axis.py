"""The time axis of the live plots."""

from __future__ import annotations

import pytest
from softcradle.sandbox.window.plots.live_plots import TimeSpan


def test_the_time_axis_scrolls_only_when_it_must():
    span = TimeSpan(8.0, 400)
    span.follow(7.0)
    assert span.left == 0
    span.follow(9.0)
    assert span.x(9.0) == pytest.approx(0.92 * 400, abs=1.0)
    assert span.time(span.x(9.0)) == pytest.approx(9.0)
    span.follow(0.0)
    assert span.left == 0
