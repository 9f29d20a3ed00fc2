"""From a scene to the trajectory of each lane, with refusals as sentences and a cost that is the solver's own."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

from softcradle.sandbox.user_error import UserError

if TYPE_CHECKING:
    from softcradle.physics import Trajectory
    from softcradle.scenes import Lane, Scene


def solve(scene: Scene, **wishes: Any) -> list[Trajectory]:
    """The trajectory of every lane of `scene`; `wishes` are keywords of `physics.simulate`, None leaves the scene's.

    Raises:
        UserError: a wish that the method cannot grant.
    """
    settings = scene.settings(**wishes)
    found = [_solve_lane(lane, settings) for lane in scene.lanes]
    fixed = any(trajectory.tolerance == 0.0 and not trajectory.choice for trajectory in found)
    if wishes.get("tolerance") is not None and fixed:
        raise UserError(f"method {found[0].method!r} takes a step, not a tolerance")
    return found


def _solve_lane(lane: Lane, settings: dict[str, Any]) -> Trajectory:
    from softcradle.physics import simulate

    chain = lane.chain()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # they are in trajectory.warnings too, which callers show
        try:
            # Loads the compiled kernels, which would otherwise be booked as the cost of this run.
            simulate(chain, lane.velocity, **{**settings, "duration": 0.0, "samples": 2})
            return simulate(chain, lane.velocity, **settings)
        except ValueError as error:
            raise UserError(str(error)) from None
