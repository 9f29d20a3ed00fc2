"""Model of a fit. The model predicts the data from the free values with `solve`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, Trajectory
from softcradle.physics.methods import find_method
from softcradle.physics.simulation import LEAST_TIME, solve
from softcradle.sandbox.measured_table import FORCE, POSITION
from softcradle.sandbox.motion import Array
from softcradle.sandbox.scene_runs import TOLD
from softcradle.sandbox.studies.fitting.observations import Observation
from softcradle.sandbox.studies.fitting.parameters import OFFSET, START, FreeValues
from softcradle.sandbox.user_error import StudyError
from softcradle.scenes.scene_errors import SceneError

# Tolerance of the simulations if the scene does not set it. Derivatives are differences of simulations, so the
# tolerance is far below any noise.
TOLERANCE = 1e-10


@dataclass
class MotionModel:
    """Motion of one lane at the times of the data, for any free values.

    Attributes:
        free: the free values.
        lane: number of the lane.
        time: (T,) times of the data [s].
        observed: the columns of data.
        runs: number of simulations so far.
    """

    free: FreeValues
    lane: int
    time: Array
    observed: Sequence[Observation]
    runs: int = 0
    _offsets: dict[int, int] = field(init=False, default_factory=dict)
    _start: int | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        for k, one in enumerate(self.free.values):
            kind, _, number = one.path.partition(" ")
            if kind == OFFSET:
                self._offsets[int(number)] = k
            elif kind == START:
                self._start = k
        scene = self.free.points.scene
        settings = scene.settings()
        method = settings.get("method", TOLD)
        if method == "auto" or find_method(method).adaptive:
            settings = {"tolerance": TOLERANCE, **settings}
        self.settings = {key: value for key, value in settings.items() if key != "duration"}
        self.present = [np.isfinite(one.values) for one in self.observed]
        self.data = np.concatenate([one.values[known] for one, known in zip(self.observed, self.present, strict=True)])
        self.which = np.repeat(np.arange(len(self.observed)), [int(known.sum()) for known in self.present])

    @property
    def tolerance(self) -> float:
        """Tolerance of the simulations. The tolerance is TOLERANCE if the scene does not set a tolerance."""
        return float(self.settings.get("tolerance", TOLERANCE))

    def start_time(self, values: Sequence[float]) -> float:
        """Return the time at which the motion of the scene begins, on the time axis of the data [s]."""
        return 0.0 if self._start is None else values[self._start]

    def motion(self, values: Sequence[float]) -> tuple[Trajectory, NDArray[np.int64]]:
        """Return the simulation with samples at the times of the data, and the (T,) indices of its samples.

        Raise ValueError if the scene does not accept the values. Raise StudyError if the simulation gave up.
        """
        try:
            start = self.free.points.starts(self.free.of_scene(values))[self.lane]
        except SceneError as error:
            raise StudyError(str(error)) from None
        time = self.time - self.start_time(values)
        early = time < 0.0
        if early.any() and not starts_freely(start.chain):
            raise StudyError(
                "the data begin before the scene, whose beads do not move freely at its start; add --free start"
            )
        later = np.where(time < LEAST_TIME, 0.0, time)
        samples, which = np.unique(np.append(later, 0.0), return_inverse=True)
        self.runs += 1
        end = float(samples[-1])
        run = solve(start.chain, start.velocity, end, samples=samples, **self.settings)
        if run.status.gave_up or run.time.size < samples.size:
            raise StudyError("the run of the scene gave up before the end of the data")
        return run, which[:-1].astype(np.int64)

    def predicted(self, values: Sequence[float]) -> Array:
        """Return the predictions for all data that are present. Raise the same errors as `motion`."""
        run, which = self.motion(values)
        early = np.minimum(self.time - self.start_time(values), 0.0)
        found = []
        for k, (one, known) in enumerate(zip(self.observed, self.present, strict=True)):
            rows = which[known]
            if one.quantity == POSITION:
                column = run.position[rows, one.index] + early[known] * run.velocity[0, one.index]
                column = column + (values[self._offsets[k]] if k in self._offsets else 0.0)
            elif one.quantity == FORCE:
                column = np.where(early[known] < 0.0, 0.0, run.force[rows, one.index])
            else:
                column = run.velocity[rows, one.index]
            found.append(column)
        return np.concatenate(found)

    def with_offsets(self, values: Sequence[float], predicted: Array) -> tuple[list[float], Array]:
        """Return the values and predictions with the best offsets. An offset is the mean difference of data and
        prediction.
        """
        better, shifted = list(values), predicted.copy()
        for k, at in self._offsets.items():
            rows = self.which == k
            best = better[at] + float(np.mean(self.data[rows] - predicted[rows]))
            best = float(np.clip(best, self.free.values[at].low, self.free.values[at].high))
            shifted[rows] += best - better[at]
            better[at] = best
        return better, shifted

    def with_slopes(self, values: Sequence[float], beads: Mapping[int, str]) -> list[float]:
        """Return the values with start velocities estimated from the first tenth of the data.

        Only the paths of single `beads` are changed.
        """
        better = list(values)
        for k, one in enumerate(self.free.values):
            bead = next((bead for bead, path in beads.items() if path == one.path), None)
            found = math.nan if bead is None else self._first_speed(bead)
            if math.isfinite(found):
                better[k] = float(np.clip(found, one.low, one.high))
        return better

    def _first_speed(self, bead: int) -> float:
        for one, known in zip(self.observed, self.present, strict=True):
            if one.quantity != FORCE and one.index == bead:
                count = min(max(3, known.sum() // 10), known.sum())
                time, values = self.time[known][:count], one.values[known][:count]
                if one.quantity != POSITION:
                    return float(values.mean())
                return float(np.polyfit(time - time[0], values, 1)[0]) if count > 1 else math.nan
        return math.nan


def starts_freely(chain: Chain) -> bool:
    """Return True if the beads move with constant velocities before the start of the scene."""
    free = chain.drive is None and not chain.forces and not chain.brakes and not chain.friction
    return free and min(chain.gap) >= 0.0
