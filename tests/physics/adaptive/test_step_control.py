"""The controller of the step size, by what it sets the next step to."""

from __future__ import annotations

import math

import numpy as np
import pytest
from softcradle.physics.adaptive.constants import FURTHER_GROWTH, MOST_GROWTH, SAFETY
from softcradle.physics.adaptive.step_control import restart_control, update_control
from softcradle.physics.adaptive.step_records import CONTROLS, DOP853, ERROR_EXPONENT, NEXT, RADAU, RADAU_NEXT, REACH

from tests.helpers.plain_kernels import only_plain

pytestmark = only_plain

H, WANTED = 0.1, 1e-9


def next_steps(kind, error, rejected=math.inf, near=False, landing=-1, reach=math.inf):
    """(of either kind, of radau) after one step of length H."""
    control = np.zeros(CONTROLS)
    restart_control(control, H)
    control[REACH] = reach
    update_control(control, H, kind, error * WANTED, near, landing, rejected, WANTED)
    return control[NEXT], control[RADAU_NEXT]


@pytest.mark.parametrize("kind", [RADAU, DOP853])
@pytest.mark.parametrize("error", [1e-3, 0.3, 1.0])
def test_the_error_of_a_step_tells_the_next(kind, error):
    expected = H * min(MOST_GROWTH, SAFETY * error ** -ERROR_EXPONENT[kind])
    assert next_steps(kind, error)[0] == pytest.approx(expected)
    assert next_steps(RADAU, error)[1] == next_steps(RADAU, error)[0]
    assert next_steps(DOP853, error)[1] == H


def test_the_step_after_one_that_was_rejected_stays_well_below_it():
    assert next_steps(DOP853, 1e-3, rejected=1.5 * H)[0] == pytest.approx(SAFETY**2 * 1.5 * H)
    assert next_steps(DOP853, 1e-3, rejected=1.1 * H)[0] == H
    assert next_steps(DOP853, 1.0, rejected=1.5 * H)[0] == pytest.approx(SAFETY * H)
    assert next_steps(RADAU, 1e-3, rejected=1.1 * H)[0] > FURTHER_GROWTH * H  # graded steps of radau grow on


@pytest.mark.parametrize("cut", [{"near": True}, {"landing": 0}])
def test_a_step_that_was_cut_short_shortens_none(cut):
    assert next_steps(DOP853, 0.9, **cut)[0] == H
    assert next_steps(DOP853, 1e-3, **cut)[0] > H
