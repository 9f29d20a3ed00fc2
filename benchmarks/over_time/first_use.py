"""Benchmark of the first use: seconds of `softcradle run one-on-four` and of `--help`.

The measurement is that of `python -m benchmarks cold-start`.
"""

from __future__ import annotations

from benchmarks.cold_start import started


class FirstUse:
    """Shortest time of three starts with an empty kernel cache."""

    params = (("run one-on-four", "--help"),)
    param_names = ("command",)
    timeout = 600
    unit = "s"

    def track_start(self, command: str) -> float:
        return min(started("-m", "softcradle", *command.split())[0] for _ in range(3))
