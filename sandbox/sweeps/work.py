"""Work of a sweep: the scene or function with its points and measures, and the computation of one chunk of points.

Each process that takes part in the sweep gets a copy of the work.
"""

import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import lru_cache, partial
from itertools import islice
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, Trajectory
from softcradle.physics.checked_input import shown
from softcradle.physics.status import Status
from softcradle.sandbox.sweeps.measure_table import OF_ENDS, Measure, Run, RunEnd, Value, ends_of, find_measure
from softcradle.sandbox.sweeps.sample_points import Points
from softcradle.sandbox.sweeps.scene_points import LaneStart, ScenePoints
from softcradle.sandbox.user_error import StudyError
from softcradle.scenes import Scene, load
from softcradle.scenes.scene_errors import SceneError

Array = NDArray[np.float64]


AT_ONCE = 64  # Number of points that are prepared together and may be computed in one call.
# Number of fast points that are prepared together. A block of this size must stay within the time of a chunk. A larger
# block contains more chains of one shape.
MOST_AT_ONCE = 256
# Smallest number of chains of one shape that are computed in one call. Fewer chains are faster separately.
LEAST_ALIKE = 4
# Names of the columns in addition to the measures. The colon distinguishes them from names of measures.
STATUS, WARNED, REASON = ":status", ":warned", ":reason"
WORTH_KERNELS = 1000  # Number of points from which on the kernels for several chains are compiled in the background.
# Reserved names, which parameters and measures cannot have.
TAKEN = ("point", "lane", "bead", "contact", "status", "warned", "reason")
UNLIKE = "a measure is a number at one point and a list at another"


class PointStatus(IntEnum):
    """Status of a point. All values except REFUSED and LOST are those of :class:`softcradle.physics.status.Status`."""

    DONE = 0
    SEPARATED = 1
    OUT_OF_STEPS = 2
    FAILED = 3
    UNDETERMINED = 4
    REFUSED = 5  # The point is invalid, or its function raised an error; the reason contains the message.
    LOST = 6  # The process that computed the point died in every attempt.
    BUDGET_SPENT = 7


@dataclass(frozen=True)
class Outcome:
    """Result of one point: its numbers by name, its status, its number of warnings, and the reason if something failed."""

    values: Mapping[str, Any]
    status: PointStatus = PointStatus.DONE
    warned: int = 0
    reason: str = ""


@dataclass(frozen=True)
class Chunk:
    """Computed points with consecutive numbers.

    Attributes:
        begin, end: number of the first point, and number after the last point.
        columns: arrays (end - begin, ...) by name of the measure; NaN if a number is missing. The columns STATUS,
            WARNED and REASON are included.
        seconds: computing time [s].
    """

    begin: int
    end: int
    columns: dict[str, NDArray[Any]]
    seconds: float = 0.0

    @property
    def count(self) -> int:
        """Number of points in the chunk."""
        return self.end - self.begin


