"""A lane at play: its setup, its state and its books, moved on by frames and changed by edits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.simulation import move
from softcradle.physics.state import State
from softcradle.sandbox.session import ledger
from softcradle.sandbox.session.edits import edited, edited_start
from softcradle.sandbox.session.history import SWITCHES
from softcradle.sandbox.session.history_slices import is_closed
from softcradle.sandbox.session.inputs import LaneInput, SetVelocity
from softcradle.sandbox.session.lane_setup import LaneSetup
from softcradle.sandbox.session.pointer_spring import push_of_hand

Array = NDArray[np.float64]
LARGEST = 1e15  # m, m/s, N: beyond it energies would overflow
LIVE_STEPS = 5_000  # of an adaptive method in one frame: some 20 ms
TROUBLE_FRAMES = 60  # in which what a method could not do is still told
Hand = tuple[float, float, float]  # lane (-1: empty), bead, position of the pointer [m]


class BlownUpError(Exception):
    """A method has gone past its limit; the message is a sentence."""


@dataclass
class LiveLane:
    """One lane as it is now: the immutable `setup`, the moving `state`, the `books` of its energy and momentum.

    `trouble` is what its method could not do of late, in a sentence, `troubled` the frames since.
    """

    setup: LaneSetup
    state: State
    books: Array
    trouble: str = ""
    troubled: int = 0

    @classmethod
    def at_start(cls, setup: LaneSetup) -> LiveLane:
        """The lane as it begins."""
        state = setup.start.copy()
        return cls(setup, state, ledger.opened(setup.chain, state))

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

    def changed(self, item: LaneInput, opening: bool) -> LiveLane:
        """The lane after an edit; one at the `opening` of the session changes its start too. ValueError: refused."""
        setup, state = edited(item, self.setup, self.state.copy())
        books = self.books.copy()
        ledger.read(setup.chain, state, books)
        ledger.book_edit(self.books, books)
        start = state.copy() if opening else edited_start(item, self.setup)
        if opening and isinstance(item, SetVelocity):
            setup = setup.with_speed(state.velocity(setup.chain))
        return LiveLane(setup.with_start(start), state, books)

    def advance(self, duration: float, bead: int, pointer: float, quickness: float) -> None:
        """Move on by one frame; `bead` (-1: none) is held at `pointer` by a hand of that quickness [1/s].

        BlownUpError, with a state that means nothing, where a number has grown beyond all sense.
        """
        chain, state, setup = self.chain, self.state, self.setup
        before, closed, switches = self.position, is_closed(state.overlap, state.force), state.switches
        absorbed = state.absorbed.copy()
        state.push = self._push(bead, pointer, quickness)
        move(chain, state, duration, setup.method, setup.step_for(duration), setup.tolerance, LIVE_STEPS)
        found = " ".join(map(str, state.warnings))
        self.trouble, self.troubled = (found, 0) if found else (self.trouble, self.troubled + 1)
        if self.troubled >= TROUBLE_FRAMES:
            self.trouble = ""
        if not all(
            (np.abs(values) < LARGEST).all() for values in (state.overlap, state.rate, state.anchor, state.force)
        ):
            raise BlownUpError(f"{setup.method} has blown up: take conserving or a smaller step")
        books = self.books.copy()
        ledger.read(chain, state, books)
        ledger.book_frame(chain, self.books, books, self._outside(before, duration, state.absorbed - absorbed))
        seen = int(np.count_nonzero(closed != is_closed(state.overlap, state.force)))
        books[SWITCHES] += max(seen, state.switches - switches)
        self.books = books

    def _push(self, bead: int, pointer: float, quickness: float) -> Array | None:
        if bead < 0:
            return None
        push = np.zeros(self.chain.contacts + 1)
        offset, velocity = pointer - float(self.position[bead]), float(self.velocity[bead])
        push[bead] = push_of_hand(self.setup, bead, offset, velocity, quickness)
        return push

    def _outside(self, before: Array, duration: float, absorbed: Array) -> ledger.Outside:
        """Work and impulse of the hand and the drive in a frame that began at the positions `before`."""
        external = self.state.external(self.chain)
        walls = np.isinf(self.chain.mass)
        wall_velocity = self.velocity[walls]
        if external is None:
            return ledger.Outside(0.0, 0.0, wall_velocity, absorbed)
        on_beads = np.where(walls, 0.0, external)
        work = float(on_beads @ (self.position - before))
        return ledger.Outside(work, duration * float(on_beads.sum()), wall_velocity, absorbed)
