"""Reference method `scipy`. It integrates a separate right-hand side in NumPy by SciPy's `solve_ivp`, and locates every
contact switch.

The reference does not use any kernel of the methods that it checks. Time is divided into phases in which no contact
changes its mode. A margin measures the distance of a constraint from its next switch. A phase ends at the time when the
first margin reaches 0. The next phase starts at this time with new modes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, minimize_scalar
from softcradle.physics.problem import NO_TIMES, Problem, Record, empty_samples
from softcradle.physics.reference.phases import (
    LOADED,
    RELEASED,
    OutOfEvaluationsError,
    Phase,
    System,
    first_phase,
    next_phase,
    switched_phase,
)
from softcradle.physics.reference.spans import Span
from softcradle.physics.state import MOVING, State, Switches
from softcradle.physics.status import CodedWarning, Status, WarningCode, Warnings

Array = NDArray[np.float64]

EVALUATIONS_A_STEP = 3  # Number of evaluations that count as one step if the number of steps of a run is limited.

SMOOTH = "DOP853"  # Integrator for chains whose exponents are all >= 1. The contacts of such chains are never stiff.
STIFF = "Radau"  # Integrator for chains with an exponent below 1. The stiffness of such chains is unbounded.
# Error of a located switch, as a fraction of a contact time. SciPy calls brentq with a tolerance of 4 ulp of 1.
ROOT = 4e-15
# Fractions of a step at which margins are checked. SciPy itself checks them only at the end of a step.
LOOKS = np.linspace(0.0, 1.0, 8, endpoint=False)
# Nodes and weights of the quadrature on [-1, 1]. The quadrature has the same order as the dense solution.
GAUSS = np.polynomial.legendre.leggauss(7)
QUIET = np.errstate(under="ignore")  # Underflow of powers of overlaps close to 0 is not an error.
MOST_PHASES = 20_000  # Largest number of phases of a run. If a run has more phases, its contacts chatter.
MOST_IN_PLACE = 50  # Largest number of switches at the same time. A longer sequence would never end.


@dataclass
class _Segment:
    """Solution of one phase: its interval, its modes, and the dense solution.

    The time of the dense solution starts at `start` [s] and has the unit `scale` [s].
    """

    start: float
    end: float
    scale: float
    phase: Phase
    solution: Any

    def at(self, times: Array) -> Array:
        """Return the (T, m+n+2) states at `times` (T,) [s]."""
        return self.solution((times - self.start) / self.scale).T


class _Run:
    """Sequence of phases from a start state, with the data needed for samples and contact switches."""

    def __init__(self, problem: Problem, duration: float | None) -> None:
        chain, state = problem.chain, problem.state
        self.system = system = System(chain, state, problem.tolerance, duration)
        self.scale = float((2.0 * system.laws.depth / system.speed).max())
        if problem.most_steps:
            system.most_evaluations = EVALUATIONS_A_STEP * problem.most_steps
        self.chain, self.time, self.taken = chain, state.time, state.taken
        self.y = system.start(state)
        self.phase = first_phase(system, Span.at(chain, self.time), self.time, self.y)
        self.closed = np.zeros(chain.contacts, dtype=bool)
        self.segments: list[_Segment] = []
        self.switches: list[tuple[int, float]] = []
        self.steps = 0
        self.status = Status.DONE
        self.warnings: Warnings = ()

    def begin(self) -> None:
        """Log the contacts that are closed at the start."""
        self._note(self._on_joints(self._carries()))

    def until(self, end: float) -> None:
        """Integrate to the time `end` [s].

        If `end` is infinite, stop when all contacts stay open forever, or when nothing moves.
        """
        try:
            while self.time < end and not self.status.gave_up:
                if self.time >= self.phase.span.end:
                    span, none = Span.at(self.chain, self.time), np.zeros(self.system.m, dtype=bool)
                    self.phase = next_phase(self.phase, span, self.time, self.y, none)
                    self._note_openings()
                if np.isinf(end) and self._is_over():
                    self.status = Status.SEPARATED
                    break
                # A switch at the start of a phase makes the phase as short as ROOT, plus round-off.
                chatters = [one.end - one.start <= 2.0 * ROOT * self.scale for one in self.segments[-MOST_IN_PLACE:]]
                if (
                    len(self.segments) >= min(MOST_PHASES, self.system.most_evaluations)
                    or sum(chatters) == MOST_IN_PLACE
                ):
                    raise OutOfEvaluationsError
                self._one_phase(min(end, self.phase.span.end))
            self._note(self.closed & ~self._on_joints(self._carries()))
        except OutOfEvaluationsError:
            sentence = (
                f"scipy gave up at t = {self.time:.6g} s after {self.system.evaluations} evaluations and "
                f"{len(self.segments)} changes of contacts; what follows repeats the state at that time: take 'radau'"
            )
            self._give_up(Status.OUT_OF_STEPS, sentence)

    def _give_up(self, status: Status, sentence: str) -> None:
        self.status = status
        self.warnings = (CodedWarning(WarningCode.GAVE_UP, sentence, {"time": self.time}),)

    def _is_over(self) -> bool:
        """Return True if the motion is over.

        This is the case if nothing moves and no force acts. The motion is also over if no contact pushes now or later,
        even while beads slide to rest.
        """
        system, phase = self.system, self.phase
        if np.isfinite(phase.span.end):
            return False
        change = phase.slope(self.time, self.y)
        if not (change[: system.m].any() or self.y[-1]):
            moves = np.abs(change[system.m :]) * self.scale > system.least_rate
            if not moves.any():
                return True
        if self._carries().any():
            return False
        if not phase.side.any():
            return not (system.row_velocity(self.y)[: system.m] > system.least_rate).any()
        return not (system.push(self.time, phase.span).any() or self._slide_together())

    def _slide_together(self) -> bool:
        """Return True if two beads on the bed will meet before they have slid to rest.

        The overlaps are checked at the times when a bead comes to rest, and at the times when two neighbours have equal
        speeds.
        """
        system, velocity = self.system, self.system.velocity(self.y)
        brake = system.brake(self.time, self.phase.span) * self.chain.inverse_mass
        rest = np.divide(np.abs(velocity), brake, out=np.full(brake.size, np.inf), where=brake > 0.0)
        slows, contacts = brake * np.sign(velocity), system.rows[: system.m]
        # Two beads without friction meet.
        if (contacts @ np.where(np.isinf(rest), velocity, 0.0) > system.least_rate).any():
            return True
        turn = contacts @ slows
        equal = np.divide(contacts @ velocity, turn, out=np.zeros(turn.size), where=turn != 0.0)
        times = np.concatenate((rest, equal))
        times = np.minimum(times[np.isfinite(times) & (times > 0.0), None], rest)
        overlap = self.y[: system.m] + (velocity * times - 0.5 * slows * times**2) @ contacts.T
        return bool((overlap > system.least_overlap).any())

    def _one_phase(self, end: float) -> None:
        system, phase, scale, start = self.system, self.phase, self.scale, self.time
        if not np.isfinite(self.y).all():
            self._give_up(Status.FAILED, f"scipy failed at t = {start:.6g} s: a number is too large")
            return

        def slope(time: float, y: Array) -> Array:
            return scale * phase.slope(start + time * scale, y)

        def jacobian(_time: float, y: Array) -> Array:
            return scale * phase.jacobian(y)

        def margin(time: float, y: Array) -> float:
            return float(phase.margin(start + time * scale, y).min())

        margin.terminal, margin.direction = True, -1.0  # type: ignore[attr-defined]
        stiff = system.laws.stiff
        # Integrate in units of the contact time, because SciPy's tolerance of event times is absolute.
        found = solve_ivp(
            slope, (0.0, (end - start) / scale), self.y, STIFF if stiff else SMOOTH, events=margin,
            rtol=system.relative, atol=system.absolute, dense_output=True, **({"jac": jacobian} if stiff else {}),
        )  # fmt: skip
        if found.t.size == 1:  # The integrator did not finish any step, so a dense solution does not exist.
            self._give_up(Status.FAILED, f"scipy failed at t = {start:.6g} s: {found.message}")
            return
        self.steps += found.t.size - 1
        elapsed, met = float(found.t[-1]), found.status == 1
        earlier = self._passed(found.sol, found.t)
        if earlier is not None:
            elapsed, met = earlier, True
        # Advance beyond the root by its error. The margin is then no longer positive.
        elapsed += ROOT if met else 0.0
        now = start + elapsed * scale if met or found.status < 0 else end
        ends = np.append(found.t[found.t < elapsed], elapsed)
        times = np.concatenate((ends, 0.5 * (ends[1:] + ends[:-1])))
        self._note_closings(start + times * scale, found.sol(times).T)
        self.segments.append(_Segment(start, now, scale, phase, found.sol))
        self.time, self.y = now, found.sol(elapsed)
        if met:
            self.phase = switched_phase(phase, self.time, self.y)
            self._note_openings()
        elif found.status < 0:
            self._give_up(Status.FAILED, f"scipy failed at t = {self.time:.6g} s: {found.message}")

    def _passed(self, solution: Any, steps: Array) -> float | None:
        """Return the first time at which a margin is negative inside a step, in units of the scale.

        Only margins that are positive at both ends of the step are searched.
        """
        phase, start, scale = self.phase, self.time, self.scale

        def least(time: float) -> float:
            return float(phase.margin(start + time * scale, solution(time)).min())

        times = np.append((steps[:-1, None] + np.diff(steps)[:, None] * LOOKS).ravel(), steps[-1])
        margins = phase.margin(start + scale * times, solution(times).T)[:-1]
        past = np.flatnonzero((margins[1:] < 0.0).any(axis=1)) + 1
        before, middle, after = margins[:-2], margins[1:-1], margins[2:]
        with np.errstate(invalid="ignore", divide="ignore"):
            lowest = middle - 0.125 * (after - before) ** 2 / (before - 2.0 * middle + after)
        dips = np.flatnonzero(((middle <= before) & (middle <= after) & (lowest < 0.0)).any(axis=1)) + 1
        for k in dips[dips < past[0]] if past.size else dips:
            low = minimize_scalar(
                least, bounds=(times[k - 1], times[k + 1]), method="bounded", options={"xatol": 1e-12}
            )
            if low.fun < 0.0:
                return _root(least, times[k - 1], float(low.x))
        return _root(least, times[past[0] - 1], times[past[0]]) if past.size else None

    def _note_closings(self, times: Array, states: Array) -> None:
        """Log the contacts that closed during a phase. `states` (T, m+n+2) are the states at `times`.

        A contact that only rested at overlap 0 did not close. A touching contact may be without force at both ends of a
        phase and still push in between, while its neighbour loads and unloads.
        """
        pressed: NDArray[np.bool_] = np.logical_or.reduce(self.phase.carries(times, states))
        self._note(self._on_joints(pressed) & ~self.closed)

    def _note_openings(self) -> None:
        loaded = self.phase.mode[: self.system.m] >= LOADED
        self._note(self.closed & ~self._on_joints(loaded | self._carries()))

    def _carries(self) -> NDArray[np.bool_]:
        return self.phase.carries(self.time, self.y)

    def _on_joints(self, contacts: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return True for each joint (n,) with at least one contact side marked in `contacts` (m,)."""
        found = np.zeros(self.system.n, dtype=bool)
        found[self.system.laws.joint[contacts]] = True
        return found

    def _note(self, changed: NDArray[np.bool_]) -> None:
        self.switches.extend((int(i), self.time) for i in np.flatnonzero(changed))
        self.closed ^= changed

    def samples(self, times: Array) -> dict[str, Array]:
        """Return the arrays of samples at `times` (T,), by name."""
        system, m = self.system, self.system.m
        states, forces = np.empty((times.size, self.y.size)), np.empty((times.size, system.rows.shape[0]))
        states[:], forces[:] = self.y, self.phase.force(self.time, self.y)
        for segment in self.segments:
            inside = np.flatnonzero((times >= segment.start) & (times < segment.end))
            if inside.size:
                states[inside] = segment.at(times[inside])
                forces[inside] = segment.phase.force(times[inside], states[inside])
                for k in inside:
                    states[k, :m] = segment.phase.shown_overlap(states[k, :m], forces[k, :m])
        # The pushing part of a coupler represents its joint.
        first = system.first
        return {
            "time": times, "overlap": states[:, first], "rate": states[:, m:-2], "anchor": states[:, -2:],
            "force": system.on_joints(forces), "taken": self.taken_at(times),
        }  # fmt: skip

    def end(self) -> State:
        """Return the current state."""
        rows = self.samples(np.array([self.time]))
        coupled = self.system.coupled.astype(np.int8) if self.chain.has_segments else np.zeros(0, dtype=np.int8)
        return State(self.time, **{name: rows[name][0] for name in MOVING}, coupled=coupled)

    def taken_at(self, times: Array) -> Array:
        """Return the (T, 4) dissipated energies and the work of forces over time [J] up to `times`.

        The columns are in the order of `State.taken`.
        """
        found, total = np.tile(self.taken, (times.size, 1)), self.taken.copy()
        if not (self.chain.dissipative or self.chain.forces):
            return found
        for segment in self.segments:
            after = times >= segment.start
            found[after], total = self._taken_in(segment, times[after], total)
        return found

    def _taken_in(self, segment: _Segment, times: Array, before: Array) -> tuple[Array, Array]:
        """Return the (T, 4) energies up to `times` inside a segment, and the energies at the end of the segment.

        The energies are computed by Gauss quadrature in every step. `before` are the energies at the start of the
        segment.
        """
        system, phase = self.system, segment.phase
        # Steps of the integrator and sample times divide the segment into smooth pieces.
        edges = segment.start + segment.scale * segment.solution.ts
        edges = np.unique(np.clip([*edges, *times], segment.start, segment.end))
        if edges.size < 2:  # Two events at the same time: nothing is absorbed between them.
            return np.tile(before, (times.size, 1)), before
        length, middle = np.diff(edges)[:, None], 0.5 * (edges[1:] + edges[:-1])[:, None]
        at = (middle + 0.5 * length * GAUSS[0]).ravel()
        velocity, finite = system.velocity(segment.at(at)), np.isfinite(self.chain.mass)
        pushed = (phase.span.push_at(at) * velocity)[:, finite].sum(axis=1)
        braked = (system.brake(at, phase.span) * phase.side * velocity).sum(axis=1) if phase.side.size else 0.0 * pushed
        given = np.tile(before, (edges.size, 1))
        for column, power in ((1, braked), (2, pushed)):
            given[1:, column] += np.cumsum(0.5 * length[:, 0] * (power.reshape(length.size, -1) @ GAUSS[1]))
        # Unloading contacts with loss dissipate a fraction of the stored energy that they release.
        back = phase.mode[: system.m] == RELEASED
        if back.any():
            stored = (back * system.laws.dissipable(segment.at(edges)[:, : system.m])).sum(axis=1)
            given[:, 0] += stored[0] - stored
        return given[np.searchsorted(edges, np.minimum(times, segment.end))], given[-1]


