"""Free values of a scene, with their paths, physical limits, bounds and scales."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, get_args

import annotated_types
import numpy as np
from pydantic import BaseModel
from pydantic.fields import FieldInfo
from softcradle.physics.contact import LEAST_EXPONENT, MOST_EXPONENT
from softcradle.sandbox.motion import Array
from softcradle.sandbox.sweeps.scene_points import EVERY, ONE_OR_MANY, ScenePoints
from softcradle.sandbox.user_error import StudyError
from softcradle.scenes import Lane, Scene
from softcradle.scenes.toml_table import suggestion

START, OFFSET = "start", "offset"  # Names of free values that belong to the data and not to the scene.
EACH = ":"  # Key of a path that stands for every item of a list. Each item has a separate value.
# If the user gives no bounds, the bounds of a positive value are the value divided and multiplied by this factor.
WIDEST = 1e3
# Keys of exponents. The limits of exponents are not part of the schema.
EXPONENTS = ("alpha", "exponent")
# Distance of a start value from a bound, relative to the scale. The least-squares method must start inside the bounds.
INSIDE = 1e-3
# Typical sizes of a loss and of a friction coefficient, used if the scene contains 0. Both are dimensionless.
LOSS_SCALE, FRICTION_SCALE = 0.5, 0.1


@dataclass(frozen=True)
class FreeValue:
    """Free value of a scene, represented by an internal coordinate z.

    A positive value equals exp(z). Any other value equals scale * z.

    Attributes:
        path: dotted path in the scene, `start`, or `offset` and the number of a column.
        name: text for tables.
        value: value at the start of the search.
        low, high: bounds of the value.
        scale: typical size of a change. For logarithmic coordinates it is relative and equals 1.
        logarithmic: True if the coordinate is the logarithm of the value.
        given: True if the user gave the bounds.
    """

    path: str
    name: str
    value: float
    low: float
    high: float
    scale: float
    logarithmic: bool
    given: bool = False

    def inner(self, value: float) -> float:
        """Return the coordinate z of a value."""
        return math.log(value) if self.logarithmic else value / self.scale

    def outer(self, z: float) -> float:
        """Return the value at the coordinate z, limited by the bounds."""
        return float(np.clip(math.exp(z) if self.logarithmic else self.scale * z, self.low, self.high))

    def slope(self, value: float) -> float:
        """Return the derivative of the value with respect to the coordinate z."""
        return value if self.logarithmic else self.scale

    @property
    def bounds(self) -> tuple[float, float]:
        """Bounds of the coordinate z."""
        low = self.inner(self.low) if math.isfinite(self.low) and (self.low or not self.logarithmic) else -math.inf
        return low, self.inner(self.high) if math.isfinite(self.high) else math.inf

    def inside(self, z: float) -> float:
        """Return the coordinate z, moved strictly inside the bounds if necessary."""
        low, high = self.bounds
        room = min(INSIDE, 0.25 * (high - low))
        return float(np.clip(z, low + room, high - room))


def scene_values(scene: Scene, free: Sequence[str], lane: int, duration: float) -> list[FreeValue]:
    """Return the free values of the scene that the texts `free` name. The texts `start` and `offset` are ignored.

    `lane` and `duration` [s] of the data give the typical size of velocities and gaps. Raise StudyError if a text does
    not name a number of the scene, or if its bounds are outside the physical limits.
    """
    found = list[FreeValue]()
    for text in free:
        path, bounds = parse(text)
        if path in (START, OFFSET):
            continue
        for single in _expanded(scene, path):
            found.append(_scene_value(scene, single, bounds, lane, duration))
    paths = [one.path for one in found]
    twice = next((path for k, path in enumerate(paths) if path in paths[:k]), None)
    if twice:
        raise StudyError(f"{twice} is given twice as a free value")
    return found


def parse(text: str) -> tuple[str, tuple[float, float] | None]:
    """Return the dotted path and the bounds of a text such as ``lanes.0.mass[1]=0.1..0.5``.

    Raise StudyError if the text is not valid.
    """
    path, equals, span = text.partition("=")
    path = re.sub(r"\[([^\]]*)\]", r".\1", path.strip()).strip(".")
    if not equals:
        return path, None
    try:
        low, high = map(float, span.split(".."))
    except ValueError:
        raise StudyError(f"{path}: bounds must be LOW..HIGH, such as {path}=0.1..0.5, not {span!r}") from None
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise StudyError(f"{path}: bounds must be two finite numbers, the lower one first, not {span!r}")
    return path, (low, high)


def _expanded(scene: Scene, path: str) -> Iterator[str]:
    """Yield the path of each list item that a path with the key `:` stands for."""
    keys = path.split(".")
    if EACH not in keys:
        yield path
        return
    at = keys.index(EACH)
    for k in range(len(_items(scene, keys[:at], path))):
        yield from _expanded(scene, ".".join([*keys[:at], str(k), *keys[at + 1 :]]))


def _items(scene: Scene, keys: Sequence[str], path: str) -> tuple[Any, ...]:
    found = _walk(scene, keys, path)[0]
    if not isinstance(found, tuple):
        owner, count = _walk(scene, keys[:-1], path)[0], 0
        if isinstance(owner, Lane) and keys[-1] in ONE_OR_MANY:
            count = len(owner.velocity) - (keys[-1] != "mass")
        found = (found,) * count
    if not found:
        raise StudyError(f"{path}: {'.'.join(keys)!r} is not a list")
    return found


def _walk(scene: Scene, keys: Sequence[str], path: str) -> tuple[Any, FieldInfo | None]:
    """Return the value at the path `keys`, and the field that contains it. Raise StudyError if it does not exist."""
    item: Any = scene
    field, owner, name = None, None, ""
    for key in keys:
        is_place = key == EVERY or key.isdecimal()
        if isinstance(item, BaseModel) and not (is_place and isinstance(owner, Lane) and name in ONE_OR_MANY):
            known = type(item).model_fields
            if key not in known:
                raise StudyError(f"{path}: there is no {key!r}{suggestion(key, known)}")
            owner, name, field, item = item, key, known[key], getattr(item, key)
        elif is_place:
            count = len(item) if isinstance(item, tuple) else 0
            if not count and isinstance(owner, Lane) and name in ONE_OR_MANY:
                count, item = len(owner.velocity) - (name != "mass"), (item,)
            owner = None
            if not count or (key != EVERY and int(key) >= count):
                allowed = f"a number from 0 to {count - 1}" if count else "left out"
                raise StudyError(f"{path}: {key!r} must be {allowed}")
            item = item[0 if key == EVERY or len(item) == 1 else int(key)]
        elif name in ONE_OR_MANY and isinstance(item, tuple):
            raise StudyError(f"{path}: {name!r} is a list: write {name}[0] for one item or {name}[*] for all")
        else:
            raise StudyError(f"{path}: there is nothing below {name!r}, which is {item!r}")
    return item, field


def _scene_value(scene: Scene, path: str, bounds: tuple[float, float] | None, lane: int, duration: float) -> FreeValue:
    keys = path.split(".")
    item, field = _walk(scene, keys, path)
    if isinstance(item, tuple) and keys[-1] == "velocity" and isinstance(_walk(scene, keys[:-1], path)[0].beads, tuple):
        item = item[0]  # The item is the common velocity of all strikers.
    if isinstance(item, tuple):
        raise StudyError(f"{path}: is a list: write {path}[0] for one item or {path}[*] for all")
    if isinstance(item, bool) or not isinstance(item, (int, float)):
        raise StudyError(f"{path}: must be a number of the scene, not {item!r}")
    if isinstance(item, int) or not math.isfinite(item):
        what = "a wall" if not math.isfinite(item) else "a whole number"
        raise StudyError(f"{path}: {what} cannot be a free value")
    name = next(key for key in reversed(keys) if not key.isdecimal() and key != EVERY)
    least, most, positive = _limits(field, name)
    low, high = bounds or (least, most)
    if bounds and (low < least or high > most or (positive and low <= 0.0)):
        above = "above 0" if positive and least == 0.0 else f"{least:g} or more"
        below = "" if math.isinf(most) else f", and at most {most:.6g}"
        raise StudyError(f"{path}: bounds must be {above}{below}, not {low:g}..{high:g}")
    value = float(item)
    if positive and bounds is None:
        low, high = max(least, value / WIDEST), min(most, value * WIDEST)
    if bounds is not None:
        value = float(np.clip(value, low, high))
    scale = 1.0 if positive else _scale(scene.lanes[lane], name, value, duration)
    return FreeValue(path, path, value, low, high, scale, positive, bounds is not None)


def _limits(field: FieldInfo | None, name: str) -> tuple[float, float, bool]:
    """Return the physical limits of a field. The third result is True if its values must be positive."""
    least, most, positive = -math.inf, math.inf, False
    for one in _constraints(field):
        if isinstance(one, annotated_types.Gt):
            least, positive = float(one.gt), float(one.gt) == 0.0  # type: ignore[arg-type]
        elif isinstance(one, annotated_types.Ge):
            least = float(one.ge)  # type: ignore[arg-type]
        elif isinstance(one, annotated_types.Lt):
            most = math.nextafter(float(one.lt), -math.inf)  # type: ignore[arg-type]
    if name in EXPONENTS:
        least, most = LEAST_EXPONENT, MOST_EXPONENT
    return least, most, positive


def _constraints(annotation: Any) -> Iterator[Any]:
    """Yield the limits in the annotation of a field. The results include the limits of the items of a list."""
    if isinstance(annotation, FieldInfo):
        yield from annotation.metadata
        yield from _constraints(annotation.annotation)
    elif not isinstance(annotation, str):
        for part in get_args(annotation):
            if isinstance(part, FieldInfo):
                yield from part.metadata
            yield from _constraints(part)


def _scale(lane: Lane, name: str, value: float, duration: float) -> float:
    """Return the typical size of a value that may be 0."""
    speed = max(map(abs, lane.velocity)) or 1.0
    typical = {
        "loss": LOSS_SCALE,
        "friction": FRICTION_SCALE,
        "velocity": speed,
        "gap": speed * duration,
        "approach": speed * duration,
        "time": duration,
    }.get(name, 0.0)
    return max(abs(value), typical) or 1.0


@dataclass(frozen=True)
class FreeValues:
    """Free values together with the scene that contains them."""

    points: ScenePoints
    values: tuple[FreeValue, ...]

    def of_scene(self, values: Sequence[float]) -> Mapping[str, float]:
        """Return the values that belong to the scene, by their paths."""
        pairs = zip(self.values, values, strict=True)
        return {one.path: value for one, value in pairs if one.path.split(" ")[0] not in (START, OFFSET)}

    def outer(self, z: Array) -> list[float]:
        """Return the values at the coordinates `z`."""
        return [one.outer(float(at)) for one, at in zip(self.values, z, strict=True)]
