"""Replay: a recording run again, frame by frame; it tells the first frame whose state differs in any digit."""

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

    Looking at earlier frames leaves it as it is. Whatever else moves or edits the session ends it.

    Attributes:
        session: the Session that shows it.
        playing: whether `tick` goes on.
        frame: the newest frame that was run.
        diverged: the first frame whose state is not the recorded one; None as long as all agree.
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
        """The replay of a file that `Session.save_recording` wrote, paced by `clock` [s]. UserError where it is none."""
        return cls(*load_recording(path), clock)

    def restart(self) -> None:
        """Begin anew with the recorded start."""
        self.session.begin(self.recording.base, self.recording.frame)
        self.frame, self.diverged = self.recording.frame, None
        self._complete = self.frame >= self.recording.last
        self._apply_inputs()

    @property
    def done(self) -> bool:
        """Whether every recorded frame has been run, or no further one can be."""
        return self._complete or self.left

    @property
    def left(self) -> bool:
        """Whether the session was moved or edited by something else."""
        return self._mark_of() != self._mark

    def _mark_of(self) -> tuple[Recording, int, int]:
        """What every frame that is computed and every input changes."""
        made = self.session.recording
        return made, len(made.inputs), made.last

    @property
    def sentence(self) -> str:
        """Its progress, for the screen."""
        frame, last = self.frame - self.recording.frame, self.recording.last - self.recording.frame
        if self.diverged is not None:
            return _("DIVERGED at frame {frame} of {last}", frame=self.diverged - self.recording.frame, last=last)
        if self.left:
            return _("replay left at frame {frame} of {last}", frame=frame, last=last)
        if self._complete:
            return ngettext("replay agrees in the one frame", "replay agrees in all {n} frames", last)
        return _("replay, frame {frame} of {last}", frame=frame, last=last)

    def tick(self, wall_seconds: float) -> int:
        """Go on by `wall_seconds` of the wall clock; returns the frames run."""
        before = self.frame
        done = self.session.pacer.run(wall_seconds, self.step) if self.playing else 0
        self.session.last_tick = before, before + done
        return done

    def run(self) -> bool:
        """Run to the end at once; True where every state is the recorded one."""
        while not self.done:
            self.step()
        return self.diverged is None

    def step(self) -> bool:
        """Run the next frame, if there is one; whether there was."""
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
        """Apply the inputs of the frame shown; they are in the file already, so none is an unsaved edit."""
        for item in self._inputs.get(self.session.frame, ()):
            try:
                # pictures of one pull are one step, as they were
                self.session.apply(item, gesture=isinstance(item, Drag))
                if not isinstance(item, Drag):
                    self.session.end_gesture()
            except ValueError:  # it was accepted when it was recorded
                self._diverge(self.session.frame)
        self.session.undo_stack.mark_saved()
        self._mark, self._present = self._mark_of(), self.session.present
