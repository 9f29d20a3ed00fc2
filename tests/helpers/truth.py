"""Reference solutions in quadruple precision, read from `data/truth.json` as chains and arrays."""

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


@dataclass(frozen=True)
class Truth:
    """A reference solution: the chain, its start velocities, and the results.

    `opened` contains the time [s] of the last opening of each contact, or NaN for a contact that never loads. Arrays of
    samples have the shapes (T,), (T, n) and (T, n+1).
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
        """The smallest exponent of the contacts in the chain."""
        return min(contact.exponent for contact in self.chain.contact)


def _truth(case_name: str, case: dict[str, Any]) -> Truth:
    powers = zip(map(float, case.get("stiffness", ())), map(Fraction, case.get("exponent", ())), strict=True)
    chain = Chain(np.array(case["mass"], float), [Contact(0.0, *map(float, power)) for power in powers] or GEAR)
    names = "start final opened largest_overlap peak_force time overlap force velocity"
    numbers = {name: np.array(case[name], float) for name in names.split()}
    return Truth(case_name, chain, struck=case["struck"], contact_time=float(case["contact_time"]), **numbers)


_DATA: dict[str, Any] = json.loads((Path(__file__).parent / "data" / "truth.json").read_text())
_CASES = [_truth(name, case) for name, case in _DATA.items() if "mass" in case]
GEARS = tuple(truth for truth in _CASES if truth.chain.contact[0] == GEAR)
ELASTIC = tuple(truth for truth in _CASES if truth.chain.contact[0] != GEAR)
CRITICAL_SPEEDS = {name: float(speed) for name, speed in _DATA["critical speeds of draft gears"].items()}
