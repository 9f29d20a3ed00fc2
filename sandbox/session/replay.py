"""Replay: run a recording again, frame by frame. It finds the first frame whose state differs from the recorded state
in any bit.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import groupby
from time import perf_counter

from softcradle.sandbox.languages import _, ngettext
from softcradle.sandbox.session.inputs import Drag, Input
from softcradle.sandbox.session.recording import Path, Recording, hash_of, load_recording
from softcradle.sandbox.session.session import Session
from softcradle.scenes import Scene


class Replay:
    """A recording that is being run again.

    Scrubbing to earlier frames does not affect the replay. Any other motion or edit of the session ends it.

    Attributes:
        session: the Session that shows the replay.
        playing: True if `tick` advances the replay.
        frame: number of the newest frame that was run.
        diverged: first frame whose state differs from the recorded state; None while all states agree.
    """

    frame: int
    diverged: int | None

    def __init__(self, recording: Recording, scene: Scene, clock: Callable[[], float] = perf_counter) -> None:
        self.recording = recording
        self.session = Session(scene, clock=clock)
        self.playing = True
        by_frame = groupby(recording.inputs, key=lambda item: item[0])
        self._inputs: dict[int, list[Input]] = {frame: [item for _, item in items] for frame, items in by_frame}
        self.restart()

    @classmethod
    def load(cls, path: Path, clock: Callable[[], float] = perf_counter) -> Replay:
        """Return the replay of a file written by `Session.save_recording`. Raise UserError for any other file.

        `clock` returns the wall time [s], which limits the computation of frames.
        """
        return cls(*load_recording(path), clock)

    def restart(self) -> None:
        """Restart from the recorded start."""
        self.session.begin(self.recording.base, self.recording.frame)
        self.frame, self.diverged = self.recording.frame, None
        self._complete = self.frame >= self.recording.last
        self._apply_inputs()

    @property
    def done(self) -> bool:
        """True if every recorded frame has been run, or if no further frame can be run."""
        return self._complete or self.left

    @property
    def left(self) -> bool:
        """True if the session was moved or edited by something other than the replay."""
        return self._mark_of() != self._mark

    def _mark_of(self) -> tuple[Recording, int, int]:
        """Return a key that changes with every computed frame and every input of the session."""
        made = self.session.recording
        return made, len(made.inputs), made.last

    @property
    def sentence(self) -> str:
        """A sentence about the progress of the replay, for the screen."""
        frame, last = self.frame - self.recording.frame, self.recording.last - self.recording.frame
        if self.diverged is not None:
            return _("DIVERGED at frame {frame} of {last}", frame=self.diverged - self.recording.frame, last=last)
        if self.left:
            return _("replay left at frame {frame} of {last}", frame=frame, last=last)
        if self._complete:
            return ngettext("replay agrees in the one frame", "replay agrees in all {n} frames", last)
        return _("replay, frame {frame} of {last}", frame=frame, last=last)

    def tick(self, wall_seconds: float) -> int:
        """Advance the replay by `wall_seconds` of wall time. Return the number of frames that were run."""
        before = self.frame
        done = self.session.pacer.run(wall_seconds, self.step) if self.playing else 0
        self.session.last_tick = before, before + done
        return done

    def run(self) -> bool:
        """Run the replay to its end at once. Return True if every state equals the recorded state."""
        while not self.done:
            self.step()
        return self.diverged is None

    def step(self) -> bool:
        """Run the next recorded frame. Return False if there is none."""
        if self.done:
            return False
        session = self.session
        session.show_newest(self._present)
        session.step_frames(1)
        self.frame += 1
        recorded = self.recording.hashes[self.frame - self.recording.frame - 1]
        if session.failure or hash_of(session.snapshot()) != recorded:
            self._diverge(self.frame)
        self._complete = self.frame >= self.recording.last or bool(session.failure)
        self._apply_inputs()
        return True

    def _diverge(self, frame: int) -> None:
        if self.diverged is None:
            self.diverged = frame

    def _apply_inputs(self) -> None:
        """Apply the recorded inputs of the visible frame. They do not count as unsaved edits, because a file contains
        them.
        """
        for item in self._inputs.get(self.session.frame, ()):
            try:
                # All positions of the pointer during one pull form one undo step, as in the original session.
                self.session.apply(item, gesture=isinstance(item, Drag))
                if not isinstance(item, Drag):
                    self.session.end_gesture()
            # The input was accepted when it was recorded, so the replay differs from the original session.
            except ValueError:
                self._diverge(self.session.frame)
        self.session.undo_stack.mark_saved()
        self._mark, self._present = self._mark_of(), self.session.present
