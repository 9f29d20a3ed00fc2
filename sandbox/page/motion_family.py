"""A family of motions: a scene with one parameter, alpha or the speed, at several values, for the slider of a page."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from softcradle.sandbox.output_files import output_file
from softcradle.sandbox.page.played_motion import PlayedMotion, scene_member
from softcradle.sandbox.page.recorded_scene import recorded
from softcradle.sandbox.page.shared_page import PageReport, write_text
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Lane, Scene
from softcradle.scenes.contact_kinds import KIND_BY_NAME
from softcradle.scenes.contact_table import AnyLaw, Law

ALPHAS = (1 / 30, 1 / 20, 1 / 14, 1 / 10, 1 / 7, 1 / 5, 1 / 4, 1 / 3, 1 / 2, 1.0)
SPEEDS = (0.25, 0.35, 0.5, 0.7, 0.85, 1.0, 1.2, 1.4, 1.7, 2.0)  # factors on all start velocities
SAME = 1e-6  # relative difference up to which a value of the list is the scene's own
Change = Callable[[Lane, float], Lane]


def render_page(
    scene: Scene, output: str | os.PathLike[str], slow: float | None = None, live: str | None = None, **settings: Any
) -> PageReport:
    """Simulate `scene` and write the page that plays it; with `live`, a family over that parameter.

    `slow` are seconds for one of motion, None takes the scene's; `settings` are keywords of `physics.simulate`. What may be
    wrong with the motion is a RuntimeWarning.

    Raises:
        UserError: it cannot be written or simulated; nothing is left behind.
    """
    if slow is not None:
        scene = scene.model_copy(update={"view": scene.view.model_copy(update={"slow": slow})})
    with output_file(output) as temporary:  # before the runs, so that an unwritable place is refused at once
        if live is None:
            played = PlayedMotion(scene, (scene_member(scene, recorded(scene, **settings)),))
        else:
            played = family(scene, live, **settings)
        size = write_text(played, temporary)
    for sentence in dict.fromkeys(
        str(w) for found in played.members[played.first].trajectories for w in found.warnings
    ):
        warnings.warn(sentence, RuntimeWarning, stacklevel=2)
    return PageReport(Path(output), size)


def family(scene: Scene, parameter: str, **settings: Any) -> PlayedMotion:
    """The motions of `scene` for values of `parameter`, of which the scene's own is shown first.

    Raises:
        UserError: the parameter is neither alpha nor speed, or the scene does not have it.
    """
    change: Change
    if parameter == "alpha":
        own = _own_alpha(scene)
        values, change = _with_own(ALPHAS, own), _with_alpha
        names = [f"alpha = {_ratio(value)}" for value in values]
    elif parameter == "speed":
        own, values, change = 1.0, list(SPEEDS), _with_speed
        names = [f"{value:g} times the speed" if value != 1.0 else "the scene's speed" for value in values]
    else:
        raise UserError(f"--live is a slider over alpha or speed, not {parameter!r}")
    members = []
    for name, value in zip(names, values, strict=True):
        one = _changed(scene, value, own, change)
        members.append(scene_member(one, recorded(one, **settings), name))
    return PlayedMotion(scene, tuple(members), parameter, values.index(own))


def _changed(scene: Scene, value: float, own: float, change: Change) -> Scene:
    if value == own:
        return scene
    return scene.model_copy(update={"lanes": tuple(change(lane, value) for lane in scene.lanes)})


def _with_own(values: tuple[float, ...], own: float) -> list[float]:
    others = [value for value in values if not math.isclose(value, own, rel_tol=SAME)]
    return sorted([*others, own])


def _laws(lane: Lane) -> tuple[AnyLaw, ...]:
    return lane.contact if isinstance(lane.contact, tuple) else (lane.contact,)


def _has_alpha(law: AnyLaw) -> bool:
    return isinstance(law, Law) and "alpha" in KIND_BY_NAME[law.law].numbers


def _own_alpha(scene: Scene) -> float:
    """The alpha that most contacts with an alpha have."""
    laws = [law for lane in scene.lanes for law in _laws(lane) if isinstance(law, Law) and _has_alpha(law)]
    found = [law.contact().exponent for law in laws]
    if not found:
        raise UserError('--live alpha needs a contact with an alpha (law = "power_law"); take --live speed')
    values, counts = np.unique(found, return_counts=True)
    return float(values[np.argmax(counts)])


def _with_alpha(lane: Lane, alpha: float) -> Lane:
    """`lane` with that `alpha` in every contact that has one; gaps below 0 keep their overlap, not their force."""
    laws = tuple(law.model_copy(update={"alpha": alpha}) if _has_alpha(law) else law for law in _laws(lane))
    contact = laws if isinstance(lane.contact, tuple) else laws[0]
    label = "" if "alpha" in lane.label else lane.label  # which would name the scene's own
    return lane.model_copy(update={"contact": contact, "label": label})


def _with_speed(lane: Lane, factor: float) -> Lane:
    return lane.model_copy(update={"velocity": tuple(factor * speed for speed in lane.velocity)})


def _ratio(value: float) -> str:
    """A value as a fraction of small numbers, else with four digits."""
    ratio = Fraction(value).limit_denominator(100)
    return str(ratio) if math.isclose(float(ratio), value, rel_tol=SAME) else f"{value:.4g}"
