"""Tests of event location. The tests check whether an attempted step ends at its first event and how long the next
attempt is.
"""

import math

import pytest
from softcradle.physics import Chain, hertz
from softcradle.physics.adaptive.constants import FEW_TRIES, FIRST_PART, LEAST_PART, MOST_TRIES, SHRINK
from softcradle.physics.adaptive.step_control import AT_START, LOST, RETRY, STANDS, locate_event
from softcradle.physics.adaptive.step_records import Bounds, Event, Target
from softcradle.physics.numerics.records import LOADED, OPEN

from tests.helpers.given_steps import H, Step
from tests.helpers.plain_kernels import context_of, only_plain

pytestmark = only_plain
WANTED, LEAST = 1e-9, 1e-14
TIME = 2.0  # Start of the step [s].
NOTHING, NO_TARGET = Event(-1, 0, 1.0, math.nan, 1.0), Target(-1, 0, 0, H)


def located(event, target=NO_TARGET, error=0.5 * WANTED, mode=OPEN, end_rate=1.0):
    """Return the outcome of a step of length H. At the end of the step, contact 0 is in mode `mode` and has the rate
    `end_rate` [m/s].
    """
    step = Step(Chain([1.0] * 3, hertz(1.0)), [0.0] * 3, [-0.1] * 2, [mode] * 2, [0.0] * 2)
    step.trial.rate[2, 0] = end_rate
    bounds = Bounds(WANTED, 0.01 * WANTED, 0.1 * WANTED, 0.1 * WANTED, 1.0, 1e-16)
    context = context_of(step.data, step.regime, step.motion, bounds, step.trial)
    return locate_event(TIME, H, LEAST, error, event, target, context)


def test_a_step_without_an_event_stands():
    assert located(NOTHING) == (STANDS, H, NO_TARGET)


@pytest.mark.parametrize("error", [0.5 * WANTED, 1e3 * WANTED])
def test_the_next_attempt_ends_at_the_first_event(error):
    """Check that the next attempt does not depend on the error. An event is located first, and the error is checked
    afterwards.
    """
    assert located(Event(1, 0, 0.25, math.nan, 1.0), error=error) == (RETRY, 0.25 * H, Target(1, 0, 1, H))


def test_an_event_near_the_start_of_a_long_step_needs_a_shorter_step_first():
    """Check that an event near the start of a long step is not a target yet. The polynomial of a long step is
    inaccurate near its start.
    """
    part = 0.5 * LEAST_PART
    assert located(Event(1, 0, part, math.nan, 1.0)) == (RETRY, LEAST_PART * H, Target(-1, 0, 1, H))


@pytest.mark.parametrize(("error", "outcome"), [(WANTED, AT_START), (2.0 * WANTED, RETRY)])
def test_an_event_at_the_start_is_now_if_the_step_is_good(error, outcome):
    found, _, target = located(Event(1, 1, 1e-17, math.nan, 1.0), error=error)
    assert found == outcome
    if found == AT_START:
        assert target[:2] == (1, 1)


@pytest.mark.parametrize("miss", [0.1 * H, -0.1 * H, -0.99 * H])
def test_newtons_iteration_moves_the_end_of_the_step(miss):
    """Check that Newton's iteration moves the end of the step by the computed miss. The end stays within the step that
    contains the event, and the change of the step size is limited by a factor.
    """
    target = Target(0, 0, 1, 1.05 * H)
    outcome, end, after = located(Event(-1, 0, 1.0, miss, 1.0), target)
    assert (outcome, after) == (RETRY, Target(0, 0, 2, 1.05 * H))
    assert end == pytest.approx(min(max(H + miss, LEAST_PART * H), 1.05 * H))


def test_an_earlier_event_becomes_the_target():
    target = Target(0, 0, 3, 2.0 * H)
    assert located(Event(1, 0, 0.5, 0.0, 1.0), target) == (RETRY, 0.5 * H, Target(1, 0, 4, 2.0 * H))


@pytest.mark.parametrize("miss", [0.0, 1e-15, -1e-15])
def test_a_step_that_ends_at_its_event_stands(miss):
    target = Target(0, 0, 3, 2.0 * H)
    assert located(Event(-1, 0, 1.0, miss, 1.0), target) == (STANDS, H, target)


def test_an_event_that_has_gone_is_no_target():
    """Check an event that no longer lies in the step. The guard function of the target stays positive. The attempt
    counts, and the next event is a target again.
    """
    target = Target(0, 0, 3, 2.0 * H)
    assert located(NOTHING, target) == (STANDS, H, Target(-1, 0, 4, 2.0 * H))
    assert located(Event(1, 0, 0.5, math.nan, 1.0), target) == (RETRY, 0.5 * H, Target(1, 0, 5, H))


@pytest.mark.parametrize(
    "event", [Event(1, 0, 0.5, 0.0, 1.0), Event(-1, 0, 1.0, -2.0 * FIRST_PART * H, 1.0)], ids=["another", "its own"]
)
def test_no_step_passes_over_an_event(event):
    """Check a step that still contains an event after the last attempt. The step must be rejected, and the next step
    must be much shorter.
    """
    outcome, end, target = located(event, Target(0, 0, MOST_TRIES, H))
    assert (outcome, end) == (LOST, SHRINK * H)
    assert target[:3] == (-1, 0, 0)


@pytest.mark.parametrize(("miss", "row"), [(0.5 * FIRST_PART * H, 0), (2.0 * FIRST_PART * H, -1)])
def test_a_step_that_ends_well_before_its_event_has_no_event(miss, row):
    outcome, _, target = located(Event(-1, 0, 1.0, miss, 1.0), Target(0, 0, MOST_TRIES, H))
    assert (outcome, target.row) == (STANDS, row)


@pytest.mark.parametrize(
    ("rate", "mode", "outcome"), [(1e-12, OPEN, STANDS), (1e-12, LOADED, RETRY), (1.0, OPEN, RETRY)]
)
def test_a_slowly_closing_contact_gets_only_a_few_attempts(rate, mode, outcome):
    found, *_ = located(Event(-1, 0, 1.0, 1e-3 * H, 1.0), Target(0, 0, FEW_TRIES, 2.0 * H), mode=mode, end_rate=rate)
    assert found == outcome
