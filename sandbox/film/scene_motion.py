"""Motion of a scene for a film. Each frame shows one sample. All lanes have samples at the same times. Free flight is
added before and after the motion.
"""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from softcradle.physics import Trajectory
from softcradle.sandbox.draw.shared_scales import longest_lead, motion_of
from softcradle.sandbox.languages import N_, _, gettext
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.scene_runs import SHOWN, run_scene
from softcradle.sandbox.story.ending import quiet_end
from softcradle.sandbox.user_error import GaveUpError, UserError
from softcradle.scenes import Scene
from softcradle.scenes.scene_schema import MOST_SLOW

# Duration of the free flight before the start, as a fraction of the motion. Free flight before the start is shown only
# if beads touch at the start.
LEAD = 0.25
AFTER = 0.35  # Default duration of the free flight after the end of a scene, as a fraction of the motion.
# Largest number of frames. If there are more, the slow motion or the frame rate is probably a typing error.
MOST_FRAMES = 100_000
# Largest number of samples of a motion for one picture. This number suffices to find the moment and to draw the curves.
MOST_ROWS = 100_000


@dataclass(frozen=True)
class Frames:
    """Description of a film or picture that is drawn frame by frame.

    Attributes:
        rows: number of samples of the motion for each frame.
        of: name of the film or picture, marked for translation.
        remedy: advice for the user if there would be too many frames, marked for translation.
    """

    rows: int = 1
    of: str = N_("film")
    remedy: str = N_("choose less slow motion")


def scene_motions(
    scene: Scene,
    rows_per_second: float,
    method: str | None = None,
    step: float | None = None,
    end: float | None = None,
    frames: Frames | None = None,
) -> list[Motion]:
    """Return the motion of each lane of `scene`. Warnings of the simulation are emitted as RuntimeWarnings.

    Arguments:
        scene: the Scene.
        rows_per_second: number of samples for each second of motion.
        method, step: method and time step. None uses the values of the scene. The default is `conserving` with its
            default step.
        end: end of the last lane [s], if :func:`motion_end` has computed it already.
        frames: description of the film. None means that the motion is used for one picture or for scales. A long motion
            then has fewer samples per second.

    Raises:
        UserError: if the method or step does not suit the scene, or if there would be too many frames.
        GaveUpError: if the method gave up before the end of the motion.
    """
    motions, sentences = scene_motions_quietly(scene, rows_per_second, method, step, end, frames=frames)
    for sentence in sentences:
        warnings.warn(sentence, RuntimeWarning, stacklevel=2)
    return motions


def scene_motions_quietly(
    scene: Scene,
    rows_per_second: float,
    method: str | None = None,
    step: float | None = None,
    end: float | None = None,
    most: int | None = None,
    frames: Frames | None = None,
) -> tuple[list[Motion], tuple[str, ...]]:
    """Return the motion of each lane of `scene` and the warnings of the simulation as sentences. See
    :func:`scene_motions`.

    The warnings are returned because the warnings of Python are not thread-safe. If a lane takes too many steps, its
    simulation counts as given up. The limit for the number of steps times the number of contacts is `most`.
    """
    said = ""
    if end is None:
        end, said = _end_and_sentence(scene, method, step, most)
    times = _row_times(scene, end, rows_per_second, frames)
    moving = times[times >= 0.0]
    trajectories = _solved(scene, method, step, most, duration=float(moving[-1]), samples=moving)
    motions = [motion_of(trajectory, times[times < 0.0]) for trajectory in trajectories]
    require_finite(motions)
    sentences = [said] if said else []
    return motions, (*sentences, *(str(warning) for trajectory in trajectories for warning in trajectory.warnings))


def motion_end(scene: Scene, method: str | None = None, step: float | None = None) -> float:
    """Return the time [s] at which the motion of the last lane ends, or the duration of the scene if it has one.

    Emit a warning if more motion follows after a pause that is too long to show. Raise UserError for the same reasons
    as :func:`scene_motions`.
    """
    end, said = _end_and_sentence(scene, method, step)
    if said:
        warnings.warn(said, RuntimeWarning, stacklevel=2)
    return end


