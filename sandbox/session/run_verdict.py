"""Verdict on a run. It lists the times at which errors, chatter or steps exceeded their limits, with a remedy.

One table of criteria is applied to every frame of a slice of the history. The badge shows the criteria of the last
frame. The findings of a run are the frames at which a criterion was met. Findings are computed from the history, so
they remain correct after every undo or new branch.
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

FAIR_VELOCITY = 1e-2  # Largest velocity error that counts as good, relative to the closing speed.
BAD_VELOCITY = 0.1  # Largest velocity error that counts as fair, relative to the closing speed.
# Largest accepted number of contact openings and closings, relative to the largest plausible number.
MOST_CHATTER = 1.0
# Smallest accepted number of steps in the shortest contact. With fewer steps, velocities become inaccurate.
FINE_STEPS = 8.0
COARSE_STEPS = 2.0  # Number of steps in the shortest contact below which velocities are arbitrary.
ON_TIME = 0.9  # Smallest ratio of model clock to wall clock that counts as good.
WINDOW = 120  # Number of frames over which contact openings and closings are counted: one second of wall time.
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
    """A condition under which the result of a lane is not good.

    Attributes:
        level: 'fair' or 'bad'.
        holds: (T,) True for each frame of the slice in which the condition is met.
        sentence: reason and remedy, for the last of these frames.
        cause: short text for the findings of a run.
    """

    level: str
    holds: NDArray[np.bool_]
    sentence: str
    cause: str


def criteria(part: HistorySlice, chatter: Array, length: float) -> list[Criterion]:
    """Return the criteria for one slice of the history, the most severe first. `length` [m] is the length of a bead."""
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
    """Return the criteria for unexplained energy or momentum. `error` is relative to the largest energy or momentum so
    far.
    """
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
    """Return the criteria for the velocity error that an adaptive method has estimated."""
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
    """Return the estimated velocity error (T,) of each frame, relative to the closing speed. It is negative without an
    estimate.
    """
    found: Array = part.ledger[:, VELOCITY_ERROR] / part.setup.speed
    return found


def _passing(part: HistorySlice, length: float) -> Criterion:
    """Return the criterion for overlaps beyond the length of a bead. Such a bead has passed through its neighbour."""
    passed = part.overlap > length
    bead = int(np.argmax(passed[-1]))
    text = _(
        "beads {left} and {right} have passed through each other: the contact is too weak for this speed",
        left=bead,
        right=bead + 1,
    )
    return Criterion(BAD, np.asarray(passed.any(axis=1), dtype=bool), text, _(PASSED))


def _chatter(part: HistorySlice, before: Sequence[HistorySlice] = ()) -> Array:
    """Return the (T,) number of contact events in the last WINDOW frames, relative to the largest plausible number.

    A contact event is a closing or an opening. It is plausible that every contact closes and opens once, and once more
    in every contact time. Frames `before` the slice are counted while the number of contacts is the same.
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


# Sentences about a method with an error in energy or momentum: for a small error, for a large error, and as the finding
# of a run.
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
        energy_error: unexplained energy relative to the largest energy so far. Input of pointer, drives, walls and
            edits is booked and does not count as unexplained. None if walls move at different speeds, because the work
                of such walls is not known.
        momentum_error: unexplained momentum, defined in the same way; None if a wall or a bed absorbs momentum.
        chatter: number of closings and openings in the last second of wall time, relative to the largest plausible
            number.
            Above 1, the method only seems to keep contacts closed.
        velocity_error: velocity error relative to the closing speed. It is the difference to an accurate run in the
            background, or otherwise the estimate of the method. None if neither is known.
        milliseconds: wall time of the physics per frame, for all lanes together.
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
    """Return the health of a lane at the end of `slices`, which contain its last :data:`WINDOW` frames.

    `warning` is the warning of the integration method. `length` [m] is the length of a bead. If an overlap is larger,
    the bead has passed its neighbour. `velocity_error` is the error found by an accurate run in the background, if
    known.
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
    """A problem that lasted for a range of frames.

    Attributes:
        cause: short text in the current language.
        level: 'fair' or 'bad', the worst level in these frames.
        first, last: first and last frame.
        begin, end: times of these two frames [s].
    """

    cause: str
    level: str
    first: int
    last: int
    begin: float
    end: float


def run_findings(history: History, lane: int, length: float) -> list[Finding]:
    """Return the findings of a lane in order of time. Findings with the same cause in close succession are merged.

    An overlap beyond the `length` [m] of a bead means that the bead has passed its neighbour.
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
    """Return the findings in order of time. Findings with the same cause are merged if at most WINDOW frames lie
    between them.
    """
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
