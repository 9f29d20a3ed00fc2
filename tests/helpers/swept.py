"""Functions for the tests of sweeps. The functions are in a separate module because other processes must import them."""

import os
import signal
import time
from pathlib import Path

import numpy as np

LOG = "SWEPT_LOG"  # Name of the environment variable that contains the path of the log.


def numbers(a: float, n: int) -> dict[str, object]:
    """Return two results for a point of the sweep. One result is a list whose length depends on the point."""
    if a > 0.9:
        raise ValueError(f"a must be at most 0.9, not {a:.3g}")
    return {"product": a * n, "powers": np.float64(a) ** np.arange(n)}


def logged(a: float, n: int) -> dict[str, object]:
    """Return the same results as `numbers`, but slowly. Also write a line to the log."""
    with Path(os.environ[LOG]).open("a") as file:
        file.write(f"{a!r} {n}\n")
    time.sleep(0.004)
    return numbers(a, n)


def deadly(a: float, n: int) -> dict[str, object]:
    """Return the same results as `numbers`, but kill the process at one of the points."""
    if n == 3 and a == 0.5:
        os.kill(os.getpid(), signal.SIGKILL)
    return numbers(a, n)
