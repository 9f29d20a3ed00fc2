"""The reference keeps BLAS to one thread while it runs, and gives the threads back."""

from __future__ import annotations

import numpy as np
import pytest
from softcradle.physics import Chain, hertz, simulate
from softcradle.physics.reference import stage_equations
from softcradle.physics.reference.one_thread import one_thread
from threadpoolctl import threadpool_info, threadpool_limits


def threads() -> set[int]:
    """Of all copies of BLAS in this process."""
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


def test_dense_solves_run_on_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: set[int] = set()
    solved = stage_equations.solved

    def watched(*arguments: object) -> object:
        seen.update(threads())
        return solved(*arguments)

    monkeypatch.setattr(stage_equations, "solved", watched)
    with threadpool_limits(limits=2, user_api="blas"):
        before = threads()
        found = simulate(
            Chain([1.0] * 3, hertz(1.0, loss=0.1)), [1.0, 0.0, 0.0], method="scipy", tolerance=1e-4, samples=2
        )
        assert threads() == before
    assert seen == {1}
    assert np.isfinite(found.final_velocity).all()


def test_threads_come_back_when_the_last_run_is_over() -> None:
    """Runs of an ensemble overlap: the first to end gave threads back to the others, and their last digits changed."""
    with threadpool_limits(limits=2, user_api="blas"):
        before = threads()
        first, second = one_thread(), one_thread()
        first.__enter__()
        second.__enter__()
        first.__exit__(None, None, None)
        assert threads() == {1}
        second.__exit__(None, None, None)
        assert threads() == before
