"""First use: seconds of `softcradle run one-on-four` and of `--help`, as `python -m benchmarks cold-start` measures them."""

from __future__ import annotations

from benchmarks.cold_start import started


class FirstUse:
    """Least of three starts with an empty cache of kernels."""

    params = (("run one-on-four", "--help"),)
    param_names = ("command",)
    timeout = 600
    unit = "s"

    def track_start(self, command: str) -> float:
        return min(started("-m", "softcradle", *command.split())[0] for _ in range(3))
