"""That something is compiled, told to the logger `softcradle`: once a machine that takes half a minute, and nothing else is seen.

A file of its own, for it imports no numba: a simulation by pymunk or SciPy does without.
"""

from __future__ import annotations

import logging
from functools import cache
from typing import Any

FIRST = "compiling for this machine, about half a minute for a method; the next start loads it from the disk"
SLOW = "numba is not installed: methods run as plain Python, a hundred times slower; pip install 'softcradle[fast]'"

logger = logging.getLogger("softcradle")


@cache
def tell_first() -> None:
    """Say once that it takes a while."""
    logger.warning(FIRST)


@cache
def log_compilation() -> None:
    """Say so as soon as this process itself compiles; without numba, say that. What is loaded from the disk is not told of."""
    try:
        from numba.core import event
    except ImportError:
        logger.warning(SLOW)
        return

    class Listener(event.Listener):  # type: ignore[misc]  # numba has no types
        """Called by numba before and after each kernel, ours and those of others."""

        def on_start(self, found: Any) -> None:
            function = getattr(found.data.get("dispatcher"), "py_func", None)
            if (getattr(function, "__module__", None) or "").startswith("softcradle."):
                tell_first()

        def on_end(self, found: Any) -> None:
            """Do nothing: one kernel compiles others while it is compiled."""

    event.register("numba:compile", Listener())
