"""Sessions for tests: their clock moves when the test moves it, so no frame is left out on a busy machine."""

from typing import Any

from softcradle.sandbox.session.frame_pacing import FrameClock
from softcradle.sandbox.session.session import Session

from softcradle import scenes


def opened(name: str = "one-on-four", **options: Any) -> Session:
    """A session with the scene `name`; `options` are those of Session."""
    return Session(scenes.load(name), **{"clock": FrameClock(), **options})
