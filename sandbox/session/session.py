"""Session: the lanes of a scene with a common clock, their history, undo and exports.

Every input changes the model and the recording through :meth:`Session.apply`. A recording can therefore be replayed
bitwise.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

from softcradle.physics.trajectory import Trajectory
from softcradle.sandbox.files import output_file
from softcradle.sandbox.languages import _, error_words
from softcradle.sandbox.motion import Array
from softcradle.sandbox.session import inputs
from softcradle.sandbox.session.contact_events import ContactEvents, Impact, contact_events
from softcradle.sandbox.session.export import lane_label, scene_of, trajectory_of
from softcradle.sandbox.session.frame_history import MEMORY, History
from softcradle.sandbox.session.frame_pacing import BUDGET, FramePacer
from softcradle.sandbox.session.history_slices import HistorySlice, approach_of, history_slices, last_slice
from softcradle.sandbox.session.lane_setup import Setup, setup_of
from softcradle.sandbox.session.live_lane import BlownUpError, LiveLane
from softcradle.sandbox.session.recording import Recording
from softcradle.sandbox.session.run_verdict import WINDOW, Finding, Health, health_of, run_findings
from softcradle.sandbox.session.snapshots import NOTHING_HELD, HeldBead, Snapshot
from softcradle.sandbox.session.undo import Checkpoint, FrozenSession, UndoStack
from softcradle.sandbox.user_error import UserError
from softcradle.scenes import Scene

# Closing speed as a fraction of the closing speed of the scene. An impact with a lower closing speed is not audible.
AUDIBLE = 1e-3
FASTEST = 1e-2  # Smallest value of the slow motion: wall time in seconds for one second of model time.
SLOWEST = 1e6  # Largest value of the slow motion: wall time in seconds for one second of model time.


class Present(NamedTuple):
    """The state that inputs change: the setup, the lanes, and the bead that the pointer holds."""

    setup: Setup
    lanes: list[LiveLane]
    held: HeldBead


def beginning(setup: Setup) -> Present:
    """Return the state in which every lane is at its start."""
    return Present(setup, [LiveLane.at_start(lane) for lane in setup.lanes], NOTHING_HELD)


def accepted(item: inputs.Input, now: Present, at_start: bool) -> Present:
    """Return the state after an input. If the session is `at_start`, the input also changes the start of the lanes.

    Raise ValueError with a sentence if the input is not valid.
    """
    if isinstance(item, inputs.Drag):
        return now._replace(held=_grasped(item, now.lanes))
    if isinstance(item, inputs.Drop):
        return now._replace(held=NOTHING_HELD)
    if isinstance(item, inputs.Resume):
        copies = [LiveLane(lane.setup, lane.state.copy(), lane.ledger.copy()) for lane in now.lanes]
        return Present(now.setup, copies, NOTHING_HELD)
    if isinstance(item, inputs.SetSlow):
        if not FASTEST <= item.slow <= SLOWEST:
            raise ValueError(
                _(
                    "slow motion must be from {least:g} to {most:g}, not {given!r}",
                    least=FASTEST,
                    most=SLOWEST,
                    given=item.slow,
                )
            )
        return now._replace(setup=replace(now.setup, slow=float(item.slow)))
    assert isinstance(item, inputs.LaneInput)
    return _edited(item, now, at_start)


def _edited(item: inputs.LaneInput, now: Present, at_start: bool) -> Present:
    chosen = range(len(now.lanes)) if item.lane is None else (item.lane,)
    changed = {index: _lane(now.lanes, index).changed(item, at_start) for index in chosen}
    lanes = [changed.get(index, lane) for index, lane in enumerate(now.lanes)]
    setup = replace(now.setup, lanes=tuple(lane.setup for lane in lanes))
    held = NOTHING_HELD if isinstance(item, inputs.AddBead | inputs.RemoveBead) else now.held
    return Present(setup, lanes, held)


def _grasped(item: inputs.Drag, lanes: list[LiveLane]) -> HeldBead:
    beads = _lane(lanes, item.lane).chain.contacts + 1
    if not (0 <= item.bead < beads and abs(item.position) < float("inf")):
        raise ValueError(_("bead {bead} cannot be held at {place!r}", bead=item.bead, place=item.position))
    return HeldBead(float(item.lane), float(item.bead), float(item.position))


def _lane(lanes: list[LiveLane], index: int) -> LiveLane:
    if not 0 <= index < len(lanes):
        raise ValueError(
            _("lane {lane} does not exist; the lanes are numbered 0 to {last}", lane=index, last=len(lanes) - 1)
        )
    return lanes[index]


class Session:
    """A scene that is being played: its lanes with a common clock, the visible frame and exports.

    Arguments:
        scene: the Scene.
        memory: largest size of the history [bytes].
        budget: wall time for the physics in one tick [s].
        clock: function that returns the wall time [s].

    Attributes:
        scene: the Scene that was opened, with its current texts; edits are in `setup`.
        setup: the immutable part: chains, methods, slow motion.
        lanes: list of LiveLane; after scrubbing they contain a frame of the history.
        held: the bead that the pointer holds.
        playing: True if `tick` advances the model.
        frame: number of the visible frame, from `history.first` to `history.last`.
        history: the stored frames.
        recording: first state, inputs, and hashes of the states.
        failure: reason why the session stopped, as a sentence; empty if it did not stop.
        last_tick: numbers of the frames before and after the last tick.
        undo_stack: the edits that can be undone and redone.
        pacer: ratio of model clock and wall clock, and physics time per frame [ms].
    """

    setup: Setup
    lanes: list[LiveLane]
    held: HeldBead
    frame: int

    def __init__(
        self, scene: Scene, memory: int = MEMORY, budget: float = BUDGET, clock: Callable[[], float] = perf_counter
    ) -> None:
        self.scene = scene
        self.history = History(memory)
        self.pacer = FramePacer(budget, clock)
        self.undo_stack = UndoStack()
        self._open(setup_of(scene))

    def _open(self, setup: Setup) -> None:
        """Begin at the start of every lane."""
        lanes = beginning(setup).lanes
        states, ledgers = tuple(lane.state for lane in lanes), tuple(lane.ledger for lane in lanes)
        self.begin(Snapshot(lanes[0].state.time, setup, NOTHING_HELD, states, ledgers), 0)

    def begin(self, snapshot: Snapshot, frame: int) -> None:
        """Start the history and the recording at `snapshot`, which gets the number `frame`. The session is paused."""
        self.playing = False
        self.history.start(snapshot, frame)
        self._show(self.history.snapshot(frame), frame)
        self.held = snapshot.held
        self.failure = ""
        # True if the visible frame was read from the history, so that playing it starts a new branch.
        self._from_history = False
        self.last_tick = frame, frame
        self.recording = Recording(self.history.snapshot(frame), frame)

    # ---- time

    @property
    def time(self) -> float:
        """Model time of the visible frame [s]."""
        return self.lanes[0].state.time

    @property
    def slow(self) -> float:
        """Slow motion: wall time [s] for one second of model time. The input SetSlow changes it."""
        return self.setup.slow

    @property
    def span(self) -> tuple[float, float]:
        """First and last model time [s] of the history."""
        return self.history.first_time, self.history.last_time

    @property
    def scrubbed(self) -> bool:
        """True if the visible frame is older than the newest frame. Playing from it drops the later frames."""
        return self.frame < self.history.last

    def play(self) -> None:
        """Start the clock at the visible frame."""
        self.playing = True
        self.pacer.restart()

    def pause(self) -> None:
        """Stop the clock, and discard the frames that are due."""
        if self.playing:
            self.pacer.restart()
        self.playing = False

    def tick(self, wall_seconds: float) -> int:
        """Advance the model by `wall_seconds` if the session is playing. Return the number of computed frames.

        If the frames take longer than the budget, the clock runs slower, but the physics does not change. See
        ``pacer.clock_ratio``.
        """
        before = self.frame
        done = self.pacer.run(wall_seconds, self._compute_frame) if self.playing else 0
        self.last_tick = before, before + done
        return done

    def step_frames(self, count: int) -> None:
        """Pause and go `count` frames forward, or back if `count` is negative. Frames that are not yet in the history
        are computed.
        """
        target = max(self.frame + count, self.history.first)
        self.scrub_frame(min(target, self.history.last))
        for _frame in range(target - self.frame):
            if not self._compute_frame():
                break

    def scrub_frame(self, frame: int) -> None:
        """Pause and show `frame`. Raise IndexError if the history does not contain it."""
        self.pause()
        if frame != self.frame:
            self._show(self.history.snapshot(frame), frame)
            self._from_history = True

    def show_newest(self, present: Present) -> None:
        """Pause and show the newest frame, with the held bead and the methods of `present`. This does not start a new
        branch.
        """
        self.pause()
        self.setup, self.lanes, self.held = present
        self.frame, self._from_history = self.history.last, False

    def restart(self) -> None:
        """Return to the start and pause. History and recording start again.

        All edits are kept. This includes edits that are later than the visible frame.
        """
        self._open(self.history.newest_setup)

    # ---- inputs

    @property
    def present(self) -> Present:
        """The current state that inputs change."""
        return Present(self.setup, self.lanes, self.held)

    def apply(self, item: inputs.Input, gesture: bool = False) -> None:
        """Apply an input from the next frame on. If it is not valid, raise ValueError with a sentence and change
        nothing.

        Inputs with `gesture`, such as the drag of a slider or a bead, form one undo step until :meth:`end_gesture` is
        called.
        """
        self.apply_all([item], gesture)

    def apply_all(
        self, items: Sequence[inputs.Input], gesture: bool = False, anew: bool = False, trial: bool = False
    ) -> None:
        """Apply the inputs `items` one after the other, as one undo step.

        If one input is not valid, raise ValueError with a sentence and change nothing. If `anew`, restart before the
        inputs. The restart belongs to the same undo step, so an undo restores the earlier motion. If `trial`, the step
        only tries another number. See :attr:`UndoStack.unsaved_work`.
        """
        if not items:
            return
        self._renew_recording()
        anew = anew and (self.frame != 0 or self.scrubbed)
        present = beginning(self.history.newest_setup) if anew else self.present
        for item in items:
            present = accepted(item, present, at_start=anew or self.frame == 0)
        if any(item.undo_name for item in items) and not self.undo_stack.continues(items, gesture):
            self.undo_stack.add(items, gesture, self._checkpoint(), trial)
        if anew:
            self.pause()
            self.restart()
        self._branch()
        self.setup, self.lanes, self.held = present
        for item in items:
            self.recording.add_input(item)
        self.history.replace_last(self.snapshot(), lambda: contact_events(self.history, self.frame - 1))

    def drag(self, lane: int, bead: int, position: float) -> None:
        """Drag a bead to the pointer at `position` [m]. While the session plays, a spring pulls the bead. While it is
        paused, the bead is moved at once.
        """
        input_class = inputs.Drag if self.playing else inputs.Place
        self.apply(input_class(lane, bead, position), gesture=True)

    def drop(self) -> None:
        """Release the bead that the pointer holds."""
        self.end_gesture()
        if self.held != NOTHING_HELD:
            self.apply(inputs.Drop())

    def end_gesture(self) -> None:
        """Finish the gesture, so that the next input is a new undo step."""
        self.undo_stack.end_gesture()

    def set_words(self, scene: Scene) -> None:
        """Use the title and the texts of `scene`, which starts in the same way as the present scene. The motion does
        not change.
        """
        self.undo_stack.add(scene, False, self._checkpoint())
        self.scene = scene

    def undo(self) -> str:
        """Pause, and restore the frame and the motion before the last edit. Return the name of the edit, or "" if there
        is none.
        """
        return self._go_to(self.undo_stack.undo(self._checkpoint()))

    def redo(self) -> str:
        """Pause, and restore the frame and the motion after the last undone edit. Return its name, or "" if there is
        none.
        """
        return self._go_to(self.undo_stack.redo(self._checkpoint()))

    def _checkpoint(self) -> FrozenSession:
        return FrozenSession(self.frame, self.history.copy_blocks(), self.recording.copy(), self.scene)

    def _go_to(self, step: Checkpoint | None) -> str:
        if step is None:
            return ""
        frame, blocks, recording, scene = step.session
        if scene is not self.scene:
            self.scene = scene
            return step.name
        self.pause()
        self.undo_stack.end_gesture()
        self.history.restore(blocks)
        self._show(self.history.snapshot(frame), frame)
        self._from_history, self.failure = True, ""
        self.last_tick = frame, frame
        self.recording = recording.copy()
        return step.name

    # ---- frames

    def _compute_frame(self) -> bool:
        """Advance every lane by the same model time. If a method fails, pause before this frame and return False."""
        self._renew_recording()
        self._branch()
        try:
            for index, lane in enumerate(self.lanes):
                bead = int(self.held.bead) if index == int(self.held.lane) else -1
                lane.advance(self.setup, bead, self.held.position)
        except BlownUpError as error:
            self.failure = str(error)
            self.pause()
            self._show(self.history.snapshot(self.frame), self.frame)
            self._from_history = True
            return False
        self.failure = ""
        self.frame += 1
        self.history.append(self.snapshot())
        self.recording.add_frame(self.snapshot())
        return True

    def snapshot(self) -> Snapshot:
        """Return the visible frame as a snapshot. The lanes use the same arrays."""
        states, ledgers = tuple(lane.state for lane in self.lanes), tuple(lane.ledger for lane in self.lanes)
        return Snapshot(self.time, self.setup, self.held, states, ledgers)

    def _show(self, snapshot: Snapshot, frame: int) -> None:
        self.setup, self.held, self.frame = snapshot.setup, NOTHING_HELD, frame
        lanes = zip(snapshot.setup.lanes, snapshot.states, snapshot.ledgers, strict=True)
        self.lanes = [LiveLane(*lane) for lane in lanes]

    def _branch(self) -> None:
        """Drop the frames after the visible frame from history and recording. It is called before the frame is played
        or edited.
        """
        if self._from_history:
            self._from_history = False
            # The newest setup has changed, because the dropped frames contained edits. These edits are dropped as well.
            if self.history.newest_setup is not self.setup:
                self.undo_stack.lose_what_was_saved()
            self.history.drop_after(self.frame)
            self.recording.cut(self.frame)
            self.recording.add_input(inputs.Resume())
        if self.recording.frame > self.frame:
            self.recording = Recording(self.snapshot().copy(), self.frame)

    def _renew_recording(self) -> None:
        """If the present recording is full, start a new one at the visible frame."""
        if self.recording.full:
            held = self.held
            self._show(self.snapshot().copy(), self.frame)
            self.held = held
            self.recording = Recording(self.snapshot().copy(), self.frame)

    # ---- what is shown

    def history_slices(self, lane: int, frames: int) -> list[HistorySlice]:
        """Return the last `frames` frames of a lane up to the visible frame, in order of time."""
        return list(history_slices(self.history, lane, self.frame - frames + 1, self.frame))

    def until_contact(self) -> float:
        """Return the time [s] until the first open contact closes at the present velocities. It is infinite if none
        will close.
        """
        found = [math.inf]
        for lane in self.lanes:
            overlap, rate = lane.state.overlap, lane.state.rate
            closing = rate > 0.0
            found += (-overlap[closing] / rate[closing]).tolist()
        return min(found)

    def contact_events(self) -> ContactEvents:
        """Return the contact events of the whole history."""
        return contact_events(self.history)

    @property
    def impacts(self) -> tuple[Impact, ...]:
        """Return the contacts that closed during the last tick, in order of time. Impacts that are too slow to hear are
        omitted.
        """
        before, after = self.last_tick
        if after == before or self.history.last <= before:
            return ()
        events = contact_events(self.history, before)
        hits = events.select(events.closed & (events.frame <= after))
        found = map(Impact, hits.time.tolist(), hits.lane.tolist(), hits.contact.tolist(), hits.speed.tolist())
        return tuple(hit for hit in found if hit.speed > AUDIBLE * self.setup.lanes[hit.lane].speed)

    def health(self, lane: int, velocity_error: float | None = None) -> Health:
        """Return the reliability of a lane at the visible frame.

        `velocity_error` is the error found by a VelocityCheck, if known.
        """
        slices, live, length = self.history_slices(lane, WINDOW), self.lanes[lane], self.scene.view.length
        return health_of(slices, self.pacer, live.warning, length, velocity_error)

    def findings(self, lane: int) -> list[Finding]:
        """Return the problems of a lane during the whole run, in order of time."""
        return run_findings(self.history, lane, self.scene.view.length)

    def approach(self, lane: int) -> tuple[Array, Array]:
        """Return overlaps (n,) [m] and velocities (n+1,) [m/s] before the collision of the visible frame.

        Between collisions, return the values of the visible frame. Return the values at the start if none are found in
        the history.
        """
        found = approach_of(self.history, lane, self.frame)
        live = self.lanes[lane]
        return (live.setup.start.overlap, live.setup.start.velocity(live.chain)) if found is None else found

    def label(self, lane: int) -> str:
        """Return the label of a lane. After an edit, the label describes the contacts of the lane."""
        return self._label(lane, self.setup)

    def _label(self, lane: int, setup: Setup) -> str:
        old = self.scene.lanes[lane]
        return lane_label(old.label, old.chain(), setup.lanes[lane].chain)

    # ---- exports

    def to_scene(self) -> Scene:
        """Return the scene at its start with all edits. This includes edits that are later than the visible frame.

        Raise ValueError (SceneError) if a scene file cannot express it.
        """
        return self._scene(self.history.newest_setup)

    def shown_scene(self) -> Scene:
        """Return the scene at its start with the edits up to the visible frame. Raise ValueError like :meth:`to_scene`."""
        return self._scene(self.setup)

    def _scene(self, setup: Setup) -> Scene:
        return scene_of(self.scene, setup, [self._label(lane, setup) for lane in range(len(self.lanes))])

    @property
    def edited(self) -> bool:
        """True if the start of a lane differs from that of the opened scene. The text of the scene may then be wrong."""
        try:
            return self.to_scene().lanes != self.scene.lanes
        except ValueError:  # A scene file cannot express the session.
            return True

    def save_scene(self, path: str | Path) -> None:
        """Write the scene returned by :meth:`to_scene` to a TOML file. If this fails, raise UserError and leave no
        partial file.
        """
        try:
            text = self.to_scene().to_toml()
        except ValueError as error:
            raise UserError(_("this cannot be saved as a scene file: {error}", error=error_words(error))) from None
        with output_file(path) as temporary:
            temporary.write_text(text, encoding="utf-8")
        self.undo_stack.mark_saved()

    def trajectory(self, lane: int) -> Trajectory:
        """Return the history of a lane up to the visible frame. It begins where the chain or the method last changed."""
        part = last_slice(self.history, lane, self.frame)
        return trajectory_of(part, lane, self.contact_events(), self.history.first)

    def export_paths(self, target: Path) -> list[Path]:
        """Return the paths of the files that :meth:`export` writes for `target`."""
        several = len(self.lanes) > 1
        return [target.with_stem(f"{target.stem}-{k + 1}") if several else target for k in range(len(self.lanes))]

    def export(self, path: str | Path) -> list[Path]:
        """Write the history as .npz or .csv, and return the paths of the files.

        Several lanes are written to separate files (name-1, name-2 ...). Raise UserError if the suffix is not known or
        a file cannot be written.
        """
        target = Path(path)
        ending = target.suffix.lower()
        if ending not in (".npz", ".csv"):
            raise UserError(_("{path}: data can only be exported as .npz or .csv", path=target))
        paths = self.export_paths(target)
        try:
            for lane, file in enumerate(paths):
                trajectory = self.trajectory(lane)
                (trajectory.save if ending == ".npz" else trajectory.to_csv)(str(file))
        except OSError as error:
            raise UserError(str(error)) from None
        return paths

    def save_recording(self, path: str | Path) -> None:
        """Write the recording of the session, which `Replay.load` can run again. Raise UserError if this fails."""
        self.recording.save(path, self.scene)
        self.undo_stack.mark_saved()
