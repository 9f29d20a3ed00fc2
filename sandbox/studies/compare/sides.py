"""What is compared: lanes of scenes, or one scene with several contacts; refused in a sentence before any work."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from softcradle.physics.analysis.collision import struck_contact
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Lane, Scene, SceneError, View
from softcradle.scenes.contact_table import Law
from softcradle.scenes.contact_text import contact_from, contact_text

MOST_SIDES = 6  # rows that a film can show


@dataclass(frozen=True)
class Side:
    """One of those compared: its name, its lane, and the scene whose settings hold for it."""

    name: str
    lane: Lane
    scene: Scene


@dataclass(frozen=True)
class Comparison:
    """Two sides or more, and what they are called together."""

    title: str
    sides: tuple[Side, ...]

    def film(self, end: float) -> Scene:
        """All sides as the lanes of one scene, on one clock that runs for at least `end` [s]."""
        lanes = tuple(side.lane.model_copy(update={"label": side.name}) for side in self.sides)
        views = [side.scene.view for side in self.sides]
        view = View(
            slow=max(view.slow for view in views),
            length=max(view.length for view in views),
            after=None if any(view.after is None for view in views) else max(view.after or 0.0 for view in views),
            labels=all(view.labels for view in views),
        )
        timed = any(side.scene.duration is not None for side in self.sides)
        sources = dict.fromkeys(side.scene.source for side in self.sides if side.scene.source)
        return Scene(
            title=self.title, source=" · ".join(sources), lanes=lanes, duration=end if timed else None, view=view
        )


def chosen(names: Sequence[str], contacts: Sequence[str], fewest: int = 2) -> Comparison:
    """The comparison of the scenes called `names`, or of one scene as it is and with each of `contacts` everywhere.

    `fewest` sides are enough.

    Raises:
        UserError: no such scene or contact, too few or too many sides, or one in which nothing collides.
    """
    scenes = [load_scene(name) for name in names]
    sides = [side for name, scene in zip(names, scenes, strict=True) for side in _own(name, scene, len(scenes))]
    if contacts:
        if len(scenes) != 1:
            raise UserError(f"--contact changes one scene, but {len(scenes)} are given: {', '.join(names)}")
        sides = _variants(names[0], scenes[0], contacts)
    return checked(Comparison(_title(scenes, sides, bool(contacts)), _told_apart(sides)), fewest)


def checked(comparison: Comparison, fewest: int) -> Comparison:
    """The same, or a UserError where it cannot be compared or has less than `fewest` sides."""
    count = len(comparison.sides)
    if count < fewest:
        name = comparison.sides[0].name
        raise UserError(f"{name} alone has nothing to be compared with: name another scene, or --contact LAW(...)")
    if count > MOST_SIDES:
        raise UserError(f"at most {MOST_SIDES} can be compared side by side, not {count}")
    for side in comparison.sides:
        try:
            struck_contact(side.lane.velocity)
        except ValueError as error:
            raise UserError(f"{side.name}: {error}") from None
    return comparison


def _own(name: str, scene: Scene, scenes: int) -> list[Side]:
    """The lanes of a scene as they are."""
    if len(scene.lanes) == 1:
        return [Side(name, scene.lanes[0], scene)]
    prefix = f"{name}: " if scenes > 1 else ""
    return [Side(f"{prefix}{lane.label or k}", lane, scene) for k, lane in enumerate(scene.lanes, 1)]


def _variants(name: str, scene: Scene, contacts: Sequence[str]) -> list[Side]:
    """Each lane as it is, then with each of the contacts; what comes twice is shown once."""
    try:
        laws = [contact_from(text) for text in contacts]
    except SceneError as error:
        raise UserError(f"--contact: {error}") from None
    sides: list[Side] = []
    for lane in scene.lanes:
        own = isinstance(lane.contact, Law)
        label = contact_text(lane.contact) if isinstance(lane.contact, Law) else "as it is"
        found = [Side(label, lane, scene)]
        for law in laws:
            if (own and law == lane.contact) or law in [side.lane.contact for side in found]:
                continue
            found.append(with_contact(found[0], law))
        several = len(scene.lanes) > 1 and lane.label
        sides += [Side(f"{lane.label}: {side.name}", side.lane, scene) for side in found] if several else found
    return sides


def with_contact(side: Side, law: Law) -> Side:
    """The same with `law` in every contact."""
    return Side(contact_text(law), side.lane.model_copy(update={"contact": law}), side.scene)


def _title(scenes: Sequence[Scene], sides: Sequence[Side], variants: bool) -> str:
    titles = list(dict.fromkeys(scene.title for scene in scenes))
    if variants or len(titles) == 1:
        return f"{titles[0]}: {len(sides)} side by side" if len(sides) > 2 else f"{titles[0]}: two side by side"
    return " against ".join(titles) if len(titles) < 3 else f"{titles[0]} and {len(titles) - 1} others"


def _told_apart(sides: Sequence[Side]) -> tuple[Side, ...]:
    names: dict[str, int] = {}
    found = []
    for side in sides:
        names[side.name] = count = names.get(side.name, 0) + 1
        found.append(Side(f"{side.name} ({count})", side.lane, side.scene) if count > 1 else side)
    return tuple(found)
