"""The results of a comparison: the trajectory of each side and its measures."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import groupby
from typing import Any

import numpy as np
from softcradle.physics import Trajectory
from softcradle.physics.analysis.collision import collide, measured
from softcradle.physics.analysis.collision_measures import CollisionMeasures
from softcradle.physics.trajectory_file import versions
from softcradle.sandbox.studies.compare.sides import Comparison, Side
from softcradle.sandbox.trajectory_summary import summarise
from softcradle.sandbox.user_error import UserError
from softcradle.scenes.contact_text import contact_text


@dataclass(frozen=True)
class SideResult:
    """One side: its trajectory and its measures."""

    side: Side
    trajectory: Trajectory
    measures: CollisionMeasures

    @property
    def contact(self) -> str:
        """Its contacts in a line of text."""
        return _contacts_text(self.trajectory)


def _contacts_text(trajectory: Trajectory) -> str:
    """The contacts of a chain; equal neighbours are named once."""
    found = [text for text, _ in groupby(contact_text(contact) for contact in trajectory.chain.contact)]
    return ", ".join(found) if len(found) <= 4 else f"{found[0]}, ... {found[-1]}"


def solve_sides(comparison: Comparison, method: str | None = None, step: float | None = None) -> list[SideResult]:
    """Simulate and measure every side.

    Raises:
        UserError: a method or step that a side cannot take.
    """
    return [_solve_side(side, method, step) for side in comparison.sides]


def _solve_side(side: Side, method: str | None, step: float | None) -> SideResult:
    settings = side.scene.settings(method=method, step=step)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # the report shows trajectory.warnings, which are the same
        try:
            trajectory = collide(side.lane.chain(), side.lane.velocity, **settings)
        except ValueError as error:
            raise UserError(f"{side.name}: {error}") from None
    if not np.isfinite(trajectory.position).all():
        raise UserError(f"{side.name}: the motion by {trajectory.method} did not stay finite: choose a smaller step")
    return SideResult(side, trajectory, measured(trajectory))


def end_time(results: Sequence[SideResult]) -> float:
    """Time [s] at which the longest motion ends."""
    return max(float(result.trajectory.time[-1]) for result in results)


def results_as_json(comparison: Comparison, results: Sequence[SideResult]) -> dict[str, Any]:
    """Everything as plain numbers, lists and texts."""
    return {"title": comparison.title, "sides": [_side_as_json(result) for result in results], "versions": versions()}


def _side_as_json(result: SideResult) -> dict[str, Any]:
    summary, trajectory = summarise(result.side.name, result.trajectory), result.trajectory
    return {
        "name": result.side.name,
        "contact": result.contact,
        "masses": [mass if math.isfinite(mass) else None for mass in trajectory.chain.mass],
        "start_velocity": list(result.side.lane.velocity),
        "measures": asdict(result.measures),
        "method": trajectory.method,
        "status": summary.status,
        "velocity_error": [bead.velocity_error for bead in summary.beads],
        "energy_error": summary.energy_error,
        "momentum_error": summary.momentum_error,
        "warnings": [str(warning) for warning in trajectory.warnings],
    }
