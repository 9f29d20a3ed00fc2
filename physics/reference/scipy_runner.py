"""The reference, method `scipy`: its own right-hand side in NumPy, SciPy's `solve_ivp`, every contact switch located.

It shares no kernel with what it checks. Time is divided into phases in which no contact changes its mode; a phase ends at
the located root of the first margin that reaches 0, and the next begins there with new modes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from softcradle.physics.chain import Chain
from softcradle.physics.problem import NO_TIMES, Problem, Record, empty_samples
from softcradle.physics.reference.phases import (
    LOADED,
    TOUCHING,
    OutOfEvaluationsError,
    Phase,
    System,
    first_modes,
    switched_modes,
)
from softcradle.physics.reference.spans import Span
from softcradle.physics.scales import contact_scales, speed_scale
from softcradle.physics.state import State, from_anchor
from softcradle.physics.status import CodedWarning, Status, WarningCode, Warnings

Array = NDArray[np.float64]

EVALUATIONS_A_STEP = 3  # evaluations that count as a step where steps are limited

SMOOTH = "DOP853"  # integrator where all exponents are >= 1: such contacts are never stiff
STIFF = "Radau"  # integrator where an exponent is below 1: stiffness has no bound
ROOT = 4e-15  # of a contact time: error of a located switch, for SciPy gives brentq a tolerance of 4 ulp of 1
GAUSS = np.polynomial.legendre.leggauss(7)  # nodes and weights on [-1, 1], of which the dense solution has the order
MOST_PHASES = 20_000  # of a run: in one with more the contacts chatter


@dataclass
class _Segment:
    """One solved phase: its interval, modes, and dense solution in units of `scale` [s] from `start`."""

    start: float
    end: float
    scale: float
    phase: Phase
    solution: Any
    span: Span | None


class _Run:
    """Phase after phase from a start state, with what samples and switches need."""

    def __init__(self, chain: Chain, state: State, tolerance: float, most: int | None = None) -> None:
        velocity = state.velocity(chain)
        speed = speed_scale(chain, velocity)
        depth, contact_time = contact_scales(chain, velocity)
        self.scale = float(contact_time.max())
        self.system = System(chain, state.external(chain), speed, depth, tolerance)
        if most:
            self.system.most_evaluations = EVALUATIONS_A_STEP * most
        self.chain, self.time = chain, state.time
        self._begin_span()
        self.y = np.concatenate((state.overlap, state.rate, state.anchor))
        self.phase = Phase.of(self.system, first_modes(self.system, self.y))
        self.closed = np.zeros(chain.contacts, dtype=bool)
        self.segments: list[_Segment] = []
        self.switches: list[tuple[float, int]] = []
        self.steps = 0
        self.status = Status.DONE
        self.warnings: Warnings = ()

    def until(self, end: float) -> None:
        """Integrate to `end`; with an infinite end until all contacts are open and none closes again."""
        try:
            while self.time < end and not self.status.gave_up:
                if self.time >= self.system.until:
                    self._begin_span()
                    self.phase = Phase.of(self.system, first_modes(self.system, self.y))
                    self._note_openings()
                if np.isinf(end) and self._is_separated():
                    self.status = Status.SEPARATED
                    break
                if len(self.segments) >= min(MOST_PHASES, self.system.most_evaluations):
                    raise OutOfEvaluationsError
                self._one_phase(min(end, self.system.until))
            self._note(self.closed & ~self._carries())
        except OutOfEvaluationsError:
            sentence = (
                f"scipy gave up at t = {self.time:.6g} s after {self.system.evaluations} evaluations and "
                f"{len(self.segments)} changes of contacts; what follows repeats the state at that time: take 'radau'"
            )
            self._give_up(Status.OUT_OF_STEPS, sentence)

    def _give_up(self, status: Status, sentence: str) -> None:
        self.status = status
        self.warnings = (CodedWarning(WarningCode.GAVE_UP, sentence, {"time": self.time}),)

    def _begin_span(self) -> None:
        if self.chain.forces:
            self.system.span = Span.at(self.chain, self.time)
            self.system.until = self.system.span.end
            self.system.go_to(self.time)

    def _is_separated(self) -> bool:
        n = self.system.n
        return (
            np.isinf(self.system.until)
            and not self._carries().any()
            and bool((self.y[n : 2 * n] <= self.system.least_rate).all())
        )

    def _one_phase(self, end: float) -> None:
        system, phase, scale, start = self.system, self.phase, self.scale, self.time

        def slope(time: float, y: Array) -> Array:
            system.go_to(start + time * scale)
            return scale * phase.slope(y)

        def jacobian(_time: float, y: Array) -> Array:
            return scale * phase.jacobian(y)

        def margin(time: float, y: Array) -> float:
            system.go_to(start + time * scale)
            return float(phase.margins(y).min())

        margin.terminal, margin.direction = True, -1.0  # type: ignore[attr-defined]
        found = solve_ivp(
            slope, (0.0, (end - self.time) / scale), self.y, STIFF if system.stiff else SMOOTH, events=margin,
            rtol=system.relative, atol=system.absolute, dense_output=True,
            **({"jac": jacobian} if system.stiff else {}),
        )  # fmt: skip
        self.steps += found.t.size - 1
        elapsed = found.t[-1] + (ROOT if found.status == 1 else 0.0)
        now = end if found.status == 0 else self.time + float(elapsed) * scale
        system.go_to(now)
        self._note_closings(found.y[: system.n])
        self.segments.append(_Segment(self.time, now, scale, phase, found.sol, system.span))
        self.time, self.y = now, found.sol(elapsed)
        if found.status == 1:
            self._switch()
        elif found.status < 0:
            self._give_up(Status.FAILED, f"scipy failed at t = {self.time:.6g} s: {found.message}")

    def _switch(self) -> None:
        margins = self.phase.margins(self.y)
        reached = margins <= max(0.0, margins.min())
        self.phase = Phase.of(self.system, switched_modes(self.system, self.y, self.phase.mode, reached))
        self._note_openings()

    def _note_closings(self, overlap: Array) -> None:
        """Log the contacts that closed in a phase with overlaps (n, steps); one that only rested at 0 did not close."""
        mode, force = self.phase.mode, self.phase.force(overlap[:, -1])
        pressed = np.where(mode == LOADED, (overlap > 0.0).any(axis=1), (mode == TOUCHING) & (force > 0.0))
        self._note(pressed & ~self.closed)

    def _note_openings(self) -> None:
        self._note(self.closed & (self.phase.mode != LOADED) & ~self._carries())

    def _carries(self) -> NDArray[np.bool_]:
        return self.phase.force(self.y[: self.system.n]) > 0.0

    def _note(self, changed: NDArray[np.bool_]) -> None:
        self.switches.extend((self.time, int(i)) for i in np.flatnonzero(changed))
        self.closed ^= changed

    def samples(self, times: Array) -> tuple[Array, Array]:
        """(T, 2n+2) states and (T, n) forces at `times`."""
        n = self.system.n
        states, forces = np.empty((times.size, self.y.size)), np.empty((times.size, n))
        states[:], forces[:] = self.y, self.phase.force(self.y[:n])
        for segment in self.segments:
            inside = np.flatnonzero((times >= segment.start) & (times < segment.end))
            if inside.size:
                states[inside] = segment.solution((times[inside] - segment.start) / segment.scale).T
                for k in inside:
                    self.system.span = segment.span
                    self.system.go_to(times[k])
                    forces[k] = segment.phase.force(states[k, :n])
                    states[k, :n] = segment.phase.shown_overlap(states[k, :n], forces[k])
        return states, forces

    def work(self, times: Array) -> Array:
        """(T,) work [J] of forces over time up to `times`, by Gauss's rule in every step."""
        found, total, finite = np.zeros(times.size), 0.0, np.isfinite(self.chain.mass)
        for segment in self.segments:
            edges = segment.start + segment.scale * segment.solution.ts
            edges = np.unique(np.clip([*edges, *times], segment.start, segment.end))
            length, middle = np.diff(edges)[:, None], 0.5 * (edges[1:] + edges[:-1])[:, None]
            at = (middle + 0.5 * length * GAUSS[0]).ravel()
            y = segment.solution((at - segment.start) / segment.scale).T
            velocity = from_anchor(y[:, self.system.n : 2 * self.system.n], y[:, -1], self.chain.anchor)
            assert segment.span is not None
            power = (segment.span.push_at(at) * velocity)[:, finite].sum(axis=1).reshape(length.size, -1)
            given = total + np.append(0.0, np.cumsum(0.5 * length[:, 0] * (power @ GAUSS[1])))
            inside = (times >= segment.start) & (times <= segment.end)
            found[inside], total = given[np.searchsorted(edges, times[inside])], given[-1]
        return np.where(times > self.time, total, found)


