"""Web page for sharing. A page is one HTML file that plays a scene. The motion is either computed in the browser or
recorded.
"""

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
from softcradle.sandbox.languages import N_, _, in_every_language
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
    with_preview,
)
from softcradle.sandbox.page.played_motion import PlayedMotion, played_motion, result_notes, result_tables
from softcradle.sandbox.scene_runs import SHOWN, run_scene
from softcradle.sandbox.story.ending import quiet_end
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Scene

COARSE = 16.0  # Step of a coarse recording, in default steps.
COARSE_SAMPLES = 361
# Number of evenly spaced samples of the complete motion, and again of the time with closed contacts.
EVEN_SAMPLES = 2001
# Number of samples after each contact event. The samples are denser near the event, because an overlap begins as a
# power of the time since the contact closed.
ONSET_SAMPLES = 48
SHORTEST_ONSET = 1e-9  # Time between a contact event and the first sample after it, as a fraction of the motion.
# Time between a contact event and the last of its additional samples, as a fraction of the motion.
LONGEST_ONSET = 1e-2
# Largest number of contact events with additional samples. If a motion has more events, the contacts are chattering.
# The curves of such a motion cannot show each event.
MOST_SWITCHES = 200


@dataclass(frozen=True)
class PageReport:
    """Report about a written page. The report contains the path, the size [bytes], and True if the page computes its
    motion.
    """

    output: Path
    size: int
    computed: bool


def write_page(
    trajectories: Trajectory | Sequence[Trajectory], scene: Scene, path: str | os.PathLike[str]
) -> PageReport:
    """Write a page that plays the recorded `trajectories`. There is one trajectory for each lane of `scene`.

    Raises
    ------
    UserError
        `path` cannot be written, or the motion is too long for a page. No file is left behind.
    """
    found = (trajectories,) if isinstance(trajectories, Trajectory) else tuple(trajectories)
    if len(found) != len(scene.lanes):
        needed, given = len(scene.lanes), len(found)
        raise UserError(_("a page needs a trajectory for each lane: {needed}, not {given}", needed=needed, given=given))
    with output_file(path) as temporary:
        size = temporary.write_bytes(_recorded_text(scene, found).encode())
    return PageReport(Path(path), size, computed=False)


def render_page(
    scene: Scene, output: str | os.PathLike[str], slow: float | None = None, address: str = "", **settings: Any
) -> PageReport:
    """Write the page of `scene`. If possible, the browser computes the motion. Otherwise the motion is simulated now
    and recorded in the page.

    `address` is the address (URL) at which the page will be published. The address is used in previews of links. `slow`
    is the number of seconds in which one second of motion is played. If it is None, the value of the scene is used.
    `settings` are keywords of `physics.simulate`. If any are given, the motion is recorded with them. Problems of the
    motion are reported as RuntimeWarning.

    Raises:
        UserError: the page cannot be written or the scene cannot be simulated. No file is left behind.
    """
    # The file is opened before the simulation. An unwritable path is therefore reported at once.
    with output_file(output) as temporary:
        text, computed = scene_text(scene, slow, **settings)
        text = with_preview(text, address) if address else text
        return PageReport(Path(output), temporary.write_bytes(text.encode()), computed)


def scene_text(scene: Scene, slow: float | None = None, **settings: Any) -> tuple[str, bool]:
    """Return the text of the page that :func:`render_page` writes, and True if the page computes its motion. Raise
    UserError for the same reasons as :func:`render_page`.
    """
    if slow is not None:
        scene = scene.model_copy(update={"view": scene.view.model_copy(update={"slow": checked_slow(slow)})})
    if can_be_computed(scene) and all(value is None for value in settings.values()):
        return _computed_text(scene), True
    return _recorded_text(scene, _recorded(scene, **settings)), False


def _recorded(scene: Scene, **settings: Any) -> list[Trajectory]:
    trajectories = recorded(scene, **settings)
    require_whole(N_("a page"), trajectories)
    for sentence in dict.fromkeys(str(warning) for found in trajectories for warning in found.warnings):
        warnings.warn(sentence, RuntimeWarning, stacklevel=3)
    return trajectories


def _recorded_text(scene: Scene, trajectories: Sequence[Trajectory]) -> str:
    played = played_motion(scene, trajectories)
    tables = in_every_language(lambda: result_notes(played) + result_tables(played))
    parts = [_scene_file(played), footer()]
    return recorded_page(played, parts, tables="".join(map(spoken, tables, tables.values())))


def _computed_text(scene: Scene) -> str:
    """Return the text of a page that computes the motion of `scene`. The page also contains a recording, which is
    played if the browser blocks WebAssembly.
    """
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
            lies=not any(lane.strings for lane in scene.lanes),
        ),
        numbers(""),
        keys(),
        _scene_file(played),
        footer(),
    ]
    return document(scene.title, scene.text, parts, data, computed=True)


def recorded_page(played: PlayedMotion, parts: Sequence[str], title: str = "", tables: str = "") -> str:
    """Return the text of a page that plays a recorded motion. `parts` are added at the end of the page. `tables` are
    added to the section with the numbers.
    """
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
    """Return the part of the page with the scene file.

    Return an empty text for scenes with user-defined contact laws, because a scene file cannot contain such laws. Also
    return an empty text for recordings that begin after the start of the motion.
    """
    if any(found.chain.own_laws or found.time[0] > 0.0 for found in played.trajectories):
        return ""
    return (
        '<details><summary data-say="file">Scene file (for the softcradle program)</summary>'
        f'<pre tabindex="0">{escape(played.scene.to_toml())}</pre></details>'
    )


def recorded(scene: Scene, **settings: Any) -> list[Trajectory]:
    """Return the trajectory of every lane of `scene`. `settings` are keywords of `physics.simulate`. A setting of None
    means the value of the scene.

    Raises:
        UserError: the method does not support the settings.
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
    """Return the trajectory of every lane of `scene`, computed with coarse time steps.

    The page plays this recording if the browser does not allow it to compute.

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
    """Return sample times (T,) [s] up to the time `latest` for recording a motion. The sample times are denser after
    the contact events of `trajectory`, which is an earlier simulation of the same motion.
    """
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
