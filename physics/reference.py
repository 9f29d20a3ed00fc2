"""The reference, method `scipy`: its own right-hand side in NumPy, SciPy's `solve_ivp`, every contact switch located.

It shares no kernel with what it checks. Time is cut into phases. In a phase every contact keeps one mode, so that the
right-hand side is smooth up to the phase's end, where some contact switches:

    OPEN      d < 0            f = 0                          until d = 0
    TOUCHING  d = 0, w = 0     f the multiplier of w' = 0     until f leaves [0, F]; contacts with preload alone
    LOADED    d > 0            f = F + K d**a                 until d = 0

    d' = w,   w' = -L f + B M^-1 push,   L = B M^-1 B^T

Which of several touching contacts give way at a switch is a linear complementarity problem in f.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from physics.chain import Chain
from physics.run import Problem, Record
from physics.state import State
from physics.time_scale import closing_speed, contact_scales

Array = NDArray[np.float64]
Modes = NDArray[np.int8]

OPEN, TOUCHING, LOADED = 0, 1, 2

SOLVER = "DOP853"
RELATIVE = 1e-4  # of the wanted error of the velocities: local error a step, so that thousands of steps stay below it
FINEST = 3e-14  # smallest relative tolerance that double precision can keep
MULTIPLIER_SLACK = 1e-12  # of the preload: a multiplier is out of [0, F] when it is out by this much
MOST_SWITCHES = 20_000  # a run with more is given up: the contacts chatter
MOST_EVALUATIONS = 20_000_000  # some minutes


class _TooLong(Exception):
    """The evaluations are used up."""


class _System:
    """A chain as NumPy arrays: forces, accelerations and the multipliers of touching contacts.

    The state vector y (2n+2,) is overlaps, rates, anchor position, anchor velocity.
    """

    def __init__(self, chain: Chain, push: Array | None, speed: float, depth: Array, tolerance: float) -> None:
        self.n = chain.contacts
        self.anchor = chain.anchor
        self.preload = np.array([c.preload for c in chain.contact])
        self.stiffness = np.array([c.stiffness for c in chain.contact])
        self.exponent = np.array([c.exponent for c in chain.contact])
        self.inverse_mass = 1.0 / np.array(chain.mass)
        self.push = np.zeros(self.n + 1) if push is None else push
        self.evaluations = 0
        # an overlap of energy F d is felt in velocities as its square root
        self.least_overlap = depth * tolerance**2
        self.least_rate = 1e-3 * tolerance * speed
        self.relative = max(RELATIVE * tolerance, FINEST)
        anchor = [float(depth.max()) * self.relative, speed * self.relative]
        self.absolute = np.concatenate((0.1 * self.least_overlap, np.full(self.n, 0.1 * self.relative * speed), anchor))
        difference = np.eye(self.n, self.n + 1) - np.eye(self.n, self.n + 1, 1)
        self.coupling = difference * self.inverse_mass @ difference.T
        self.pushed = difference @ (self.inverse_mass * self.push)

    def bead_acceleration(self, force: Array) -> Array:
        """(n+1,) accelerations [m/s^2] under the contact forces (n,) and the push."""
        net = self.push.copy()
        net[:-1] -= force
        net[1:] += force
        return net * self.inverse_mass

    def law(self, overlap: Array) -> Array:
        """(n,) forces of loaded contacts."""
        return self.preload + self.stiffness * np.maximum(overlap, 0.0) ** self.exponent


@dataclass
class _Phase:
    """A stretch of time in which no contact changes its mode.

    `carried` (n, n) and `carried_push` (n,) give the multipliers of the touching contacts from the loaded forces.
    """

    system: _System
    mode: Modes
    carried: Array
    carried_push: Array

    @classmethod
    def of(cls, system: _System, mode: Modes) -> _Phase:
        touching = mode == TOUCHING
        carried, carried_push = np.zeros((system.n, system.n)), np.zeros(system.n)
        if touching.any():
            # least squares: between two walls the multipliers are not unique
            solved = np.linalg.pinv(system.coupling[np.ix_(touching, touching)])
            carried[touching] = -solved @ system.coupling[touching]
            carried[:, touching] = 0.0
            carried_push[touching] = solved @ system.pushed[touching]
        return cls(system, mode, carried, carried_push)

    def force(self, overlap: Array) -> Array:
        loaded = np.where(self.mode == LOADED, self.system.law(overlap), 0.0)
        return loaded + self.carried @ loaded + self.carried_push

    def slope(self, _time: float, y: Array) -> Array:
        """Right-hand side: (2n+2,) time derivative of y."""
        system, n = self.system, self.system.n
        system.evaluations += 1
        if system.evaluations > MOST_EVALUATIONS:
            raise _TooLong
        acceleration = system.bead_acceleration(self.force(y[:n]))
        change = np.empty_like(y)
        change[:n] = y[n : 2 * n]
        change[n : 2 * n] = np.where(self.mode == TOUCHING, 0.0, acceleration[:-1] - acceleration[1:])
        change[2 * n] = y[2 * n + 1]
        change[2 * n + 1] = acceleration[system.anchor]
        return change

    def margins(self, y: Array) -> Array:
        """(n,) how far each contact is from its next switch; negative once it is past it.

        The slack keeps a contact that has just switched at d = 0 from switching back at once by round-off.
        """
        system = self.system
        overlap = y[: system.n]
        to_zero = np.where(self.mode == LOADED, overlap, -overlap) + system.least_overlap
        touching = self.mode == TOUCHING
        if not touching.any():
            return to_zero
        force, slack = self.force(overlap), MULTIPLIER_SLACK * system.preload
        return np.where(touching, np.minimum(force, system.preload - force) + slack, to_zero)


def _first_modes(system: _System, y: Array) -> Modes:
    """Modes at the start of a run, where nothing is known but overlaps and rates."""
    n = system.n
    mode = np.where(y[:n] > 0.0, LOADED, OPEN).astype(np.int8)
    return _settle(system, y, mode, np.abs(y[:n]) <= system.least_overlap)


def _settle(system: _System, y: Array, mode: Modes, undecided: NDArray[np.bool_]) -> Modes:
    """Modes right after a switch; the `undecided` contacts are at overlap 0 (they are put there exactly)."""
    n = system.n
    overlap, rate = y[:n], y[n : 2 * n]
    overlap[undecided] = 0.0
    new = mode.copy()
    new[undecided] = np.where(rate[undecided] >= 0.0, LOADED, OPEN)
    resting = undecided & (system.preload > 0.0) & (np.abs(rate) <= system.least_rate)
    resting |= mode == TOUCHING
    if resting.any():
        rate[resting] = 0.0
        new[resting] = _give_way(system, overlap, new, resting)
    return new


def _give_way(system: _System, overlap: Array, mode: Modes, resting: NDArray[np.bool_]) -> Modes:
    """Modes of the `resting` contacts: f in [0, F], and w' <= 0 at f = 0, w' = 0 between, w' >= 0 at f = F.

    Active sets: contacts are held at F until their w' is negative there, then solved for with w' = 0, and let go where
    the multiplier turns out below 0. L is an M-matrix, so each round lowers every force and the rounds are few.
    """
    trial = np.where(resting, LOADED, mode).astype(np.int8)
    for _ in range(2 * system.n + 2):
        phase = _Phase.of(system, trial)
        force = phase.force(overlap)
        closing = system.pushed - system.coupling @ force
        lower = (trial == LOADED) & resting & (closing < 0.0)
        release = (trial == TOUCHING) & resting & (force < -MULTIPLIER_SLACK * system.preload)
        if not (lower.any() or release.any()):
            break
        trial[lower] = TOUCHING
        trial[release] = OPEN
    return trial[resting]


@dataclass
class _Segment:
    """One solved phase: its interval, modes and dense solution."""

    start: float
    end: float
    phase: _Phase
    solution: Any


class _Run:
    """Phase after phase from a start state; keeps what samples and switches need."""

    def __init__(self, chain: Chain, state: State, tolerance: float) -> None:
        velocity = state.velocity(chain)
        speed = closing_speed(velocity)
        depth, _ = contact_scales(chain, velocity)
        self.system = _System(chain, state.push, speed, depth, tolerance)
        self.time = state.time
        self.y = np.concatenate((state.overlap, state.rate, state.anchor))
        self.phase = _Phase.of(self.system, _first_modes(self.system, self.y))
        self.closed = np.zeros(chain.contacts, dtype=bool)
        self.segments: list[_Segment] = []
        self.switches: list[tuple[float, int]] = []
        self.steps = 0
        self.warnings: tuple[str, ...] = ()

    def until(self, end: float) -> None:
        """Integrate to `end`; with an infinite end until no contact pushes or can come to push."""
        try:
            while self.time < end and not (np.isinf(end) and self._apart()):
                if len(self.switches) > MOST_SWITCHES:
                    raise _TooLong
                self._one_phase(end)
        except _TooLong:
            self.warnings = (
                f"scipy gave up at t = {self.time:.6g} s after {self.system.evaluations} evaluations and "
                f"{len(self.switches)} contact switches; what follows repeats the state at that time: take 'radau'",
            )

    def _apart(self) -> bool:
        n = self.system.n
        return not self.phase.force(self.y[:n]).any() and bool((self.y[n : 2 * n] <= 0.0).all())

    def _one_phase(self, end: float) -> None:
        system, phase, n = self.system, self.phase, self.system.n

        def margin(_time: float, y: Array) -> float:
            return float(phase.margins(y).min())

        margin.terminal, margin.direction = True, -1.0  # type: ignore[attr-defined]
        found = solve_ivp(
            phase.slope, (self.time, end), self.y, SOLVER, events=margin, dense_output=True,
            rtol=system.relative, atol=system.absolute,
        )  # fmt: skip
        self._note_closings(phase.mode, found.y[:n])
        self.steps += found.t.size - 1
        self.segments.append(_Segment(self.time, float(found.t[-1]), phase, found.sol))
        self.time, self.y = float(found.t[-1]), found.y[:, -1].copy()
        if found.status == 1:
            self._switch()
        elif found.status < 0:
            self.warnings = (f"scipy failed at t = {self.time:.6g} s: {found.message}",)

    def _switch(self) -> None:
        margins = self.phase.margins(self.y)
        reached = margins <= max(0.0, margins.min())
        self.phase = _Phase.of(self.system, _settle(self.system, self.y, self.phase.mode, reached))
        self._note_openings()

    def _note_closings(self, mode: Modes, overlap: Array) -> None:
        pressed = (mode == LOADED) & (overlap > 0.0).any(axis=1) & ~self.closed
        self._note(pressed)

    def _note_openings(self) -> None:
        self._note((self.phase.mode != LOADED) & self.closed)

    def _note(self, changed: NDArray[np.bool_]) -> None:
        self.switches.extend((self.time, int(i)) for i in np.flatnonzero(changed))
        self.closed ^= changed

    def samples(self, times: Array) -> tuple[Array, Array]:
        """(T, 2n+2) states and (T, n) forces at `times`."""
        states, forces = np.empty((times.size, self.y.size)), np.empty((times.size, self.system.n))
        states[:], forces[:] = self.y, self.phase.force(self.y[: self.system.n])
        for segment in self.segments:
            inside = np.flatnonzero((times >= segment.start) & (times < segment.end))
            if inside.size:
                states[inside] = segment.solution(times[inside]).T
                forces[inside] = [segment.phase.force(row[: self.system.n]) for row in states[inside]]
        return states, forces


def run(problem: Problem) -> Record:
    """Solve `problem`; ``problem.tolerance`` is the wanted error of the velocities relative to the closing speed."""
    chain, state = problem.chain, problem.state
    solved = _Run(chain, state, problem.tolerance)
    solved.until(np.inf if problem.duration is None else state.time + problem.duration)
    times = problem.sample_times(solved.time)
    if times.size and times[-1] > solved.time and not solved.warnings:
        solved.until(float(times[-1]))
    states, forces = solved.samples(times)
    n = chain.contacts
    return Record(
        times, states[:, :n], states[:, n : 2 * n], states[:, 2 * n :], forces,
        np.array([contact for _, contact in solved.switches], dtype=np.int64),
        np.array([time for time, _ in solved.switches]),
        _end(solved), solved.steps, solved.system.evaluations, solved.warnings,
    )  # fmt: skip


def _end(solved: _Run) -> State:
    n, y = solved.system.n, solved.y.copy()
    return State(solved.time, y[:n], y[n : 2 * n], y[2 * n :], solved.phase.force(y[:n]))


def advance(chain: Chain, state: State, duration: float, method: str, tolerance: float) -> None:
    """Move `state` on by `duration` [s] in place."""
    solved = _Run(chain, state, tolerance)
    solved.until(state.time + duration)
    end = _end(solved)
    state.time += duration
    for target, source in ((state.overlap, end.overlap), (state.rate, end.rate), (state.anchor, end.anchor)):
        target[:] = source
    state.force[:] = end.force
