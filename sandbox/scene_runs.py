"""Loading of a scene by its name, and simulation of the lanes of a scene. Errors become UserErrors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from softcradle.sandbox.user_error import UserError

# Default methods of simulations if neither the scene nor the user has chosen a method. The default method of
# `simulate`, and of every study, is "accurate".
KEEPING = "conserving"  # for simulations that must conserve energy and momentum with any time step
SHOWN = KEEPING  # for simulations that are shown live or in a film; its kernel is compiled in a few seconds
TOLD = "accurate"  # for simulations that measure the errors of other simulations

if TYPE_CHECKING:
    from softcradle.physics import Trajectory
    from softcradle.scenes import Lane, Scene


def load_scene(name_or_path: str) -> Scene:
    """Return the scene with this name, or the scene in the file with this path. Raise UserError if loading fails."""
    from softcradle.scenes import SceneError, load

    try:
        return load(name_or_path)
    except SceneError as error:
        raise UserError(str(error)) from None


def run_scene(scene: Scene, most: int | None = None, **overrides: Any) -> list[Trajectory]:
    """Simulate every lane of `scene` and return the trajectories.

    `overrides` are keywords of `physics.simulate`. A keyword with the value None keeps the value of the scene. `most`
    limits the computing time: a lane gives up when its number of steps exceeds `most` divided by its number of
    contacts.

    Raises:
        UserError: the method does not accept the settings.
    """
    from softcradle.physics.methods import refusal_of_fineness

    settings = scene.settings(**overrides)
    reason = refusal_of_fineness(settings.get("method", ""), None, overrides.get("tolerance"))
    if reason:
        raise UserError(reason)
    return [_run_lane(lane, settings, most) for lane in scene.lanes]


def _run_lane(lane: Lane, settings: dict[str, Any], most: int | None) -> Trajectory:
    # The function `solve` does not emit warnings. Callers print `trajectory.warnings`.
    from softcradle.physics.simulation import solve

    try:
        chain = lane.chain()
        return solve(chain, lane.velocity, most_steps=most and most // chain.contacts, **settings)
    except ValueError as error:
        raise UserError(str(error)) from None
