"""Goals of a design. The measure of a goal is made as small or large as possible, or reaches a stated value."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from softcradle.physics import Trajectory
from softcradle.physics.analysis.collision import collide
from softcradle.physics.simulation import solve
from softcradle.sandbox.motion import Array
from softcradle.sandbox.sweeps.measure_table import MEASURE_BY_NAME, OF_ENDS, Run, find_measure
from softcradle.sandbox.user_error import StudyError
from softcradle.scenes import Lane

LEAST, MOST = "least", "most"
GOAL = re.compile(
    r"(?:lane (?P<lane>\d+) )?(?:(?P<sense>least|most) )?(?P<measure>[a-z_][a-z_ ]*?)"
    r"(?: of (?P<kind>bead|contact) (?P<index>\d+))?(?: ?= ?(?P<target>[^=]+))?",
)
# Number of samples that locate the largest force of a contact while it is closed. The overlap is then interpolated.
SAMPLES = 201


@dataclass(frozen=True)
class Goal:
    """Measure of one lane that is minimised, maximised or brought to a target.

    Attributes:
        text: text of the goal.
        lane: number of the lane.
        sense: "least", "most", or "" for a goal with a target.
        measure: name of the measure.
        index: number of the bead or contact, or None.
        target: wanted value; NaN without one.
        error: half the width of a stated range of values; 0 for a single value.
        unit: unit of the measure.
    """

    text: str
    lane: int
    sense: str
    measure: str
    index: int | None
    target: float
    error: float
    unit: str

    @property
    def of_ends(self) -> bool:
        """True if the measure depends only on the final state of a simulation."""
        return self.measure in OF_ENDS or self.measure in BEAD_MEASURES

    def value(self, run: Run) -> float:
        """Return the measure of a simulation; NaN if it does not exist."""
        found = _values(self.measure, run)
        if found is None:
            return math.nan
        numbers = np.atleast_1d(np.array([math.nan if one is None else one for one in np.atleast_1d(found)], float))
        if self.index is not None:
            return float(numbers[self.index])
        # The goal must hold for the worst bead or contact.
        return float(numbers.min() if self.sense == MOST else numbers.max())


def _of_bead(each: Callable[[Array, Array], Array]) -> Callable[[Run], Array]:
    def values(run: Run) -> Array:
        return each(np.array(run.start.chain.mass), np.array(run.motion.final_velocity))

    return values


# Measures of beads at the end of a simulation that the table of measures does not contain. Each measure has a unit and
# a function of a Run.
BEAD_MEASURES: dict[str, tuple[str, Callable[[Run], Array]]] = {
    "momentum": ("N s", _of_bead(lambda mass, velocity: mass * velocity)),
    "velocity": ("m/s", _of_bead(lambda mass, velocity: velocity)),
    "energy": ("J", _of_bead(lambda mass, velocity: 0.5 * mass * velocity**2)),
}
FORCES = ("peak_force", "largest_force")  # Names of the measure "largest force of each contact".


def _values(name: str, run: Run) -> Any:
    if name in BEAD_MEASURES:
        return BEAD_MEASURES[name][1](run)
    if name in FORCES:
        return peak_forces(run)
    return MEASURE_BY_NAME[name].function(run)


def peak_forces(run: Run) -> Array:
    """Return the largest force [N] of each contact during a simulation.

    The force is computed from the interpolated largest overlap.
    """
    found = collide(run.start.chain, run.start.velocity, samples=SAMPLES, run=solve, **run.start.settings)
    run.sampled = found
    contacts = found.chain.contacts
    return np.array([_peak_force(found, k) for k in range(contacts)])


def _peak_force(run: Trajectory, contact: int) -> float:
    overlap, rate = run.overlap[:, contact], run.rate[:, contact]
    k = int(np.argmax(overlap))
    largest = float(run.force[:, contact].max())
    if overlap[k] <= 0.0:
        return largest
    depth = float(overlap[k])
    other = k + 1 if rate[k] > 0.0 else k - 1
    if 0 <= other < overlap.size and rate[k] * rate[other] < 0.0:
        # The rate is assumed to fall linearly through 0 between the two samples.
        time = float(run.time[other] - run.time[k]) * float(rate[k] / (rate[k] - rate[other]))
        depth += 0.5 * float(rate[k]) * time
    return max(largest, float(run.chain.contact[contact].force(depth)))


def goals_of(texts: Sequence[str], lanes: Sequence[Lane]) -> list[Goal]:
    """Return the goals that the texts describe. Raise StudyError if the goals do not fit together."""
    found = [_goal(text, lanes) for text in texts]
    if not found:
        raise StudyError("a design needs a goal, such as 'least peak force'")
    if len(found) > 1 and any(goal.sense for goal in found):
        raise StudyError("only goals with a stated value, such as 'momentum of bead 3 = 0.5', can be combined")
    return found


def _goal(text: str, lanes: Sequence[Lane]) -> Goal:
    match = GOAL.fullmatch(" ".join(text.lower().split()))
    if match is None:
        raise StudyError(f"a goal must be such as 'least peak force' or 'momentum of bead 3 = 0.5', not {text!r}")
    lane = int(match["lane"] or 0)
    if lane >= len(lanes):
        raise StudyError(f"goal {text!r}: lane {lane} does not exist; the scene has {len(lanes)}")
    name = match["measure"].replace(" ", "_")
    unit, each = _described(name)
    beads = len(lanes[lane].velocity)
    kind, index = match["kind"], None
    if kind is not None:
        index, count = int(match["index"]), beads - (kind == "contact")
        if kind != each:
            owner = f"of a {each}" if each else "of the whole chain"
            raise StudyError(f"goal {text!r}: {name} is a measure {owner}, not of a {kind}")
        if index >= count:
            raise StudyError(f"goal {text!r}: {kind} {index} does not exist; the numbers are 0 to {count - 1}")
    elif each == "bead":
        raise StudyError(f"goal {text!r}: name the bead, such as '{name.replace('_', ' ')} of bead {beads - 1}'")
    if match["target"] is not None and match["sense"]:
        raise StudyError(f"goal {text!r}: a stated value and {match['sense']!r} exclude each other")
    target, error = (math.nan, 0.0) if match["target"] is None else _target(match["target"], text)
    sense = match["sense"] or (MOST if match["target"] is None else "")
    shown = text.strip() if match["sense"] or not sense else f"{MOST} {text.strip()}"
    return Goal(shown, lane, sense, name, index, target, error, unit)


def _described(name: str) -> tuple[str, str]:
    """Return the unit of a measure, and "bead" or "contact" if it belongs to one, or "".

    Raise StudyError if the measure is unknown.
    """
    if name in BEAD_MEASURES:
        return BEAD_MEASURES[name][0], "bead"
    if name in FORCES:
        return "N", "contact"
    measure = find_measure(name)
    return measure.unit, measure.each


def _target(text: str, goal: str) -> tuple[float, float]:
    """Return the middle and half the width of a stated range. Percentages are allowed. A single value has width 0."""
    unit = 0.01 if text.strip().endswith("%") else 1.0
    try:
        parts = [unit * float(part) for part in text.strip().rstrip("%").split("..")]
    except ValueError:
        parts = []
    if not 1 <= len(parts) <= 2 or not all(map(math.isfinite, parts)) or parts[-1] < parts[0]:
        raise StudyError(
            f"goal {goal!r}: the value must be a number or a range such as 0.05..0.1, not {text.strip()!r}"
        )
    return 0.5 * (parts[0] + parts[-1]), 0.5 * (parts[-1] - parts[0])
