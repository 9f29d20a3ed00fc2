"""Benchmark of the cases of the work-precision chart with `accurate`, and of many collisions in sequence."""

from __future__ import annotations

from time import thread_time
from typing import Any

import numpy as np
from softcradle.physics import warm
from softcradle.physics.simulation import solve
from softcradle.sandbox.studies.precision.cases import CASE_DEFINITIONS

from benchmarks.sweeps import measure_work

CASES = {definition.name: definition for definition in CASE_DEFINITIONS}
COLLISIONS = 2000


def setup_cache() -> None:
    """Compile the kernels before the measurement. A process without machine code would start in plain Python."""
    warm("accurate")


setup_cache.timeout = 1800  # type: ignore[attr-defined]  # asv reads it [s]


class Solve:
    """Processor time to solve a case with two samples."""

    params = (tuple(CASES), (1e-6, 1e-9))
    param_names = ("case", "tolerance")
    timer = staticmethod(thread_time)
    timeout = 600

    def setup(self, case: str, tolerance: float) -> None:
        definition = CASES[case]
        chain = definition.make_chain()
        velocity = np.eye(1, chain.contacts + 1)[0] if definition.velocity is None else definition.velocity
        self.problem: tuple[Any, ...] = chain, velocity, definition.duration, "accurate", None, 2, tolerance
        solve(*self.problem)

    def time_solve(self, case: str, tolerance: float) -> None:
        solve(*self.problem)


class Ensemble:
    """Mean processor time [us] of a collision of one bead with four at tolerance 1e-6."""

    timeout = 600
    unit = "µs"

    def track_collision(self) -> float:
        return 1e6 * min(measure_work(COLLISIONS) for _ in range(3)) / COLLISIONS
