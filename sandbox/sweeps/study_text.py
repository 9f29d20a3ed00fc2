"""A sweep as text: all that its numbers follow from, by which kept points and a Dataset know the study that they belong to."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from functools import partial
from typing import Any

import numpy as np
from softcradle.sandbox.sweeps.chunk_work import Work, current_versions
from softcradle.sandbox.sweeps.measure_table import Measure, find_measure
from softcradle.sandbox.sweeps.sample_points import Points
from softcradle.sandbox.sweeps.scene_points import ScenePoints
from softcradle.sandbox.user_error import StudyError
from softcradle.scenes import Scene, load
from softcradle.scenes.scene_errors import SceneError

TAKEN = ("point", "lane", "bead", "contact", "status", "warned", "reason")  # names that parameters cannot have


def sweep_work(what: Scene | str | Callable[..., Any], points: Points, measures: Sequence[str | Measure]) -> Work:
    """The Work of a sweep. Raises StudyError."""
    return Work(points, checked_source(what, points, measures), tuple(measures), current_versions())


def checked_source(
    what: Scene | str | Callable[..., Any], points: Points, measures: Sequence[str | Measure]
) -> ScenePoints | Callable[..., Any]:
    """What is swept; all that can be checked before the work begins is. Raises StudyError."""
    names = [find_measure(item).name if isinstance(item, str) else item.name for item in measures]
    for name in [axis.coordinate for axis in points.axes]:
        if name in (*TAKEN, *names) or set(name) & set(" /"):
            raise StudyError(f"a parameter cannot be called {name!r}: give it another name")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise StudyError(f"measure {twice!r} is given twice")
    if callable(what) and not isinstance(what, Scene):
        source: ScenePoints | Callable[..., Any] = what
    else:
        scene = what if isinstance(what, Scene) else scene_of(str(what))
        if not measures:
            raise StudyError("a sweep of a scene needs at least one measure")
        source = ScenePoints(scene)
        _check(source, points)
    return source


def scene_of(name_or_path: str) -> Scene:
    """The scene of that name or in that file. Raises StudyError with what is wrong with it."""
    try:
        return load(name_or_path)
    except SceneError as error:
        raise StudyError(str(error)) from None


def _check(source: ScenePoints, points: Points) -> None:
    """Refuse a path that is not there, and first or last values that cannot be."""
    first = {axis.path: axis.ends()[0] for axis in points.axes}
    for changed in [first, *(first | {axis.path: axis.ends()[1]} for axis in points.axes)]:
        try:
            source.checked(changed)
        except SceneError as error:
            raise StudyError(str(error).removeprefix("the scene: ")) from None


def lanes_of(work: Work) -> tuple[tuple[str, ...], str]:
    """The labels of the lanes, numbers where there are none, and the title of the scene or function."""
    if isinstance(work.source, ScenePoints):
        scene = work.source.scene
        return tuple(lane.label or str(k) for k, lane in enumerate(scene.lanes)), scene.title
    return ("",), function_name(work.source)


def study_text(work: Work, title: str) -> str:
    """All that the numbers of a sweep follow from as one line of JSON; long lists of values as their digest."""
    axes = [asdict(axis) | {"values": _shortened(axis.values)} for axis in work.points.axes]
    source: Any = {"function": function_name(work.source), "code": _code_digest(work.source)}
    if isinstance(work.source, ScenePoints):
        source = work.source.scene.model_dump(mode="json", exclude={"view", "text", "question", "source"})
    found = {
        "title": title,
        "design": work.points.design,
        "count": work.points.count,
        "seed": work.points.seed,
        "axes": axes,
        "of": source,
        "measures": [
            item if isinstance(item, str) else [item.name, _code_digest(item.function)] for item in work.measures
        ],
        "versions": dict(work.versions),
    }
    return json.dumps(found, default=str)


MOST_VALUES = 100  # of an axis that are written out


def _shortened(values: tuple[Any, ...]) -> Any:
    if len(values) <= MOST_VALUES:
        return list(values)
    return {"number": len(values), "digest": hashlib.sha256(repr(values).encode()).hexdigest()[:16]}


def function_name(function: Any) -> str:
    """The name of a function, with its module."""
    if isinstance(function, partial):
        return f"partial({function_name(function.func)})"
    return f"{getattr(function, '__module__', '?')}.{getattr(function, '__qualname__', type(function).__name__)}"


def _code_digest(function: Any) -> str:
    """What tells one version of a function from another: its code, and what `partial` gave it. Not what it calls."""
    told: list[Any] = []
    if isinstance(function, partial):
        told += [function.args, sorted(function.keywords.items())]
        function = function.func
    code = getattr(function, "__code__", None)
    while code is not None:
        inner = [constant for constant in code.co_consts if hasattr(constant, "co_code")]
        told += [code.co_code, code.co_names, [c for c in code.co_consts if not hasattr(c, "co_code")]]
        code = inner[0] if inner else None
    cells = [cell.cell_contents for cell in getattr(function, "__closure__", None) or ()]
    told += [cell for cell in cells if isinstance(cell, (int, float, str, tuple, np.ndarray, Mapping))]
    return hashlib.sha256(repr(told).encode()).hexdigest()[:16]
