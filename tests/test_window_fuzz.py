"""A minute of random hands; an hour of them is `python -m tests.window_fuzz`."""

from __future__ import annotations

import pytest

from tests.window_fuzz import Fuzz


@pytest.mark.parametrize("seed", [1, 2])
def test_random_hands_meet_no_exception_and_no_number_that_is_none(seed: int) -> None:
    fuzz = Fuzz(seed)
    while fuzz.driver.app.frames < 1800:
        fuzz.act()
    assert fuzz.driver.app.running
    fuzz.driver.close()
