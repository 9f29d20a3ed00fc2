"""The sample points of a sweep: grids, lists, Latin hypercube and Sobol samples, each computed from its index alone."""

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.checked_input import LARGEST, SMALLEST, shown, whole_number
from softcradle.sandbox.user_error import StudyError

Array = NDArray[np.float64]
Scale = Literal["linear", "log", "whole"]
Design = Literal["grid", "list", "sobol", "latin_hypercube"]

MOST_POINTS = 2**30  # of which a Dataset holds 8 GB for every number
MOST_SAMPLED = 2**24  # numbers of samples, or of one parameter, which exist as a whole alone: 128 MB in every process
MOST_WHOLE = 2**53  # whole numbers up to here are exact as floats
SOBOL_BITS = 30  # of the sequence, so that 2**30 points differ


@dataclass(frozen=True)
class Axis:
    """One parameter that varies.

    Attributes
    ----------
    path : str
        Where it is in the scene, such as ``lanes.0.contact.alpha``, or the name of a function's argument.
    values : tuple
        The values that it takes, numbers or texts; empty for one that is sampled between bounds.
    low : float
        The lower bound of a sampled one.
    high : float
        Its upper bound.
    scale : str
        How samples lie between them: "linear", "log" (even in the logarithm), "whole" (whole numbers, both
        included).
    name : str
        Name of its coordinate in the Dataset; "": its path.
    """

    path: str
    values: tuple[Any, ...] = ()
    low: float = 0.0
    high: float = 1.0
    scale: Scale = "linear"
    name: str = ""

    @property
    def coordinate(self) -> str:
        """The name of its coordinate in the Dataset."""
        return self.name or self.path

    @cached_property
    def array(self) -> NDArray[Any]:
        """The values as truth values, whole numbers or floats where all are, else as objects."""
        kinds = kinds_of(self.values)
        known = ({bool}, np.bool_), ({int}, np.int64), ({int, float}, np.float64)
        return np.array(self.values, dtype=next((own for of, own in known if kinds <= of), object))

    @cached_property
    def given(self) -> NDArray[Any]:
        """The values as they were given: whole numbers stay whole beside floats, with which `array` makes them floats."""
        return np.array(self.values, object) if kinds_of(self.values) == {int, float} else self.array

    def between(self, unit: Array) -> NDArray[Any]:
        """The values at (N,) places from 0 to 1; number by number, so that they do not depend on N."""
        if self.scale == "whole":
            steps = np.floor(unit * (self.high - self.low + 1.0))
            return (self.low + np.minimum(steps, self.high - self.low)).astype(np.int64)
        if self.scale == "log":
            low, width = math.log(self.low), math.log(self.high / self.low)
            return np.array([math.exp(low + place * width) for place in unit.tolist()])
        return np.asarray(self.low + unit * (self.high - self.low))

    def ends(self) -> tuple[Any, Any]:
        """Its first and its last value."""
        return (self.values[0], self.values[-1]) if self.values else (self.low, self.high)


def kinds_of(values: Sequence[Any]) -> set[type]:
    """Which of bool, int, float and str the values are, and other types that are among them."""
    return {
        next((kind for kind in (bool, int, float, str) if isinstance(value, kind)), type(value)) for value in values
    }


@dataclass(frozen=True)
class Points:
    """All points of a sweep, by number.

    Attributes:
        design: "grid" (every combination), "list" (the k-th values of all axes together), "sobol" or "latin_hypercube".
        axes: what varies; the last one varies fastest in a grid.
        count: number of points.
        seed: of the samples.
    """

    design: Design
    axes: tuple[Axis, ...]
    count: int
    seed: int = 0

    @property
    def shape(self) -> tuple[int, ...]:
        """Points along each dimension of the Dataset."""
        return tuple(len(axis.values) for axis in self.axes) if self.design == "grid" else (self.count,)

    @property
    def dimensions(self) -> tuple[str, ...]:
        """The dimensions of the Dataset: the axes of a grid, else "point"."""
        return tuple(axis.coordinate for axis in self.axes) if self.design == "grid" else ("point",)

    def columns(self, begin: int, end: int, given: bool = False) -> dict[str, NDArray[Any]]:
        """The values of every axis, by path, at the points from `begin` to `end`; as they were `given`, or all of one type."""
        arrays = [axis.given if given else axis.array for axis in self.axes]
        if self.design == "grid":
            places = np.unravel_index(np.arange(begin, end), self.shape)
            return {axis.path: array[place] for axis, array, place in zip(self.axes, arrays, places, strict=True)}
        if self.design == "list":
            return {axis.path: array[begin:end] for axis, array in zip(self.axes, arrays, strict=True)}
        unit = _unit_rows(self.design, len(self.axes), self.count, self.seed)[begin:end]
        return {axis.path: axis.between(unit[:, k]) for k, axis in enumerate(self.axes)}

    def rows(self, begin: int, end: int, block: int) -> Iterator[dict[str, Any]]:
        """The values of every axis, by path, at one point after the other; read a `block` at a time."""
        for first in range(begin, end, block):
            found = self.columns(first, min(first + block, end), given=True)
            columns = {path: values.tolist() for path, values in found.items()}
            yield from (dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True))


def grid(axes: Mapping[str, Any] | Sequence[Axis]) -> Points:
    """Every combination of the values; ``{path: values}``, or a list of Axis."""
    found = _valued(axes)
    return _checked(Points("grid", found, math.prod(len(axis.values) for axis in found)))


