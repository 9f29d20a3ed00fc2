"""Cost of a step on this machine: measured once, stored in the user's cache folder, used by :mod:`auto_method`.

A step of a chain of n contacts takes ``base + contact * n`` seconds. The numbers are valid for these kernels on this machine,
and both are in the name of the file. Where no file can be written every process measures again, in a few tenths of a
second.
"""

from __future__ import annotations

import json
import platform
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from softcradle.physics import dispatch
from softcradle.physics.atomic_files import output_file
from softcradle.physics.chain import one_on
from softcradle.physics.contact import Contact, hertz, power_law
from softcradle.physics.problem import Problem
from softcradle.physics.source_digest import digest_of, kernel_sources
from softcradle.physics.state import State

SMALL = 4  # contacts of the shorter chain that is timed
LARGE = 32  # contacts of the longer one
ROUNDS = 5  # runs of each chain; the shortest time counts, for other processes only add to it
DURATION = 1.5  # [s] of the motion that is timed: contacts are closed in most of it
STEP = 1e-3  # [s], of the fixed-step methods: hundreds of steps in the duration
TOLERANCE = 1e-6  # of the adaptive method: the middle of those in use
SOFT = "soft"  # kind of contacts whose force takes a call of `pow`, or which need a stiff method
SMOOTH = "smooth"  # kind of contacts whose force takes neither

# pairs of a method and a kind of contact whose step is timed
TIMED: tuple[tuple[str, str], ...] = (
    ("verlet", SOFT), ("verlet", SMOOTH), ("yoshida4", SOFT), ("yoshida4", SMOOTH), ("conserving", SOFT),
    ("conserving", SMOOTH), ("accurate", SOFT), ("accurate", SMOOTH),
)  # fmt: skip


class Cost(NamedTuple):
    """Seconds of a step: `base`, and `contact` more for each contact."""

    base: float
    contact: float

    def of(self, steps: float, contacts: int) -> float:
        """Seconds of `steps` steps of a chain of `contacts` contacts."""
        return steps * (self.base + self.contact * contacts)


Costs = dict[tuple[str, str], Cost]


def kind_of(contacts: tuple[Contact, ...]) -> str:
    """SMOOTH where no contact takes a call of `pow` or a stiff method, else SOFT."""
    cheap = all(law.preload == 0.0 and law.exponent in (1.0, 1.5) for law in contacts)
    return SMOOTH if cheap else SOFT


@lru_cache(maxsize=1)
def costs() -> Costs:
    """The costs on this machine, from the cache folder; where they are not there, they are measured and stored."""
    path = cache_file()
    found = _read(path)
    if found is None:
        found = measure()
        _write(path, found)
    return found


def cache_file() -> Path:
    """Path of the file of costs, whose name depends on the kernels and the machine."""
    from platformdirs import user_cache_path

    machine = platform.node(), platform.machine(), platform.processor(), platform.python_version()
    key = digest_of(kernel_sources(), *machine)
    return user_cache_path("softcradle", appauthor=False) / f"costs-{key}.json"


def measure() -> Costs:
    """The costs of every method and kind of contact in TIMED, measured now; kernels are compiled where they have to be."""
    found = {}
    for method, kind in TIMED:
        small, large = (_seconds_a_step(method, kind, contacts) for contacts in (SMALL, LARGE))
        contact = max((large - small) / (LARGE - SMALL), 0.0)
        found[method, kind] = Cost(max(small - SMALL * contact, 0.0), contact)
    return found


def _seconds_a_step(method: str, kind: str, contacts: int) -> float:
    chain = one_on(contacts, power_law(1.0, 0.1) if kind == SOFT else hertz(1.0))
    start = State.at_start(chain, np.eye(1, contacts + 1)[0])
    step, tolerance = (0.0, TOLERANCE) if method == "accurate" else (STEP, 0.0)
    problem = Problem(chain, start, method, DURATION, step, tolerance, samples=2)
    runs = [dispatch.run(problem) for _ in range(ROUNDS)]
    return min(run.seconds / run.steps for run in runs)


def _read(path: Path) -> Costs | None:
    try:
        rows = json.loads(path.read_text(encoding="utf-8"))
        found = {(method, kind): Cost(float(base), float(contact)) for method, kind, base, contact in rows}
    except (OSError, ValueError, TypeError):
        return None
    return found if set(found) == set(TIMED) and all(np.isfinite(cost).all() for cost in found.values()) else None


def _write(path: Path, found: Costs) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with output_file(path) as temporary:
            temporary.write_text(json.dumps([[*key, *cost] for key, cost in found.items()]), encoding="utf-8")
    except OSError:
        return  # without a file every process measures again