@dataclass(frozen=True)
class Work:
    """Description of a sweep that is sent to the processes that compute it.

    Attributes:
        points: the sample points.
        source: a scene, or a function of the parameters by name. The function returns a mapping of names to numbers, an
            Outcome, a Trajectory, (chain, start velocities) or (chain, start velocities, keywords of `simulate`).
        measures: measures of every simulation; those of the table by name.
        versions: versions of the computing code. A process with other versions refuses the work.
    """

    points: Points
    source: ScenePoints | Callable[..., Any]
    measures: tuple[str | Measure, ...]
    versions: Mapping[str, str]

    @property
    def lanes(self) -> list[str]:
        """Labels of the lanes of the scene, or their numbers if the labels are empty.

        A function has a single empty label.
        """
        lanes = self.source.scene.lanes if isinstance(self.source, ScenePoints) else ()
        return [lane.label or str(k) for k, lane in enumerate(lanes)] or [""]

    @property
    def lengths(self) -> dict[str, int]:
        """Lengths of the dimensions inside a point for the unchanged scene.

        The mapping is empty for a function, because its lengths are unknown.
        """
        lanes = self.source.scene.lanes if isinstance(self.source, ScenePoints) else ()
        beads = max((len(lane.velocity) for lane in lanes), default=0)
        return {"lane": len(lanes), "bead": beads, "contact": beads - 1} if lanes else {}

    @property
    def title(self) -> str:
        """Title of the scene, or name of the function."""
        return self.source.scene.title if isinstance(self.source, ScenePoints) else function_name(self.source)

    def compute(self, begin: int, end: int, seconds: float = math.inf) -> Chunk:
        """Compute the points from `begin` up to `end`, or until `seconds` have passed. At least one point is computed."""
        began, outcomes = perf_counter(), list[Outcome]()
        points = self.points.rows(begin, end, AT_ONCE)
        size = AT_ONCE if self._runs_at_once() else 1
        while (not outcomes or perf_counter() - began <= seconds) and (block := [*islice(points, size)]):
            outcomes += self._at_once(block) if size > 1 else map(self.outcome, block)
            pace = (perf_counter() - began) / len(outcomes)
            size = MOST_AT_ONCE if size > 1 and MOST_AT_ONCE * pace < seconds else size
        return packed(begin, outcomes, perf_counter() - began)

    def _runs_at_once(self) -> bool:
        """Return True if several chains can be computed together.

        Such a computation requires that only final states are measured, and that the kernels for several chains are
        available. If a large sweep lacks these kernels, their compilation is started in the background.
        """
        from softcradle.physics.batch.ends import TIERS

        ends_alone = isinstance(self.source, ScenePoints) and set(self.measures) <= set(OF_ENDS)
        kernels = TIERS["batch-adaptive"]
        if ends_alone and not kernels.in_memory and not kernels.on_disk and self.points.count >= WORTH_KERNELS:
            kernels.compile_behind()
        return ends_alone and (kernels.in_memory or kernels.on_disk)

    def _at_once(self, points: Sequence[Mapping[str, Any]]) -> list[Outcome]:
        """Compute several points. Chains with the same shape and settings are computed in one call.

        The results are bitwise the same as for separate points. A point is computed separately if its shape is too
        rare, if its simulation does not end normally, or if it cannot be measured.
        """
        lanes = [self._starts(values) for values in points]
        alike: dict[Any, list[LaneStart]] = {}
        for start in (start for own in lanes for start in own):
            alike.setdefault((start.chain.contacts, *sorted(start.settings.items())), []).append(start)
        ends: dict[int, RunEnd] = {}  # The key is the identity of a LaneStart.
        for group in alike.values():
            if len(group) >= LEAST_ALIKE:
                # Some chains cannot be computed together. The separate computation of the point reports the problem.
                with suppress(Exception):
                    ends.update(zip(map(id, group), ends_of(group), strict=True))
        return [
            self._beside(values, own, [ends.get(id(start)) for start in own])
            for values, own in zip(points, lanes, strict=True)
        ]

    def _starts(self, values: Mapping[str, Any]) -> list[LaneStart]:
        """Return the initial state of each lane at a point.

        The list is empty if the point is invalid. The separate computation of the point then reports the reason.
        """
        with suppress(Exception):
            return self.source.starts(values)  # type: ignore[union-attr]
        return []

    def _beside(self, values: Mapping[str, Any], starts: Sequence[LaneStart], ends: Sequence[RunEnd | None]) -> Outcome:
        """Return the outcome of a point from the final states of its chains.

        If a final state is missing (None), compute the point separately.
        """
        if ends and all(end is not None and end.status in (Status.DONE, Status.SEPARATED) for end in ends):
            # Numbers of the lanes that differ in shape cause an error. The separate computation of the point reports
            # the problem.
            with suppress(Exception):
                return self._measured([Run(*both) for both in zip(starts, ends, strict=True)])
        return self.outcome(values)

    def outcome(self, values: Mapping[str, Any]) -> Outcome:
        """Compute one point. If an error occurs, it determines the status and the reason of the point."""
        try:
            if isinstance(self.source, ScenePoints):
                return self._measured([Run(start) for start in self.source.starts(values)])
            found = self.source(**{axis.coordinate: values[axis.path] for axis in self.points.axes})
            if isinstance(found, Mapping):
                found = Outcome(found)
            elif not isinstance(found, Outcome):
                return self._measured([_run_of(found)])
            return replace(found, values={name: _number_of(name, value) for name, value in found.values.items()})
        except Exception as error:  # An error at one point, or in a user's function, must not stop the others.
            return Outcome({}, PointStatus.REFUSED, 0, _sentence_of(error))

    def _measured(self, runs: Sequence[Run]) -> Outcome:
        """Compute all measures of all lanes at a point. A measure that fails becomes NaN."""
        measures = [find_measure(item) if isinstance(item, str) else item for item in self.measures]
        numbers: dict[str, Array] = {}
        # Maps each reason for which measures fail to the names of these measures.
        without: dict[str, dict[str, None]] = {}

        def taken(measure: Measure, run: Run) -> Array | None:
            try:
                return _number_of(measure.name, measure.function(run))
            except Exception as error:
                # If the simulation itself is invalid, this raises its error. The measure is then not the cause.
                _ = run.motion
                without.setdefault(_sentence_of(error), {})[measure.name] = None
                return None

        for measure in measures:
            each = [taken(measure, run) for run in runs]
            if any(value is not None for value in each):
                numbers[measure.name] = stacked(each) if len(each) > 1 else each[0]  # type: ignore[assignment]
        status = PointStatus(max(run.status for run in runs))
        warnings = [str(warning) for run in runs for one in run.runs() for warning in one.warnings]
        bad = status not in (PointStatus.DONE, PointStatus.SEPARATED)
        told = (warnings[:1] if bad else []) + [f"{', '.join(names)}: {why}" for why, names in without.items()]
        return Outcome(numbers, status, len(warnings), "; ".join(told))


