"""Outcome of a motion. The outcome describes which beads move together, which beads nearly stand still, and the speeds
of the other beads.

Definitions
-----------
The *change* of a bead is the change of its velocity since the start. Neighbouring beads move **together** if their
velocities are nearly equal. The difference may be at most TOGETHER times the smallest change among these beads. If a
cluster is hit as one rigid body, all its beads have equal changes. The definition therefore measures how far the
cluster is from rigid. The definition does not depend on the frame of reference or on the direction in which beads are
counted. Differences below RESOLUTION times the largest change in the chain do not count. Beads that a collision has
hardly moved therefore stay together.

Groups **nearly stand still** if they are slow and have little momentum and energy. Slow means at most SLOW times the
largest speed at the start. All these groups together have at most STILL_MOMENTUM of the momentum and STILL_ENERGY of
the kinetic energy. The groups with the least momentum are considered first. A long chain that was hit by a single bead
is slow but carries the momentum, so it does not stand still. A wall that does not move is not reported.

`assets/page/ending.js` contains the same rule in JavaScript. tests/sandbox/story/test_same_story.py compares the two.

Tests: tests/sandbox/story/test_outcome.py
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Largest difference between velocities in a group, as a fraction of the smallest change of velocity of its beads.
# Consider a cluster that was hit. With a value of 0.1, its slowest bead lags behind the fastest one by at most a tenth
# of the speed that both received.
TOGETHER = 0.1
# Largest difference between velocities that is ignored, as a fraction of the largest change of velocity in the chain.
# The value is the width of a line in a plot of velocities.
RESOLUTION = 0.01
# Largest speed of a group that nearly stands still, as a fraction of the largest speed at the start.
SLOW = 0.1
# Largest shares of momentum (without sign) and of kinetic energy that all groups at rest have together. A bead with the
# mass of the striking bead and the speed SLOW has these shares of the striking bead's momentum and energy.
STILL_MOMENTUM = 0.1
STILL_ENERGY = 0.01
# Largest speed that counts as a rounding error, as a fraction of the largest speed at the start. A group with a smaller
# speed stands exactly still.
AT_REST = 1e-6
# Largest relative difference between two numbers that count as equal. This tolerance ensures that a chain and its
# mirror image have the same groups.
EQUAL = 1e-6

MOVES, NEARLY_STILL, STILL = "moves", "nearly still", "still"


@dataclass(frozen=True)
class Group:
    """Neighbouring beads that move together, or a moving wall.

    Attributes:
        first, last: numbers of the first and the last bead of the group.
        velocity: velocity of the centre of mass of the group [m/s].
        state: MOVES, NEARLY_STILL or STILL.
        wall: True if the group is a wall.
    """

    first: int
    last: int
    velocity: float
    state: str
    wall: bool = False

    @property
    def count(self) -> int:
        """Number of beads in the group."""
        return self.last - self.first + 1

    @property
    def moves(self) -> bool:
        """True if the group stands neither exactly nor nearly still."""
        return self.state == MOVES


@dataclass(frozen=True)
class Outcome:
    """Outcome of the motion of one lane.

    Attributes:
        groups: the groups of beads from left to right.
        start: (n+1,) velocities at the start [m/s].
    """

    groups: tuple[Group, ...]
    start: tuple[float, ...]

    def group_of(self, bead: int) -> Group | None:
        """Return the group that contains a bead. Return None if the bead is a wall at rest."""
        return next((group for group in self.groups if group.first <= bead <= group.last), None)


def outcome_of(mass: Sequence[float], start: Sequence[float], velocity: Sequence[float]) -> Outcome:
    """Return the outcome of a motion.

    Arguments:
        mass: (n+1,) masses [kg]; infinity is a wall.
        start: (n+1,) velocities at the start [m/s].
        velocity: (n+1,) velocities now [m/s].
    """
    row = _Row(np.asarray(mass, dtype=float), np.asarray(start, dtype=float), np.asarray(velocity, dtype=float))
    return Outcome(tuple(row.groups()), tuple(row.start.tolist()))


class _Row:
    """Beads of one lane, with the typical speeds of their motion."""

    def __init__(self, mass: Array, start: Array, velocity: Array) -> None:
        self.wall = np.isinf(mass)
        self.mass = np.where(self.wall, 0.0, mass)
        self.start, self.velocity = start, velocity
        self.change = np.abs(velocity - start)
        self.speed = float(np.abs(start).max()) or float(np.abs(velocity).max())
        bodies = self.change[~self.wall]
        self.resolution = max(RESOLUTION * float(bodies.max(initial=0.0)), EQUAL * RESOLUTION * self.speed)

    def groups(self) -> Iterator[Group]:
        """Yield the groups and the moving walls from left to right."""
        spans = self._spans()
        still = self._still(spans)
        joined: list[tuple[int, int, bool]] = []
        for (first, last), stands in zip(spans, still, strict=True):
            beside = stands and bool(joined) and joined[-1][2] and joined[-1][1] == first - 1
            joined.append((joined.pop()[0] if beside else first, last, stands))
        for first, last, stands in joined:
            velocity = self._centre(first, last)
            if not self.wall[first]:
                state = MOVES if not stands else STILL if self._rests(first, last) else NEARLY_STILL
                yield Group(first, last, velocity, state)
            elif abs(velocity) > AT_REST * self.speed:
                yield Group(first, last, velocity, MOVES, wall=True)

    def _spans(self) -> list[tuple[int, int]]:
        """Return the numbers of the first and the last bead of each group and of each wall."""
        spans, first = [], 0
        for wall in [*np.flatnonzero(self.wall).tolist(), len(self.wall)]:
            if wall > first:
                spans += self._split(first, wall - 1)
            if wall < len(self.wall):
                spans.append((wall, wall))
            first = wall + 1
        return spans

    def _split(self, first: int, last: int) -> list[tuple[int, int]]:
        """Return the groups of the beads from `first` to `last`, which are not walls.

        A part whose beads do not move together is split at the largest difference between the velocities of neighbours.
        Parts are split until the beads of each part move together.
        """
        found, left = [], [(first, last)]
        while left:
            first, last = left.pop()
            part = slice(first, last + 1)
            allowed = max(TOGETHER * float(self.change[part].min()), self.resolution)
            if float(np.ptp(self.velocity[part])) <= allowed:
                found.append((first, last))
            else:
                middle = first + self._widest(self.velocity[part])
                left += [(middle + 1, last), (first, middle)]
        return found

    @staticmethod
    def _widest(velocity: Array) -> int:
        """Return the bead to the left of the largest difference between the velocities of neighbours. If several
        differences are equally large, use the difference nearest to the middle.
        """
        jumps = np.abs(np.diff(velocity))
        equal = np.flatnonzero(jumps >= (1.0 - EQUAL) * jumps.max())
        return int(equal[np.abs(equal - 0.5 * (len(jumps) - 1)).argmin()])

    def _centre(self, first: int, last: int) -> float:
        """Return the velocity of the centre of mass of a group, or the velocity of a wall."""
        if self.wall[first]:
            return float(self.velocity[first])
        part = slice(first, last + 1)
        return float(self.mass[part] @ self.velocity[part] / self.mass[part].sum())

    def _rests(self, first: int, last: int) -> bool:
        """Return True if all beads of a group are at rest, apart from rounding errors."""
        return bool((np.abs(self.velocity[first : last + 1]) <= AT_REST * self.speed).all())

    def _still(self, spans: Sequence[tuple[int, int]]) -> list[bool]:
        """Return True for each group that stands still. Starting with the least momentum, groups stand still while
        their total shares of momentum and energy are small.
        """
        momentum = np.abs([0.0 if self.wall[a] else self.mass[a : b + 1].sum() * self._centre(a, b) for a, b in spans])
        energy = np.array([0.5 * self.mass[a : b + 1] @ self.velocity[a : b + 1] ** 2 for a, b in spans])
        largest = self._most(self.mass * np.abs(self.velocity), self.mass * np.abs(self.start))
        whole = self._most(0.5 * self.mass * self.velocity**2, 0.5 * self.mass * self.start**2)
        slow = [
            k
            for k in np.argsort(momentum, kind="stable").tolist()
            if not self.wall[spans[k][0]] and abs(self._centre(*spans[k])) <= SLOW * self.speed
        ]
        still = [False] * len(spans)
        carried, held, begun = 0.0, 0.0, 0
        while begun < len(slow):
            equal = begun + 1  # Groups with the same momentum either all stand still or all move.
            while equal < len(slow) and momentum[slow[equal]] <= (1.0 + EQUAL) * momentum[slow[begun]]:
                equal += 1
            carried += float(momentum[slow[begun:equal]].sum())
            held += float(energy[slow[begun:equal]].sum())
            if carried > STILL_MOMENTUM * largest or held > STILL_ENERGY * whole:
                break
            for k in slow[begun:equal]:
                still[k] = True
            begun = equal
        return still

    @staticmethod
    def _most(now: Array, before: Array) -> float:
        """Return the larger of two sums over all beads."""
        return max(float(now.sum()), float(before.sum()))
