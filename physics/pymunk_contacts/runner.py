"""Method `pymunk`: a chain as bodies on a line in a pymunk Space, with soft contacts between them and substeps.

A step of pymunk first moves the bodies (drift) and then changes their velocities (kick). This is the symplectic Euler
method, so the results equal those of method `euler` up to round-off. The Space stores positions. Differences of
positions cannot resolve the tiny overlaps deep inside a cluster. Therefore the overlaps are integrated separately from
the velocities of the bodies, and are passed to the contacts. External forces are set on the bodies before every step.
pymunk applies them after the drift, as `euler` does. After every step of the Space, friction of the bed slows the
bodies, at most to rest.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pymunk
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.kernel_records import chain_records, knots_of, motion_record
from softcradle.physics.numerics.knots import put_mean
from softcradle.physics.numerics.meeting import meets_again
from softcradle.physics.numerics.plain_kernels import plain
from softcradle.physics.numerics.records import ChainData, Motion
from softcradle.physics.problem import Problem, Record, empty_samples, first_samples, run_to_end
from softcradle.physics.pymunk_contacts.contact_constraint import SoftContact
from softcradle.physics.scales import contact_scales, speed_scale
from softcradle.physics.state import MOVING, State, Switches
from softcradle.physics.status import CodedWarning, Status, WarningCode, Warnings

Array = NDArray[np.float64]

MOST_SPACE_STEPS = 20_000_000  # Largest number of steps of a run. This number of steps takes several minutes.
# Largest distance of two anchors [m]. Only motions that diverge because of too long steps need a larger one.
MOST_REACH = 2.0**90
GRID_TOLERANCE = 1e-9  # Fraction of a step. A time that is this close to a grid point counts as lying on the grid.


class Row:
    """Chain of beads as bodies in a Space. The motion is read from a State and written back to it.

    The x coordinate of a body is the displacement of its bead. This coordinate is near 0 for all beads, so its
    round-off is small. The anchors of the bodies are shifted by `reach`, the distance of two bodies that just touch.
    `reach` exceeds every overlap. Otherwise the line between two anchors would reverse its direction.
    """

    def __init__(self, chain: Chain, state: State, step: float) -> None:
        velocity = state.velocity(chain)
        depth = float(contact_scales(chain, velocity)[0].max())
        # The touching distance of the bodies is larger than any expected overlap and than any motion in one step.
        reach = min(_power_of_two(8.0 * max(depth, step * speed_scale(chain, velocity))), MOST_REACH)
        self.chain = chain
        self.space = pymunk.Space()
        self.space.iterations = 1  # Soft contacts are ordinary forces, so pymunk's iterative solver is not needed.
        self.bodies = [_body(mass) for mass in chain.mass]
        self.contacts = [
            SoftContact(a, b, (0.0, 0.0), (reach, 0.0), reach, contact)
            for (a, b), contact in zip(pairwise(self.bodies), chain.contact, strict=True)
        ]
        self.space.add(*self.bodies, *self.contacts)
        self.reach = reach
        self.overlaps, self.rates = [0.0] * chain.contacts, [0.0] * chain.contacts
        self.closed = [False] * chain.contacts
        self.taken, self.finite = np.zeros(4), np.isfinite(chain.mass)

    def write(self, state: State) -> None:
        """Set the positions and velocities of the bodies to the values of the beads in `state`."""
        positions, velocities = state.position(self.chain).tolist(), state.velocity(self.chain).tolist()
        for body, position, velocity in zip(self.bodies, positions, velocities, strict=True):
            body.position = position, 0.0
            body.velocity = velocity, 0.0
        self.taken[:] = state.taken
        self.knots, self.push, self.bed = knots_of(self.chain, state), np.zeros(len(self.bodies)), self.chain.bed.copy()
        self.external = state.external(self.chain)
        self._take(state.overlap.tolist(), state.rate.tolist())

    def read(self, state: State) -> None:
        """Write the positions and velocities of the bodies, and the contact forces at these positions, into `state`."""
        velocity = np.array([body.velocity.x for body in self.bodies])
        state.overlap[:] = self.overlaps
        state.rate[:] = velocity[:-1] - velocity[1:]
        state.anchor[:] = self.bodies[self.chain.anchor].position.x, velocity[self.chain.anchor]
        each = zip(self.chain.contact, self.overlaps, self.rates, strict=True)
        state.force[:] = [contact.force(d) * (1.0 - contact.loss if w < 0.0 else 1.0) for contact, d, w in each]
        state.taken[:] = self.taken

    def step(self, time: float, step: float) -> None:
        """Take one step of the Space, starting at `time`, with the mean of the external forces during the step."""
        push = self.external
        if self.chain.timed:
            plain(put_mean)(time, step, self.knots, self.push, self.bed)
            push = self.push
        if push is not None:
            for body, force in zip(self.bodies, push.tolist(), strict=True):
                body.force = force, 0.0
        # The overlaps change with the rates before the step.
        before = self.overlaps
        speeds = [body.velocity.x for body in self.bodies]
        rates = [a - b for a, b in pairwise(speeds)]
        self._take([d + step * w for d, w in zip(self.overlaps, rates, strict=True)], rates)
        try:
            self.space.step(step)
        except ValueError:  # The motion has diverged and a force is not a number. Mark the whole motion as NaN.
            self._take([math.nan] * len(rates), [math.nan] * len(rates))
            for body in self.bodies:
                body.velocity = math.nan, 0.0
        if self.chain.dissipative:
            self._absorb(before, speeds, step)
        if self.chain.timed:
            mean = [0.5 * (body.velocity.x + speed) for body, speed in zip(self.bodies, speeds, strict=True)]
            self.taken[2] += step * (self.push - self.knots.drive)[self.finite] @ np.array(mean)[self.finite]

    def _absorb(self, before: list[float], speeds: list[float], step: float) -> None:
        """Apply bed friction after a step, and record the energy dissipated by friction and by the contacts.

        `before` and `speeds` are the overlaps and the velocities before the step. The work of friction is its impulse
        times the mean speed, so it is 0 for a bead at rest.
        """
        # Contacts dissipate energy during unloading.
        for contact, start, end in zip(self.chain.contact, before, self.overlaps, strict=True):
            if end < start:
                self.taken[0] += contact.loss * (contact.energy(start) - contact.energy(end))
        # Coulomb friction reduces the speed, at most to 0.
        for body, start, bed in zip(self.bodies, speeds, self.bed.tolist(), strict=False):
            speed = body.velocity.x
            slower = math.copysign(max(abs(speed) - step * bed, 0.0), speed) if bed else speed
            if slower != speed:
                self.taken[1] += 0.5 * body.mass * (speed - slower) * (start + slower)
                body.velocity = slower, 0.0

    def steps(self, most: int, time: float, step: float) -> int:
        """Take at most `most` steps, starting at `time`, until a contact opens or closes. Return the number of steps."""
        before = self.closed
        for count in range(1, most + 1):
            self.step(time + (count - 1) * step, step)
            if self.closed != before:
                return count
        return most

    def look_ahead(self, step: float, state: State) -> None:
        """Write the result of one step into `state`, but restore the bodies."""
        kept, taken = [(body.position, body.velocity) for body in self.bodies], self.taken.copy()
        overlaps, rates = self.overlaps, self.rates
        # Take the step, read the result, and restore the bodies.
        self.step(state.time, step)
        self.read(state)
        for body, (position, velocity) in zip(self.bodies, kept, strict=True):
            body.position = position
            body.velocity = velocity
        self.taken[:] = taken
        self._take(overlaps, rates)

    def _take(self, overlaps: list[float], rates: list[float]) -> None:
        """Pass the overlaps and rates after the drift to the contacts. If an overlap comes close to `reach`, increase
        `reach`.
        """
        self.overlaps, self.rates = overlaps, rates
        for contact, overlap, rate in zip(self.contacts, overlaps, rates, strict=True):
            contact._take_overlap(overlap, rate)
        self.closed = [overlap > 0.0 for overlap in overlaps]
        deepest = max(overlaps)
        if deepest > 0.5 * self.reach and self.reach < MOST_REACH:
            self.reach = min(_power_of_two(8.0 * min(deepest, MOST_REACH)), MOST_REACH)
            for contact in self.contacts:
                contact.anchor_b = self.reach, 0.0
                contact.touching_distance = self.reach


def _body(mass: float) -> pymunk.Body:
    """Return a body that does not rotate. A wall becomes a body that keeps its velocity."""
    if math.isinf(mass):
        return pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    return pymunk.Body(mass, math.inf)


def _power_of_two(least: float) -> float:
    """Return the smallest power of two above `least`. Sums with a power of two have less round-off."""
    return 2.0 ** math.ceil(math.log2(least))


def run(problem: Problem) -> Record:
    """Run the whole problem in a Space."""
    return run_to_end(problem, _pass)


def _pass(problem: Problem, times: Array) -> Record:
    """Run the problem once to its end."""
    return _Run(problem, times).until(problem.end).result()


class _Run:
    """One run of a Row: its steps, samples and contact switches, and its end. The algorithm is that of the kernels of
    fixed steps.
    """

    def __init__(self, problem: Problem, times: Array) -> None:
        self.problem, self.h, self.times = problem, problem.step, times
        self.most_steps = problem.most_steps or MOST_SPACE_STEPS
        self.row = Row(problem.chain, problem.state, self.h)
        self.samples = empty_samples(times, problem.chain.contacts)
        self.steps = self.flown = self.evaluations = self.sampled = 0
        self.switches: list[tuple[int, float]] = []
        self.status = Status.DONE
        self.warnings: Warnings = ()
        self.state = problem.state.copy()
        self.row.write(self.state)
        self.closed = [False] * problem.chain.contacts
        self.note_switches(0.0)

    def until(self, end: float) -> _Run:
        """Advance to the time `end`. If `end` is infinite, advance until no contact can close again."""
        self.take_samples()
        while self.state.time < end - self.h * GRID_TOLERANCE:
            # Steps of free flight are not counted.
            if self.steps - self.flown >= self.most_steps:
                sentence = f"pymunk gave up after {self.most_steps} steps: take a larger step"
                self.status = Status.OUT_OF_STEPS
                self.warnings = (CodedWarning(WarningCode.GAVE_UP, sentence, {"steps": self.most_steps}),)
                break
            flight = self.flight_time()
            # A run without a duration ends when the beads separate, or when they rest under constant forces.
            if math.isinf(end) and (
                math.isinf(flight)
                or (self.steps and not self.changes() and not self.state.velocity(self.problem.chain).any())
            ):
                self.status = Status.SEPARATED
                break
            self.move(end, flight)
            self.take_samples()
        return self

    def flight_time(self) -> float:
        """Return the time [s] until the first contact closes in free flight.

        The result is 0 if a contact or an external force pushes. The result is infinite if all beads separate.
        """
        chain = self.problem.chain
        pushed = chain.driven and (chain.lasts or self.state.time < chain.knots[-1])
        if pushed or self.row.external is not None or any(self.closed):
            return 0.0
        if chain.on_bed:  # Sliding beads are not in free flight.
            return 0.0 if self.changes() or self.meets_again() else math.inf
        both = zip(self.state.overlap.tolist(), self.state.rate.tolist(), strict=True)
        return min((-overlap / rate for overlap, rate in both if rate > 0.0), default=math.inf)

    def meets_again(self) -> bool:
        """Return True if two beads that slide apart will meet before they come to rest."""
        chain, motion = ChainData(*chain_records(self.problem.chain, self.state)), Motion(*motion_record(self.state))
        return plain(meets_again)(chain, chain.dissipation.bed, motion, 0.0, np.zeros(chain.inverse_mass.size))

    def changes(self) -> bool:
        """Return True if a force or a brake will still change."""
        return self.problem.chain.timed and self.state.time < self.problem.chain.knots[-1]

    def move(self, end: float, flight: float) -> None:
        """Advance by whole steps to the next contact switch or sample. At the end of the run, advance by a part of a
        step.
        """
        state, h = self.state, self.h
        goal = min(end, float(self.times[self.sampled])) if self.sampled < self.times.size else end
        flown = 0 if self.problem.chain.on_bed else math.floor(min(flight, goal - state.time) / h) - 1
        if flown >= 1:  # The motion of free flight is exact, so take many steps at once.
            self.row.step(state.time, flown * h)
            self.steps += flown
            self.flown += flown
        else:
            length = h if end - state.time >= h * (1.0 - GRID_TOLERANCE) else end - state.time
            # A contact may close and open within one step without a trace in the flags. Therefore take at most one step
            # beyond the free flight.
            ahead = min(goal - state.time, flight + h) if flight > 0.0 else goal - state.time
            most = max(1.0, min(ahead / h, self.most_steps + self.flown - self.steps))
            taken = self.row.steps(int(most), state.time, length)
            self.steps += taken
            self.evaluations += taken
        self.row.read(state)
        state.time = min(end, self.problem.state.time + self.steps * h)
        self.note_switches(self.h)

    def note_switches(self, last_step: float) -> None:
        """Log the contacts that have closed or opened within `last_step`.

        The time of a switch follows from a straight line through overlap 0.
        """
        self.switches += _switches(self.closed, self.row.closed, self.state, last_step)
        self.closed = self.row.closed

    def take_samples(self) -> None:
        """Write all samples up to the next step.

        A sample between two steps is computed by a shorter step, which does not change the run.
        """
        time, slack = self.state.time, self.h * GRID_TOLERANCE
        while self.sampled < self.times.size and self.times[self.sampled] < time + self.h - slack:
            sample = self.state.copy()
            if self.times[self.sampled] - time > slack:
                self.row.look_ahead(self.times[self.sampled] - time, sample)
                self.evaluations += 1
            for name in MOVING:
                getattr(self.samples, name)[self.sampled] = getattr(sample, name)
            self.sampled += 1

    def result(self) -> Record:
        """Return the Record of the run. If the run gave up, it contains fewer samples than wanted."""
        samples = first_samples(self.samples, self.sampled)
        return Record(
            self.problem.chain, samples, *Switches.of(self.switches), self.state, self.steps, self.evaluations, self.status,
            self.warnings, kept=self if self.problem.keeps else None,
        )  # fmt: skip

    def record(self, found: Record, times: Array) -> Record:
        """Add samples at `times` to the record `found`, by running again. The times may lie after the end of the run."""
        return found.with_samples(_Run(self.problem, times).until(float(times[-1])).result().samples)


def _switches(before: list[bool], now: list[bool], state: State, last_step: float) -> list[tuple[int, float]]:
    """Return (contact, time) for each contact that has closed or opened within `last_step`.

    The time follows from a straight line through overlap 0.
    """
    found = []
    for i in (i for i, both in enumerate(zip(before, now, strict=True)) if both[0] != both[1]):
        overlap, rate = float(state.overlap[i]), float(state.rate[i])
        back = overlap / rate if rate else 0.0
        found.append((i, state.time - min(max(back, 0.0), last_step)))
    return found


def advance(problem: Problem) -> Status:
    """Advance ``problem.state`` in place by the duration.

    The Space is stored in the state, and is reused as long as the chain is the same.
    """
    chain, state, step = problem.chain, problem.state, problem.step
    duration = problem.duration or 0.0
    row = state.work.get("pymunk")
    if row is None or row.chain is not chain:
        row = state.work["pymunk"] = Row(chain, state, step)
    row.write(state)
    start = state.time
    whole = math.floor(duration / step + GRID_TOLERANCE)
    # First take whole steps, then one shorter step for the rest of the duration.
    for length, count, begin in ((step, whole, start), (duration - whole * step, 1, start + whole * step)):
        taken = 0
        while taken < count and length > step * GRID_TOLERANCE:
            before = row.closed
            taken += row.steps(count - taken, state.time, length)
            state.time = begin + taken * length
            if row.closed != before:
                row.read(state)
                state.note_switches(*Switches.of(_switches(before, row.closed, state, length)))
    row.read(state)
    state.time = start + duration
    return Status.DONE
