"""A scene by its name, and the trajectory of each of its lanes; what cannot be is a UserError."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from softcradle.sandbox.user_error import UserError

# Methods of runs for which neither a scene nor a person has chosen one; `simulate` itself, and so every study, takes "accurate".
KEEPING = "conserving"  # of what must keep energy and momentum at any step
SHOWN = KEEPING  # of what is looked at, live or in a film; its kernel compiles in seconds
TOLD = "accurate"  # of what says how far another run is off

if TYPE_CHECKING:
    from softcradle.physics import Trajectory
    from softcradle.scenes import Lane, Scene


def load_scene(name_or_path: str) -> Scene:
    """The scene of that name or in that file. Raises UserError with what is wrong with it."""
    from softcradle.scenes import SceneError, load

    try:
        return load(name_or_path)
    except SceneError as error:
        raise UserError(str(error)) from None


def run_scene(scene: Scene, most: int | None = None, **overrides: Any) -> list[Trajectory]:
    """The trajectory of every lane of `scene`; `overrides` are keywords of `physics.simulate`, None takes the scene's.

    A lane that takes more than `most` steps times contacts has given up.

    Raises:
        UserError: settings that the method does not take.
    """
    from softcradle.physics.methods import refusal_of_fineness

    settings = scene.settings(**overrides)
    reason = refusal_of_fineness(settings.get("method", ""), None, overrides.get("tolerance"))
    if reason:
        raise UserError(reason)
    return [_run_lane(lane, settings, most) for lane in scene.lanes]


def _run_lane(lane: Lane, settings: dict[str, Any], most: int | None) -> Trajectory:
    from softcradle.physics.simulation import solve  # what may be wrong is in trajectory.warnings, which callers print

    try:
        chain = lane.chain()
        return solve(chain, lane.velocity, most_steps=most and most // chain.contacts, **settings)
    except ValueError as error:
        raise UserError(str(error)) from None
