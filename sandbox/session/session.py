"""The session: lanes on one clock, their history, and every input on its way into the model and into the recording."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from physics.chain import Chain
from physics.simulation import advance
from physics.state import State
from sandbox.session import inputs, ledger
from sandbox.session.edits import edited
from sandbox.session.hand import push_of_hand
from sandbox.session.history import MEMORY, NO_HAND, SWITCHES, History, Moment
from sandbox.session.pace import BUDGET, Pace
from sandbox.session.setup import LaneSetup, Setup, setup_of
from scenes import Scene

Array = NDArray[np.float64]


@dataclass
class LiveLane:
    """One lane as it is now: the immutable `setup`, the moving `state`, the `books` of its energy and momentum."""

    setup: LaneSetup
    state: State
    books: Array

    @property
    def label(self) -> str:
        """What is written beside it."""
        return self.setup.label

    @property
    def chain(self) -> Chain:
        """The chain."""
        return self.setup.chain

    @property
    def position(self) -> Array:
        """(n+1,) positions [m], bead lengths taken out."""
        return self.state.position(self.chain)

    @property
    def velocity(self) -> Array:
        """(n+1,) bead velocities [m/s]."""
        return self.state.velocity(self.chain)


class Session:
    """A scene that is being played with.

    Arguments:
        scene: the Scene.
        memory: bound of the history [bytes].
        budget: wall seconds of physics in one tick.
        clock: what measures them.

    Attributes:
        scene: the Scene it was opened with.
        lanes: list of LiveLane; at a scrubbed moment they show that moment.
        playing: whether `tick` moves the model.
        frame: the frame shown; `history.first` <= frame <= `history.last`.
        history: every frame kept.
        pace: clock ratio and physics milliseconds a frame.
    """

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
        setup = setup_of(scene)
        starts = [State.at_start(one.chain, lane.velocity) for one, lane in zip(setup.lanes, scene.lanes, strict=True)]
        self._open(setup, starts)

    def _open(self, setup: Setup, starts: Sequence[State]) -> None:
        """Begin at `starts`, one State a lane."""
        self.setup = setup
        self.starts = [state.copy() for state in starts]
        self.lanes = [
            LiveLane(one, state.copy(), ledger.opened(one.chain, state))
            for one, state in zip(setup.lanes, starts, strict=True)
        ]
        self.hand = NO_HAND
        self.playing = False
        self.frame = 0
        self.history.start(self._moment())

    # ---- time

    @property
    def time(self) -> float:
        """Model time shown [s]."""
        return self.lanes[0].state.time

    @property
    def slow(self) -> float:
        """Wall seconds for one second of the model; set it by the input SetSlow."""
        return self.setup.slow

    @property
    def span(self) -> tuple[float, float]:
        """First and last model time [s] that can be scrubbed to."""
        return float(self.history.blocks[0].time[0]), self.history.moment(self.history.last).time

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
        return self.pace.run(wall_seconds, self._compute_frame) if self.playing else 0

    def step_frames(self, count: int) -> None:
        """Pause and go `count` frames forward (computing them where there are none yet) or, if negative, back."""
        self.pause()
        target = max(self.frame + count, self.history.first)
        self.scrub_frame(min(target, self.history.last))
        for _ in range(target - self.frame):
            self._compute_frame()

    def scrub(self, time: float) -> None:
        """Pause and show the moment nearest to `time` [s] of the history."""
        self.scrub_frame(self.history.frame_at(time))

    def scrub_frame(self, frame: int) -> None:
        """Pause and show `frame`; IndexError where it is not kept."""
        self.pause()
        if frame == self.frame:
            return
        self._show(self.history.moment(frame), frame)

    def restart(self) -> None:
        """Back to the start with all edits kept, paused; the history begins anew."""
        self._open(self.setup, self.starts)

    # ---- inputs

    def apply(self, item: inputs.Input) -> None:
        """Do what `item` says, felt in the next frame. ValueError, with a sentence, where it cannot be; nothing changed."""
        self._branch()
        self._accept(item)
        self.history.replace_last(self._moment())

    def drag(self, lane: int, bead: int, position: float) -> None:
        """Hold a bead at the pointer: by a spring while the model runs, by placing it while it is paused."""
        kind = inputs.Drag if self.playing else inputs.Place
        self.apply(kind(lane, bead, position))

    def drop(self) -> None:
        """Let go."""
        self.apply(inputs.Drop())

    def _accept(self, item: inputs.Input) -> None:
        if isinstance(item, inputs.Drag):
            self._lane(item.lane)
            self.hand = (float(item.lane), float(item.bead), item.position)
        elif isinstance(item, inputs.Drop | inputs.Resume):
            self.hand = NO_HAND
        elif isinstance(item, inputs.SetSlow):
            self.setup = replace(self.setup, slow=item.slow)
        else:
            chosen = range(len(self.lanes)) if item.lane is None else (item.lane,)
            for index in chosen:
                self._edit(index, item)

    def _edit(self, index: int, item: inputs.Input) -> None:
        lane = self._lane(index)
        setup, state = edited(item, lane.setup, lane.state.copy())
        books = lane.books.copy()
        ledger.read(setup.chain, state, books)
        ledger.book_edit(lane.books, books)
        self.lanes[index] = LiveLane(setup, state, books)
        self.setup = replace(self.setup, lanes=tuple(one.setup for one in self.lanes))
        if self.frame == 0:
            self.starts[index] = state.copy()

    def _lane(self, index: int) -> LiveLane:
        if not 0 <= index < len(self.lanes):
            raise ValueError(f"there is no lane {index}; they are numbered 0 to {len(self.lanes) - 1}")
        return self.lanes[index]

    # ---- frames

    def _compute_frame(self) -> None:
        """One frame: every lane moves on by the same model time."""
        self._branch()
        for index, lane in enumerate(self.lanes):
            self._advance(index, lane)
        self.frame += 1
        self.history.append(self._moment())

    def _advance(self, index: int, lane: LiveLane) -> None:
        chain, state, duration = lane.chain, lane.state, self.setup.frame_time
        bead = int(self.hand[1]) if index == int(self.hand[0]) else -1
        before = lane.position
        state.push = None
        if bead >= 0:
            state.push = np.zeros(chain.contacts + 1)
            offset = self.hand[2] - float(before[bead])
            state.push[bead] = push_of_hand(self.setup, index, bead, offset, float(lane.velocity[bead]))
        closed = state.overlap > 0.0
        advance(chain, state, duration, lane.setup.method, lane.setup.step_for(duration), lane.setup.tolerance)
        books = lane.books.copy()
        ledger.read(chain, state, books)
        work = impulse = 0.0
        if state.push is not None:
            work = float(state.push @ (lane.position - before))
            impulse = duration * float(state.push.sum())
        ledger.book_frame(chain, books, work, impulse)
        books[SWITCHES] += np.count_nonzero(closed != (state.overlap > 0.0))
        lane.books = books

    def _moment(self) -> Moment:
        states = tuple(lane.state for lane in self.lanes)
        return Moment(self.time, self.setup, self.hand, states, tuple(lane.books for lane in self.lanes))

    def _show(self, moment: Moment, frame: int) -> None:
        self.setup, self.hand, self.frame = moment.setup, NO_HAND, frame
        self.lanes = [LiveLane(*parts) for parts in zip(moment.setup.lanes, moment.states, moment.ledgers, strict=True)]

    def _branch(self) -> None:
        """What is later than the moment shown is dropped before it is played or edited differently."""
        if self.scrubbed:
            self.history.drop_after(self.frame)