def _root(falling: Callable[[float], float], low: float, high: float) -> float:
    """Return the point between `low` and `high` at which a function falls below 0.

    If rounding errors hide the root, return `low` or `high`.
    """
    if falling(low) <= 0.0:
        return low
    return float(brentq(falling, low, high, xtol=ROOT)) if falling(high) < 0.0 else high


@QUIET
def run(problem: Problem) -> Record:
    """Solve `problem`. ``problem.tolerance`` is the wanted error of the velocities, relative to the closing speed."""
    solved = _Run(problem, problem.duration)
    solved.begin()
    solved.until(problem.end)
    times, switches = problem.sample_times(solved.time), Switches.of(solved.switches)
    status, warnings = solved.status, solved.warnings
    if times.size and times[-1] > solved.time and not warnings:  # Some samples lie after the end of the motion.
        solved.until(float(times[-1]))
    samples = empty_samples(NO_TIMES, problem.chain.contacts)._replace(**solved.samples(times))
    end, steps, evaluations = solved.end(), solved.steps, solved.system.evaluations
    return Record(problem.chain, samples, *switches, end, steps, evaluations, status, warnings)


@QUIET
def advance(problem: Problem) -> Status:
    """Advance ``problem.state`` by the duration, in place."""
    state = problem.state
    # The duration is None because the length of a frame is unrelated to the time scale of the motion.
    solved = _Run(problem, None)
    solved.closed = state.closed
    solved.until(problem.end)
    end = solved.end()
    state.time = end.time
    state.note_switches(*Switches.of(solved.switches))
    state.coupled = end.coupled
    for name in MOVING:
        getattr(state, name)[:] = getattr(end, name)
    return solved.status
