"""Steps: nanoseconds of a contact and step, as `python -m benchmarks steps` measures them."""

from __future__ import annotations

from softcradle.physics import warm

from benchmarks.steps import CASES, measure

BY_NAME = {
    f"{case.method}, {case.contacts} contacts, step {case.step:.2g}, {'alike' if case.alike else 'colliding'}": case
    for case in CASES
}


def setup_cache() -> None:
    """Compile before time is taken."""
    warm(sorted({case.method for case in CASES}))


setup_cache.timeout = 1800  # type: ignore[attr-defined]  # asv reads it [s]


class Step:
    """Least time of a contact and step."""

    params = (tuple(BY_NAME),)
    param_names = ("case",)
    timeout = 600
    unit = "ns"

    def setup(self, case: str) -> None:
        """Load the machine code: live steps do not wait for it, and long chains in plain Python would take hours."""
        warm(BY_NAME[case].method)

    def track_step(self, case: str) -> float:
        return float(measure(BY_NAME[case])["nanoseconds"])
