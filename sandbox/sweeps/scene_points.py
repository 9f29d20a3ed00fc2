"""Insertion of the values of a point into a scene. Values replace the numbers at dotted paths, such as
`lanes.0.contact.alpha`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Annotated, Any, NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError
from softcradle.physics import Chain
from softcradle.scenes import Lane, Scene
from softcradle.scenes.scene_errors import SceneError, scene_error
from softcradle.scenes.scene_schema import strikers_at
from softcradle.scenes.toml_table import suggestion

ONE_OR_MANY = ("mass", "contact", "gap")  # Fields of a lane that can contain one value for all beads or contacts.
LENGTHS = ("beads",)  # Fields that determine the lengths of the lists in a lane.
EVERY = "*"  # Key of a path that stands for every item of a list.
KEPT = 64  # Largest number of cached scenes with different beads, contact laws or methods.

Change = Callable[[Mapping[str, Any]], Any]  # Maps the values of a point, by path, to a scene or a part of a scene.
Moving = tuple[Sequence[Lane], Mapping[str, Any]]  # Lanes of a scene, and its keyword arguments of `simulate`.


class LaneStart(NamedTuple):
    """Chain, start velocities of its beads, and keyword arguments of `simulate`."""

    chain: Chain
    velocity: Any
    settings: Mapping[str, Any]


@dataclass
class ScenePoints:
    """Scene in which some numbers vary from point to point.

    Attributes:
        scene: the scene; all of its lanes are simulated.
    """

    scene: Scene
    _moving: dict[tuple[Any, ...], Callable[[Mapping[str, Any]], Moving]] = field(
        default_factory=dict, repr=False, compare=False
    )

    def __getstate__(self) -> Scene:
        """Return the scene for pickling.

        Functions that were derived from the scene cannot be pickled. These functions are derived again after
        unpickling.
        """
        return self.scene

    def __setstate__(self, scene: Scene) -> None:
        self.scene, self._moving = scene, {}

    def starts(self, values: Mapping[str, Any]) -> list[LaneStart]:
        """Return the initial state of each lane at a point. Raise ValueError if the values are invalid."""
        structure = {path: value for path, value in values.items() if is_structure(path, value)}
        # The types are part of the key. 4 and 4.0 are equal as keys, but only 4 is a valid number of beads.
        kinds = tuple(map(type, structure.values()))
        paths = tuple(path for path in values if path not in structure)
        key = (*structure.items(), kinds, paths)
        if key not in self._moving:
            if len(self._moving) >= KEPT:
                self._moving.clear()
            self._moving[key] = _moving_at(self._base(structure), paths)
        try:
            lanes, settings = self._moving[key](values)
        except ValidationError:
            self.checked(values)  # This check raises the same error message as for a file.
            raise
        return [LaneStart(lane.chain(), lane.velocity, settings) for lane in lanes]

    def checked(self, values: Mapping[str, Any]) -> Scene:
        """Return the scene at a point, after the same checks as for a scene file. Raise SceneError if a check fails."""
        structure = {path: value for path, value in values.items() if is_structure(path, value)}
        numbers = {path: value for path, value in values.items() if path not in structure}
        return changed(self._base(structure), numbers)

    def _base(self, structure: Mapping[str, Any]) -> Scene:
        """Return the checked scene with new numbers of beads or new texts."""
        return changed(self.scene, structure) if structure else self.scene


def _moving_at(scene: Scene, paths: Sequence[str]) -> Callable[[Mapping[str, Any]], Moving]:
    """Return a function that maps the numbers at `paths` to the lanes and settings of the scene.

    The function is built once for all points that differ only in these numbers.
    """
    places = [(path.split("."), path) for path in paths]
    lanes = change_of(scene.lanes, [(keys[1:], path) for keys, path in places if keys[0] == "lanes"], True)
    others = change_of(scene, [(keys, path) for keys, path in places if keys[0] != "lanes"], True)

    def moving(values: Mapping[str, Any]) -> Moving:
        numbers = {path: float(values[path]) for path in paths}
        return lanes(numbers), others(numbers).settings()

    return moving


def is_structure(path: str, value: Any) -> bool:
    """Return True if the value changes the structure of the scene. Such a scene is checked completely, like a file.

    For any other value it is sufficient to check its own field.
    """
    return not isinstance(value, (int, float, np.number)) or any(part in LENGTHS for part in path.split("."))


def changed(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """Return the scene with the values at their paths, after the same checks as for a scene file.

    Values that change the structure are inserted first. Raise SceneError if a check fails.
    """
    structure = [path for path, value in values.items() if is_structure(path, value)]
    found = scene
    for path in structure:
        found = change_of(found, [(path.split("."), path)])(values)
    if structure:
        lanes = zip(found.lanes, scene.lanes, strict=True)
        found = found.model_copy(update={"lanes": tuple([_spread_anew(*both) for both in lanes])})
    for path in values:
        if path not in structure:
            found = change_of(found, [(path.split("."), path)])(values)
    try:
        return Scene.model_validate(found.model_dump(warnings=False))
    except ValidationError as error:
        raise scene_error("the scene", error) from None


def _spread_anew(lane: Lane, before: Lane) -> Lane:
    """Return `lane` with velocities for its new numbers of beads. The lane `before` has the old numbers.

    The velocities change only if all strikers had one velocity and all targets were at rest. The new strikers then get
    this velocity, and the new targets are at rest.
    """
    velocity, clusters = lane.velocity, before.beads
    if lane.beads == clusters or not (isinstance(velocity, tuple) and isinstance(clusters, tuple)):
        return lane
    strikers, targets = clusters
    if velocity != (velocity[0],) * strikers + (0.0,) * targets:
        return lane
    return lane.model_copy(update={"velocity": _spread(velocity[0], lane.beads)})


def _spread(speed: Any, beads: Any) -> Any:
    """Return the velocities of all beads if the strikers have the speed `speed`. `beads` is [strikers, targets].

    For any other value of `beads`, return `speed` itself. The check of the scene then rejects it, as in a file.
    """
    pair = isinstance(beads, (list, tuple)) and len(beads) == 2
    return strikers_at(speed, beads) if pair else speed


def change_of(item: Any, places: Sequence[tuple[list[str], str]], check: bool = False) -> Change:
    """Return a function that maps the values of a point to a changed copy of `item`.

    The function inserts the value of each path at the keys of the path. If two paths have the same keys, the last one
    wins. Tables and lists along a path are copied, and `item` stays unchanged. Everything that does not depend on the
    values is resolved once. Raise SceneError if a path does not exist. With `check`, the function raises
    ValidationError if a field rejects its new value.
    """
    if not places:
        return lambda _: item
    path = places[-1][1]
    if not places[-1][0]:
        return lambda values: values[path]
    if isinstance(item, BaseModel):
        return _change_of_table(item, places, check)
    if isinstance(item, tuple):
        return _change_of_list(item, places, check)
    keys = places[-1][0]
    raise SceneError([f"{path}: there is nothing below {'.'.join(path.split('.')[: -len(keys)])!r}, which is {item!r}"])


def _change_of_table(item: BaseModel, places: Sequence[tuple[list[str], str]], check: bool) -> Change:
    known, changes = type(item).model_fields, dict[str, Change]()
    for (key, *_), path in places:
        if key not in known:
            raise SceneError([f"{path}: there is no {key!r}{suggestion(key, known)}"])
        own = [(keys[1:], of) for keys, of in places if keys[0] == key]
        inner = getattr(item, key)
        single = isinstance(item, Lane) and key in ONE_OR_MANY and not isinstance(inner, tuple)
        if single and isinstance(item, Lane) and any(rest and _is_place(rest[0]) for rest, _ in own):
            inner = (inner,) * (len(item.velocity) - (key != "mass"))
            own = [(rest if rest and _is_place(rest[0]) else [EVERY, *rest], of) for rest, of in own]
        whole = max((k for k, (rest, _) in enumerate(own) if not rest), default=None)
        if isinstance(item, Lane) and key == "velocity" and whole is not None:
            changes[key] = _change_of_velocity(item.beads, own[whole][1], own[whole + 1 :])
        else:
            changes[key] = change_of(inner, own, check)
    if check:
        changes = {key: _checked_change(type(item), key, change) for key, change in changes.items()}
    return lambda values: item.model_copy(update={key: change(values) for key, change in changes.items()})


def _checked_change(table: type[BaseModel], key: str, change: Change) -> Change:
    field = _field_of(table, key)
    return lambda values: field.validate_python(change(values))


@cache
def _field_of(table: type[BaseModel], key: str) -> TypeAdapter[Any]:
    """Return a validator for one field of a table. The validator works without the rest of the table."""
    field = table.model_fields[key]
    kind: Any = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    if isinstance(field.annotation, type) and issubclass(
        field.annotation, BaseModel
    ):  # A table is excluded because it has its own configuration.
        return TypeAdapter(kind)
    return TypeAdapter(kind, config=ConfigDict(allow_inf_nan=table.model_config.get("allow_inf_nan", True)))


def _change_of_velocity(beads: Any, path: str, after: Sequence[tuple[list[str], str]]) -> Change:
    """Return a change of the velocities.

    The value at `path` applies to all beads, or to the strikers if it is a number. The paths `after` then change the
    velocities of single beads.
    """

    def velocity(values: Mapping[str, Any]) -> Any:
        whole = values[path]
        return change_of(tuple(whole) if isinstance(whole, (list, tuple)) else _spread(whole, beads), after)(values)

    return velocity


def _change_of_list(item: tuple[Any, ...], places: Sequence[tuple[list[str], str]], check: bool) -> Change:
    for (key, *_), path in places:
        if key != EVERY and not (key.isdecimal() and int(key) < len(item)):
            raise SceneError([f"{path}: {key!r} must be a number from 0 to {len(item) - 1}, or * for all"])
    changes = [
        change_of(part, [(keys[1:], path) for keys, path in places if keys[0] == EVERY or int(keys[0]) == k], check)
        for k, part in enumerate(item)
    ]
    return lambda values: tuple([change(values) for change in changes])


def _is_place(key: str) -> bool:
    return key.isdecimal() or key == EVERY
