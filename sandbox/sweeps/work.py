"""The work of a sweep: what is swept, checked, and what every process that takes part computes, one chunk of points at a time."""

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


AT_ONCE = 64  # points that are read at once, and may run side by side
MOST_AT_ONCE = 256  # of them where they are so quick that these take no longer than a chunk should: more are alike
LEAST_ALIKE = 4  # chains of one shape that run side by side: fewer cost less alone
STATUS, WARNED, REASON = ":status", ":warned", ":reason"  # columns beside the measures, by names that none of these has
WORTH_KERNELS = 1000  # points of a sweep for which the kernels of such runs are compiled behind it
TAKEN = ("point", "lane", "bead", "contact", "status", "warned", "reason")  # names of no parameter or measure
UNLIKE = "a measure is a number at one point and a list at another"


class PointStatus(IntEnum):
    """What became of a point; all but REFUSED and LOST are those of a run, :class:`softcradle.physics.status.Status`."""

    DONE = 0
    SEPARATED = 1
    OUT_OF_STEPS = 2
    FAILED = 3
    UNDETERMINED = 4
    REFUSED = 5  # the point cannot be, or its function raised an error: the reason says which
    LOST = 6  # the process that computed it died, each time
    BUDGET_SPENT = 7


@dataclass(frozen=True)
class Outcome:
    """One point: its numbers by name, its status, how many warnings there were, and what went wrong."""

    values: Mapping[str, Any]
    status: PointStatus = PointStatus.DONE
    warned: int = 0
    reason: str = ""


@dataclass(frozen=True)
class Chunk:
    """Computed points.

    Attributes:
        begin, end: their numbers.
        columns: arrays (end - begin, ...) by the name of a measure, nan where there is no number; STATUS, WARNED, REASON.
        seconds: what it took.
    """

    begin: int
    end: int
    columns: dict[str, NDArray[Any]]
    seconds: float = 0.0

    @property
    def count(self) -> int:
        """How many points it has."""
        return self.end - self.begin


