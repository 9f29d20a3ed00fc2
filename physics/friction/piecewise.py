"""Adaptive methods for chains that rub: phases in which no friction changes its mode, each moved without friction.

While every bead slides one way or sticks, and every contact with loss is pressed in, eases or is held, the motion is that of
a smaller chain without friction (softcradle.physics.friction.lumped_chain), which radau, dop853, accurate and scipy move as any other. A phase is
run in windows with looks at the margins of its modes; the first that runs out is located by bisection, and the modes are
settled anew there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.friction.lumped_chain import Groups
from softcradle.physics.friction.stick_slip import EASED, settle
from softcradle.physics.friction.stopping import meets_again, rests
from softcradle.physics.problem import Problem, Record, empty_samples, run_to_end
from softcradle.physics.scales import contact_scales
from softcradle.physics.state import State

Array = NDArray[np.float64]
Runner = Callable[[Problem], Record]

LOOKS = 16  # at the margins in a window
HALVINGS = 60  # of the interval in which a margin runs out
SHORT, LONG = 1.0 / 64.0, 8.0  # windows, of the longest contact time
MOST_WINDOWS = 20_000
STEPS_A_WINDOW = 250  # where steps are counted: a window costs as much as so many,
STEPS_A_RUN, EVALUATIONS_A_STEP = 25, 10  # a run as so many at the least, and what it refused counts too
ROUND_OFF = 1e-12  # of the largest speed: a bead or contact this slow at an event stands still


class _Walk:
    """One run, phase after phase."""

    def __init__(self, problem: Problem, runner: Runner, times: Array) -> None:
        self.problem, self.runner, self.times = problem, runner, times
        most = problem.most_steps
        self.most_windows = max(1, most // STEPS_A_WINDOW) if most else MOST_WINDOWS
        self.chain = problem.chain
        self.state = problem.state.copy()
        velocity = self.state.velocity(self.chain)
        self.speed = float(np.abs(np.append(velocity, self.state.rate)).max()) or 1.0
        self.unit = float(contact_scales(self.chain, velocity)[1].max())
        self.window = SHORT * self.unit
        self.rows = *empty_samples(times.size, self.chain.contacts), np.zeros((times.size, 2))
        self.spent = 0  # steps, as far as they are counted
        self.taken = self.steps = self.evaluations = self.windows = 0
        self.switches: list[tuple[float, int]] = []
        self.closed = self._closed(self.state)
        for i in np.flatnonzero(self.closed):
            self.switches.append((self.state.time, int(i)))
        self.warnings: tuple[str, ...] = ()
        self.gave_up = ""
        self.groups = self._settled()

    def until(self, end: float, stop: bool) -> _Walk:
        """Go to `end`, or with `stop` until nothing can meet again or everything rests."""
        while self.state.time < end and not (stop and self._over()) and not self.gave_up:
            most = self.problem.most_steps
            if self.windows >= self.most_windows or (most and self.spent > most):
                self._give_up("friction changes its mode without end")
            else:
                self._one_window(end)
        while self.taken < self.times.size and self.times[self.taken] <= self.state.time + 1e-12 * self.unit:
            self._take(self.state)
        return self

    def record(self) -> Record:
        """What `simulate` wants to know."""
        overlap, rate, anchor, force, absorbed = (row[: self.taken] for row in self.rows)
        contact = np.array([i for _, i in self.switches], dtype=np.int64)
        time = np.array([t for t, _ in self.switches])
        return Record(
            self.times[: self.taken], overlap, rate, anchor, force, contact, time, self.state, self.steps, self.evaluations,
            tuple(dict.fromkeys(self.warnings)), absorbed=absorbed,
        )  # fmt: skip

    def _give_up(self, why: str) -> None:
        self.gave_up = f"{self.problem.method} gave up at t = {self.state.time:.6g} s: {why}"
        self.warnings += (f"{self.gave_up}; take method 'conserving'",)

    def _one_window(self, end: float) -> None:
        self.windows += 1
        length = min(self.window, end - self.state.time)
        looks = self.state.time + length * np.arange(1, LOOKS + 1) / LOOKS
        looks[-1] = end if length < self.window else looks[-1]
        states, switches = self._run(looks)
        margins = [self.groups.margin(state) for state in states]
        broken = next((k for k, margin in enumerate(margins) if margin < 0.0), None)
        if broken is None and len(states) < LOOKS:  # the frictionless part gave up on its way
            if states:
                self._accept(states[-1], switches)
            self._give_up("the contacts rattle on between changes of friction")
            return
        if broken is None:
            self._accept(states[-1], switches)
            self.window = min(2.0 * self.window, LONG * self.unit)
            self.groups = self._continued()
            return
        low = self.state.time if broken == 0 else looks[broken - 1]
        event = self._locate(low, float(looks[broken]))
        states, switches = self._run(np.array([event]))
        if not states:
            self._give_up("the contacts rattle on between changes of friction")
            return
        self._accept(states[-1], switches)
        self.window = max(0.25 * self.window, SHORT * self.unit)
        self.groups = self._settled()

    def _locate(self, low: float, high: float) -> float:
        """First time after `low` at which the margin has run out, to the last digits."""
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if high - low <= 4e-16 * max(abs(high), self.unit) or not low < middle < high:
                break
            states, _switches = self._run(np.array([middle]))
            if not states:
                break
            low, high = (low, middle) if self.groups.margin(states[0]) < 0.0 else (middle, high)
        return high

    def _run(self, times: Array) -> tuple[list[State], list[tuple[float, int]]]:
        """States of all beads at `times`, all after now, in the present modes, as far as it comes; switches of contacts."""
        groups, begin = self.groups, self.groups.begin
        if groups.reduced is None:
            return [self._glide(float(t)) for t in times], []
        most = self.problem.most_steps
        part = Problem(
            groups.reduced,
            begin,
            self.problem.method,
            float(times[-1] - begin.time),
            0.0,
            self.problem.tolerance,
            times,
            most and max(1, most - self.spent),
        )
        found = self.runner(part)
        self.steps += found.steps
        self.evaluations += found.evaluations
        self.spent += max(STEPS_A_RUN, found.steps, found.evaluations // EVALUATIONS_A_STEP)
        self.warnings += tuple(said for said in found.warnings if "energy" not in said and "gave up" not in said)
        rows = zip(found.time, found.overlap, found.rate, found.anchor, found.force, strict=True)
        last = found.end.time if found.gave_up else np.inf  # rows beyond repeat where it stopped
        states = [groups.whole(float(t), *row) for t, *row in rows if t <= last]
        both = zip(found.switch_time.tolist(), found.switch_contact.tolist(), strict=True)
        return states, [(t, int(groups.between[i])) for t, i in both]

    def _glide(self, time: float) -> State:
        """All beads as one group: constant acceleration."""
        groups, begin = self.groups, self.groups.begin
        none = np.zeros(0)
        fixed = np.isinf(groups.mass[0])
        a = 0.0 if fixed else float(groups.push[0] / groups.mass[0])
        t, v = time - begin.time, float(begin.anchor[1])
        return groups.whole(time, none, none, np.array([t * (v + 0.5 * t * a), v + t * a]), none)

    def _accept(self, state: State, switches: list[tuple[float, int]]) -> None:
        inside = [k for k in range(self.taken, self.times.size) if self.times[k] < state.time]
        now = [k for k in inside if self.times[k] <= self.state.time]
        for _ in now:
            self._take(self.state)
        later = [k for k in inside if self.times[k] > self.state.time]
        if later:
            for sample in self._run(self.times[later])[0]:
                self._take(sample)
        for time, i in switches:
            opens = self.closed[i]
            if time <= state.time and not (opens and time <= self.state.time):
                self.closed[i] = not opens
                self.switches.append((time, i))
        self.state = state
        for changed in np.flatnonzero(self._closed(state) != self.closed).tolist():
            self.closed[changed] = not self.closed[changed]
            self.switches.append((state.time, changed))

    def _take(self, sample: State) -> None:
        values = sample.overlap, sample.rate, sample.anchor, sample.force, sample.absorbed
        for rows, value in zip(self.rows, values, strict=True):
            rows[self.taken] = value
        self.taken += 1

    def _continued(self) -> Groups:
        """The same modes from the present state on; contacts that have opened are pressed in when they close again."""
        modes = self.groups.modes
        contact = np.where((modes.contact == EASED) & (self.state.overlap <= 0.0), 0, modes.contact)
        return Groups.at(self.chain, self.state, replace(modes, contact=contact))

    def _settled(self) -> Groups:
        """Groups in the modes that the present state asks for; what is slow by round-off stands still."""
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
        return Groups.at(chain, state, settle(chain, state, velocity))

    def _over(self) -> bool:
        if self.windows and rests(self.chain, self.state) and self.chain.drive is None:
            return True
        return not self.closed.any() and not meets_again(self.chain, self.state, 1e-9 * self.speed)

    def _closed(self, state: State) -> NDArray[np.bool_]:
        closed: NDArray[np.bool_] = (state.overlap > 0.0) | ((state.overlap == 0.0) & (state.force > 0.0))
        return closed


def run(problem: Problem, runner: Runner) -> Record:
    """Run `problem` on a chain that rubs; `runner` moves chains that do not."""

    def once(problem: Problem, end: float, times: Array, stop: bool) -> Record:
        return _Walk(problem, runner, times).until(end, stop).record()

    return run_to_end(problem, once)


def advance(
    chain: Chain, state: State, duration: float, method: str, tolerance: float, most_steps: int, runner: Runner
) -> str:
    """Move `state` on by `duration` [s] in place. Returns why it stopped before, empty where it did not."""
    problem = Problem(chain, state, method, duration, 0.0, tolerance, np.array([state.time + duration]), most_steps)
    found = _Walk(problem, runner, np.zeros(0)).until(state.time + duration, False)
    for name in ("overlap", "rate", "anchor", "force", "absorbed"):
        getattr(state, name)[:] = getattr(found.state, name)
    state.switches += len(found.switches)
    state.time = found.state.time if found.gave_up else state.time + duration
    return found.gave_up
