"""What numba compiles, told to the logger `softcradle`: once a machine that takes half a minute, in which nothing else is seen.

A WARNING is logged when compiling begins, an INFO for each kernel. Kernels that are loaded from the disk are not told of.
"""

from __future__ import annotations

import logging
from functools import cache
from time import perf_counter
from typing import Any

logger = logging.getLogger("softcradle")


@cache
def log_compilation() -> None:
    """Log what is compiled from now on in this process; without numba, log that."""
    try:
        from numba.core import event
    except ImportError:
        logger.warning(SLOW)
        return

    class Listener(event.Listener):  # type: ignore[misc]  # numba has no types
        """Counts the kernels of softcradle; numba calls it before and after each."""

        def __init__(self) -> None:
            self.count, self.began = 0, 0.0

        def on_start(self, found: Any) -> None:
            kernel = _kernel_name(found.data.get("dispatcher"))
            if not kernel:
                return
            if self.count == 0:
                self.began = perf_counter()
                logger.warning(FIRST)
            self.count += 1
            logger.info("compiling %s: kernel %d, %.0f s so far", kernel, self.count, perf_counter() - self.began)

        def on_end(self, found: Any) -> None:
            """Do nothing: one kernel compiles others while it is compiled."""

    event.register("numba:compile", Listener())


SLOW = "numba is not installed: methods run as plain Python, a hundred times slower; pip install 'softcradle[fast]'"
FIRST = "compiling for this machine, about half a minute for a method; the next start loads it from the disk"


def _kernel_name(dispatcher: Any) -> str:
    """Name of a kernel of softcradle; empty for other code."""
    function = getattr(dispatcher, "py_func", None)
    module = getattr(function, "__module__", None) or ""
    return function.__name__.replace("_", " ") if function is not None and module.startswith("softcradle.") else ""
