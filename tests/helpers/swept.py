"""Functions that tests sweep, in a module that other processes can import. `logged` writes a line per point to a log."""

import os
import signal
import time
from pathlib import Path

import numpy as np

LOG = "SWEPT_LOG"  # Environment variable with the path of the log.


def numbers(a: float, n: int) -> dict[str, object]:
    """Return two results of a point. One is a list whose length depends on the point."""
    if a > 0.9:
        raise ValueError(f"a must be at most 0.9, not {a:.3g}")
    return {"product": a * n, "powers": np.float64(a) ** np.arange(n)}


def logged(a: float, n: int) -> dict[str, object]:
    """Return the same results slowly, and write a line to the log."""
    with Path(os.environ[LOG]).open("a") as file:
        file.write(f"{a!r} {n}\n")
    time.sleep(0.004)
    return numbers(a, n)


def deadly(a: float, n: int) -> dict[str, object]:
    """Return the same results, but kill the process at one of the points."""
    if n == 3 and a == 0.5:
        os.kill(os.getpid(), signal.SIGKILL)
    return numbers(a, n)
