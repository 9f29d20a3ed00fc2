"""Loading of a scene by its name, and simulation of its lanes. Errors become UserErrors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from softcradle.sandbox.user_error import UserError

# Methods of runs for which neither the scene nor the user has chosen one. `simulate` itself, and so every study, uses
# "accurate".
KEEPING = "conserving"  # for runs that must conserve energy and momentum at any time step
SHOWN = KEEPING  # for runs that are shown live or in a film; its kernel compiles in seconds
TOLD = "accurate"  # for runs that measure the error of other runs

if TYPE_CHECKING:
    from softcradle.physics import Trajectory
    from softcradle.scenes import Lane, Scene


def load_scene(name_or_path: str) -> Scene:
    """Return the scene with this name or in this file. Raise UserError with its problems."""
    from softcradle.scenes import SceneError, load

    try:
        return load(name_or_path)
    except SceneError as error:
        raise UserError(str(error)) from None


def run_scene(scene: Scene, most: int | None = None, **overrides: Any) -> list[Trajectory]:
    """Simulate every lane of `scene` and return the trajectories.

    `overrides` are keywords of `physics.simulate`; None keeps the value of the scene. A lane gives up after `most`
    divided by the number of contacts steps.

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
    from softcradle.physics.simulation import solve  # This does not emit warnings; callers print trajectory.warnings.

    try:
        chain = lane.chain()
        return solve(chain, lane.velocity, most_steps=most and most // chain.contacts, **settings)
    except ValueError as error:
        raise UserError(str(error)) from None
