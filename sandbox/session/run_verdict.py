"""The verdict of a whole run: when its energy or momentum was off, contacts chattered or beads passed through each other.

It is found in the history alone, so it is right after a scrub, a new branch, an undo and a redo.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.methods import find_method
from softcradle.sandbox.languages import N_, _, language
from softcradle.sandbox.motion import Array
from softcradle.sandbox.session.badge_numbers import BAD, BAD_ERROR, FAIR, FAIR_ERROR, LEVELS, MOST_CHATTER, WINDOW
from softcradle.sandbox.session.frame_history import Block, History
from softcradle.sandbox.session.history_slices import HistorySlice, history_slices
from softcradle.sandbox.session.ledger import SWITCHES, energy_error, momentum_error
from softcradle.sandbox.session.live_method import contact_time

PASSED = N_("beads passed through each other")


@dataclass(frozen=True)
class Finding:
    """Something that was wrong for a while.

    Attributes:
        cause: in some words of the language in use.
        level: 'fair' or 'bad', the worst of that while.
        first, last: frames.
        begin, end: times [s].
    """

    cause: str
    level: str
    first: int
    last: int
    begin: float
    end: float


class RunVerdicts:
    """The findings of all lanes of a history; those of full blocks are found once.

    Arguments:
        history: the frames.
        length: of a bead [m]; an overlap beyond it means that a bead has passed its neighbour.
    """

    def __init__(self, history: History, length: float) -> None:
        self.history, self.length = history, length
        self._known: dict[tuple[int, int, str], tuple[Block, int, list[Finding]]] = {}

    def of(self, lane: int) -> list[Finding]:
        """The findings of a lane, in order of time; those of one cause that follow each other closely are one."""
        found: list[Finding] = []
        for block in self.history.blocks:
            found += self._of_block(block, lane)
        return _merged(found)

    def _of_block(self, block: Block, lane: int) -> list[Finding]:
        key = (id(block), lane, language())
        known = self._known.get(key)
        if known and known[0] is block and known[1] == block.revision and block is not self.history.blocks[-1]:
            return known[2]
        last = block.first + block.used - 1
        slices = history_slices(self.history, lane, block.first - WINDOW, last)
        parts = [part for part in slices if part.first + len(part.time) > block.first]
        found = [item for part in parts for item in findings_of(part, self.length) if item.last >= block.first]
        if len(self._known) > 4 * len(self.history.blocks) + 16:
            self._known.clear()
        self._known[key] = (block, block.revision, found)
        return found


def findings_of(part: HistorySlice, length: float) -> list[Finding]:
    """What was wrong in one slice."""
    method = part.setup.method
    chatter = BAD if not find_method(method).set_valued else FAIR
    energy: Array = np.atleast_1d(energy_error(part.ledger))
    momentum: Array = np.atleast_1d(momentum_error(part.ledger))
    passed: NDArray[np.bool_] = np.asarray((part.overlap > length).any(axis=1), dtype=bool)
    lost_energy, lost_momentum = _("{method} lost energy", method=method), _("{method} lost momentum", method=method)
    rows: list[tuple[str, str, NDArray[np.bool_]]] = [
        (_(PASSED), BAD, passed),
        (_("{method} chattered", method=method), chatter, _chatter(part) > MOST_CHATTER),
        (lost_energy, BAD, energy > BAD_ERROR),
        (lost_momentum, BAD, momentum > BAD_ERROR),
        (lost_energy, FAIR, (energy > FAIR_ERROR) & (energy <= BAD_ERROR)),
        (lost_momentum, FAIR, (momentum > FAIR_ERROR) & (momentum <= BAD_ERROR)),
    ]
    return [item for cause, level, mask in rows if mask.any() for item in _spells(part, cause, level, mask)]


def _chatter(part: HistorySlice) -> Array:
    """(T,) switches over the last WINDOW frames of the slice, relative to the most that is plausible."""
    switches, rows = part.ledger[:, SWITCHES], np.arange(len(part.time))
    begin = np.maximum(rows - WINDOW, 0)
    elapsed = part.time - part.time[begin]
    most = 2.0 * part.chain.contacts * (1.0 + elapsed / contact_time(part.chain, part.setup.speed))
    chatter: Array = (switches - switches[begin]) / most
    return chatter


def _spells(part: HistorySlice, cause: str, level: str, mask: NDArray[np.bool_]) -> list[Finding]:
    edges = np.flatnonzero(np.diff(np.concatenate(([0], mask.astype(np.int8), [0]))))
    return [
        Finding(cause, level, part.first + a, part.first + b, float(part.time[a]), float(part.time[b]))
        for a, b in zip(edges[::2].tolist(), (edges[1::2] - 1).tolist(), strict=True)
    ]


def _merged(found: list[Finding]) -> list[Finding]:
    """Findings of one cause joined where less than WINDOW frames lie between them."""
    joined: dict[str, list[Finding]] = {}
    for item in sorted(found, key=lambda one: one.first):
        own = joined.setdefault(item.cause, [])
        if own and item.first - own[-1].last <= WINDOW:
            worst = max(own[-1].level, item.level, key=LEVELS.index)
            last, end = max((own[-1].last, own[-1].end), (item.last, item.end))
            own[-1] = replace(own[-1], level=worst, last=last, end=end)
        else:
            own.append(item)
    return sorted((item for own in joined.values() for item in own), key=lambda one: one.first)
