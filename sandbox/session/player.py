"""The player: lanes on one clock, their history, and every input on its way into the model and into the recording."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from time import perf_counter

from softcradle.sandbox.session import inputs
from softcradle.sandbox.session.frame_pacing import BUDGET, Pace
from softcradle.sandbox.session.history import MEMORY, NO_HAND, History, Moment
from softcradle.sandbox.session.lane_setup import Setup, setup_of
from softcradle.sandbox.session.live_lane import BlownUpError, Hand, LiveLane
from softcradle.sandbox.session.pointer_spring import quickness
from softcradle.sandbox.session.recording import Recording
from softcradle.scenes import Scene

FASTEST, SLOWEST = 1e-2, 1e6  # slow motion


class Player:
    """Lanes on one clock: what moves a scene that is being played with.

    Arguments:
        scene: the Scene.
        memory: bound of the history [bytes].
        budget: wall seconds of physics in one tick.
        clock: what measures them.

    Attributes:
        scene: the Scene it was opened with; edits are in `setup`.
        setup: the immutable half: chains, methods, slow motion.
        lanes: list of LiveLane; at a scrubbed moment they show that moment.
        hand: (lane, bead, position of the pointer [m]); lane -1 is an empty hand.
        playing: whether `tick` moves the model.
        frame: the frame shown; `history.first` <= frame <= `history.last`.
        history: every frame kept.
        recording: base, inputs and hashes of all that.
        trouble: why the session stopped by itself, in a sentence; empty where it did not.
        ticked: the frames before and after the last tick.
        pace: clock ratio and physics milliseconds a frame.
    """

    setup: Setup
    lanes: list[LiveLane]
    hand: Hand
    frame: int

    def __init__(
        self,
        scene: Scene,
        memory: int = MEMORY,
        budget: float = BUDGET,
        clock: Callable[[], float] = perf_counter,
    ) -> None:
        self.scene = scene
        self.history = History(memory)
        self.pace = Pace(budget, clock)
        self._open(setup_of(scene))

    def _open(self, setup: Setup) -> None:
        """Begin at the start of every lane."""
        lanes = [LiveLane.at_start(lane) for lane in setup.lanes]
        parts = tuple(lane.state for lane in lanes), tuple(lane.books for lane in lanes)
        self.begin(Moment(lanes[0].state.time, setup, NO_HAND, *parts), 0)

    def begin(self, moment: Moment, frame: int) -> None:
        """Begin at `moment`, which is frame `frame`, paused: history and recording begin there too."""
        self.playing = False
        self.history.start(moment, frame)
        self._show(self.history.moment(frame), frame)
        self.hand = moment.hand
        self.trouble = ""
        self._loaded = False  # whether the moment shown was read from the history: playing on is then a new branch
        self.ticked = frame, frame
        self.recording = Recording(self.history.moment(frame), frame)

    # ---- time

    @property
    def time(self) -> float:
        """Model time shown [s]."""
        return self.lanes[0].state.time

    @property
    def slow(self) -> float:
        """Wall seconds for one second of the model; the input SetSlow changes it."""
        return self.setup.slow

    @property
    def span(self) -> tuple[float, float]:
        """First and last model time [s] that can be scrubbed to."""
        return self.history.first_time, self.history.last_time

    @property
    def scrubbed(self) -> bool:
        """Whether an earlier moment than the newest is shown; playing on drops what is later."""
        return self.frame < self.history.last

    def play(self) -> None:
        """Let the clock run, from the moment shown."""
        self.playing = True
        self.pace.forget()

    def pause(self) -> None:
        """Stop the clock."""
        self.playing = False

    def tick(self, wall_seconds: float) -> int:
        """Move the model by `wall_seconds` of the wall clock if it plays; returns the frames computed.

        Late frames are dropped from the clock, never from the physics: see ``pace.clock_ratio``.
        """
        before = self.frame
        done = self.pace.run(wall_seconds, self._compute_frame) if self.playing else 0
        self.ticked = before, before + done
        return done

    def step_frames(self, count: int) -> None:
        """Pause and go `count` frames forward (computing them where there are none yet) or, if negative, back."""
        target = max(self.frame + count, self.history.first)
        self.scrub_frame(min(target, self.history.last))
        for _ in range(target - self.frame):
            if not self._compute_frame():
                break

    def scrub(self, time: float) -> None:
        """Pause and show the moment nearest to `time` [s] of the history."""
        self.scrub_frame(self.history.frame_at(time))

    def scrub_frame(self, frame: int) -> None:
        """Pause and show `frame`; IndexError where it is not kept."""
        self.pause()
        if frame != self.frame:
            self._show(self.history.moment(frame), frame)
            self._loaded = True

    def restart(self) -> None:
        """Back to the start with all edits kept, paused; history and recording begin anew."""
        self._open(self.setup)

    # ---- inputs

    def apply(self, item: inputs.Input) -> None:
        """Do what `item` says, felt in the next frame. ValueError: refused, in a sentence; nothing has changed."""
        self._branch()
        self._accept(item)
        self.recording.note(item)
        self.history.replace_last(self.moment())

    def drag(self, lane: int, bead: int, position: float) -> None:
        """Hold a bead at the pointer: by a spring while the model runs, by placing it while it is paused."""
        kind = inputs.Drag if self.playing else inputs.Place
        self.apply(kind(lane, bead, position))

    def drop(self) -> None:
        """Let go."""
        if self.hand != NO_HAND:
            self.apply(inputs.Drop())

    def _accept(self, item: inputs.Input) -> None:
        if isinstance(item, inputs.Drag):
            self.hand = self._held(item)
        elif isinstance(item, inputs.Drop):
            self.hand = NO_HAND
        elif isinstance(item, inputs.Resume):
            self._show(self.moment().copy(), self.frame)
        elif isinstance(item, inputs.SetSlow):
            if not FASTEST <= item.slow <= SLOWEST:
                raise ValueError(f"slow motion must be from {FASTEST:g} to {SLOWEST:g}, not {item.slow!r}")
            self.setup = replace(self.setup, slow=float(item.slow))
        else:
            self._edit(item)

    def _held(self, item: inputs.Drag) -> Hand:
        """The hand with that bead in it."""
        beads = self._lane(item.lane).chain.contacts + 1
        if not (0 <= item.bead < beads and abs(item.position) < float("inf")):
            raise ValueError(f"there is no bead {item.bead} to hold at {item.position!r}")
        return float(item.lane), float(item.bead), float(item.position)

    def _edit(self, item: inputs.LaneInput) -> None:
        chosen = range(len(self.lanes)) if item.lane is None else (item.lane,)
        opening = self.frame == 0
        changed = {index: self._lane(index).changed(item, opening) for index in chosen}
        self.lanes = [changed.get(index, lane) for index, lane in enumerate(self.lanes)]
        self.setup = replace(self.setup, lanes=tuple(lane.setup for lane in self.lanes))
        if isinstance(item, inputs.AddBead | inputs.RemoveBead):
            self.hand = NO_HAND

    def _lane(self, index: int) -> LiveLane:
        if not 0 <= index < len(self.lanes):
            raise ValueError(f"there is no lane {index}; they are numbered 0 to {len(self.lanes) - 1}")
        return self.lanes[index]

    # ---- frames

    def _compute_frame(self) -> bool:
        """One frame: every lane moves on by the same model time. False where a method blew up: paused before it."""
        self._branch()
        try:
            self._advance()
        except BlownUpError as error:
            self.trouble = str(error)
            self.pause()
            self._show(self.history.moment(self.frame), self.frame)
            self._loaded = True
            return False
        self.trouble = ""
        self.frame += 1
        self.history.append(self.moment())
        self.recording.note_frame(self.moment())
        return True

    def _advance(self) -> None:
        held, bead, pointer = self.hand
        for index, lane in enumerate(self.lanes):
            holding = int(bead) if index == int(held) else -1
            lane.advance(self.setup.frame_time, holding, pointer, quickness(self.setup.slow))

    def moment(self) -> Moment:
        """The moment shown, all of it; its arrays are those of the lanes."""
        parts = tuple(lane.state for lane in self.lanes), tuple(lane.books for lane in self.lanes)
        return Moment(self.time, self.setup, self.hand, *parts)

    def _show(self, moment: Moment, frame: int) -> None:
        self.setup, self.hand, self.frame = moment.setup, NO_HAND, frame
        parts = zip(moment.setup.lanes, moment.states, moment.ledgers, strict=True)
        self.lanes = [LiveLane(*lane) for lane in parts]

    def _branch(self) -> None:
        """Before a moment from the history is played on or edited: drop what was later, there and in the recording."""
        if self._loaded:
            self._loaded = False
            self.history.drop_after(self.frame)
            self.recording.cut(self.frame)
            self.recording.note(inputs.Resume())
        if self.recording.full or self.recording.frame > self.frame:
            hand = self.hand
            self._show(self.moment().copy(), self.frame)
            self.hand = hand
            self.recording = Recording(self.moment().copy(), self.frame)

    # ---- what there is to see
