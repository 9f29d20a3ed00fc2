"""The layout of the Dataset of a sweep: variables, dimensions, units, and the blocks in which they are written."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.sweeps.chunk_work import Chunk, PointStatus
from softcradle.sandbox.sweeps.journal import Journal
from softcradle.sandbox.sweeps.measure_table import MEASURE_BY_NAME, Measure
from softcradle.sandbox.sweeps.sample_points import Points

BLOCK = 65_536  # points that are in memory at once, and in a chunk of the file

Region = tuple[int | slice, ...]


@dataclass(frozen=True)
class Variable:
    """One variable of the Dataset: its dimensions, attributes, and the type of its numbers; `text` for sentences."""

    name: str
    dimensions: tuple[str, ...]
    kind: type
    attributes: Mapping[str, Any] = field(default_factory=dict)
    values: Any = None  # of a coordinate that does not depend on the point


@dataclass(frozen=True)
class Layout:
    """What is in the Dataset.

    Attributes:
        points: the sample points.
        sizes: of every dimension.
        variables: those that are written block by block.
        coordinates: those that are written at once.
        attributes: of the Dataset.
    """

    points: Points
    sizes: Mapping[str, int]
    variables: Sequence[Variable]
    coordinates: Sequence[Variable]
    attributes: Mapping[str, str]

    @property
    def moving(self) -> tuple[str, ...]:
        """The coordinates that are written block by block."""
        return () if self.points.design == "grid" else tuple(axis.coordinate for axis in self.points.axes)

    def stored_attributes(self, variable: Variable) -> dict[str, Any]:
        """The attributes of a variable in a file, which name the coordinates along the points."""
        told = {"coordinates": " ".join(self.moving)} if self.moving and variable.dimensions[0] == "point" else {}
        return {**variable.attributes, **(told if variable.name not in self.moving else {})}


def layout_of(
    journal: Journal, points: Points, lanes: Sequence[str], measures: Sequence[Measure], units: Mapping[str, str],
    attributes: Mapping[str, str],
) -> Layout:  # fmt: skip
    """The layout of the Dataset of all that the journal keeps.

    Arguments:
        lanes: the labels of a scene's lanes; with more than one, each measure has a number for each of them.
        measures: those that are not of the table.
        units: of the numbers that a function returns.
    """
    known = MEASURE_BY_NAME | {measure.name: measure for measure in measures}
    sizes = dict(zip(points.dimensions, points.shape, strict=True))
    variables = [_status(points), Variable("warned", points.dimensions, np.int32, {"long_name": "number of warnings"})]
    variables.append(Variable("reason", points.dimensions, str, {"long_name": 'what went wrong; "" where nothing did'}))
    for name, shape in journal.shapes().items():
        if name in ("status", "warned"):
            continue
        own = known.get(name)
        inner = ("lane",) * (own is not None and len(lanes) > 1)
        inner += tuple(
            own.each or f"{name}_item" if own else f"{name}_item{k or ''}" for k in range(len(shape) - len(inner))
        )
        for dimension, length in zip(inner, shape, strict=True):
            sizes[dimension] = max(length, sizes.get(dimension, 0))
        told: dict[str, Any] = {"units": own.unit, "long_name": own.meaning} if own else {"units": units.get(name, "")}
        variables.append(Variable(name, (*points.dimensions, *inner), np.float64, told))
    coordinates = [Variable(n, (n,), np.int64, {}, np.arange(sizes[n])) for n in ("bead", "contact") if n in sizes]
    if "lane" in sizes:
        coordinates.append(Variable("lane", ("lane",), str, {}, np.array([*lanes], dtype=object)))
    axes = _axis_variables(points)
    if points.design == "grid":
        return Layout(points, sizes, variables, coordinates + axes, attributes)
    return Layout(points, sizes, variables + axes, coordinates, attributes)


def _status(points: Points) -> Variable:
    """What became of each point, by the conventions for flags."""
    codes = np.array([status.value for status in PointStatus], dtype=np.int8)
    told = {"long_name": "what became of the point", "flag_values": codes}
    return Variable(
        "status", points.dimensions, np.int8, told | {"flag_meanings": " ".join(s.name.lower() for s in PointStatus)}
    )


def _axis_variables(points: Points) -> list[Variable]:
    """The coordinates of the parameters that vary: along their own dimension in a grid, else along the points."""
    columns = points.columns(0, 1)
    found = []
    for axis in points.axes:
        kind = str if columns[axis.path].dtype == object else columns[axis.path].dtype.type
        values = np.array(axis.values, dtype=object if kind is str else kind) if points.design == "grid" else None
        dimension = axis.coordinate if points.design == "grid" else "point"
        found.append(Variable(axis.coordinate, (dimension,), kind, {"long_name": axis.path}, values))
    return found


def blocks(shape: tuple[int, ...], most: int = BLOCK) -> Iterator[tuple[int, int, Region]]:
    """Blocks of at most about `most` points: first and last number, and their place in an array of that shape."""
    split, inner = _split(shape, most)
    step = max(1, most // inner)
    for lead in np.ndindex(shape[:split]):
        for first in range(0, shape[split], step):
            last = min(first + step, shape[split])
            before = int(np.ravel_multi_index(lead, shape[:split])) if lead else 0
            begin = (before * shape[split] + first) * inner
            region = (*lead, slice(first, last), *(slice(0, length) for length in shape[split + 1 :]))
            yield begin, begin + (last - first) * inner, region


def _split(shape: tuple[int, ...], most: int) -> tuple[int, int]:
    """The dimension along which blocks are cut, and the points at each place of it."""
    split, inner = len(shape) - 1, 1
    while split > 0 and inner * shape[split] <= most:
        inner *= shape[split]
        split -= 1
    return split, inner


def chunk_shape(variable: Variable, layout: Layout, most: int = BLOCK) -> tuple[int, ...]:
    """The chunks in which a variable is stored: blocks of points with all of their numbers."""
    shape = layout.points.shape
    split, inner = _split(shape, most)
    own = (*(1,) * split, min(shape[split], max(1, most // inner)), *shape[split + 1 :])
    return (*own, *(max(1, layout.sizes[name]) for name in variable.dimensions[len(shape) :]))


def block_values(variable: Variable, chunk: Chunk, columns: Mapping[str, NDArray[Any]], layout: Layout) -> NDArray[Any]:
    """(N, ...) the numbers of a variable at the points of a chunk, nan beyond those that there are."""
    for axis in layout.points.axes:
        if variable.name == axis.coordinate:
            return columns[axis.path]
    count = chunk.end - chunk.begin
    if variable.kind is str:
        return np.array([chunk.reasons.get(k, "") for k in range(chunk.begin, chunk.end)], dtype=object)
    inner = tuple(layout.sizes[name] for name in variable.dimensions[len(layout.points.shape) :])
    values = chunk.columns.get(variable.name)
    if values is not None and values.shape[1:] == inner:
        return values
    whole = np.full((count, *inner), np.nan)
    if values is not None:
        whole[(slice(None), *(slice(0, length) for length in values.shape[1:]))] = values
    return whole