def listed(axes: Mapping[str, Any] | Sequence[Axis]) -> Points:
    """The k-th values of all axes together are the k-th point; ``{path: values}`` of one length, or a list of Axis."""
    found = _valued(axes)
    lengths = {axis.coordinate: len(axis.values) for axis in found}
    if len(set(lengths.values())) > 1:
        raise StudyError(f"a list of points needs as many values of each parameter, not {shown(lengths)}")
    return _checked(Points("list", found, len(found[0].values)))


def sobol(axes: Mapping[str, Any] | Sequence[Axis], count: int, seed: int = 0) -> Points:
    """`count` points of a scrambled Sobol sequence; ``{path: (low, high)}`` or ``(low, high, scale)``, or a list of Axis.

    A power of 2 balances them best. The first of a longer sequence of the same seed are those of a shorter one.
    """
    return _sampled("sobol", axes, count, seed)


def latin_hypercube(axes: Mapping[str, Any] | Sequence[Axis], count: int, seed: int = 0) -> Points:
    """`count` points of a Latin hypercube: each of `count` equal parts of every axis holds one; axes as for `sobol`."""
    return _sampled("latin_hypercube", axes, count, seed)


def _sampled(design: Design, axes: Mapping[str, Any] | Sequence[Axis], count: int, seed: int) -> Points:
    found = Points(design, _bounded(axes), whole_number("count", count), whole_number("seed", seed))
    most = MOST_SAMPLED // len(found.axes)
    if count > most:
        raise StudyError(f"samples of {len(found.axes)} parameters have at most {most} points, not {count}")
    return _checked(found)


def _valued(axes: Mapping[str, Any] | Sequence[Axis]) -> tuple[Axis, ...]:
    if isinstance(axes, Mapping):
        axes = [Axis(str(path), _value_tuple(path, values)) for path, values in axes.items()]
    for axis in axes:
        if not axis.values:
            raise StudyError(f"{axis.path} needs at least one value")
        if any(isinstance(value, int) and abs(value) > MOST_WHOLE for value in axis.values):
            raise StudyError(
                f"{axis.path}: whole numbers must be from -{MOST_WHOLE} to {MOST_WHOLE}, not {shown(axis.values)}"
            )
    return _named(axes)


def _value_tuple(path: str, values: Any) -> tuple[Any, ...]:
    if isinstance(values, (str, bytes)) or np.ndim(values) != 1:
        raise StudyError(f"{path} must be a list of values, not {shown(values)}")
    return tuple(value.item() if isinstance(value, np.generic) else value for value in values)


def _bounded(axes: Mapping[str, Any] | Sequence[Axis]) -> tuple[Axis, ...]:
    if isinstance(axes, Mapping):
        axes = [_from_bounds(str(path), bounds) for path, bounds in axes.items()]
    for axis in axes:
        if axis.values:
            raise StudyError(f"{axis.path} must be sampled between bounds, not from a list of values")
        check_bounds(axis)
    return _named(axes)


def check_bounds(axis: Axis) -> None:
    """Raise StudyError where nothing can lie between the bounds of the axis."""
    path, low, high = axis.path, axis.low, axis.high
    if axis.scale not in get_args(Scale):
        raise StudyError(f"{path}: scale must be one of {', '.join(get_args(Scale))}, not {axis.scale!r}")
    told = f"not {shown(low)} and {shown(high)}"
    if not -LARGEST <= low < high <= LARGEST:
        raise StudyError(f"{path} must lie between two numbers of at most {LARGEST:g}, the smaller one first, {told}")
    if axis.scale == "log" and low < SMALLEST:
        raise StudyError(f"{path}: bounds on a log scale must be at least {SMALLEST:g}, {told}")
    if axis.scale == "whole" and not all(
        float(bound).is_integer() and abs(bound) <= MOST_WHOLE for bound in (low, high)
    ):
        raise StudyError(f"{path}: bounds of whole numbers must be whole and at most {MOST_WHOLE}, {told}")


def _from_bounds(path: str, bounds: Any) -> Axis:
    numbers = list(bounds) if isinstance(bounds, (list, tuple)) else []
    if len(numbers) not in (2, 3) or not all(isinstance(number, (int, float)) for number in numbers[:2]):
        raise StudyError(f"{path} must be (low, high) or (low, high, scale), not {shown(bounds)}")
    return Axis(path, low=numbers[0], high=numbers[1], scale=numbers[2] if len(numbers) == 3 else "linear")


def _named(axes: Sequence[Axis]) -> tuple[Axis, ...]:
    names = [axis.coordinate for axis in axes]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise StudyError(f"two parameters are called {twice!r}")
    if not names:
        raise StudyError("a sweep needs at least one parameter that varies")
    return tuple(axes)


def _checked(points: Points) -> Points:
    if not 1 <= points.count <= MOST_POINTS:
        raise StudyError(f"a sweep has from 1 to {MOST_POINTS} points, not {points.count}")
    if points.seed < 0:
        raise StudyError(f"seed must be at least 0, not {points.seed}")
    return points


@lru_cache(maxsize=2)
def _unit_rows(design: Design, dimensions: int, count: int, seed: int) -> Array:
    """(count, dimensions) places from 0 to 1 of all samples."""
    from scipy.stats import qmc

    random = np.random.default_rng(seed)
    if design == "latin_hypercube":
        return np.asarray(qmc.LatinHypercube(dimensions, rng=random).random(count))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a number of points that is no power of 2
        return np.asarray(qmc.Sobol(dimensions, bits=SOBOL_BITS, rng=random).random(count))
