"""The table of measures: every number that a sweep can take of a run, one line each, by name, with unit and meaning."""

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
    """One lane at one point: its runs, each computed when a measure asks for it.

    Arguments:
        start: what moves.
        motion: its Trajectory, where that is known already.
    """

    def __init__(self, start: LaneStart, motion: Trajectory | RunEnd | None = None) -> None:
        self.start = start
        if motion is not None:
            self.motion = motion  # type: ignore[assignment]

    @cached_property
    def motion(self) -> Trajectory:
        """The run to its end, with its start and its end as samples."""
        return solve(self.start.chain, self.start.velocity, samples=2, **self.start.settings)

    @cached_property
    def struck(self) -> int:
        """The contact that is struck."""
        return struck_contact(self.start.velocity)

    @cached_property
    def detachment(self) -> float:
        """When the struck contact opens last [s]; nan where it does not, or where the run gave up before."""
        spans = self.motion.contact_intervals[self.struck]
        return spans[-1][1] if spans and math.isfinite(spans[-1][1]) else math.nan

    @property
    def contact_time(self) -> float:
        """For how long the struck contact was closed [s]; nan where it does not open for good."""
        spans = self.motion.contact_intervals[self.struck]
        return math.nan if math.isnan(self.detachment) else sum(opened - closed for closed, opened in spans)

    @cached_property
    def detached(self) -> Trajectory | None:
        """The run up to the detachment; None without one."""
        if math.isnan(self.detachment):
            return None
        settings = {**self.start.settings, "duration": self.detachment}
        return solve(self.start.chain, self.start.velocity, samples=2, **settings)

    @cached_property
    def collision(self) -> CollisionMeasures:
        """All measures of the collision, of a run with fine samples."""
        struck_contact(self.start.velocity)  # without a collision every measure of it fails before two runs, not after
        found = collide(self.start.chain, self.start.velocity, run=solve, **self.start.settings)
        self.sampled = found
        return measured(found)

    def runs(self) -> list[Trajectory]:
        """All runs that were computed."""
        found = [self.__dict__.get(name) for name in ("motion", "detached", "sampled")]
        return [run for run in found if run is not None]

    @property
    def status(self) -> Status:
        """The worst status of these runs."""
        return max((run.status for run in self.runs()), default=Status.DONE)

    def spread(self, run: Trajectory | None) -> float:
        """The rigidity of the struck cluster at the end of `run`; nan where that is unknown."""
        beads = target_beads(self.start.chain, self.struck)
        known = run is not None and not run.status.gave_up and beads.size > 0
        return float(rigidity(run.final_velocity[beads])) if run is not None and known else math.nan


class RunEnd(NamedTuple):
    """What is known of a run whose chain ran beside others of its shape; names are those of a Trajectory."""

    final_velocity: Array
    velocity_error: Array
    time: Array
    status: Status
    steps: int
    evaluations: int
    warnings: Warnings


def ends_of(starts: Sequence[LaneStart]) -> list[RunEnd]:
    """How runs of one shape and with the same settings end, to the digits of `solve`. ValueError where they cannot run so."""
    from softcradle.physics.batch.chain_batch import ChainBatch
    from softcradle.physics.batch.ends import ensemble_ends

    settings = {"method": "accurate", "tolerance": 1e-8, "step": None, **starts[0].settings}
    if not find_method(settings["method"]).adaptive:
        raise ValueError("warnings of fixed steps are those of each run")
    velocity = np.array([start.velocity for start in starts])
    found = ensemble_ends(ChainBatch.of([start.chain for start in starts]), velocity, workers=1, **settings)
    warned = [unusual_warnings(start.chain, start.velocity, settings["tolerance"]) for start in starts]
    numbers = found.steps.tolist(), found.evaluations.tolist()
    status = [Status(code) for code in found.status.tolist()]
    columns = found.final_velocity, found.velocity_error, found.time[:, None], status, *numbers, warned
    return [RunEnd(*row) for row in zip(*columns, strict=True)]


@dataclass(frozen=True)
class Measure:
    """One measure of a run.

    Attributes
    ----------
    name : str
        Name of its variable in the Dataset.
    unit : str
        Its unit, an attribute of the variable.
    meaning : str
        A sentence, another attribute.
    each : str
        "bead" or "contact" where it has a number for each of these, else "".
    function : callable
        Gives the value for a Run; None is nan.
    """

    name: str
    unit: str
    meaning: str
    each: str
    function: Callable[[Run], Value]


def _of_contacts(name: str) -> Callable[[Run], Value]:
    return lambda run: [getattr(contact, name) for contact in run.collision.contacts]


# Those of the run to its end alone cost least; two runs; one with fine samples.
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
    Measure("rigidity", "", "spread of the struck cluster's velocities over their mean", "", lambda run: run.spread(run.motion)),
    Measure("rigidity_at_detachment", "", "the same at the detachment", "", lambda run: run.spread(run.detached)),
)  # fmt: skip


def _collision_measures() -> tuple[Measure, ...]:
    """The numbers of `measured`, and those of each contact as ``contact_...``."""
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


OF_ENDS = ("final_velocity", "velocity_error", "end", "steps", "evaluations", "rigidity")  # all that a RunEnd tells
MEASURES = (*CHEAP, *_collision_measures())
MEASURE_BY_NAME = {measure.name: measure for measure in MEASURES}


def find_measure(name: str) -> Measure:
    """The measure of that name. Raises StudyError."""
    if name not in MEASURE_BY_NAME:
        raise StudyError(f"there is no measure {name!r}{suggestion(name, MEASURE_BY_NAME)}")
    return MEASURE_BY_NAME[name]
