"""Adaptive methods with friction and loss: the motion in pieces in which no stick-slip mode changes.

While every bead slides one way or sticks, and every contact with loss is pressed in, comes out or is held, the motion is that
of a smaller chain without dissipation (`lumped_chain`), which radau, dop853, accurate and scipy move as any other. A piece is
run in windows; the margins of its modes are sampled in each, the first that runs out is located by bisection, and the modes
are resolved anew there (`stick_slip`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.friction.lumped_chain import LumpedChain
from softcradle.physics.friction.stick_slip import PRESSED, RELEASED, resolve_modes
from softcradle.physics.friction.stopping import meets_again, rests
from softcradle.physics.problem import NO_TIMES, Problem, Record, Runner, empty_samples, run_to_end
from softcradle.physics.scales import contact_scales
from softcradle.physics.state import State
from softcradle.physics.status import CodedWarning, Status, WarningCode, Warnings

Array = NDArray[np.float64]
Switches = list[tuple[float, int]]

MARGINS_A_WINDOW = 16  # times in a window at which the margins are evaluated
SHORTEST = 1.0 / 64.0  # of the longest contact time: the first window, and one after a change of modes
LONGEST = 8.0  # of the longest contact time: the longest window
MOST_WINDOWS = 20_000  # of a run
STEPS_A_WINDOW = 250  # what a window counts as where steps are limited: it costs as much
STEPS_A_RUN = 25  # what a run counts as at the least where steps are limited
EVALUATIONS_A_STEP = 10  # evaluations that count as a step there, for rejected steps cost too
HALVINGS = 60  # of the interval in which a margin runs out; margins jump, so no faster root finder gains
ROUND_OFF = 1e-12  # of the largest speed: a bead or contact this slow at an event stands still
STILL = 1e-9  # of the largest speed: beads that close slower do not meet
LAST_DIGITS = 4e-16  # of a time: no event is located more finely
STUCK = "stick and slip change without end"
RATTLES = "the contacts rattle on between changes of stick and slip"


@dataclass(frozen=True)
class PiecewiseRunner:
    """The Runner of dissipative chains for the methods of another one, which moves chains that nothing dissipates."""

    inner: Runner

    def run(self, problem: Problem) -> Record:
        """Compute the whole motion; ``problem.state`` stays as it is."""
        return run_to_end(problem, self._pass)

    def advance(self, problem: Problem) -> Status:
        """Move ``problem.state`` on by the duration in place; it stops early with a status that says so."""
        state, end = problem.state, problem.end
        found = _Run(replace(problem, samples=np.array([end])), self.inner, NO_TIMES).until(end, False)
        for name in ("overlap", "rate", "anchor", "force", "absorbed"):
            getattr(state, name)[:] = getattr(found.state, name)
        state.switches += len(found.switches)
        state.time = found.state.time if found.status.gave_up else end
        return found.status

    def _pass(self, problem: Problem, end: float, times: Array, stop: bool) -> Record:
        return _Run(problem, self.inner, times).until(end, stop).record()


class _Run:
    """One run, piece after piece."""

    def __init__(self, problem: Problem, inner: Runner, times: Array) -> None:
        self.problem, self.inner, self.times = problem, inner, times
        most = problem.most_steps
        self.most_windows = max(1, most // STEPS_A_WINDOW) if most else MOST_WINDOWS
        self.chain = problem.chain
        self.state = problem.state.copy()
        velocity = self.state.velocity(self.chain)
        self.speed = float(np.abs(np.append(velocity, self.state.rate)).max()) or 1.0
        self.unit = float(contact_scales(self.chain, velocity)[1].max())
        self.window = SHORTEST * self.unit
        self.rows = empty_samples(times.size, self.chain.contacts)
        self.spent = 0  # steps, as far as they are counted
        self.sampled = self.steps = self.evaluations = self.windows = 0
        self.closed = self.state.closed
        self.switches: Switches = [(self.state.time, int(i)) for i in np.flatnonzero(self.closed)]
        self.status = Status.DONE
        self.warnings: Warnings = ()
        self.lumped = self._resolved()

    def until(self, end: float, stop: bool) -> _Run:
        """Go to `end`, or with `stop` until nothing can meet again or all beads rest."""
        while self.state.time < end and self.status == Status.DONE:
            most = self.problem.most_steps
            if stop and self._is_over():
                self.status = Status.SEPARATED
            elif self.windows >= self.most_windows or (most and self.spent > most):
                self._give_up(STUCK)
            else:
                self._one_window(end)
        while self.sampled < self.times.size and self.times[self.sampled] <= self.state.time + 1e-12 * self.unit:
            self._take_sample(self.state)
        return self

    def record(self) -> Record:
        """The record of this run."""
        overlap, rate, anchor, force, absorbed = (row[: self.sampled] for row in self.rows)
        contact = np.array([i for _, i in self.switches], dtype=np.int64)
        time = np.array([t for t, _ in self.switches])
        return Record(
            self.times[: self.sampled], overlap, rate, anchor, force, contact, time, self.state, self.steps, self.evaluations,
            self.status, tuple(dict.fromkeys(self.warnings)), absorbed=absorbed,
        )  # fmt: skip

    def _give_up(self, why: str) -> None:
        self.status = Status.OUT_OF_STEPS
        sentence = f"{self.problem.method} gave up at t = {self.state.time:.6g} s: {why}; take method 'conserving'"
        self.warnings += (CodedWarning(WarningCode.GAVE_UP, sentence, {"time": self.state.time}),)

    def _one_window(self, end: float) -> None:
        self.windows += 1
        length = min(self.window, end - self.state.time)
        times = self.state.time + length * np.arange(1, MARGINS_A_WINDOW + 1) / MARGINS_A_WINDOW
        times[-1] = end if length < self.window else times[-1]
        states, switches = self._run(times)
        margins = [self.lumped.margin(state) for state in states]
        broken = next((k for k, margin in enumerate(margins) if margin < 0.0), None)
        if broken is None and len(states) < MARGINS_A_WINDOW:  # the inner run gave up on its way
            if states:
                self._accept(states[-1], switches)
            self._give_up(RATTLES)
        elif broken is None:
            self._accept(states[-1], switches)
            self.window = min(2.0 * self.window, LONGEST * self.unit)
            self.lumped = self._continued()
        else:
            self._change_modes(self.state.time if broken == 0 else times[broken - 1], float(times[broken]))

    def _change_modes(self, low: float, high: float) -> None:
        """Go to the first end of a mode between `low` and `high`, and resolve the modes there."""
        states, switches = self._run(np.array([self._locate(low, high)]))
        if not states:
            self._give_up(RATTLES)
            return
        self._accept(states[-1], switches)
        self.window = max(0.25 * self.window, SHORTEST * self.unit)
        self.lumped = self._resolved()

    def _locate(self, low: float, high: float) -> float:
        """First time after `low` at which the margin has run out, to the last digits."""
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if high - low <= LAST_DIGITS * max(abs(high), self.unit) or not low < middle < high:
                break
            states, _switches = self._run(np.array([middle]))
            if not states:
                break
            low, high = (low, middle) if self.lumped.margin(states[0]) < 0.0 else (middle, high)
        return high

    def _run(self, times: Array) -> tuple[list[State], Switches]:
        """States of all beads at `times`, all after now, in the present modes, as far as it comes; switches of contacts."""
        lumped, begin = self.lumped, self.lumped.begin
        if lumped.reduced is None:
            return [self._glide(float(t)) for t in times], []
        most, duration = self.problem.most_steps, float(times[-1] - begin.time)
        limit = most and max(1, most - self.spent)
        method, tolerance = self.problem.method, self.problem.tolerance
        found = self.inner.run(Problem(lumped.reduced, begin, method, duration, 0.0, tolerance, times, limit))
        self.steps += found.steps
        self.evaluations += found.evaluations
        self.spent += max(STEPS_A_RUN, found.steps, found.evaluations // EVALUATIONS_A_STEP)
        kept = (w for w in found.warnings if w.code not in (WarningCode.ENERGY, WarningCode.GAVE_UP))
        self.warnings += tuple(kept)
        rows = zip(found.time, found.overlap, found.rate, found.anchor, found.force, strict=True)
        last = found.end.time if found.status.gave_up else np.inf  # rows beyond repeat where it stopped
        states = [lumped.whole(float(t), *row) for t, *row in rows if t <= last]
        both = zip(found.switch_time.tolist(), found.switch_contact.tolist(), strict=True)
        return states, [(t, int(lumped.between[i])) for t, i in both]

    def _glide(self, time: float) -> State:
        """All beads as one lump: constant acceleration."""
        lumped, begin = self.lumped, self.lumped.begin
        none = np.zeros(0)
        fixed = np.isinf(lumped.mass[0])
        a = 0.0 if fixed else float(lumped.push[0] / lumped.mass[0])
        t, v = time - begin.time, float(begin.anchor[1])
        return lumped.whole(time, none, none, np.array([t * (v + 0.5 * t * a), v + t * a]), none)

    def _accept(self, state: State, switches: Switches) -> None:
        inside = [k for k in range(self.sampled, self.times.size) if self.times[k] < state.time]
        now = [k for k in inside if self.times[k] <= self.state.time]
        for _ in now:
            self._take_sample(self.state)
        later = [k for k in inside if self.times[k] > self.state.time]
        if later:
            for sample in self._run(self.times[later])[0]:
                self._take_sample(sample)
        for time, i in switches:
            opens = self.closed[i]
            if time <= state.time and not (opens and time <= self.state.time):
                self.closed[i] = not opens
                self.switches.append((time, i))
        self.state = state
        for changed in np.flatnonzero(state.closed != self.closed).tolist():
            self.closed[changed] = not self.closed[changed]
            self.switches.append((state.time, changed))

    def _take_sample(self, sample: State) -> None:
        values = sample.overlap, sample.rate, sample.anchor, sample.force, sample.absorbed
        for rows, value in zip(self.rows, values, strict=True):
            rows[self.sampled] = value
        self.sampled += 1

    def _continued(self) -> LumpedChain:
        """The same modes from the present state on; contacts that have opened are pressed in when they close again."""
        modes = self.lumped.modes
        contact = np.where((modes.contact == RELEASED) & (self.state.overlap <= 0.0), PRESSED, modes.contact)
        return LumpedChain.at(self.chain, self.state, replace(modes, contact=contact))

    def _resolved(self) -> LumpedChain:
        """The lumped chain in the modes that the present state has; what is slow by round-off stands still."""
        state, chain = self.state, self.chain
        small = ROUND_OFF * self.speed
        velocity = state.velocity(chain)
        velocity[(np.abs(velocity) <= small) & (chain.friction > 0.0)] = 0.0
        rests_now = velocity == 0.0
        lossy = (chain.loss > 0.0) & (state.overlap > 0.0)
        state.rate[lossy & (np.abs(state.rate) <= small)] = 0.0
        if chain.friction:
            state.rate[rests_now[:-1] & rests_now[1:]] = 0.0
            if rests_now[chain.anchor]:
                state.anchor[1] = 0.0
        return LumpedChain.at(chain, state, resolve_modes(chain, state, velocity))

    def _is_over(self) -> bool:
        if self.windows and rests(self.chain, self.state) and self.chain.drive is None:
            return True
        return not self.closed.any() and not meets_again(self.chain, self.state, STILL * self.speed)
