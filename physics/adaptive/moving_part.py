"""The part of a long chain that moves: while the rest of it is at rest, this part alone is stepped, to the same digits.

A contact rests here where its beads have one velocity, and it carries no force and no overlap. A step of dop853 takes the
contacts that push, with a margin, and leaves those that rest beyond exactly as they are. So what moves grows by that margin a
step at most, and as long as it does not reach the edge of the part, a run of the part is a run of the chain.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from softcradle.physics.adaptive.constants import MARGIN
from softcradle.physics.adaptive.step_records import Scratch, empty_scratch, empty_trial
from softcradle.physics.chain import Chain
from softcradle.physics.numerics.records import LOADED, OPEN, SWITCH, Motion, SwitchLog
from softcradle.physics.state import State

# contacts beside those that move, so that a part lasts for some steps; a chain that is no longer is one part
SHORTEST = 128
ADVANCE = MARGIN + 1  # contacts by which what moves grows a step at either side; one of them where a closing is stopped
LEAST_STEPS = 8  # steps for which a part lasts, or it is made anew
# fields of Scratch, a number a contact
OWN_ROWS = "opening", "opened", "lateness", "grown", "most_grown", "course", "turns"


def rests_exactly(chain: Chain, state: State, explicit: bool) -> bool:
    """Whether contacts at rest stay exactly so in a step; `explicit`: all steps are those of dop853, soft contacts or not.

    Where beads may stick or are driven, and where contacts that touch pass on at once what pushes them, none is at rest.
    """
    if chain.contacts <= SHORTEST or chain.dissipative or chain.couplers or chain.own_laws:
        return False
    law = chain.law_rows
    smooth = bool((law[:, 0] == 0.0).all()) and (explicit or bool((law[:, 2] >= 1.0).all()))
    return smooth and state.external(chain) is None


class MovingPart:
    """Contacts [first, last) of a chain, and the records of kernels for them; most are views of those of the whole chain.

    Arguments:
        chain, regime, motion: fields of the records of the whole chain.
        trial, look, scratch, log: the same of its memory.
        time: when the run begins [s].
        divisible: whether contacts at rest are left out; else the part is the chain.
    """

    def __init__(
        self, chain: Any, regime: Any, motion: Any, trial: Any, look: Any, scratch: Scratch, log: SwitchLog, time: float,
        divisible: bool,
    ) -> None:  # fmt: skip
        self._chain, self._regime, self._motion, self._scratch, self._log = chain, regime, Motion(*motion), scratch, log
        self._divisible, self._size = divisible, self._motion.overlap.size
        self.records: Any = (chain, regime, motion, tuple(trial), tuple(look), tuple(scratch))
        self.log: Any = tuple(log)
        self.first, self.last, self._holds_anchor = 0, self._size, True
        if divisible:
            self._begin(time)
            self._take(*self._with_room(*self._moving(0, self._size)))

    def _begin(self, time: float) -> None:
        """Put all contacts at rest; those that move are put into their modes by the kernel."""
        motion, scratch = self._motion, self._scratch
        motion.mode[:], motion.held[:] = np.where(motion.overlap < 0.0, OPEN, LOADED), 0
        for name in OWN_ROWS:
            getattr(scratch, name)[:] = 0.0
        scratch.opened[:] = np.where(motion.overlap < 0.0, time, np.inf)

    @property
    def contacts(self) -> int:
        """Contacts of the part."""
        return self.last - self.first

    def _moving(self, first: int, last: int) -> tuple[int, int]:
        """The least stretch of [first, last) beyond which contacts rest; an empty one in its middle where all do."""
        inside, motion = slice(first, last), self._motion
        moves = (motion.rate[inside] != 0.0) | (motion.overlap[inside] > 0.0) | (motion.force[inside] != 0.0)
        moving, middle = np.flatnonzero(moves), (first + last) // 2
        return (first + int(moving[0]), first + int(moving[-1]) + 1) if moving.size else (middle, middle)

    def _with_room(self, low: int, high: int) -> tuple[int, int]:
        """The part for contacts [low, high) that move."""
        room = max((high - low) // 2, SHORTEST)
        return max(low - room, 0), min(high + room, self._size)

    def steps(self, most: int) -> int:
        """How many steps, `most` at the most, the part lasts for; where these are few, it is made anew."""
        if not self._divisible:
            return most
        low, high = self._moving(self.first, self.last)
        if self._lasting(low, high) < LEAST_STEPS:
            self._take(*self._with_room(low, high))
        return min(self._lasting(low, high), most)

    def _lasting(self, low: int, high: int) -> int:
        """Steps after which contacts [low, high), which move, may have grown to an edge within the chain."""
        left = (low - self.first) // ADVANCE if self.first else self._size
        right = (self.last - high) // ADVANCE if self.last < self._size else self._size
        return int(min(left, right) - 1)

    def _take(self, first: int, last: int) -> None:
        """Make the records of contacts [first, last)."""
        self.first, self.last = first, last
        law, inverse_mass, push, external, anchor, *others = self._chain
        inside, beads, motion = slice(first, last), slice(first, last + 1), self._motion
        holds_anchor = first <= anchor <= last
        own = law[inside], inverse_mass[beads]
        chain = (*own, push, external, anchor - first if holds_anchor else 0, *others)
        regime = (*own, *self._regime[2:])
        moved = motion._replace(
            anchor=motion.anchor if holds_anchor else np.zeros(2),
            **{name: getattr(motion, name)[inside] for name in ("overlap", "rate", "force", "mode", "held")},
        )
        count = last - first
        scratch = empty_scratch(count)._replace(
            control=self._scratch.control, **{name: getattr(self._scratch, name)[inside] for name in OWN_ROWS}
        )
        self.records = (
            chain, regime, tuple(moved), tuple(empty_trial(count)), tuple(empty_trial(count)), tuple(scratch)
        )  # fmt: skip
        self.log_into(self._log)
        self._holds_anchor = holds_anchor

    def log_into(self, log: SwitchLog) -> None:
        """Log into `log`, that of the whole chain, from now on."""
        own = log._replace(closed=log.closed[self.first : self.last]) if self._divisible else log
        self._log, self.log = log, tuple(own)

    def stepped(self, logged: int, passed: float) -> None:
        """Bring what is beyond the part up to date after `passed` [s] of its steps; `logged` switches were in the log before."""
        if self.first:
            self._log.contact[logged : int(self._log.counter[SWITCH])] += self.first
        if not self._holds_anchor:
            self._motion.anchor[0] += passed * self._motion.anchor[1]
