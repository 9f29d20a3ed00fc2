"""Sessions for tests: their clock moves when the test moves it, so no frame is left out on a busy machine."""

from __future__ import annotations

from typing import Any

from softcradle.sandbox.session.session import Session

from softcradle import scenes


class FakeClock:
    """A clock that a test sets.

    Attributes:
        now: the time that it tells [s].
    """

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def opened(name: str = "one-on-four", **options: Any) -> Session:
    """A session with the scene `name`; `options` are those of Session."""
    return Session(scenes.load(name), **{"clock": FakeClock(), **options})
