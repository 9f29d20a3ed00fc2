"""The sweep of a parameter: the scene again and again with one number changed, each run from its start to its end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from softcradle.sandbox.motion import Motion
from softcradle.sandbox.session.inputs import Input
from softcradle.sandbox.session.session import Session
from softcradle.scenes import Scene


@dataclass(frozen=True, eq=False)
class Variant:
    """The scene with one value of the parameter; `motion` is that of the lane, None where it could not be computed."""

    value: float
    motion: Motion | None
    problem: str = ""


def variants(
    scene: Scene,
    lane: int,
    values: Sequence[float],
    edit: Callable[[float], Input],
    motions: Callable[[Scene], list[Motion]],
) -> list[Variant]:
    """The scene with each of the `values`, set by `edit` at its start; `motions` computes those of all lanes of a scene."""
    found = []
    for value in values:
        session = Session(scene)
        try:
            session.apply(edit(value))
            found.append(Variant(value, motions(session.to_scene())[lane]))
        except (ValueError, RuntimeError, ArithmeticError) as error:
            found.append(Variant(value, None, str(error)))
    return found
