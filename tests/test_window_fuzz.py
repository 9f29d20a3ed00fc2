"""A minute of random hands; an hour of them is `python -m tests.window_fuzz`."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.window_fuzz import Fuzz, run


@pytest.mark.parametrize("seed", [1, 2])
def test_random_hands_meet_no_exception_and_no_number_that_is_none(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    fuzz = Fuzz(seed, tmp_path)
    run(fuzz, 1800)
    assert fuzz.driver.app.running
