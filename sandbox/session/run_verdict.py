"""Verdict on a run: when its errors, its chatter or its steps exceeded their limits, and what to do about it.

One table of criteria judges every frame of a slice of the history. The badge shows the last frame. The findings of the
whole run are the frames at which a criterion was met, so they stay correct after a scrub, a new branch, an undo and a
redo.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import takewhile
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.methods import find_method
from softcradle.physics.scales import shortest_contact
from softcradle.physics.trajectory import work_of_walls
from softcradle.sandbox.languages import N_, _, language, localized
from softcradle.sandbox.motion import Array
from softcradle.sandbox.session.frame_history import Block, History
from softcradle.sandbox.session.frame_pacing import FramePacer
from softcradle.sandbox.session.history_slices import HistorySlice, history_slices
from softcradle.sandbox.session.ledger import SWITCHES, VELOCITY_ERROR, energy_error, momentum_error
from softcradle.sandbox.story.verdict import BAD, BAD_ERROR, FAIR, FAIR_ERROR, GOOD, LEVELS, level_of

FAIR_VELOCITY = 1e-2  # largest velocity error that is good, relative to the closing speed
BAD_VELOCITY = 0.1  # largest velocity error that is fair, relative to the closing speed
MOST_CHATTER = 1.0  # largest ratio of switches to plausible switches
FINE_STEPS = 8.0  # steps in the shortest contact; with fewer, velocities lose digits
COARSE_STEPS = 2.0  # steps in the shortest contact; with fewer, velocities are arbitrary
ON_TIME = 0.9  # smallest clock ratio that is good
WINDOW = 120  # frames over which chatter is counted: one second of wall time
BOUNCING = N_(
    "contacts open and close {times:.0f} times faster than the time step can follow: "
    "individual beads may be wrong; use slower motion"
)
CHATTERING = N_(
    "contacts at rest open and close {times:.0f} times faster than is possible: "
    "{method} is beyond its limit; use conserving"
)
PASSED = N_("beads passed through each other")
COARSE = N_("steps were too long for the contacts")


class Criterion(NamedTuple):
    """Reason for a verdict worse than good.

    Attributes:
        level: 'fair' or 'bad'.
        holds: (T,) True for each frame of a slice that meets it.
        sentence: reason at the last of these frames, and remedy.
        cause: short text for the findings of a run.
    """

    level: str
    holds: NDArray[np.bool_]
    sentence: str
    cause: str


def criteria(part: HistorySlice, chatter: Array, length: float) -> list[Criterion]:
    """Return the criteria of one slice, the most severe first; `length` [m] is the length of a bead."""
    setup, method = part.setup, part.setup.method
    steps = shortest_contact(part.chain, setup.scale) / part.step if part.step else math.inf
    found = _off(part, "energy", np.atleast_1d(energy_error(part.ledger)))
    found += _off(part, "momentum", np.atleast_1d(momentum_error(part.ledger)))
    found += _uncertain(part)
    level, text = (FAIR, BOUNCING) if find_method(method).set_valued else (BAD, CHATTERING)
    chattered = _("{method} chattered", method=method)
    found.append(Criterion(level, chatter > MOST_CHATTER, _(text, times=chatter[-1], method=method), chattered))
    arbitrary = _("{steps:.1g} steps per contact: velocities are arbitrary; {remedy}", steps=steps, remedy=setup.finer)
    rough = _(
        "only {steps:.0f} steps in the shortest contact: velocities are inaccurate; {remedy}",
        steps=steps,
        remedy=setup.finer,
    )
    always = np.ones(len(part.time), dtype=bool)
    found += [
        Criterion(BAD, always & (steps < COARSE_STEPS), arbitrary, _(COARSE)),
        Criterion(FAIR, always & (steps < FINE_STEPS), rough, _(COARSE)),
        _passing(part, length),
    ]
    return sorted(found, key=lambda item: -LEVELS.index(item.level))


def _off(part: HistorySlice, name: str, error: Array) -> list[Criterion]:
    """Return the criteria of unexplained energy or momentum, relative to the largest so far."""
    setup, method = part.setup, part.setup.method
    fair, bad, lost = OFF[name]
    values = {"method": method, "error": _percent(float(error[-1])), "remedy": setup.remedy}
    blown_up = _("{method} has blown up: restart, and {remedy}", method=method, remedy=setup.remedy)
    is_bad, finite, cause = ~(error <= BAD_ERROR), np.isfinite(error), _(lost, method=method)
    return [
        Criterion(BAD, ~finite, blown_up, cause),
        Criterion(BAD, is_bad & finite, _(bad, **values), cause),
        Criterion(FAIR, (error > FAIR_ERROR) & ~is_bad, _(fair, **values), cause),
    ]


def _uncertain(part: HistorySlice) -> list[Criterion]:
    """Return the criteria of the error that an adaptive method estimates for its own velocities."""
    error = estimated_error(part)
    text = _(
        "{method} may be off by {error} of the closing speed: the motion amplifies small errors",
        method=part.setup.method,
        error=_percent(float(error[-1])),
    )
    cause = _("velocities were uncertain")
    return [
        Criterion(BAD, error > BAD_VELOCITY, text, cause),
        Criterion(FAIR, (error > FAIR_VELOCITY) & ~(error > BAD_VELOCITY), text, cause),
    ]


def estimated_error(part: HistorySlice) -> Array:
    """Return the estimated velocity error (T,) of each frame relative to the closing speed; negative if there is none."""
    found: Array = part.ledger[:, VELOCITY_ERROR] / part.setup.speed
    return found


def _passing(part: HistorySlice, length: float) -> Criterion:
    """Return the criterion of overlaps beyond the length of a bead, at which a bead has passed its neighbour."""
    passed = part.overlap > length
    bead = int(np.argmax(passed[-1]))
    text = _(
        "beads {left} and {right} have passed through each other: the contact is too weak for this speed",
        left=bead,
        right=bead + 1,
    )
    return Criterion(BAD, np.asarray(passed.any(axis=1), dtype=bool), text, _(PASSED))


def _chatter(part: HistorySlice, before: Sequence[HistorySlice] = ()) -> Array:
    """Return the (T,) number of switches over the last WINDOW frames, relative to the largest plausible number.

    Plausible is that every contact closes and opens once, and again in every contact time. Frames `before` the slice
    count as far back as the number of contacts is the same.
    """
    alike = list(takewhile(lambda one: one.chain.contacts == part.chain.contacts, reversed(before)))[::-1]
    time = np.concatenate([one.time for one in (*alike, part)])
    switches = np.concatenate([one.ledger[:, SWITCHES] for one in (*alike, part)])
    row = np.arange(len(time) - len(part.time), len(time))
    begin = np.maximum(row - WINDOW, 0)
    most = (
        2.0 * part.chain.contacts * (1.0 + (time[row] - time[begin]) / shortest_contact(part.chain, part.setup.scale))
    )
    chatter: Array = np.maximum(switches[row] - switches[begin], 0.0) / most
    return chatter


def _percent(value: float) -> str:
    return localized(f"{100.0 * value:.2g} %")


# what is said of a method that is off by some of it, a little or badly, and of a run in which it was
OFF = {
    "energy": (
        N_("{method} is off by {error} of the energy"),
        N_("{method} is off by {error} of the energy: {remedy}"),
        N_("{method} lost energy"),
    ),
    "momentum": (
        N_("{method} is off by {error} of the momentum"),
        N_("{method} is off by {error} of the momentum: {remedy}"),
        N_("{method} lost momentum"),
    ),
}


@dataclass(frozen=True)
class Health:
    """Present reliability of a lane.

    Attributes:
        energy_error: unexplained energy relative to the largest so far, without the booked input of pointer, drives,
            walls and edits. None if walls move at different speeds, because their work is not known.
        momentum_error: the same for momentum; None if a wall or a bed takes momentum.
        chatter: contact switches over the last second of wall time relative to the largest plausible number; above 1, a
            method only seems to keep contacts closed.
        velocity_error: difference to an accurate run in the background, or else the estimate of the method, relative to
            the closing speed; None if neither is known.
        milliseconds: wall time of physics in a frame, all lanes together.
        level: 'good', 'fair' or 'bad'.
        sentence: reason and remedy.
    """

    energy_error: float | None
    momentum_error: float | None
    chatter: float
    milliseconds: float
    level: str
    sentence: str
    velocity_error: float | None = None


def health_of(
    slices: Sequence[HistorySlice],
    pacer: FramePacer,
    warning: str = "",
    length: float = math.inf,
    velocity_error: float | None = None,
) -> Health:
    """Return the health of a lane at the end of `slices`, its last :data:`WINDOW` frames.

    `warning` is the warning of its method. `length` [m] is the length of a bead; a larger overlap means that it has
    passed its neighbour. `velocity_error` is the error found by an accurate run in the background, if known.
    """
    *before, part = slices
    ledger, chain = part.ledger[-1], part.chain
    unknown = np.isnan(work_of_walls(chain, part.velocity[-1:], np.zeros(1))[0])
    chatter = _chatter(part, before)
    found = [(item.level, item.sentence) for item in criteria(part, chatter, length) if item.holds[-1]]
    if warning:
        found.append((BAD, warning))
    if velocity_error is not None and (off := level_of(velocity_error, FAIR_VELOCITY, BAD_VELOCITY)) != GOOD:
        text = N_("velocities are wrong by {error} of the closing speed: use slower motion")
        found.append((off, _(text, error=_percent(velocity_error))))
    estimate = float(estimated_error(part)[-1])
    if velocity_error is None and estimate >= 0.0:
        velocity_error = estimate
    if pacer.clock_ratio < ON_TIME:
        late = N_("only {share} of the chosen speed: computing a frame takes too long")
        found.append((FAIR, _(late, share=_percent(pacer.clock_ratio))))
    found.append((GOOD, _("accuracy OK ({method})", method=part.setup.method)))
    level, sentence = max(found, key=lambda item: LEVELS.index(item[0]))
    return Health(
        energy_error=None if unknown else float(energy_error(ledger)),
        momentum_error=None if chain.walls or chain.takes_momentum else float(momentum_error(ledger)),
        chatter=float(chatter[-1]),
        milliseconds=pacer.milliseconds,
        level=level,
        sentence=sentence,
        velocity_error=velocity_error,
    )


@dataclass(frozen=True)
class Finding:
    """Problem that lasted for a while.

    Attributes:
        cause: short text in the current language.
        level: 'fair' or 'bad', the worst of that time.
        first, last: frames.
        begin, end: times [s].
    """

    cause: str
    level: str
    first: int
    last: int
    begin: float
    end: float


def run_findings(history: History, lane: int, length: float) -> list[Finding]:
    """Return the findings of a lane in order of time; findings of one cause in close succession are merged.

    An overlap beyond the `length` [m] of a bead means that a bead has passed its neighbour.
    """
    found: list[Finding] = []
    for before, block in history.pairs():
        what = "findings", lane, language(), before is None
        found += block.found(what, partial(_found_in, history, block, lane, length))
    return _merged(found)


def _found_in(history: History, block: Block, lane: int, length: float) -> list[Finding]:
    slices = list(history_slices(history, lane, block.first - WINDOW, block.first + block.used - 1))
    parts = [(k, part) for k, part in enumerate(slices) if part.first + len(part.time) > block.first]
    found = [(part, one) for k, part in parts for one in criteria(part, _chatter(part, slices[:k]), length)]
    return [item for part, one in found for item in _spells(part, one) if item.last >= block.first]


def _spells(part: HistorySlice, found: Criterion) -> list[Finding]:
    edges = np.flatnonzero(np.diff(np.concatenate(([0], found.holds.astype(np.int8), [0]))))
    return [
        Finding(found.cause, found.level, part.first + a, part.first + b, float(part.time[a]), float(part.time[b]))
        for a, b in zip(edges[::2].tolist(), (edges[1::2] - 1).tolist(), strict=True)
    ]


def _merged(found: list[Finding]) -> list[Finding]:
    """Return the findings with those of one cause joined if fewer than WINDOW frames lie between them."""
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
