"""Sample points of a sweep: grids, lists, Latin hypercubes and Sobol sequences. A point depends only on its index."""

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

MOST_POINTS = 2**30  # Largest number of points. A Dataset then has 8 GB for each measure.
# Largest number of sampled coordinates, or of values of one parameter. The numbers are held in memory and take 128 MB
# in every process.
MOST_SAMPLED = 2**24
MOST_WHOLE = 2**53  # Whole numbers up to this size are exact as floats.
SOBOL_BITS = 30  # Number of bits of the Sobol sequence. With this number, 2**30 points differ from each other.


@dataclass(frozen=True)
class Axis:
    """Parameter that varies in a sweep.

    Attributes
    ----------
    path : str
        Path of the number in the scene, such as ``lanes.0.contact.alpha``, or the name of an argument of the function.
    values : tuple
        Values of the parameter, numbers or texts; empty if it is sampled between bounds.
    low : float
        Lower bound of a sampled parameter.
    high : float
        Upper bound of a sampled parameter.
    scale : str
        Distribution of the samples between the bounds: "linear", "log" (uniform in the logarithm) or "whole" (whole
        numbers, both bounds included).
    name : str
        Name of the coordinate in the Dataset; "" means the path.
    """

    path: str
    values: tuple[Any, ...] = ()
    low: float = 0.0
    high: float = 1.0
    scale: Scale = "linear"
    name: str = ""

    @property
    def coordinate(self) -> str:
        """Name of the coordinate in the Dataset."""
        return self.name or self.path

    @cached_property
    def array(self) -> NDArray[Any]:
        """Values as an array. The type of the array is boolean, whole number or float if all values allow it, otherwise
        object.
        """
        kinds = kinds_of(self.values)
        known = ({bool}, np.bool_), ({int}, np.int64), ({int, float}, np.float64)
        return np.array(self.values, dtype=next((own for of, own in known if kinds <= of), object))

    @cached_property
    def given(self) -> NDArray[Any]:
        """Values with their original types.

        Whole numbers stay whole if there are floats among the values. The property `array` converts such numbers to
        floats.
        """
        return np.array(self.values, object) if kinds_of(self.values) == {int, float} else self.array

    def between(self, unit: Array) -> NDArray[Any]:
        """Return (N,) samples of the parameter for the numbers `unit` (N,) from 0 to 1.

        Each sample is computed separately, so it does not depend on N.
        """
        if self.scale == "whole":
            steps = np.floor(unit * (self.high - self.low + 1.0))
            return (self.low + np.minimum(steps, self.high - self.low)).astype(np.int64)
        if self.scale == "log":
            low, width = math.log(self.low), math.log(self.high / self.low)
            return np.array([math.exp(low + place * width) for place in unit.tolist()])
        return np.asarray(self.low + unit * (self.high - self.low))

    def ends(self) -> tuple[Any, Any]:
        """Return the first and the last value."""
        return (self.values[0], self.values[-1]) if self.values else (self.low, self.high)


def kinds_of(values: Sequence[Any]) -> set[type]:
    """Return the set of types of `values`, such as bool, int, float and str."""
    return {
        next((kind for kind in (bool, int, float, str) if isinstance(value, kind)), type(value)) for value in values
    }


@dataclass(frozen=True)
class Points:
    """All points of a sweep. The points are numbered.

    Attributes:
        design: "grid" (every combination), "list" (point k has the k-th value of each axis), "sobol" or
            "latin_hypercube".
        axes: the varied parameters. In a grid the last parameter varies fastest.
        count: number of points.
        seed: seed of the samples.
    """

    design: Design
    axes: tuple[Axis, ...]
    count: int
    seed: int = 0

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points along each dimension of the Dataset."""
        return tuple(len(axis.values) for axis in self.axes) if self.design == "grid" else (self.count,)

    @property
    def dimensions(self) -> tuple[str, ...]:
        """Names of the dimensions of the Dataset: the axes of a grid, otherwise "point"."""
        return tuple(axis.coordinate for axis in self.axes) if self.design == "grid" else ("point",)

    def columns(self, begin: int, end: int, given: bool = False) -> dict[str, NDArray[Any]]:
        """Return the values of every axis, by path, at the points from `begin` up to `end`.

        If `given` is True, the values keep their original types. Otherwise all values of an axis have one type.
        """
        arrays = [axis.given if given else axis.array for axis in self.axes]
        if self.design == "grid":
            places = np.unravel_index(np.arange(begin, end), self.shape)
            return {axis.path: array[place] for axis, array, place in zip(self.axes, arrays, places, strict=True)}
        if self.design == "list":
            return {axis.path: array[begin:end] for axis, array in zip(self.axes, arrays, strict=True)}
        unit = _unit_rows(self.design, len(self.axes), self.count, self.seed)[begin:end]
        return {axis.path: axis.between(unit[:, k]) for k, axis in enumerate(self.axes)}

    def rows(self, begin: int, end: int, block: int) -> Iterator[dict[str, Any]]:
        """Yield the values of every axis, by path, for each point in turn. The values are computed in blocks of `block`
        points.
        """
        for first in range(begin, end, block):
            found = self.columns(first, min(first + block, end), given=True)
            columns = {path: values.tolist() for path, values in found.items()}
            yield from (dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True))


def grid(axes: Mapping[str, Any] | Sequence[Axis]) -> Points:
    """Return the points of every combination of values. The argument `axes` is ``{path: values}`` or a list of Axis."""
    found = _valued(axes)
    return _checked(Points("grid", found, math.prod(len(axis.values) for axis in found)))


def listed(axes: Mapping[str, Any] | Sequence[Axis]) -> Points:
    """Return the points of a list, in which point k has the k-th value of each axis.

    `axes` is ``{path: values}`` with lists of equal length, or a list of Axis.
    """
    found = _valued(axes)
    lengths = {axis.coordinate: len(axis.values) for axis in found}
    if len(set(lengths.values())) > 1:
        raise StudyError(f"a list of points needs as many values of each parameter, not {shown(lengths)}")
    return _checked(Points("list", found, len(found[0].values)))


def sobol(axes: Mapping[str, Any] | Sequence[Axis], count: int, seed: int = 0) -> Points:
    """Return `count` points of a scrambled Sobol sequence.

    `axes` is ``{path: (low, high)}`` or ``{path: (low, high, scale)}``, or a list of Axis. A power of 2 gives the best
    balance. With the same seed, a longer sequence begins with the points of a shorter one.
    """
    return _sampled("sobol", axes, count, seed)


def latin_hypercube(axes: Mapping[str, Any] | Sequence[Axis], count: int, seed: int = 0) -> Points:
    """Return `count` points of a Latin hypercube. Each of `count` equal parts of every axis contains one point.

    The argument `axes` has the same form as for `sobol`.
    """
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
    """Raise StudyError if the bounds or the scale of the axis are invalid."""
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
    """Return the (count, dimensions) coordinates of all samples, from 0 to 1."""
    from scipy.stats import qmc

    random = np.random.default_rng(seed)
    if design == "latin_hypercube":
        return np.asarray(qmc.LatinHypercube(dimensions, rng=random).random(count))
    with warnings.catch_warnings():
        # The warning of SciPy about numbers of points that are not a power of 2 is suppressed.
        warnings.simplefilter("ignore")
        return np.asarray(qmc.Sobol(dimensions, bits=SOBOL_BITS, rng=random).random(count))