def _end_and_sentence(
    scene: Scene, method: str | None, step: float | None, most: int | None = None
) -> tuple[float, str]:
    """Return the end [s] of the last lane, or the duration of the scene. Also return a sentence if more motion follows
    after a long pause.
    """
    if scene.duration is not None:
        return scene.duration, ""
    return quiet_end(_solved(scene, method, step, most, samples=2))


def _solved(
    scene: Scene, method: str | None, step: float | None, most: int | None, **settings: Any
) -> list[Trajectory]:
    # If the scene has a time step but no method, the scene chooses the method.
    usual = SHOWN if scene.step is None else None
    found = run_scene(scene, most, method=method or scene.method or usual, step=step, **settings)
    require_whole(N_("a film"), found)
    return found


def require_whole(what: str, trajectories: Sequence[Trajectory]) -> None:
    """Raise GaveUpError if the simulation of a trajectory gave up before the end of the motion."""
    for trajectory in trajectories:
        if trajectory.status.gave_up:
            warnings = "; ".join(map(str, trajectory.warnings))
            raise GaveUpError(_("{what} needs the whole motion: {warnings}", what=gettext(what), warnings=warnings))


def checked_slow(slow: float) -> float:
    """Return `slow`, the seconds of film for each second of motion. Raise UserError if it exceeds the limits of a
    scene.
    """
    if not 1.0 / MOST_SLOW <= slow <= MOST_SLOW:
        raise UserError(
            _(
                "slow motion must be from {least:g} to {most:g}, not {given!r}",
                least=1.0 / MOST_SLOW,
                most=MOST_SLOW,
                given=slow,
            )
        )
    return slow


def _row_times(scene: Scene, end: float, rate: float, frames: Frames | None) -> Array:
    """Return the times of all samples [s]. The start of the motion, 0, is one of them."""
    lead, until = shown_span(scene, end)
    if frames is None and (lead + until) * rate > MOST_ROWS:
        rate = MOST_ROWS / (lead + until)
    if frames is not None and (count := (lead + until) * rate / frames.rows) > MOST_FRAMES:
        raise UserError(
            _(
                "the {picture} would have {count} frames, more than {most}: {remedy}",
                picture=gettext(frames.of),
                count=math.ceil(count),
                most=MOST_FRAMES,
                remedy=gettext(frames.remedy),
            )
        )
    first, last = -math.floor(lead * rate), math.ceil(until * rate)
    return np.arange(first, max(last, first + 1) + 1) / rate


def shown_span(scene: Scene, end: float) -> tuple[float, float]:
    """Return how long [s] the scene is shown before and after its start. `end` [s] is the end of its motion."""
    starts = [(lane.chain(), np.array(lane.velocity)) for lane in scene.lanes]
    apart = any(any(chain.gap) for chain, _ in starts)
    lead = 0.0 if apart else min(LEAD * end, *(longest_lead(chain, velocity) for chain, velocity in starts))
    return lead, end + after_time(scene, end)


def after_time(scene: Scene, end: float) -> float:
    """Return the duration [s] of the free flight that is shown after the end of the motion. `end` [s] is the time at
    which the last contact has opened.
    """
    if scene.duration is not None:
        return 0.0
    return AFTER * end if scene.view.after is None else scene.view.after


def require_finite(motions: Sequence[Motion]) -> None:
    """Raise UserError if a motion contains numbers that are not finite, because a picture cannot show them."""
    if not all(np.isfinite(motion.position).all() and np.isfinite(motion.force).all() for motion in motions):
        method = motions[0].method
        raise UserError(_("The motion by {method} did not stay finite: choose a smaller step.", method=method))


def first_force(motions: Sequence[Motion]) -> int:
    """Return the number of the first sample at which a contact of any lane pushes or pulls. Return 0 if all forces are
    0.
    """
    return int(np.argmax(np.any([(motion.force != 0.0).any(axis=1) for motion in motions], axis=0)))


def strongest_row(motions: Sequence[Motion]) -> int:
    """Return the number of the sample with the largest contact force (push or pull) of all lanes. A single picture
    shows this sample.
    """
    return int(np.argmax(np.max([np.abs(motion.force).max(axis=1) for motion in motions], axis=0)))
