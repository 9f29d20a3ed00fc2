"""The page to share: one HTML file in which a scene is played, computed in the browser, or as it was recorded."""

import math
import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from softcradle.physics import Trajectory
from softcradle.physics.scales import default_step
from softcradle.sandbox.files import output_file
from softcradle.sandbox.film.scene_motion import checked_slow, require_whole
from softcradle.sandbox.languages import in_every_language
from softcradle.sandbox.motion import Array
from softcradle.sandbox.page.data import can_be_computed, is_train, page_data
from softcradle.sandbox.page.document import (
    document,
    footer,
    heading,
    keys,
    numbers,
    player,
    spoken,
)
from softcradle.sandbox.page.played_motion import PlayedMotion, played_motion, result_notes, result_tables
from softcradle.sandbox.scene_runs import SHOWN, run_scene
from softcradle.sandbox.story.ending import quiet_end
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Scene

COARSE = 16.0  # default steps to one of a page
COARSE_SAMPLES = 401
EVEN_SAMPLES = 2001  # over the whole motion, and again while contacts are closed
ONSET_SAMPLES = 48  # after each switch, closer and closer to it: overlaps begin as powers of the time since
SHORTEST_ONSET = 1e-9  # of the whole motion: the first of them
LONGEST_ONSET = 1e-2  # of the whole motion: the last of them
MOST_SWITCHES = 200  # with such samples; motions with more rattle, and their curves have no room for each


@dataclass(frozen=True)
class PageReport:
    """Report of a written page: its path, its size [bytes], and if it computes its motion."""

    output: Path
    size: int
    computed: bool


def write_page(
    trajectories: Trajectory | Sequence[Trajectory], scene: Scene, path: str | os.PathLike[str]
) -> PageReport:
    """Write the recorded `trajectories`, one for each lane of `scene`, as a page that plays them.

    Raises
    ------
    UserError
        `path` cannot be written, or the motion is too long for a page; nothing is left behind.
    """
    found = (trajectories,) if isinstance(trajectories, Trajectory) else tuple(trajectories)
    if len(found) != len(scene.lanes):
        raise UserError(f"a page needs a trajectory for each lane: {len(scene.lanes)}, not {len(found)}")
    with output_file(path) as temporary:
        size = temporary.write_bytes(_recorded_text(scene, found).encode())
    return PageReport(Path(path), size, computed=False)


def render_page(scene: Scene, output: str | os.PathLike[str], slow: float | None = None, **settings: Any) -> PageReport:
    """Write the page of `scene`: computed in the browser where it can be, else recorded here.

    `slow` are seconds for one of motion, None takes the scene's. With `settings`, keywords of `physics.simulate`, the
    motion is recorded by them. What may be wrong with the motion is a RuntimeWarning.

    Raises:
        UserError: it cannot be written or simulated; nothing is left behind.
    """
    with output_file(output) as temporary:  # before the runs, so that an unwritable place is refused at once
        text, computed = scene_text(scene, slow, **settings)
        return PageReport(Path(output), temporary.write_bytes(text.encode()), computed)


def scene_text(scene: Scene, slow: float | None = None, **settings: Any) -> tuple[str, bool]:
    """The page of :func:`render_page` as text, and whether it computes its motion. Raises UserError likewise."""
    if slow is not None:
        scene = scene.model_copy(update={"view": scene.view.model_copy(update={"slow": checked_slow(slow)})})
    if can_be_computed(scene) and all(value is None for value in settings.values()):
        return _computed_text(scene), True
    return _recorded_text(scene, _recorded(scene, **settings)), False


def _recorded(scene: Scene, **settings: Any) -> list[Trajectory]:
    trajectories = recorded(scene, **settings)
    require_whole("a page", trajectories)
    for sentence in dict.fromkeys(str(warning) for found in trajectories for warning in found.warnings):
        warnings.warn(sentence, RuntimeWarning, stacklevel=3)
    return trajectories


def _recorded_text(scene: Scene, trajectories: Sequence[Trajectory]) -> str:
    played = played_motion(scene, trajectories)
    tables = in_every_language(lambda: result_notes(played) + result_tables(played))
    parts = [_scene_file(played), footer()]
    return recorded_page(played, parts, tables="".join(map(spoken, tables, tables.values())))


def _computed_text(scene: Scene) -> str:
    """Return the text of the page of a scene that :func:`can_be_computed`, with a recording for blocked WebAssembly."""
    played = played_motion(scene, recorded_coarsely(scene))
    data = page_data(played, computed=True)
    parts = [
        heading(scene.title, scene.source),
        player(
            scene.question,
            scene.text,
            uniform=data["uniform"] is not None,
            alone=len(scene.lanes) == 1 and not is_train(scene.lanes[0].chain().mass),
            moving=any(map(any, (lane.velocity for lane in scene.lanes))),
        ),
        numbers(""),
        keys(),
        _scene_file(played),
        footer(),
    ]
    return document(scene.title, scene.text, parts, data, computed=True)


def recorded_page(played: PlayedMotion, parts: Sequence[str], title: str = "", tables: str = "") -> str:
    """The page that plays a recorded motion, as text; `parts` follow below it, `tables` are among its numbers."""
    scene, title = played.scene, title or played.scene.title
    first = [
        heading(title, scene.source),
        player(scene.question, scene.text, uniform=False, alone=False, moving=False),
        numbers(tables),
        keys(),
    ]
    data = page_data(played, computed=False)
    for texts in data["texts"].values():
        texts["title"] = title if title != scene.title else texts["title"]
    return document(title, scene.text, [*first, *parts], data)


def _scene_file(played: PlayedMotion) -> str:
    """Return the scene file, or "" if there is none: for user-defined laws and for samples that begin after the start."""
    if any(found.chain.own_laws or found.time[0] > 0.0 for found in played.trajectories):
        return ""
    return (
        '<details><summary data-say="file">Scene file (for the softcradle program)</summary>'
        f'<pre tabindex="0">{escape(played.scene.to_toml())}</pre></details>'
    )


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
    steps = [COARSE * default_step(lane.chain(), lane.velocity, scene.duration) for lane in scene.lanes]
    scene = scene.model_copy(update={"method": SHOWN, "step": min(steps), "tolerance": None})
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
