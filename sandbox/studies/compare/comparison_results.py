"""The results of a comparison: each side's motion and what it came to."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from softcradle.physics import Trajectory
from softcradle.physics.analysis.collision import CollisionMeasures, collide, measured
from softcradle.physics.storage import versions
from softcradle.sandbox.studies.compare.sides import Comparison, Side
from softcradle.sandbox.trajectory_summary import summarise
from softcradle.sandbox.user_error import UserError
from softcradle.scenes.contact_text import contact_text


@dataclass(frozen=True)
class Result:
    """One side: how it moved, and its measures."""

    side: Side
    trajectory: Trajectory
    measures: CollisionMeasures

    @property
    def contact(self) -> str:
        """Its contacts in a line of text."""
        return contacts_text(self.trajectory)


def contacts_text(trajectory: Trajectory) -> str:
    """The contacts of a chain, those that follow each other and are alike told once."""
    found: list[str] = []
    for contact in trajectory.chain.contact:
        text = contact_text(contact)
        if not found or found[-1] != text:
            found.append(text)
    return ", ".join(found) if len(found) <= 4 else f"{found[0]}, ... {found[-1]}"


def solved(comparison: Comparison, method: str | None = None, step: float | None = None) -> list[Result]:
    """Every side, moved and measured.

    Raises:
        UserError: a method or step that a side cannot take.
    """
    return [_solved(side, method, step) for side in comparison.sides]


def _solved(side: Side, method: str | None, step: float | None) -> Result:
    settings = side.scene.settings(method=method, step=step)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # they are in trajectory.warnings too, which the report shows
        try:
            trajectory = collide(side.lane.chain(), side.lane.velocity, **settings)
        except ValueError as error:
            raise UserError(f"{side.name}: {error}") from None
    if not np.isfinite(trajectory.position).all():
        raise UserError(f"{side.name}: the motion by {trajectory.method} did not stay finite: choose a smaller step")
    return Result(side, trajectory, measured(trajectory))


def ends(results: Sequence[Result]) -> float:
    """Time at which the last of them is over [s]."""
    return max(float(result.trajectory.time[-1]) for result in results)


def as_json(comparison: Comparison, results: Sequence[Result]) -> dict[str, Any]:
    """Everything as plain numbers, lists and texts."""
    return {"title": comparison.title, "sides": [_side(result) for result in results], "versions": versions()}


def _side(result: Result) -> dict[str, Any]:
    summary, trajectory = summarise(result.side.name, result.trajectory), result.trajectory
    return {
        "name": result.side.name,
        "contact": result.contact,
        "masses": [mass if math.isfinite(mass) else None for mass in trajectory.chain.mass],
        "start_velocity": list(result.side.lane.velocity),
        "measures": asdict(result.measures),
        "method": trajectory.method,
        "energy_error": summary.energy_error,
        "momentum_error": summary.momentum_error,
        "warnings": [warning.sentence for warning in trajectory.warnings],
    }
