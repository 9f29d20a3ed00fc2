"""The clock of the page. It plays, pauses, steps and restarts a session or a replay, and detects the end of a motion."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from softcradle.sandbox.languages import N_, _
from softcradle.sandbox.session.replay import Replay
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.story.live_rules import FRAME_RATE
from softcradle.sandbox.window.page import Host
from softcradle.sandbox.window.scene.editor import PREPARING, SceneEditor
from softcradle.sandbox.window.scene.time_controls import SceneTimeControls, Timeline, late_note
from softcradle.sandbox.window.scene.view import SceneView

# Width of a gap that is visible at the end of a motion, in lengths of a bead. The motion ends when every lane has such
# a gap.
APART = 2.0
LEAST_FRAMES = FRAME_RATE // 2  # Smallest number of frames that are shown after the last contact has opened.
# Largest number of frames that are shown after the last contact has opened, if the beads separate slowly.
MOST_FRAMES = 5 * FRAME_RATE


# Factor by which the clock runs faster before the first contact in Explore. It shortens the waiting time.
APPROACHING = 4.0
# Wall time in seconds before the first contact at which the clock returns to its normal speed.
NEAR = 0.5


class EndOfMotion:
    """Pauses a session once at the end of its motion, and calls the function `ended`. A replay ends where its recording
    ends.

    A motion with repeated collisions has no end of its own. It counts as ended at the duration of the scene, and
    continues.

    Attributes:
        enabled: True if the session is paused at the end.
        reached: True if the end of this motion has been reached, paused or not.
    """

    def __init__(self, host: Host, session: Session, ended: Callable[[], None]) -> None:
        self.host, self.session, self.ended = host, session, ended
        self.enabled = True
        self._frames, self.reached = 0, False  # Number of frames since the end of the motion.

    def toggle(self) -> None:
        """Switch between pausing at the end and continuing."""
        self.enabled = not self.enabled
        on, off = _("the clock stops at the end of the motion"), _("the clock continues after the end of the motion")
        self.host.messages.show(on if self.enabled else off)

    def update(self, frames: int, replay: Replay | None) -> None:
        """Update after a tick in which the clock advanced by `frames` frames. `replay` is None in a normal session."""
        session, replayed = self.session, replay is not None and replay.done
        if not all(lane.over for lane in session.lanes) or session.held.lane >= 0.0:
            lasted = session.time >= session.setup.lanes[0].duration or replayed
            self._frames, self.reached = 0, lasted and any(lane.endless for lane in session.lanes)
            return
        self._frames += frames
        shown = self._frames >= LEAST_FRAMES and (self._apart or self._frames >= MOST_FRAMES)
        if not self.reached and (shown or replayed):
            self.reached = True
            if self.enabled and replay is None:
                session.pause()
                self.ended()

    @property
    def _apart(self) -> bool:
        """True if every lane has a gap that is large enough to be visible."""
        least = -APART * self.session.scene.view.length
        return all(float(lane.state.overlap.min()) <= least for lane in self.session.lanes)


class SceneClock:
    """Advances a session, or a `replay` of a recorded session.

    Attributes:
        end: detects the end of the motion and pauses the session.
        controls: time controls. A changed slow motion is applied when the scene continues.
        collided: function that returns True if a contact has carried a force since the start.
        actions: actions that have keys.
    """

    controls: SceneTimeControls
    collided: Callable[[], bool]

    def __init__(
        self,
        host: Host,
        session: Session,
        editor: SceneEditor,
        view: SceneView,
        timeline: Timeline,
        replay: Replay | None,
        ended: Callable[[], None],
    ) -> None:
        self.host, self.session, self.editor, self.view, self.replay = host, session, editor, view, replay
        self.end = EndOfMotion(host, session, ended)
        self.actions: dict[str, Callable[[], None]] = {
            "play_pause": self.play_pause,
            "forward": partial(self.step, 1),
            "back": partial(self.step, -1),
            "slower": lambda: self.controls.step_slow(1),
            "faster": lambda: self.controls.step_slow(-1),
            "restart": self.restart,
            "first": lambda: session.scrub_frame(session.history.first),
            "last": lambda: session.scrub_frame(session.history.last),
            "previous_event": partial(timeline.scrub_to_event, -1),
            "next_event": partial(timeline.scrub_to_event, 1),
            "pause_at_end": self.end.toggle,
        }

    @property
    def _running(self) -> Replay | None:
        """The replay, or None if it has ended or does not exist."""
        return None if self.replay is None or self.replay.done else self.replay

    def may_edit(self) -> bool:
        """Return True if an edit loses nothing. An edit ends a running replay, and an edit of an old frame drops the
        later frames.
        """
        return self._running is None and not self.session.scrubbed

    def activity(self) -> str:
        """Return the state of the clock: 'playing', 'replaying' or 'paused'."""
        if self._running is not None:
            return N_("replaying") if self._running.playing and not self.session.scrubbed else N_("paused")
        return N_("playing") if self.session.playing else N_("paused")

    def note(self) -> tuple[str, bool]:
        """Return the text below the time. The second value is True if the text is a warning."""
        late = late_note(self.session.pacer)
        if self.session.playing and late[0]:
            return late
        if self.replay is not None:
            return self.replay.sentence, self.replay.diverged is not None
        if self.editor.preparing:
            return _(PREPARING), False
        return _(N_("in the past") if self.session.scrubbed else self.activity()), False

    def play_pause(self) -> None:
        """Play or pause."""
        if self._running is not None:
            self._running.playing = not self._running.playing
            self.session.scrub_frame(self.session.history.last)
        elif self.session.playing:
            self.session.pause()
        elif self.editor.preparing:
            self.host.messages.hint(_(PREPARING))
        else:
            self.controls.apply_slow()
            self.session.play()

    def pause(self) -> None:
        """Pause the session or the replay."""
        if self._running is not None:
            self._running.playing = False
        self.session.pause()

    def step(self, by: int) -> None:
        """Move by `by` frames. At the newest frame of a replay, continue with the next recorded frame."""
        running = self._running
        if self.editor.preparing:
            return
        if running is not None:
            running.playing = False
        if running is not None and by > 0 and not self.session.scrubbed:
            running.step()
        else:
            self.session.step_frames(by)
            self._show_failure()

    def _show_failure(self) -> None:
        """Show the reason if the session has stopped by itself."""
        if self.session.failure:
            self.host.messages.show(self.session.failure, warning=True)

    def restart(self) -> None:
        """Return to the start. A session keeps its edits, and continues to play if it was playing."""
        playing = self.activity() != "paused"
        self.view.reset_camera()
        self.end.reached = False
        if self.replay is not None and not self.replay.left:
            self.replay.restart()
            self.replay.playing = playing
            return
        self.session.restart()
        if playing:
            self.session.play()

    def play_again(self) -> None:
        """Play from the start after an edit has returned to the start."""
        self.end.reached = False
        if not self.editor.preparing:
            self.controls.apply_slow()
            self.session.play()

    def _pace(self) -> float:
        """Return the factor by which the clock runs faster. It is above 1 in Explore, long before the first contact."""
        session = self.session
        if not self.host.explore or not session.playing or session.held.lane >= 0.0 or self.collided():
            return 1.0
        return APPROACHING if session.until_contact() * session.slow > NEAR else 1.0

    def tick(self, seconds: float) -> None:
        """Advance by `seconds` of wall time."""
        running, moving = self._running, self.activity() != "paused"
        frames = 0
        if self.replay is None and self.may_edit():
            self.controls.apply_slow()
        if running is None:
            frames = self.session.tick(seconds * self._pace())
        elif self.session.scrubbed:
            running.playing = False
        else:
            frames = running.tick(seconds * self.session.slow / self.controls.wanted)
            if running.done:
                self.session.pacer.restart()
                self.host.messages.show(running.sentence, warning=running.diverged is not None)
        if moving:
            self._show_failure()
            self.end.update(frames, running)
