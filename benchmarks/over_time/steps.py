"""Benchmark of steps: nanoseconds for one contact and one step, as in `python -m benchmarks steps`."""

from __future__ import annotations

from softcradle.physics import warm

from benchmarks.steps import CASES, measure

BY_NAME = {
    f"{case.method}, {case.contacts} contacts, step {case.step:.2g}, {'alike' if case.alike else 'colliding'}": case
    for case in CASES
}


def setup_cache() -> None:
    """Compile the kernels before the measurement."""
    warm(sorted({case.method for case in CASES}))


setup_cache.timeout = 1800  # type: ignore[attr-defined]  # asv reads it [s]


class Step:
    """Shortest time for one contact and one step."""

    params = (tuple(BY_NAME),)
    param_names = ("case",)
    timeout = 600
    unit = "ns"

    def setup(self, case: str) -> None:
        """Load the machine code. Steps of the live simulation do not wait for it, and long chains would take hours in
        plain Python.
        """
        warm(BY_NAME[case].method)

    def track_step(self, case: str) -> float:
        return float(measure(BY_NAME[case])["nanoseconds"])
