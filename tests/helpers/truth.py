"""The quadruple-precision answers of `data/truth.json` as chains and arrays."""

import json
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, Contact, draft_gear

Array = NDArray[np.float64]

GEAR = draft_gear(770.0, 0.0177)


def gear_critical_speed(n: int) -> float:
    """Speed [m/s] up to which one unit mass on `n`, all GEARs between them, stays exactly rigid; from energy alone."""
    precompression = GEAR.preload / GEAR.stiffness
    return precompression * float(np.sqrt(GEAR.stiffness * (n + 1) / n * ((n / (n - 1)) ** 2 - 1)))


@dataclass(frozen=True)
class Truth:
    """One case: chain and start, and what happens.

    `opened` holds the last opening [s] of each contact, nan where it never loads; samples are (T,), (T, n), (T, n+1).
    """

    name: str
    chain: Chain
    start: Array
    final: Array
    struck: int
    contact_time: float
    opened: Array
    largest_overlap: Array
    peak_force: Array
    time: Array
    overlap: Array
    force: Array
    velocity: Array

    @property
    def least_exponent(self) -> float:
        """Smallest exponent of its contacts."""
        return min(contact.exponent for contact in self.chain.contact)


_DATA: dict[str, Any] = json.loads((Path(__file__).parent / "data" / "truth.json").read_text())


def _numbers(values: Any) -> Array:
    return np.array(values, dtype=np.float64)


def _truth(name: str, case: dict[str, Any], chain: Chain, start: Array, names: str, samples: Any) -> Truth:
    """A case; `names` are those of its contact time, last openings, largest overlaps and forces in the file."""
    contact_time, *others = (_numbers(case[key]) for key in names.split())
    columns = map(_numbers, zip(*samples, strict=True))
    ends = _numbers(case["vfinal"]), case["hit_contact"], float(contact_time)
    return Truth(name, chain, start, *ends, *others, *columns)


def _elastic(name: str, case: dict[str, Any]) -> Truth:
    contacts = [Contact(0.0, float(f), float(Fraction(str(a)))) for f, a in zip(case["F"], case["a"], strict=True)]
    samples = [[row[key] for key in "tdfv"] for row in case["samples_contact"]]
    chain, names = Chain(case["m"], contacts), "contact_duration open_last d_max f_max"
    return _truth(name, case, chain, _numbers(case["v_init"]), names, samples)


def _gear(name: str, case: dict[str, Any]) -> Truth:
    chain, names = Chain(_numbers(case["masses"]), GEAR), "T_hit_open last_open dmax fmax"
    return _truth(f"draft gear {name}", case, chain, _numbers(case["v"]), names, case["samples_t_d_f_v"])


ELASTIC = tuple(_elastic(name, case) for name, case in _DATA.items() if isinstance(case, dict) and "m" in case)
GEARS = tuple(_gear(name, case) for name, case in _DATA["draft gear"].items() if "masses" in case)
CRITICAL_SPEEDS = {
    name: float(speed)
    for name, speed in next(v for k, v in _DATA["draft gear"].items() if k.startswith("critical_speeds")).items()
}