def _run_of(found: Any) -> Run:
    """Return the Run for the value that a function returned."""
    if isinstance(found, Trajectory):
        return Run(LaneStart(found.chain, found.velocity[0], _settings_of(found)), found)
    if isinstance(found, tuple) and len(found) in (2, 3) and isinstance(found[0], Chain):
        return Run(LaneStart(found[0], found[1], found[2] if len(found) == 3 else {}))
    kinds = "numbers by name, a Trajectory, or (chain, velocity)"
    raise StudyError(f"the function must return {kinds}, not {type(found).__name__}")


def _settings_of(found: Trajectory) -> dict[str, Any]:
    """Return the keyword arguments of `simulate` that reproduce a Trajectory.

    Raise StudyError if the samples of the Trajectory do not include its start and its end.
    """
    whole = found.status.gave_up or np.allclose(found.velocity[-1], found.final_velocity, rtol=1e-9, atol=1e-9)
    if found.time[0] != 0.0 or not whole:
        raise StudyError("the samples of a Trajectory that is measured must begin and end with its run")
    fineness = {"step": found.step} if found.step else {"tolerance": found.tolerance}
    duration = None if found.status is Status.SEPARATED else float(found.time[-1])
    return {"duration": duration, "method": found.method, **fineness}


def _sentence_of(error: BaseException) -> str:
    """Return the message of an error in one line. The name of the error precedes the message, except for ValueError."""
    text = " ".join(str(error).split())
    return text if isinstance(error, ValueError) and text else f"{type(error).__name__}: {text}".rstrip(": ")


def _number_of(name: str, value: Any) -> Array:
    """Return the value of a measure as an array. Raise StudyError if it is not numeric."""
    with suppress(TypeError, ValueError):
        if not np.iscomplexobj(value):
            return as_floats(value)
    raise StudyError(f"{name!r} must be a number or a list of numbers, not {shown(value)}")


def as_floats(value: Value) -> Array:
    """Return a number or a list of numbers as an array; None becomes NaN."""
    return np.asarray(np.nan if value is None else value, dtype=np.float64)


def stacked(arrays: Sequence[Array | None]) -> Array:
    """Return the arrays stacked to shape (N, ...) and padded with NaN to the largest shape. None becomes a row of NaN."""
    given = [array for array in arrays if array is not None]
    if len({array.ndim for array in given}) > 1:
        raise StudyError(UNLIKE)
    shape = np.max([array.shape for array in given], axis=0).astype(int) if given and given[0].ndim else ()
    found = np.full((len(arrays), *shape), np.nan)
    for row, array in enumerate(arrays):
        if array is not None:
            places: tuple[Any, ...] = (row, *(slice(0, length) for length in array.shape))
            found[places] = array
    return found


def packed(begin: int, outcomes: Sequence[Outcome], seconds: float = 0.0) -> Chunk:
    """Return the outcomes of the points from `begin` on as a chunk of arrays."""
    names = dict.fromkeys(name for outcome in outcomes for name in outcome.values)
    columns: dict[str, NDArray[Any]] = {
        name: stacked([as_floats(o.values[name]) if name in o.values else None for o in outcomes]) for name in names
    }
    columns[STATUS] = np.array([outcome.status for outcome in outcomes], dtype=np.int8)
    columns[WARNED] = np.array([outcome.warned for outcome in outcomes], dtype=np.int32)
    columns[REASON] = np.array([outcome.reason for outcome in outcomes], dtype=str)
    return Chunk(begin, begin + len(outcomes), columns, seconds)