@dataclass(frozen=True)
class Work:
    """A sweep as it is sent to the processes that compute it.

    Attributes:
        points: the sample points.
        source: a scene, or a function of the parameters by name. The function returns numbers by name, an Outcome, a
            Trajectory, a (chain, start velocities), or these and keywords of `simulate`.
        measures: what is taken of every run; those of the table by name.
        versions: of what computes it; a process with others refuses.
    """

    points: Points
    source: ScenePoints | Callable[..., Any]
    measures: tuple[str | Measure, ...]
    versions: Mapping[str, str]

    @property
    def lanes(self) -> list[str]:
        """The labels of the scene's lanes, numbers where they have none; one for a function."""
        lanes = self.source.scene.lanes if isinstance(self.source, ScenePoints) else ()
        return [lane.label or str(k) for k, lane in enumerate(lanes)] or [""]

    @property
    def lengths(self) -> dict[str, int]:
        """How long the dimensions within a point are for the scene as it is; nothing for a function, which does not tell."""
        lanes = self.source.scene.lanes if isinstance(self.source, ScenePoints) else ()
        beads = max((len(lane.velocity) for lane in lanes), default=0)
        return {"lane": len(lanes), "bead": beads, "contact": beads - 1} if lanes else {}

    @property
    def title(self) -> str:
        """The title of the scene, or the name of the function."""
        return self.source.scene.title if isinstance(self.source, ScenePoints) else function_name(self.source)

    def compute(self, begin: int, end: int, seconds: float = math.inf) -> Chunk:
        """The points from `begin` on, up to `end` or until `seconds` have passed, at least one."""
        began, outcomes = perf_counter(), list[Outcome]()
        points = self.points.rows(begin, end, AT_ONCE)
        size = AT_ONCE if self._runs_at_once() else 1
        while (not outcomes or perf_counter() - began <= seconds) and (block := [*islice(points, size)]):
            outcomes += self._at_once(block) if size > 1 else map(self.outcome, block)
            pace = (perf_counter() - began) / len(outcomes)
            size = MOST_AT_ONCE if size > 1 and MOST_AT_ONCE * pace < seconds else size
        return packed(begin, outcomes, perf_counter() - began)

    def _runs_at_once(self) -> bool:
        """Whether ends of runs are all that is measured, and the kernels that run chains side by side are at hand."""
        from softcradle.physics.batch.ends import TIERS

        ends_alone = isinstance(self.source, ScenePoints) and set(self.measures) <= set(OF_ENDS)
        kernels = TIERS["batch-adaptive"]
        if ends_alone and not kernels.in_memory and not kernels.on_disk and self.points.count >= WORTH_KERNELS:
            kernels.compile_behind()
        return ends_alone and (kernels.in_memory or kernels.on_disk)

    def _at_once(self, points: Sequence[Mapping[str, Any]]) -> list[Outcome]:
        """Points whose chains run side by side, those of one shape and with the same settings in one call, to the same digits.

        Those that are alone of their shape, do not end as they should, or cannot be measured, run alone.
        """
        lanes = [self._starts(values) for values in points]
        alike: dict[Any, list[LaneStart]] = {}
        for start in (start for own in lanes for start in own):
            alike.setdefault((start.chain.contacts, *sorted(start.settings.items())), []).append(start)
        ends: dict[int, RunEnd] = {}  # by the identity of a start
        for group in alike.values():
            if len(group) >= LEAST_ALIKE:
                with suppress(Exception):  # of chains that cannot run so; alone each tells what is wrong with it
                    ends.update(zip(map(id, group), ends_of(group), strict=True))
        return [
            self._beside(values, own, [ends.get(id(start)) for start in own])
            for values, own in zip(points, lanes, strict=True)
        ]

    def _starts(self, values: Mapping[str, Any]) -> list[LaneStart]:
        """What moves at a point; nothing where it cannot be, which the point alone tells."""
        with suppress(Exception):
            return self.source.starts(values)  # type: ignore[union-attr]
        return []

    def _beside(self, values: Mapping[str, Any], starts: Sequence[LaneStart], ends: Sequence[RunEnd | None]) -> Outcome:
        """A point whose chains ended so beside others; None where one did not run."""
        if ends and all(end is not None and end.status in (Status.DONE, Status.SEPARATED) for end in ends):
            with suppress(Exception):  # of lanes whose numbers are unlike: likewise
                return self._measured([Run(*both) for both in zip(starts, ends, strict=True)])
        return self.outcome(values)

    def outcome(self, values: Mapping[str, Any]) -> Outcome:
        """One point. What goes wrong with it is its status and reason."""
        try:
            if isinstance(self.source, ScenePoints):
                return self._measured([Run(start) for start in self.source.starts(values)])
            found = self.source(**{axis.coordinate: values[axis.path] for axis in self.points.axes})
            if isinstance(found, Mapping):
                found = Outcome(found)
            elif not isinstance(found, Outcome):
                return self._measured([_run_of(found)])
            return replace(found, values={name: _number_of(name, value) for name, value in found.values.items()})
        except Exception as error:  # whatever a point or a user's function does, the others go on
            return Outcome({}, PointStatus.REFUSED, 0, _sentence_of(error))

    def _measured(self, runs: Sequence[Run]) -> Outcome:
        """What is measured of the runs of all lanes at a point; a measure that cannot be taken of one has no number there."""
        measures = [find_measure(item) if isinstance(item, str) else item for item in self.measures]
        numbers: dict[str, Array] = {}
        without: dict[str, dict[str, None]] = {}  # measures that cannot be taken, by the reason

        def taken(measure: Measure, run: Run) -> Array | None:
            try:
                return _number_of(measure.name, measure.function(run))
            except Exception as error:
                _ = run.motion  # a run that cannot be is no matter of the measure, and raises here
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
    """The Run of what a function returned."""
    if isinstance(found, Trajectory):
        return Run(LaneStart(found.chain, found.velocity[0], _settings_of(found)), found)
    if isinstance(found, tuple) and len(found) in (2, 3) and isinstance(found[0], Chain):
        return Run(LaneStart(found[0], found[1], found[2] if len(found) == 3 else {}))
    kinds = "numbers by name, a Trajectory, or (chain, velocity)"
    raise StudyError(f"the function must return {kinds}, not {type(found).__name__}")


def _settings_of(found: Trajectory) -> dict[str, Any]:
    """The keywords of `simulate` that gave it. Raises StudyError where its samples do not tell its start and its end."""
    whole = found.status.gave_up or np.allclose(found.velocity[-1], found.final_velocity, rtol=1e-9, atol=1e-9)
    if found.time[0] != 0.0 or not whole:
        raise StudyError("the samples of a Trajectory that is measured must begin and end with its run")
    fineness = {"step": found.step} if found.step else {"tolerance": found.tolerance}
    duration = None if found.status is Status.SEPARATED else float(found.time[-1])
    return {"duration": duration, "method": found.method, **fineness}


def _sentence_of(error: BaseException) -> str:
    """What an error says, in one line; errors that are no refusals have their name before it."""
    text = " ".join(str(error).split())
    return text if isinstance(error, ValueError) and text else f"{type(error).__name__}: {text}".rstrip(": ")


def _number_of(name: str, value: Any) -> Array:
    """The value of a measure as an array. Raises StudyError where it is none."""
    with suppress(TypeError, ValueError):
        if not np.iscomplexobj(value):
            return as_floats(value)
    raise StudyError(f"{name!r} must be a number or a list of numbers, not {shown(value)}")


