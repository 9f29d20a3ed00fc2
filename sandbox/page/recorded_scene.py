"""The recorded scene: its trajectories for a page, with samples where curves bend, at contact switches above all."""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
from softcradle.physics import Trajectory
from softcradle.physics.default_step import default_step
from softcradle.sandbox.film.scene_motion import quiet_end
from softcradle.sandbox.motion import Array
from softcradle.sandbox.scene_runs import run_scene
from softcradle.scenes import Scene

COARSE = 16.0  # default steps to one of a page
COARSE_SAMPLES = 401
EVEN_SAMPLES = 2001  # over the whole motion, and again while contacts are closed
ONSET_SAMPLES = 48  # after each switch, closer and closer to it: overlaps begin as powers of the time since
SHORTEST_ONSET = 1e-9  # of the whole motion: the first of them
LONGEST_ONSET = 1e-2  # of the whole motion: the last of them
MOST_SWITCHES = 200  # with such samples; motions with more rattle, and their curves have no room for each


def recorded(scene: Scene, **settings: Any) -> list[Trajectory]:
    """The trajectory of every lane of `scene`; `settings` are keywords of `physics.simulate`, None takes the scene's.

    Raises:
        UserError: settings that the method does not take.
    """
    found, coarse = [], run_scene(scene, samples=2, **settings)
    end, said = (math.inf, "") if scene.duration is not None else quiet_end(coarse)
    if said:
        warnings.warn(said, RuntimeWarning, stacklevel=2)
    for lane, whole in zip(scene.lanes, coarse, strict=True):
        cut = {"duration": end} if end < float(whole.time[-1]) else {}
        alone = scene.model_copy(update={"lanes": (lane,), **cut})
        found += run_scene(alone, samples=sample_times(whole, end), **settings)
    return found


def recorded_coarsely(scene: Scene) -> list[Trajectory]:
    """The trajectory of every lane of `scene` in the steps that a page takes: for what it shows where it may not compute.

    Raises:
        UserError: the scene cannot be simulated.
    """
    steps = [COARSE * default_step(lane.chain(), lane.velocity) for lane in scene.lanes]
    scene = scene.model_copy(update={"method": "conserving", "step": min(steps), "tolerance": None})
    found = run_scene(scene, samples=COARSE_SAMPLES)
    end = math.inf if scene.duration else quiet_end(found)[0]
    late = any(trajectory.time[-1] > end for trajectory in found)
    return run_scene(scene, samples=COARSE_SAMPLES, duration=end) if late else found


def sample_times(trajectory: Trajectory, latest: float = math.inf) -> Array:
    """(T,) sample times [s] up to `latest` for the motion of `trajectory`, of which switches and end are known."""
    end = min(float(trajectory.time[-1]), latest)
    found = {time for spans in trajectory.contact_intervals for span in spans for time in span}
    switches = np.array(sorted(time for time in found if math.isfinite(time) and time <= end))
    even = np.linspace(0.0, end, EVEN_SAMPLES)
    if not switches.size:
        return even
    closed = np.linspace(switches[0], switches[-1], EVEN_SAMPLES)
    onset = end * np.geomspace(SHORTEST_ONSET, LONGEST_ONSET, ONSET_SAMPLES)
    near = switches[:MOST_SWITCHES, None] + np.concatenate(([-onset[0], 0.0], onset))
    times: Array = np.unique(np.clip(np.concatenate((even, closed, near.ravel())), 0.0, end))
    return times
