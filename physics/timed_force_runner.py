"""Forces over time, for every method alike: a motion in pieces, within each of which they are steady.

Kernels know steady forces alone. Where a force is steady, a piece ends at its next point, and that is exact. A slope s is a
stair of pieces of equal length h, each with the force of its middle. A bead of mass m under a stair is ahead of one under
the slope by s h**2 / 12 m of velocity in the mean, for what the force of the middle gives early it takes back late. So the
first piece of a stair has s h / 12 less, the last as much more. Within the stair velocities are then within s h**2 / 12 m of
those under the slope, at its end they are the same, and the path is off by s h**3 / 24 m, however many pieces there are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.problem import (
    NO_TIMES,
    Problem,
    Record,
    continued_switches,
    run_to_end,
    with_samples_of,
)
from softcradle.physics.scales import contact_scales
from softcradle.physics.state import State, from_anchor
from softcradle.physics.status import CodedWarning, Status, WarningCode, Warnings
from softcradle.physics.timed_force import TimedForce

Array = NDArray[np.float64]

MOST_PIECES = 1000  # in the time over which forces change, beside one for each of their points
FIXED_TOLERANCE = 1e-5  # in place of a tolerance where a method has none
# of the tolerance: what velocities within a slope are off by, relative to the speed that forces can give
STAIR_PART = 0.1
STILL = 1e-6  # of the largest energy so far: with less, no piece is blamed for what it lacks


@dataclass(frozen=True)
class Piece:
    """A time within which the forces are steady.

    Attributes:
        start, end: [s]; the end may be inf.
        push: (n+1,) forces over time on the beads [N].
        chain: the chain with steady brakes, without forces over time.
        error: (n+1,) what positions [m] are off by at the end of a stair, booked with its last piece.
    """

    start: float
    end: float
    push: Array
    chain: Chain
    error: Array


def pieces_of(chain: Chain, start: float, end: float, tolerance: float, least: float) -> Iterator[Piece]:
    """The pieces of the time from `start` to `end`.

    Within a slope velocities are off by a part of `tolerance`, relative to the speed that forces and brakes can give at the
    most; no piece of a slope is much shorter than `least` [s].
    """
    edges = [start, *(knot for knot in chain.knots if start < knot < end), end]
    speed = float((_impulses(chain) * chain.inverse_mass).max())
    shortest = max(least, (chain.knots[-1] - chain.knots[0]) / MOST_PIECES)
    for first, last in pairwise(edges):
        yield from _between_knots(chain, first, last, STAIR_PART * tolerance * speed, shortest)


def _impulses(chain: Chain) -> Array:
    """(n+1,) the largest momentum [N s] that forces and brakes could give to each bead until they change no more."""
    found = np.zeros(chain.contacts + 1)
    for item in (*chain.forces, *chain.brakes):
        found[list(item.beads)] += max(map(abs, item.force)) * (chain.knots[-1] - item.time[0])
    return found


def _between_knots(chain: Chain, start: float, end: float, error: float, shortest: float) -> Iterator[Piece]:
    """The pieces of a time without a knot inside: as long as velocities [m/s] are off by `error`, and not below `shortest`."""
    middle = start + 1.0 if math.isinf(end) else end
    forces = [(item, *item.line(start, middle)) for item in chain.forces]
    brakes = [(item, *item.line(start, middle)) for item in chain.brakes]
    sloped = [item for item in (*forces, *brakes) if item[1] != item[2]]
    beads = chain.contacts + 1
    if not sloped:
        yield Piece(start, end, _total(forces, 0.0, beads), _braked(chain, brakes, 0.0), np.zeros(beads))
        return
    change = sum(
        (_total([(item, 0.0, abs(last - first))], 1.0, beads) for item, first, last in sloped), np.zeros(beads)
    )
    bend = change * chain.inverse_mass / (end - start)  # of the velocities [m/s³]
    length = max(math.sqrt(12.0 * error / float(bend.max())) if bend.any() else math.inf, shortest)
    count = max(1, math.ceil((end - start) / length * (1.0 - 1e-12)))
    off = bend * ((end - start) / count) ** 3 / 24.0
    edges = np.linspace(start, end, count + 1)
    for k in range(count):
        part = (k + 0.5 - (1.0 / 12.0 if k == 0 else 0.0) + (1.0 / 12.0 if k == count - 1 else 0.0)) / count
        booked = off if k == count - 1 else np.zeros(beads)
        edge = float(edges[k]), float(edges[k + 1])
        yield Piece(*edge, _total(forces, part, beads), _braked(chain, brakes, part), booked)


Line = tuple[TimedForce, float, float]


def _total(lines: list[Line], part: float, beads: int) -> Array:
    """(beads,) the sum of forces at a part of the way from their first value to their last."""
    total = np.zeros(beads)
    for item, first, last in lines:
        total[list(item.beads)] += (1.0 - part) * first + part * last
    return total


def _braked(chain: Chain, brakes: list[Line], part: float) -> Chain:
    """The chain with the brakes as they are at a part of the way."""
    if not brakes:
        return chain.untimed
    steady = [item.held((1.0 - part) * first + part * last) for item, first, last in brakes]
    return replace(chain.untimed, brakes=tuple(steady))


def _moved(chain: Chain, overlap: Array, anchor: Array, before: Array) -> Array:
    """(..., n+1) way of each bead from `before` to the state with these overlaps; 0 for walls."""
    way = from_anchor(overlap, anchor, chain.anchor) - before
    return np.where(np.isfinite(chain.mass), way, 0.0)


def _given(chain: Chain, piece: Piece, way: Array, passed: float) -> Array:
    """(2,) work [J] and impulse [N s] that the forces of a piece give to the beads along their `way` (n+1,) in `passed` [s]."""
    return np.array([way @ piece.push, passed * piece.push[np.isfinite(chain.mass)].sum()])


def _problem(whole: Problem, piece: Piece, state: State, push: Array | None, most_steps: int | None) -> Problem:
    """The problem of one piece, from `state` on with the `push` of a hand beside the forces."""
    state.time = piece.start
    total = piece.push if push is None else piece.push + push
    state.push = total if total.any() else None
    duration = None if math.isinf(piece.end) else piece.end - piece.start
    step = min(whole.step, duration) if duration else whole.step
    most = None if most_steps is None else max(1, most_steps)
    return replace(
        whole, chain=piece.chain, state=state, duration=duration, step=step, samples=NO_TIMES, most_steps=most
    )


@dataclass
class _Joined:
    """Records of pieces on their way to one Record."""

    whole: Problem
    state: State
    rows: list[tuple[Array, ...]] = field(default_factory=list)
    switches: list[tuple[int, float]] = field(default_factory=list)
    steps: int = 0
    evaluations: int = 0
    seconds: float = 0.0
    error: Array = field(default_factory=lambda: NO_TIMES)
    growth: float = 1.0
    status: Status = Status.DONE
    warnings: dict[WarningCode, CodedWarning] = field(default_factory=dict)
    most_energy: float = 0.0
    fastest: float = 0.0

    def __post_init__(self) -> None:
        chain = self.whole.chain
        self.frequency = math.pi / float(contact_scales(chain, self.state.velocity(chain))[1].min())
        self.closed = np.zeros(self.whole.chain.contacts, dtype=bool)
        self.error = np.zeros(self.whole.chain.contacts + 1)
        self.estimated = False

    def add(self, piece: Piece, start: State, record: Record, times: Array) -> None:
        """Take the record of a piece from `start`; its rows belong to `times`, as far as it got."""
        chain, count = self.whole.chain, min(len(record.time), times.size)  # a run to its end has samples of its own
        before = start.position(chain)
        for k in range(count):
            way = _moved(chain, record.overlap[k], record.anchor[k, 0], before)
            given = start.given + _given(chain, piece, way, times[k] - piece.start)
            absorbed = record.absorbed[k] if len(record.absorbed) else np.zeros(2)
            self.rows.append(
                (times[k : k + 1], record.overlap[k], record.rate[k], record.anchor[k], record.force[k],
                 start.absorbed + absorbed, given)
            )  # fmt: skip
        self.switches += continued_switches(self.closed, piece.start, record)
        end = record.end
        end.absorbed = start.absorbed + end.absorbed
        way = _moved(chain, end.overlap, end.anchor[0], before)
        end.given = start.given + _given(chain, piece, way, end.time - piece.start)
        end.push = None
        self._count(piece, start, record)
        self.state = end

    def _count(self, piece: Piece, start: State, record: Record) -> None:
        """Cost, error, status and warnings."""
        self.steps += record.steps
        self.evaluations += record.evaluations
        self.seconds += record.seconds
        self.growth *= record.growth
        if record.velocity_error.size:
            self.estimated = True
            self.error = np.hypot(record.growth * self.error, record.velocity_error + self.frequency * piece.error)
        self.most_energy = max(self.most_energy, start.energy(self.whole.chain))
        self.fastest = max(self.fastest, float(np.ptp(start.velocity(self.whole.chain))))
        still = start.energy(self.whole.chain) < STILL * self.most_energy
        allowed = self.whole.tolerance * self.fastest  # however small the speeds of this piece are
        determined = not (record.velocity_error > allowed).any()
        status = Status.DONE if record.status is Status.UNDETERMINED and determined else record.status
        blameless = {WarningCode.ENERGY: still, WarningCode.SENSITIVE: determined}
        for warning in record.warnings:
            if not blameless.get(warning.code, False):
                self.warnings.setdefault(warning.code, warning)
        if status.gave_up or status is Status.UNDETERMINED or not self.status.gave_up:
            self.status = status if self.status is not Status.UNDETERMINED else self.status

    def record(self) -> Record:
        """All of them as one."""
        n, rows = self.whole.chain.contacts, self.rows
        shapes = ((), (n,), (n,), (2,), (n,), (2,), (2,))
        time, overlap, rate, anchor, force, absorbed, given = (
            np.array([np.reshape(row[k], shape) for row in rows]).reshape(len(rows), *shape)
            for k, shape in enumerate(shapes)
        )
        warnings: Warnings = tuple(self.warnings.values())
        return Record(
            time, overlap, rate, anchor, force,
            np.array([contact for contact, _ in self.switches], dtype=np.int64),
            np.array([time for _, time in self.switches]),
            self.state, self.steps, self.evaluations, self.status, warnings, self.seconds, absorbed,
            self.error if self.estimated else NO_TIMES, self.growth, given,
        )  # fmt: skip


@dataclass
class _Part:
    """A piece, the state at its start and the record of its run, which is over."""

    piece: Piece
    start: State
    record: Record


@dataclass
class _KeptPieces:
    """The runs of all pieces, each of which kept what samples are taken from."""

    whole: Problem
    parts: list[_Part]

    def record(self, found: Record, times: Array) -> Record:
        """The record `found` of all of them with its samples at `times`; the last piece goes on beyond its end."""
        joined = _Joined(self.whole, self.parts[0].start.copy())
        ends = [*(part.piece.end for part in self.parts[:-1]), math.inf]
        edges = [0, *np.searchsorted(times, ends)]
        for part, (first, last) in zip(self.parts, pairwise(edges), strict=True):
            mine, kept = times[first:last], part.record.kept
            if kept is not None and mine.size:
                joined.add(part.piece, part.start, kept.record(part.record, np.maximum(mine, part.piece.start)), mine)
        return with_samples_of(found, joined.record())


def run(problem: Problem, steady: Callable[[Problem], Record]) -> Record:
    """Compute the whole motion of a chain with forces over time; `steady` runs one with steady forces."""

    def once(whole: Problem, end: float, times: Array, stop: bool) -> Record:
        joined, parts = _Joined(whole, whole.state.copy()), list[_Part]()
        taken = 0
        tolerance = whole.tolerance or FIXED_TOLERANCE
        for piece in pieces_of(whole.chain, whole.state.time, math.inf if stop else end, tolerance, whole.step):
            start = joined.state
            last = piece.end >= end
            until = times.size if last else int(np.searchsorted(times, piece.end))
            mine = times[taken:until]
            begin = start.copy()
            begin.absorbed[:], begin.given[:] = 0.0, 0.0
            left = None if whole.most_steps is None else whole.most_steps - joined.steps
            part = _problem(whole, piece, begin, None, left)
            record = steady(replace(part, samples=np.clip(mine, piece.start, part.end), later=whole.keeps))
            parts.append(_Part(piece, start, replace(record, end=record.end.copy())))
            joined.add(piece, start, record, mine)
            taken = until
            if joined.status.gave_up:
                break
        kept = _KeptPieces(whole, parts) if all(part.record.kept for part in parts) else None
        return replace(joined.record(), kept=kept)

    return run_to_end(problem, once)


def advance(problem: Problem, steady: Callable[[Problem], Status]) -> Status:
    """Move the state of a chain with forces over time on by the duration in place; `steady` moves one with steady forces."""
    state, chain, hand = problem.state, problem.chain, problem.state.push
    status = Status.DONE
    pieces = list(pieces_of(chain, state.time, problem.end, problem.tolerance or FIXED_TOLERANCE, problem.step))
    most = None if problem.most_steps is None else problem.most_steps // len(pieces)
    for piece in pieces:
        before = state.position(chain)
        status = steady(_problem(problem, piece, state, hand, most))
        way = _moved(chain, state.overlap, state.anchor[0], before)
        state.given += _given(chain, piece, way, state.time - piece.start)
        if status.gave_up:
            break
    state.push = hand
    return status
