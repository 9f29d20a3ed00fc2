"""Phases of the reference: while no contact changes its mode, the right-hand side is smooth.

    OPEN      d < 0            f = 0                          until d = 0
    TOUCHING  d = 0, w = 0     f the multiplier of w' = 0     until f leaves [0, C]
    LOADED    d > 0            f = F + K d**a                 until d = 0

    d' = w,   w' = -L f + B M^-1 push,   L = B M^-1 B^T

The capacity C is the law's force at the least overlap that the tolerance distinguishes from 0, so it exceeds the preload F:
inside a rigid-like cluster the beads behind a soft interface start with overlaps of 1e-100, which no step could follow.
Which of several touching contacts load or open at a switch is a linear complementarity problem in f.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.reference.laws import Laws
from softcradle.physics.reference.spans import Span

Array = NDArray[np.float64]
Modes = NDArray[np.int8]

OPEN, TOUCHING, LOADED = 0, 1, 2

RELATIVE_SMOOTH = 1e-4  # local error of a step in parts of the wanted error, so that thousands of steps stay below it
RELATIVE_STIFF = 1e-3  # the same with stiff contacts, whose steps are damped
FINEST = 3e-14  # smallest relative tolerance that double precision allows
MULTIPLIER_SLACK = 1e-12  # of the capacity: a multiplier further than this outside of [0, C] ends the phase
MOST_EVALUATIONS = 20_000_000  # of a run: some minutes


class OutOfEvaluationsError(Exception):
    """The run has used all evaluations that it may."""


class System:
    """A chain as NumPy arrays: forces, accelerations and the multipliers of touching contacts.

    The state vector y (2n+2,) is overlaps, rates, anchor position, anchor velocity.
    """

    def __init__(self, chain: Chain, push: Array | None, speed: float, depth: Array, tolerance: float) -> None:
        self.n = chain.contacts
        self.anchor = chain.anchor
        self.laws = Laws(chain, depth)
        self.stiff = self.laws.stiff
        self.inverse_mass = 1.0 / np.array(chain.mass)
        self.steady = self.push = np.zeros(self.n + 1) if push is None else push
        self.span: Span | None = None
        self.until = np.inf  # when forces over time bend or jump next [s]
        self.evaluations, self.most_evaluations = 0, MOST_EVALUATIONS
        # an overlap d of energy F d changes velocities by the square root of d
        self.depth, self.least_overlap = depth, depth * tolerance**2
        self.least_rate = 1e-3 * tolerance * speed
        self.relative = max((RELATIVE_STIFF if self.stiff else RELATIVE_SMOOTH) * tolerance, FINEST)
        anchor = [float(depth.max()) * self.relative, speed * self.relative]
        self.absolute = np.concatenate((0.1 * self.least_overlap, np.full(self.n, 0.1 * self.relative * speed), anchor))
        self.capacity = self.laws.force(self.least_overlap)
        self.difference = difference = np.eye(self.n, self.n + 1) - np.eye(self.n, self.n + 1, 1)
        self.coupling = difference * self.inverse_mass @ difference.T
        self.pushed = difference @ (self.inverse_mass * self.push)

    def go_to(self, time: float) -> None:
        """Let forces over time be those at `time`."""
        if self.span is not None:
            self.push = self.steady + self.span.push_at(time)
            self.pushed = self.difference @ (self.inverse_mass * self.push)

    def bead_acceleration(self, force: Array) -> Array:
        """(n+1,) accelerations [m/s^2] under the contact forces (n,) and the push."""
        net = self.push.copy()
        net[:-1] -= force
        net[1:] += force
        return net * self.inverse_mass


@dataclass
class Phase:
    """An interval of time in which no contact changes its mode.

    `carried` (n, n) gives the multipliers of the touching contacts (t,) from the loaded forces, `solved` (t, t) from the push.
    """

    system: System
    mode: Modes
    carried: Array
    solved: Array

    @classmethod
    def of(cls, system: System, mode: Modes) -> Phase:
        """The phase in which each contact keeps its `mode` (n,)."""
        touching = mode == TOUCHING
        carried = np.zeros((system.n, system.n))
        solved: NDArray[Any] = np.zeros((0, 0))
        if touching.any():
            # pseudo-inverse: between two walls the multipliers are not unique
            solved = np.linalg.pinv(system.coupling[np.ix_(touching, touching)])
            carried[touching] = -solved @ system.coupling[touching]
            carried[:, touching] = 0.0
        return cls(system, mode, carried, solved)

    def force(self, overlap: Array) -> Array:
        """(n,) forces of all contacts [N]: by the law where loaded, multipliers where touching."""
        loaded = np.where(self.mode == LOADED, self.system.laws.force(overlap), 0.0)
        found: Array = loaded + self.carried @ loaded
        if self.solved.size:
            touching = self.mode == TOUCHING
            found[touching] += self.solved @ self.system.pushed[touching]
        return found

    def shown_overlap(self, overlap: Array, force: Array) -> Array:
        """(n,) overlaps for samples: a contact without preload that counts as touching has the overlap of its force."""
        resting = self.mode == TOUCHING
        return (
            np.where(resting, self.system.laws.resting_overlap(force, overlap), overlap) if resting.any() else overlap
        )

    def slope(self, y: Array) -> Array:
        """Right-hand side: (2n+2,) time derivative of y."""
        system, n = self.system, self.system.n
        system.evaluations += 1
        if system.evaluations > system.most_evaluations:
            raise OutOfEvaluationsError
        acceleration = system.bead_acceleration(self.force(y[:n]))
        change = np.empty_like(y)
        change[:n] = y[n : 2 * n]
        change[n : 2 * n] = np.where(self.mode == TOUCHING, 0.0, acceleration[:-1] - acceleration[1:])
        change[2 * n] = y[2 * n + 1]
        change[2 * n + 1] = acceleration[system.anchor]
        return change

    def jacobian(self, y: Array) -> Array:
        """(2n+2, 2n+2) derivative of the slope."""
        system, n = self.system, self.system.n
        stiffness = np.where(self.mode == LOADED, system.laws.slope(y[:n]), 0.0)
        by_overlap = (np.eye(n) + self.carried) * stiffness
        matrix = np.zeros((y.size, y.size))
        matrix[:n, n : 2 * n] = np.eye(n)
        matrix[n : 2 * n, :n] = -system.coupling @ by_overlap
        matrix[n : 2 * n, :n][self.mode == TOUCHING] = 0.0
        matrix[2 * n, 2 * n + 1] = 1.0
        matrix[2 * n + 1, :n] = -(system.difference.T @ by_overlap)[system.anchor] * system.inverse_mass[system.anchor]
        return matrix

    def margins(self, y: Array) -> Array:
        """(n,) distance of each contact from its next switch, as a part of its depth or capacity; negative past it.

        With the slack a contact that has just switched at d = 0 does not switch back by round-off.
        """
        system = self.system
        overlap = y[: system.n]
        to_zero = (np.where(self.mode == LOADED, overlap, -overlap) + system.least_overlap) / system.depth
        touching = self.mode == TOUCHING
        if not touching.any():
            return to_zero
        force = self.force(overlap)
        inside = np.minimum(force, system.capacity - force) / system.capacity + MULTIPLIER_SLACK
        return np.where(touching, inside, to_zero)


def first_modes(system: System, y: Array) -> Modes:
    """Modes at the start of a run, from overlaps and rates alone."""
    n = system.n
    mode = np.where(y[:n] > 0.0, LOADED, OPEN).astype(np.int8)
    return switched_modes(system, y, mode, np.abs(y[:n]) <= system.least_overlap)


def switched_modes(system: System, y: Array, mode: Modes, undecided: NDArray[np.bool_]) -> Modes:
    """Modes right after a switch of the `undecided` contacts; their overlaps in `y` are set to 0 exactly."""
    n = system.n
    overlap, rate = y[:n], y[n : 2 * n]
    overlap[undecided] = 0.0
    new = mode.copy()
    new[undecided] = np.where(rate[undecided] >= 0.0, LOADED, OPEN)
    resting = undecided & (np.abs(rate) <= system.least_rate) | (mode == TOUCHING)
    if resting.any():
        rate[resting] = 0.0
        overlap[resting] = system.least_overlap[resting]
        new[resting] = _resting_modes(system, overlap, new, resting)
        overlap[resting & (new != LOADED)] = 0.0
    return new


def _resting_modes(system: System, overlap: Array, mode: Modes, resting: NDArray[np.bool_]) -> Modes:
    """Modes of the `resting` contacts: f in [0, C], and w' <= 0 at f = 0, w' = 0 between, w' >= 0 at f = C.

    Active sets: a contact begins at C; where its w' is negative there it is solved for with w' = 0, and where its multiplier
    is then below 0 it opens. L is an M-matrix, so each round lowers every force and the rounds are few.
    """
    trial = np.where(resting, LOADED, mode).astype(np.int8)
    for _ in range(2 * system.n + 2):
        phase = Phase.of(system, trial)
        force = phase.force(overlap)
        closing = system.pushed - system.coupling @ force
        lower = (trial == LOADED) & resting & (closing < 0.0)
        release = (trial == TOUCHING) & resting & (force < -MULTIPLIER_SLACK * system.capacity)
        if not (lower.any() or release.any()):
            break
        trial[lower] = TOUCHING
        trial[release] = OPEN
    return trial[resting]