def run(problem: Problem) -> Record:
    """Solve `problem`; ``problem.tolerance`` is the wanted error of the velocities relative to the closing speed."""
    solved = _Run(problem.chain, problem.state, problem.tolerance, problem.most_steps)
    solved.until(problem.end)
    overlap, rate, anchor, force, _ = empty_samples(0, problem.chain.contacts)
    found = Record(
        NO_TIMES, overlap, rate, anchor, force,
        np.array([contact for _, contact in solved.switches], dtype=np.int64),
        np.array([time for time, _ in solved.switches]),
        _end(solved), solved.steps, solved.system.evaluations, solved.status, solved.warnings, kept=_KeptSolution(solved),
    )  # fmt: skip
    return found if problem.later else _KeptSolution(solved).record(found, problem.sample_times(solved.time))


@dataclass
class _KeptSolution:
    """A run whose segments know the motion at every time."""

    solved: _Run

    def record(self, found: Record, times: Array) -> Record:
        """The record `found` of the run with its samples at `times`; where they lie beyond its end, it goes on to them."""
        solved, n = self.solved, self.solved.system.n
        if times.size and times[-1] > solved.time and not solved.warnings:
            solved.until(float(times[-1]))
            found = replace(found, end=_end(solved), steps=solved.steps, evaluations=solved.system.evaluations)
        states, forces = solved.samples(times)
        rows = {"overlap": states[:, :n], "rate": states[:, n : 2 * n], "anchor": states[:, 2 * n :], "force": forces}
        if solved.chain.forces:
            rows["taken"] = np.column_stack((np.zeros((times.size, 2)), solved.work(times), np.zeros(times.size)))
        sampled: dict[str, Any] = {"time": times, **rows}
        return replace(found, kept=None, **sampled)


def _end(solved: _Run) -> State:
    n, y = solved.system.n, solved.y.copy()
    return State(solved.time, y[:n], y[n : 2 * n], y[2 * n :], solved.phase.force(y[:n]))


def advance(problem: Problem) -> Status:
    """Move ``problem.state`` on by the duration in place."""
    state = problem.state
    solved = _Run(problem.chain, state, problem.tolerance, problem.most_steps)
    solved.closed = state.closed
    solved.until(problem.end)
    end = _end(solved)
    state.time = end.time
    state.note_switches([contact for _, contact in solved.switches], [time for time, _ in solved.switches])
    pairs = (state.overlap, end.overlap), (state.rate, end.rate), (state.anchor, end.anchor), (state.force, end.force)
    for target, source in pairs:
        target[:] = source
    if problem.chain.forces:
        state.taken[2] += solved.work(np.array([end.time]))[0]
    return solved.status