def as_floats(value: Value) -> Array:
    """A number, or a list of them, as an array; None is nan."""
    return np.asarray(np.nan if value is None else value, dtype=np.float64)


def stacked(arrays: Sequence[Array | None]) -> Array:
    """(N, ...) the arrays in the largest shape among them, nan where one has no number, or is None."""
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
    """The outcomes of the points from `begin` on as arrays."""
    names = dict.fromkeys(name for outcome in outcomes for name in outcome.values)
    columns: dict[str, NDArray[Any]] = {
        name: stacked([as_floats(o.values[name]) if name in o.values else None for o in outcomes]) for name in names
    }
    columns[STATUS] = np.array([outcome.status for outcome in outcomes], dtype=np.int8)
    columns[WARNED] = np.array([outcome.warned for outcome in outcomes], dtype=np.int32)
    columns[REASON] = np.array([outcome.reason for outcome in outcomes], dtype=str)
    return Chunk(begin, begin + len(outcomes), columns, seconds)


def merged(chunks: Sequence[Chunk], count: int) -> Chunk:
    """All chunks, in the order of their points, as one. Raises StudyError where a measure is a number here and a list there."""
    columns: dict[str, NDArray[Any]] = {}
    for name in dict.fromkeys(name for chunk in chunks for name in chunk.columns):
        found = [chunk.columns.get(name) for chunk in chunks]
        shapes = {None if column is None else column.shape[1:] for column in found}
        if len(shapes) == 1:
            columns[name] = np.concatenate(found)  # type: ignore[arg-type]
        else:
            rows = zip(chunks, found, strict=True)
            columns[name] = stacked(
                [row for c, column in rows for row in ([None] * c.count if column is None else column)]
            )
    return Chunk(0, count, columns)


def lost(begin: int, times: int) -> Chunk:
    """The one point of number `begin`, whose process died so many times."""
    return packed(begin, [Outcome({}, PointStatus.LOST, 0, f"the process that computed it died, {times} times")])


@lru_cache(maxsize=1)
def current_versions() -> dict[str, str]:
    """Versions of all that the numbers of a sweep depend on."""
    import scipy
    from softcradle.physics.source_digest import PHYSICS, digest_of
    from softcradle.physics.trajectory_file import versions

    compiled = "no" if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0") else "yes"
    return {**versions(), "scipy": scipy.__version__, "compiled": compiled, "source": digest_of(PHYSICS.rglob("*.py"))}


def compute_checked(work: Work, begin: int, end: int, seconds: float) -> Chunk:
    """A chunk, in another process, where everything has the same version as here. Raises StudyError."""
    own = current_versions()
    for name, wanted in work.versions.items():
        if own[name] != wanted:
            raise StudyError(
                f"a worker has {name} {own[name]}, but the sweep was begun with {wanted}: install the same there"
            )
    return work.compute(begin, end, seconds)


def sweep_work(what: Scene | str | Callable[..., Any], points: Points, measures: Sequence[str | Measure]) -> Work:
    """The Work of a sweep; all that can be checked before it begins is. Raises StudyError, or the SceneError of a file."""
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
    """Refuse names that a variable of the Dataset cannot have beside the `others`. Raises StudyError."""
    for name in names:
        if not (isinstance(name, str) and name) or name in (*TAKEN, *others) or set(name) & set(" /"):
            raise StudyError(f"a {what} cannot be called {name!r}: give it another name")


def check_columns(chunk: Chunk, work: Work, known: dict[str, int]) -> None:
    """Refuse what a function returns where the Dataset cannot hold it; `known` has the dimensions of numbers before it.

    Raises StudyError.
    """
    columns = {name: column for name, column in chunk.columns.items() if name not in (STATUS, WARNED, REASON)}
    inner = [f"{name}_item" for name, column in columns.items() if column.ndim > 1]
    check_names("measure", columns, [*inner, *(axis.coordinate for axis in work.points.axes)])
    for name, column in columns.items():
        if known.setdefault(name, column.ndim) != column.ndim:
            raise StudyError(UNLIKE)


def _check(source: ScenePoints, points: Points) -> None:
    """Refuse a path that is not there, and first or last values that cannot be."""
    first = {axis.path: axis.ends()[0] for axis in points.axes}
    for changed in [first, *(first | {axis.path: axis.ends()[1]} for axis in points.axes)]:
        try:
            source.checked(changed)
        except SceneError as error:
            raise StudyError(str(error).removeprefix("the scene: ")) from None


def function_name(function: Any) -> str:
    """The name of a function, with its module."""
    if isinstance(function, partial):
        return f"partial({function_name(function.func)})"
    return f"{getattr(function, '__module__', '?')}.{getattr(function, '__qualname__', type(function).__name__)}"
