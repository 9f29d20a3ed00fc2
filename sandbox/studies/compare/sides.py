"""Sides of a comparison. A side is a lane of a scene, a scene with another contact, or the nearest contact.

All sides are validated before the first simulation.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from pydantic import ValidationError
from softcradle.physics.analysis.collision import struck_contact
from softcradle.physics.analysis.matching import ALPHAS, NEAR, Distance, Match, match, only_contact
from softcradle.physics.methods import refusal_of_fineness
from softcradle.sandbox.scene_runs import load_scene
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Lane, Scene, SceneError, View
from softcradle.scenes.contact_table import Law, law_of
from softcradle.scenes.contact_text import contact_from, contact_text
from softcradle.scenes.scene_errors import scene_error

FINENESS = ("method", "step", "tolerance")  # Names of the scene's fields that set its method and accuracy.
MOST_SIDES = 6  # Maximum number of sides. The charts of the page have this number of colours.


@dataclass(frozen=True)
class Side:
    """One chain of a comparison, with its name, its lane and the scene that provides its settings."""

    name: str
    lane: Lane
    scene: Scene


@dataclass(frozen=True)
class Comparison:
    """Two or more sides with a common title."""

    title: str
    sides: tuple[Side, ...]

    def as_scene(self, end: float) -> Scene:
        """Return a scene in which each side is a lane. The scene lasts until `end` [s] if the scene of any side has a
        duration.

        The method, the step or tolerance, and the magnification are set if the scenes of all sides agree.
        """
        lanes = tuple(side.lane.model_copy(update={"label": side.name}) for side in self.sides)
        views = [side.scene.view for side in self.sides]
        view = View(
            slow=max(view.slow for view in views),
            length=max(view.length for view in views),
            magnify=views[0].magnify if len({view.magnify for view in views}) == 1 else None,
            after=None if any(view.after is None for view in views) else max(view.after or 0.0 for view in views),
            labels=all(view.labels for view in views),
        )
        ways = {name: {getattr(side.scene, name) for side in self.sides} for name in FINENESS}
        timed = any(side.scene.duration is not None for side in self.sides)
        sources = dict.fromkeys(side.scene.source for side in self.sides if side.scene.source)
        return Scene(
            title=self.title,
            source=" · ".join(sources),
            lanes=lanes,
            duration=end if timed else None,
            **{name: found.pop() for name, found in ways.items() if len(found) == 1},
            view=view,
        )


def comparison_of(
    names: Sequence[str], contacts: Sequence[str], method: str | None = None, step: float | None = None, added: int = 0
) -> Comparison:
    """Return the comparison of the scenes `names`, or of one scene with several contacts.

    If `contacts` are given, the first side is the scene as it is. In each other side, one of `contacts` replaces all
    contacts of the scene. All sides use `method` and `step`; None uses the settings of the scene. The number `added`
    counts sides that the caller will add later.

    Raises:
        UserError: for an unknown scene or contact, too few or too many sides, or a side in which nothing collides.
    """
    scenes = [_moved_by(load_scene(name), method, step) for name in names]
    # A report cannot contain characters that UTF-8 does not encode.
    told = [name.encode(errors="replace").decode() for name in names]
    sides = [side for name, scene in zip(told, scenes, strict=True) for side in _lane_sides(name, scene, len(scenes))]
    if contacts:
        if len(scenes) != 1:
            raise UserError(f"--contact changes one scene, but {len(scenes)} are given: {', '.join(names)}")
        sides = _contact_sides(scenes[0], contacts)
    comparison = Comparison(_title(scenes, sides, bool(contacts)), _distinct_names(sides))
    _check(comparison, added)
    return comparison


def _moved_by(scene: Scene, method: str | None, step: float | None) -> Scene:
    """Return `scene` with the given method and step. The scene keeps its own tolerance if the method uses a tolerance."""
    settings = scene.settings(method=method, step=step)
    if refusal_of_fineness(settings.get("method", ""), None, scene.tolerance):
        settings["tolerance"] = None
    return scene.model_copy(update={name: settings.get(name) for name in FINENESS})


def _check(comparison: Comparison, added: int) -> None:
    """Raise UserError if the comparison is not valid.

    A comparison must not have too few or too many sides, including the `added` ones. Each lane must be valid and have a
    collision.
    """
    count = len(comparison.sides) + added
    if count < 2:
        name = comparison.sides[0].name
        raise UserError(f"{name} alone has nothing to be compared with: name another scene, or --contact LAW(...)")
    if count > MOST_SIDES:
        raise UserError(f"at most {MOST_SIDES} can be compared side by side, not {count}")
    for side in comparison.sides:
        try:
            # The law of the lane can differ from the law in its file, so the lane is validated again.
            Lane.model_validate(side.lane)
            struck_contact(side.lane.velocity)
        except ValidationError as error:
            raise UserError(str(scene_error(side.name, error))) from None
        except ValueError as error:
            raise UserError(f"{side.name}: {error}") from None


def _lane_sides(name: str, scene: Scene, scenes: int) -> list[Side]:
    """Return each lane of a scene as one side. The number `scenes` counts the compared scenes."""
    if len(scene.lanes) == 1:
        return [Side(name, scene.lanes[0], scene)]
    prefix = f"{name}: " if scenes > 1 else ""
    return [Side(f"{prefix}{lane.label or k}", lane, scene) for k, lane in enumerate(scene.lanes, 1)]


def _contact_sides(scene: Scene, contacts: Sequence[str]) -> list[Side]:
    """Return each lane of `scene` as it is, and with each of `contacts`. Duplicates are left out."""
    try:
        laws = [contact_from(text) for text in contacts]
    except SceneError as error:
        raise UserError(f"--contact: {error}") from None
    sides: list[Side] = []
    for lane in scene.lanes:
        label = contact_text(lane.contact) if isinstance(lane.contact, Law) else "as it is"
        found = [Side(label, lane, scene)]
        for law in laws:
            if law not in [side.lane.contact for side in found]:
                found.append(with_contact(found[0], law))
        several = len(scene.lanes) > 1 and lane.label
        sides += [Side(f"{lane.label}: {side.name}", side.lane, scene) for side in found] if several else found
    return sides


def with_contact(side: Side, law: Law) -> Side:
    """Return a copy of `side` in which every contact has the law `law`."""
    return Side(contact_text(law), side.lane.model_copy(update={"contact": law}), side.scene)


def _title(scenes: Sequence[Scene], sides: Sequence[Side], variants: bool) -> str:
    titles = list(dict.fromkeys(scene.title for scene in scenes))
    if variants or len(titles) == 1:
        return f"{titles[0]}: {len(sides)} side by side" if len(sides) > 2 else f"{titles[0]}: two side by side"
    return " against ".join(titles) if len(titles) < 3 else f"{titles[0]} and {len(titles) - 1} others"


def _distinct_names(sides: Sequence[Side]) -> tuple[Side, ...]:
    """Return the sides with distinct names. If two sides have the same name, the second is called "name (2)"."""
    names: dict[str, int] = {}
    found = []
    for side in sides:
        names[side.name] = count = names.get(side.name, 0) + 1
        found.append(Side(f"{side.name} ({count})", side.lane, side.scene) if count > 1 else side)
    return tuple(found)


DIFFERENCES = {  # For each kind of distance, the quantity that differs and the text for the size of the difference.
    "force": "forces of the struck contact differ by {} in the root mean square",
    "outcome": "final velocities over the closing speed and the logarithm of the contact time differ by {} together",
}


def side_to_match(comparison: Comparison) -> Side:
    """Return the side whose contact is to be matched, which is the first one.

    Raise UserError if its contact cannot be matched.
    """
    side = comparison.sides[0]
    if len(side.scene.lanes) > 1 or len({other.scene.title for other in comparison.sides}) > 1:
        raise UserError("--match needs one scene with one lane")
    try:
        only_contact(side.lane.chain())
    except ValueError as error:
        raise UserError(f"{side.name}: {error}") from None
    return side


def add_match(
    comparison: Comparison, distance: Distance, progress: Callable[[int], None] | None = None
) -> tuple[Comparison, Match]:
    """Search the nearest contact, and return the comparison with it as the last side, and the match.

    The function `progress` is called as in `match`.
    """
    side = side_to_match(comparison)
    found = match(side.lane.chain(), side.lane.velocity, distance, progress=progress)
    law: Law = law_of(found.contact)
    given = replace(side, name=contact_text(found.given))
    nearest = with_contact(side, law)
    nearest = replace(nearest, name=f"nearest: {short_text(contact_text(found.contact))}")
    sides = (given, *comparison.sides[1:], nearest)
    return Comparison(f"{side.scene.title}, and its nearest {_family(found)}", sides), found


def short_text(text: str) -> str:
    """Return the text of a contact for labels, with three digits of each number. JSON files contain all digits.

    >>> short_text("draft_gear(0.668973, 0.985412)")
    'draft_gear(0.669, 0.985)'
    """
    return re.sub(r"\d+\.\d+(?:e[-+]?\d+)?", lambda number: f"{float(number[0]):.3g}", text)


def match_sentence(found: Match) -> str:
    """Return a sentence that names the nearest contact and its difference, and judges if it is near."""
    difference = DIFFERENCES[found.distance].format(f"{100.0 * found.residual:.2g} %")
    kind, contact, given = _family(found), contact_text(found.contact), contact_text(found.given)
    if found.near:
        text = f"The {kind} nearest to {given} in this collision is {contact}: {difference}."
    else:
        text = f"No {kind} comes near {given} in this collision: with the nearest, {contact}, {difference} (near: {NEAR:.0%})."
    if found.distance == "force":
        text += f" There {DIFFERENCES['outcome'].format(f'{100.0 * found.outcome:.2g} %')}."
    if found.speed_ratio is not None:
        text += f" {_speed_sentence(found.speed_ratio)}"
    if found.ends:
        ends = " and ".join(found.ends)
        text += f" Its {ends} lies at the end of the range searched{_range(found)}: a nearer one may lie beyond."
    return text


def _speed_sentence(ratio: float) -> str:
    """Return a sentence that compares the impact speed of the draft gear with its critical speed."""
    below = ": the clusters stay exactly rigid" if ratio <= 1.0 else ""
    return f"The draft gear is struck at {ratio:.3g} times its critical speed{below}."


def match_as_json(found: Match) -> dict[str, Any]:
    """Return the match as JSON data: numbers and texts."""
    return asdict(found) | {
        "ends": list(found.ends),
        "sentence": match_sentence(found),
        "given": contact_text(found.given),
        "contact": contact_text(found.contact),
        "numbers": asdict(found.contact),
    }


def _family(found: Match) -> str:
    return "power law" if found.contact.preload == 0.0 else "draft gear"


def _range(found: Match) -> str:
    return f" ({ALPHAS[0]:g} to {ALPHAS[1]:g})" if "alpha" in found.ends else ""
