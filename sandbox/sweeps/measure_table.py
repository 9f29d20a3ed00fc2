"""Table of measures. A measure is a number that a sweep computes from a simulation. A measure has a name, a unit and a
meaning.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Trajectory
from softcradle.physics.advice.unusual_numbers import unusual_warnings
from softcradle.physics.analysis.collision import CollisionMeasures, ContactMeasures, collide, measured, struck_contact
from softcradle.physics.analysis.measures import rigidity, target_beads
from softcradle.physics.methods import find_method
from softcradle.physics.simulation import solve
from softcradle.physics.status import Status, Warnings
from softcradle.sandbox.sweeps.scene_points import LaneStart
from softcradle.sandbox.user_error import StudyError
from softcradle.scenes.toml_table import suggestion

Array = NDArray[np.float64]
Value = float | int | None | Sequence[Any] | np.ndarray[Any, Any]


class Run:
    """Simulations of one lane at one point. Each simulation is computed when a measure first needs it.

    Arguments:
        start: chain, start velocities and settings.
        motion: Trajectory or final state of the simulation, if already known.
    """

    def __init__(self, start: LaneStart, motion: Trajectory | RunEnd | None = None) -> None:
        self.start = start
        if motion is not None:
            self.motion = motion  # type: ignore[assignment]

    @cached_property
    def motion(self) -> Trajectory:
        """Trajectory of the whole motion. The only samples of the Trajectory are the start and the end."""
        return solve(self.start.chain, self.start.velocity, samples=2, **self.start.settings)

    @cached_property
    def struck(self) -> int:
        """Index of the struck contact."""
        return struck_contact(self.start.velocity)

    @cached_property
    def detachment(self) -> float:
        """Time [s] of the last opening of the struck contact; NaN if it does not open, or if the simulation gave up
        earlier.
        """
        spans = self.motion.contact_intervals[self.struck]
        return spans[-1][1] if spans and math.isfinite(spans[-1][1]) else math.nan

    @cached_property
    def opened(self) -> Trajectory | None:
        """Trajectory up to the last opening of any contact; None if no contact opens."""
        ends = [end for spans in self.motion.contact_intervals for _, end in spans if math.isfinite(end)]
        if not ends:
            return None
        settings = {**self.start.settings, "duration": max(ends)}
        return solve(self.start.chain, self.start.velocity, samples=2, **settings)

    @property
    def contact_time(self) -> float:
        """Time [s] for which the struck contact was closed; NaN if it does not finally open."""
        spans = self.motion.contact_intervals[self.struck]
        return math.nan if math.isnan(self.detachment) else sum(opened - closed for closed, opened in spans)

    @cached_property
    def detached(self) -> Trajectory | None:
        """Trajectory up to the detachment of the striker; None if there is no detachment."""
        if math.isnan(self.detachment):
            return None
        settings = {**self.start.settings, "duration": self.detachment}
        return solve(self.start.chain, self.start.velocity, samples=2, **settings)

    @cached_property
    def collision(self) -> CollisionMeasures:
        """All measures of the collision, computed from a simulation with many samples."""
        # If there is no collision, this call raises an error before the simulations and not after them.
        struck_contact(self.start.velocity)
        found = collide(self.start.chain, self.start.velocity, run=solve, **self.start.settings)
        self.sampled = found
        return measured(found)

    def runs(self) -> list[Trajectory]:
        """Return all simulations that have been computed so far."""
        found = [self.__dict__.get(name) for name in ("motion", "detached", "opened", "sampled")]
        return [run for run in found if run is not None]

    @property
    def status(self) -> Status:
        """Worst status of the simulations that have been computed so far."""
        return max((run.status for run in self.runs()), default=Status.DONE)

    def spread(self, run: Trajectory | None) -> float:
        """Return the rigidity of the struck cluster at the end of the simulation `run`, or NaN if it is unknown."""
        beads = target_beads(self.start.chain, self.struck)
        known = run is not None and not run.status.gave_up and beads.size > 0
        return float(rigidity(run.final_velocity[beads])) if run is not None and known else math.nan


class RunEnd(NamedTuple):
    """Final state of a simulation that was computed together with other chains of the same shape.

    The names of the fields are those of Trajectory.
    """

    final_velocity: Array
    velocity_error: Array
    time: Array
    status: Status
    steps: int
    evaluations: int
    warnings: Warnings


def ends_of(starts: Sequence[LaneStart], workers: int | None = 1) -> list[RunEnd]:
    """Compute the final states of chains that have the same shape and settings.

    The results are bitwise equal to `solve`. The number of threads is `workers`; None means one for each core. Raise
    ValueError if the chains cannot be computed together.
    """
    from softcradle.physics.batch.chain_batch import ChainBatch
    from softcradle.physics.batch.ends import ensemble_ends

    settings = {"method": "accurate", "tolerance": 1e-8, "step": None, **starts[0].settings}
    if not find_method(settings["method"]).adaptive:
        raise ValueError("warnings of fixed steps are those of each run")
    velocity = np.array([start.velocity for start in starts])
    found = ensemble_ends(ChainBatch.of([start.chain for start in starts]), velocity, workers=workers, **settings)
    warned = [unusual_warnings(start.chain, start.velocity, settings["tolerance"]) for start in starts]
    numbers = found.steps.tolist(), found.evaluations.tolist()
    status = [Status(code) for code in found.status.tolist()]
    columns = found.final_velocity, found.velocity_error, found.time[:, None], status, *numbers, warned
    return [RunEnd(*row) for row in zip(*columns, strict=True)]


@dataclass(frozen=True)
class Measure:
    """Number, or list of numbers, that is computed from a simulation.

    Attributes
    ----------
    name : str
        Name of the variable in the Dataset.
    unit : str
        Unit, an attribute of the variable.
    meaning : str
        Description, an attribute of the variable.
    each : str
        "bead" or "contact" if the measure has one value for each of them, otherwise "".
    function : callable
        Function that returns the value for a Run; None means NaN.
    """

    name: str
    unit: str
    meaning: str
    each: str
    function: Callable[[Run], Value]


def _of_contacts(name: str) -> Callable[[Run], Value]:
    return lambda run: [getattr(contact, name) for contact in run.collision.contacts]


def _missing(name: str) -> Callable[[Run], Value]:
    """Return a function that computes which share of a quantity of the beads is missing when the last contact opens."""

    def share(run: Run) -> float:
        if run.opened is None:
            return math.nan
        values = getattr(run.opened, name)
        return 1.0 - float(values[-1] / values[0]) if values[0] else math.nan

    return share


# Measures that take little time. Most of them need only one simulation without samples, and the last one needs a
# second. All other measures need a simulation with many samples.
CHEAP = (
    Measure("final_velocity", "m/s", "velocity at the end", "bead", lambda run: run.motion.final_velocity),
    Measure("velocity_error", "m/s", "estimated error of final_velocity", "bead", lambda run: run.motion.velocity_error),
    Measure("end", "s", "time at which the run ended", "", lambda run: run.motion.time[-1]),
    Measure("steps", "", "steps that the method took", "", lambda run: run.motion.steps),
    Measure("evaluations", "", "evaluations of all contact forces", "", lambda run: run.motion.evaluations),
    Measure("closings", "", "how often each contact closed", "contact",
            lambda run: list(map(len, run.motion.contact_intervals))),
    Measure("lost_to_contacts", "J", "energy that contacts took", "", lambda run: run.motion.absorbed_by_contacts[-1]),
    Measure("lost_to_bed", "J", "energy that friction took", "", lambda run: run.motion.absorbed_by_bed[-1]),
    Measure("detachment", "s", "time of the last opening of the struck contact", "", lambda run: run.detachment),
    Measure("contact_time", "s", "for how long the struck contact was closed", "", lambda run: run.contact_time),
    Measure("missing_momentum", "", "share of the momentum at the start that is missing at the last opening of any contact", "",
            _missing("momentum")),
    Measure("missing_energy", "", "the same of the kinetic energy", "", _missing("kinetic_energy")),
    Measure("rigidity", "", "spread of the struck cluster's velocities over their mean", "", lambda run: run.spread(run.motion)),
    Measure("rigidity_at_detachment", "", "the same at the detachment", "", lambda run: run.spread(run.detached)),
)  # fmt: skip


def _collision_measures() -> tuple[Measure, ...]:
    """Return the measures of a collision. Names of measures of each contact begin with ``contact_``."""
    known = {measure.name for measure in CHEAP}
    whole = [item for item in fields(CollisionMeasures) if item.metadata and item.name not in known]
    return (
        *(
            Measure(f.name, f.metadata["unit"], f.metadata["meaning"], "", attrgetter(f"collision.{f.name}"))
            for f in whole
        ),
        *(
            Measure(f"contact_{f.name}", f.metadata["unit"], f.metadata["meaning"], "contact", _of_contacts(f.name))
            for f in fields(ContactMeasures)
        ),
    )


# Measures that a RunEnd contains.
OF_ENDS = ("final_velocity", "velocity_error", "end", "steps", "evaluations", "rigidity")
MEASURES = (*CHEAP, *_collision_measures())
MEASURE_BY_NAME = {measure.name: measure for measure in MEASURES}


def find_measure(name: str) -> Measure:
    """Return the measure called `name`. Raise StudyError if it does not exist."""
    if name not in MEASURE_BY_NAME:
        raise StudyError(f"there is no measure {name!r}{suggestion(name, MEASURE_BY_NAME)}")
    return MEASURE_BY_NAME[name]
