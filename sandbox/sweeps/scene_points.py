"""From a scene and a point to what moves: the numbers at dotted paths such as `lanes.0.contact.alpha` are replaced."""

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

ONE_OR_MANY = ("mass", "contact", "gap")  # fields of a lane that may be one value for all
LENGTHS = ("beads",)  # fields that decide how long the lists of a lane are
EVERY = "*"  # a path of every item of a list
KEPT = 64  # scenes with other beads, laws or methods that are kept in memory

Change = Callable[[Mapping[str, Any]], Any]  # gives a scene or a part of it with the values of a point, by path
Moving = tuple[Sequence[Lane], Mapping[str, Any]]  # the lanes of a scene, and its keywords of `simulate`


class LaneStart(NamedTuple):
    """A chain, the start velocities of its beads, and keywords of `simulate`."""

    chain: Chain
    velocity: Any
    settings: Mapping[str, Any]


@dataclass
class ScenePoints:
    """A scene whose numbers vary.

    Attributes:
        scene: the scene; every lane of it moves.
    """

    scene: Scene
    _moving: dict[tuple[Any, ...], Callable[[Mapping[str, Any]], Moving]] = field(
        default_factory=dict, repr=False, compare=False
    )

    def __getstate__(self) -> Scene:
        """The scene: the functions that were made of it cannot be sent, and are made anew."""
        return self.scene

    def __setstate__(self, scene: Scene) -> None:
        self.scene, self._moving = scene, {}

    def starts(self, values: Mapping[str, Any]) -> list[LaneStart]:
        """What moves at a point, a lane each. Raises ValueError where the numbers cannot be."""
        structure = {path: value for path, value in values.items() if is_structure(path, value)}
        kinds = tuple(map(type, structure.values()))  # 4 and 4.0 are equal, and only one of them is a number of beads
        paths = tuple(path for path in values if path not in structure)
        key = (*structure.items(), kinds, paths)
        if key not in self._moving:
            if len(self._moving) >= KEPT:
                self._moving.clear()
            self._moving[key] = _moving_at(self._base(structure), paths)
        try:
            lanes, settings = self._moving[key](values)
        except ValidationError:
            self.checked(values)  # says what is wrong with which number, as of a file
            raise
        return [LaneStart(lane.chain(), lane.velocity, settings) for lane in lanes]

    def checked(self, values: Mapping[str, Any]) -> Scene:
        """The scene at a point, checked as a file is. Raises SceneError."""
        structure = {path: value for path, value in values.items() if is_structure(path, value)}
        numbers = {path: value for path, value in values.items() if path not in structure}
        return changed(self._base(structure), numbers)

    def _base(self, structure: Mapping[str, Any]) -> Scene:
        """The scene with other beads or texts, checked."""
        return changed(self.scene, structure) if structure else self.scene


def _moving_at(scene: Scene, paths: Sequence[str]) -> Callable[[Mapping[str, Any]], Moving]:
    """What gives the lanes and settings of the scene with numbers at `paths`; made once for all points that share the rest."""
    places = [(path.split("."), path) for path in paths]
    lanes = change_of(scene.lanes, [(keys[1:], path) for keys, path in places if keys[0] == "lanes"], True)
    others = change_of(scene, [(keys, path) for keys, path in places if keys[0] != "lanes"], True)

    def moving(values: Mapping[str, Any]) -> Moving:
        numbers = {path: float(values[path]) for path in paths}
        return lanes(numbers), others(numbers).settings()

    return moving


def is_structure(path: str, value: Any) -> bool:
    """Whether another value makes another kind of chain, checked as a file is; of other numbers their own fields are."""
    return not isinstance(value, (int, float, np.number)) or any(part in LENGTHS for part in path.split("."))


def changed(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """The scene with the values at their paths, those of its structure first, checked as a file is. Raises SceneError."""
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
    """The lane with other beads than `before`; if the strikers had one velocity and the targets rested, so they do again."""
    velocity, clusters = lane.velocity, before.beads
    if lane.beads == clusters or not (isinstance(velocity, tuple) and isinstance(clusters, tuple)):
        return lane
    strikers, targets = clusters
    if velocity != (velocity[0],) * strikers + (0.0,) * targets:
        return lane
    return lane.model_copy(update={"velocity": _spread(velocity[0], lane.beads)})


def _spread(speed: Any, beads: Any) -> Any:
    """The speed as the velocities of [strikers, targets]; as it is for other beads, as in a file, which then is refused."""
    pair = isinstance(beads, (list, tuple)) and len(beads) == 2
    return strikers_at(speed, beads) if pair else speed


def change_of(item: Any, places: Sequence[tuple[list[str], str]], check: bool = False) -> Change:
    """A function that gives `item` with the values of each path at its keys; of two the last.

    Tables and lists on the way are new, `item` itself stays; what the values do not tell is found once. Raises SceneError.
    With `check` the function raises a ValidationError where a field of a table does not take what it becomes.
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
    """What checks a value of a field as the table does, without the rest of the table."""
    field = table.model_fields[key]
    kind: Any = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    if isinstance(field.annotation, type) and issubclass(
        field.annotation, BaseModel
    ):  # a table has a config of its own
        return TypeAdapter(kind)
    return TypeAdapter(kind, config=ConfigDict(allow_inf_nan=table.model_config.get("allow_inf_nan", True)))


def _change_of_velocity(beads: Any, path: str, after: Sequence[tuple[list[str], str]]) -> Change:
    """The velocities that the value at `path` gives all beads, or the strikers if it is a number, and those of single ones."""

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
