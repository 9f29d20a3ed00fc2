"""The quadruple-precision answers of `data/truth.json` as chains and arrays."""

import json
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
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


@cache
def _data() -> dict[str, Any]:
    content: dict[str, Any] = json.loads((Path(__file__).parent / "data" / "truth.json").read_text())
    return content


def _numbers(values: Any) -> Array:
    return np.array([np.nan if value is None else float(value) for value in values])


def _elastic(name: str, case: dict[str, Any]) -> Truth:
    contacts = [Contact(0.0, float(f), float(Fraction(str(a)))) for f, a in zip(case["F"], case["a"], strict=True)]
    samples = case["samples_contact"]
    return Truth(
        name=name, chain=Chain(case["m"], contacts), start=_numbers(case["v_init"]), final=_numbers(case["vfinal"]),
        struck=case["hit_contact"], contact_time=float(case["contact_duration"]), opened=_numbers(case["open_last"]),
        largest_overlap=_numbers(case["d_max"]), peak_force=_numbers(case["f_max"]),
        time=_numbers([row["t"] for row in samples]),
        overlap=np.array([_numbers(row["d"]) for row in samples]),
        force=np.array([_numbers(row["f"]) for row in samples]),
        velocity=np.array([_numbers(row["v"]) for row in samples]),
    )  # fmt: skip


def _gear(name: str, case: dict[str, Any]) -> Truth:
    samples = case["samples_t_d_f_v"]
    return Truth(
        name=f"draft gear {name}", chain=Chain(_numbers(case["masses"]), GEAR), start=_numbers(case["v"]),
        final=_numbers(case["vfinal"]), struck=case["hit_contact"], contact_time=float(case["T_hit_open"]),
        opened=_numbers(case["last_open"]), largest_overlap=_numbers(case["dmax"]), peak_force=_numbers(case["fmax"]),
        time=_numbers([row[0] for row in samples]), overlap=np.array([_numbers(row[1]) for row in samples]),
        force=np.array([_numbers(row[2]) for row in samples]),
        velocity=np.array([_numbers(row[3]) for row in samples]),
    )  # fmt: skip


ELASTIC = tuple(_elastic(name, case) for name, case in _data().items() if isinstance(case, dict) and "m" in case)
GEARS = tuple(_gear(name, case) for name, case in _data()["draft gear"].items() if "masses" in case)
CRITICAL_SPEEDS = {
    name: float(speed)
    for name, speed in next(v for k, v in _data()["draft gear"].items() if k.startswith("critical_speeds")).items()
}
