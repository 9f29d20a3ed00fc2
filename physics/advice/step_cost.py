"""What a step costs on this machine, measured once and kept in the user's cache folder: what `auto` chooses by.

Seconds a step are ``base + contact * n`` for n contacts. The figures belong to these kernels on this machine: both are in
the name of the file. Where no file can be kept, every process measures anew, in a few hundredths of a second.
"""

from __future__ import annotations

import json
import platform
import warnings
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from softcradle.physics.atomic_files import output_file
from softcradle.physics.chain import Chain, one_on
from softcradle.physics.contact import Contact, hertz, power_law
from softcradle.physics.source_digest import digest_of, kernel_sources

SMALL, LARGE = 4, 32  # contacts of the two chains that are timed
ROUNDS = 5  # of which the least time counts: a machine is never faster than it is
SPAN = 1.5  # [s] a part of their collision in which contacts are closed
STEP = 1e-3  # [s] of the fixed-step methods
TOLERANCE = 1e-6
SOFT, SMOOTH = "soft", "smooth"  # exponents whose power is taken by `pow`, and those that need none

# method and kind of contact whose step is timed
TIMED: tuple[tuple[str, str], ...] = (
    ("verlet", SOFT), ("verlet", SMOOTH), ("yoshida4", SOFT), ("yoshida4", SMOOTH), ("conserving", SOFT),
    ("conserving", SMOOTH), ("accurate", SOFT), ("accurate", SMOOTH),
)  # fmt: skip


class Cost(NamedTuple):
    """Seconds of a step: `base`, and `contact` for each contact."""

    base: float
    contact: float

    def of(self, steps: float, contacts: int) -> float:
        """Seconds of so many steps of so many contacts."""
        return steps * (self.base + self.contact * contacts)


Costs = dict[tuple[str, str], Cost]


def kind_of(contacts: tuple[Contact, ...]) -> str:
    """SMOOTH where no contact needs a costly power or a stiff method, else SOFT."""
    cheap = all(law.preload == 0.0 and law.exponent in (1.0, 1.5) for law in contacts)
    return SMOOTH if cheap else SOFT


@lru_cache(maxsize=1)
def costs() -> Costs:
    """The costs on this machine: from the cache folder, else measured and put there."""
    path = cache_file()
    found = _read(path)
    if found is None:
        found = measure()
        _write(path, found)
    return found


def cache_file() -> Path:
    """Where they are kept: a name for these kernels on this machine."""
    from platformdirs import user_cache_path

    machine = platform.node(), platform.machine(), platform.processor(), platform.python_version()
    key = digest_of(kernel_sources(), *machine)
    return user_cache_path("softcradle", appauthor=False) / f"costs-{key}.json"


def measure() -> Costs:
    """Time a step of every method and kind of contact in TIMED; compiles what is not compiled yet."""
    found = {}
    for method, kind in TIMED:
        small, large = (_seconds_a_step(method, kind, contacts) for contacts in (SMALL, LARGE))
        contact = max((large - small) / (LARGE - SMALL), 0.0)
        found[method, kind] = Cost(max(small - SMALL * contact, 0.0), contact)
    return found


def _seconds_a_step(method: str, kind: str, contacts: int) -> float:
    from softcradle.physics.simulation import simulate

    chain: Chain = one_on(contacts, power_law(1.0, 0.1) if kind == SOFT else hertz(1.0))
    fineness: dict[str, Any] = {"tolerance": TOLERANCE} if method == "accurate" else {"step": STEP}
    velocity = np.eye(1, contacts + 1)[0]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        runs = [simulate(chain, velocity, SPAN, method, samples=2, **fineness) for _ in range(ROUNDS)]
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
        return  # a folder that cannot be written costs a measurement a process