def merged(chunks: Sequence[Chunk], count: int) -> dict[str, NDArray[Any]]:
    """Return the columns of all chunks together. Missing numbers are NaN.

    Raise StudyError if a measure is a number in one chunk and a list in another.
    """
    columns: dict[str, NDArray[Any]] = {}
    for name in dict.fromkeys(name for chunk in chunks for name in chunk.columns):
        parts = {chunk.begin: chunk.columns[name] for chunk in chunks if name in chunk.columns}
        first = next(iter(parts.values()))
        if any(part.ndim != first.ndim for part in parts.values()):
            raise StudyError(UNLIKE)
        shape = [max(lengths) for lengths in zip(*(part.shape[1:] for part in parts.values()), strict=True)]
        kind, empty = (object, "") if name == REASON else (first.dtype, 0 if name in (STATUS, WARNED) else np.nan)
        columns[name] = np.full((count, *shape), empty, kind)
        for begin, part in parts.items():
            columns[name][(slice(begin, begin + len(part)), *map(slice, part.shape[1:]))] = part
    return columns


def lost(begin: int, times: int) -> Chunk:
    """Return the chunk of the single point `begin`, whose process died `times` times."""
    return packed(begin, [Outcome({}, PointStatus.LOST, 0, f"the process that computed it died, {times} times")])


@lru_cache(maxsize=1)
def current_versions() -> dict[str, str]:
    """Return the versions of everything that the numbers of a sweep depend on."""
    import scipy
    from softcradle.physics.source_digest import PHYSICS, digest_of
    from softcradle.physics.trajectory_file import versions

    compiled = "no" if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0") else "yes"
    return {**versions(), "scipy": scipy.__version__, "compiled": compiled, "source": digest_of(PHYSICS.rglob("*.py"))}


def compute_checked(work: Work, begin: int, end: int, seconds: float) -> Chunk:
    """Compute a chunk in another process.

    Raise StudyError if the version of the code in this process differs from the version of the sweep.
    """
    own = current_versions()
    for name, wanted in work.versions.items():
        if own[name] != wanted:
            raise StudyError(
                f"a worker has {name} {own[name]}, but the sweep was begun with {wanted}: install the same there"
            )
    return work.compute(begin, end, seconds)


def sweep_work(what: Scene | str | Callable[..., Any], points: Points, measures: Sequence[str | Measure]) -> Work:
    """Return the Work of a sweep. All checks that are possible before the start are done first.

    Raise StudyError or SceneError if a check fails.
    """
    names = [find_measure(item).name if isinstance(item, str) else item.name for item in measures]
    check_names("parameter", [axis.coordinate for axis in points.axes], names)
    check_names("measure", names)
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise StudyError(f"measure {twice!r} is given twice")
    if callable(what) and not isinstance(what, Scene):
        source: ScenePoints | Callable[..., Any] = what
    else:
        source = ScenePoints(what if isinstance(what, Scene) else load(str(what)))
        if not measures:
            raise StudyError("a sweep of a scene needs at least one measure")
        _check(source, points)
    return Work(points, source, tuple(measures), current_versions())


def check_names(what: str, names: Iterable[Any], others: Sequence[str] = ()) -> None:
    """Raise StudyError if one of `names` cannot be the name of a variable of the Dataset.

    Names in `others` are already used.
    """
    for name in names:
        if not (isinstance(name, str) and name) or name in (*TAKEN, *others) or set(name) & set(" /"):
            raise StudyError(f"a {what} cannot be called {name!r}: give it another name")


def check_columns(chunk: Chunk, work: Work, known: dict[str, int]) -> None:
    """Raise StudyError if the Dataset cannot hold the numbers that a function returned.

    The mapping `known` contains the number of dimensions of each column so far, and is updated.
    """
    columns = {name: column for name, column in chunk.columns.items() if name not in (STATUS, WARNED, REASON)}
    inner = [f"{name}_item" for name, column in columns.items() if column.ndim > 1]
    check_names("measure", columns, [*inner, *(axis.coordinate for axis in work.points.axes)])
    for name, column in columns.items():
        if known.setdefault(name, column.ndim) != column.ndim:
            raise StudyError(UNLIKE)


def _check(source: ScenePoints, points: Points) -> None:
    """Raise StudyError if a path does not exist in the scene, or if the first or last value of an axis is invalid."""
    first = {axis.path: axis.ends()[0] for axis in points.axes}
    for changed in [first, *(first | {axis.path: axis.ends()[1]} for axis in points.axes)]:
        try:
            source.checked(changed)
        except SceneError as error:
            raise StudyError(str(error).removeprefix("the scene: ")) from None


def function_name(function: Any) -> str:
    """Return the name of a function with its module."""
    if isinstance(function, partial):
        return f"partial({function_name(function.func)})"
    return f"{getattr(function, '__module__', '?')}.{getattr(function, '__qualname__', type(function).__name__)}"
