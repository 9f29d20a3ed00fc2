"""Reference method in extended precision: Radau collocation of a chain whose contacts open and close at events.

A step is accepted if its local error is small and no guard function can have changed its sign inside the step. Near an
event, steps become geometrically shorter. Finally a step crosses the event. This step is so short that it changes no
velocity by more than the tolerance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BarycentricInterpolator
from scipy.optimize import brentq
from softcradle.physics.chain import Chain
from softcradle.physics.reference.spans import Span
from softcradle.physics.state import State

from benchmarks.scan.collocation import EPSILON, Array, Extended, Tableau, tableau
from benchmarks.scan.monotone_rows import HELD, OPEN, PRESSED, RELEASED, STICKS, TOUCHING, Branches, Rows
from benchmarks.scan.stage_equations import Point, Stages, Strings

STAGES = 7  # Number of stages of a step. The order is 13.
# Largest ratio of successive steps, and safety factor of the step that the local error allows.
GROWTH, SAFETY = 4.0, 0.8
CROSSING = 0.1  # Largest change of a velocity in a step that crosses an event, in units of the tolerance.
STILL = 1e-2  # Speed below which a bead counts as being at rest, in units of the tolerance.
# Allowed residual of Newton's iteration, in units of the tolerance. With a larger residual, contacts with almost no
# force would bounce.
NEWTON = 1e-6
# Distance by which a guard function of velocities may be past its zero, in units of the tolerance. The same number is
# the allowed residual of a step across an event.
SLACK = 1e-3
FIRST_STEPS = 2  # Number of steps after which the branches of constraints at rest are determined.
# Gap or rate that counts as round-off. A gap is relative to the overlap that the fastest contact reaches, and a rate to
# the speed.
ROUND_OFF = 64.0 * EPSILON
# The simulation gives up if a step does not converge although it is shorter than the crossing step times this fraction.
NO_STEP = 1e-6
MOST_STEPS = 20_000  # Largest number of steps of a run, including rejected steps.
NEVER = np.inf
APPROACH = 15.0 / 16.0  # Longest step towards an event, as a fraction of the time to it.
# A contact that reverses more slowly than this fraction of the velocity change of a crossing counts as standing still.
STANDS = 0.01
# Fraction of the speed scale. Events at which a contact opens more slowly than this are not located.
SLOW = 1e-9


class ReferenceGaveUpError(Exception):
    """Raised if a reference simulation has not reached the end within its step limit."""


class Event(NamedTuple):
    """Time at which a contact begins or ceases to overlap."""

    contact: int
    closes: bool
    time: float  # Time [s].
    speed: float  # Absolute rate of the overlap at this time [m/s].


@dataclass(frozen=True)
class ReferenceEnd:
    """Final state of a motion, with error estimates.

    Attributes:
        velocity: (n+1,) final velocities [m/s].
        position: (n+1,) final positions [m].
        events: every closing and opening of a contact, in order of time; couplers are excluded.
        time: time of the end [s].
        error: error of velocities [m/s]. It is the largest difference from a simulation with fewer stages and a tenfold
            tolerance, plus the tolerance of the finer simulation.
        position_error: error of positions [m], computed in the same way.
        steps: number of steps of both simulations.
    """

    velocity: NDArray[np.float64]
    position: NDArray[np.float64]
    events: list[Event]
    time: float
    error: float
    position_error: float
    steps: int


def reference_end(
    chain: Chain,
    velocity: ArrayLike,
    duration: float | None = None,
    tolerance: float = 1e-13,
    most_steps: int = MOST_STEPS,
) -> ReferenceEnd:
    """Return the final velocities of `chain` in extended precision, with their error.

    Raises:
        ReferenceGaveUpError: the motion takes more than `most_steps` steps.
    """
    state = State.at_start(chain, velocity)
    fine = ExtendedRun(chain, state, tolerance, most_steps=most_steps)
    fine.until(math.inf if duration is None else duration)
    coarse = ExtendedRun(chain, state, 10.0 * tolerance, STAGES - 2, most_steps)
    coarse.until(float(fine.time) if duration is None else duration)
    apart = float(np.abs(fine.point.velocity - coarse.point.velocity).max())
    error = apart + tolerance * fine.speed
    late = fine.time - coarse.time
    shift = float(np.abs(fine.position - coarse.position - late * coarse.point.velocity).max())
    return ReferenceEnd(
        fine.point.velocity.astype(np.float64), fine.position.astype(np.float64), fine.events, float(fine.time), error,
        shift + tolerance * fine.speed * float(fine.time), fine.steps + coarse.steps,
    )  # fmt: skip


@dataclass
class ExtendedRun:
    """One simulation in extended precision.

    Arguments:
        chain, state: the chain and its initial state.
        tolerance: tolerance of the local error of a step, relative to the speed scale.
        stages: number of stages of a step. The order is twice this number minus 1.
        most_steps: step limit of the simulation.
    """

    chain: Chain
    state: State
    tolerance: float
    stages: int = STAGES
    most_steps: int = MOST_STEPS
    time: Extended = field(init=False)
    point: Point = field(init=False)
    steps: int = field(init=False, default=0)
    position: Array = field(init=False)
    events: list[Event] = field(init=False, default_factory=list)

    def __post_init__(self) -> None:
        chain, state = self.chain, self.state
        self.steady = self.rows = Rows.of(chain, state.external(chain))
        self.tableau, self.span = tableau(self.stages), Span.at(chain, state.time)
        self.rows = self._rows(state.time)
        self.time = Extended(state.time)
        self.point = _first_point(self.rows, chain, state)
        self.position = state.position(chain).astype(Extended)
        self.rest = State.at_start(chain, np.zeros(len(chain.mass))).position(chain).astype(Extended)
        rows = self.rows
        if chain.forces:
            strongest = max(chain.drives, key=lambda force: float(np.abs(force).max()))
            rows = replace(rows, external=strongest.astype(Extended))
        self.speed, self.quickest = _scales(rows, self.point, state.position(chain))
        self.length = 1e-3 * self.tolerance * self.quickest

    def until(self, end: float) -> None:
        """Integrate to `end` [s]. If it is infinite, integrate until every contact is open and none can close again."""
        while self.time < end and not (math.isinf(end) and self.is_over()):
            self.step(end)

    def _rows(self, time: Any) -> Rows:
        """Return the constraints at the times `time` (...). The constraints are constant if no force or brake depends
        on time.
        """
        if not (self.chain.forces or self.chain.brakes):
            return self.steady
        return self.steady.under(self.span.push_at(time), self.span.brake_at(time))

    def _stage_rows(self, h: Extended, nodes: Array) -> Rows:
        """Return the constraints at all stages of a step."""
        return self._rows(self.time + h * nodes) if self.span.changes else self.rows

    def step(self, end: float) -> None:
        """Try one step, which ends at `end` or at the next breakpoint of a force at the latest.

        Raise ReferenceGaveUpError after `most_steps` steps.
        """
        self.steps += 1
        if self.steps > self.most_steps:
            raise ReferenceGaveUpError(f"at t = {float(self.time):.6g} s after {self.most_steps} steps")
        end = min(end, self.span.end)
        if self._rests():
            self.time = Extended(end)
            return
        with np.errstate(all="ignore"):  # Newton's iteration can pass overlaps whose powers overflow.
            self._step(Extended(end))
        if math.isfinite(end) and end - self.time <= 4.0 * EPSILON * abs(end):
            self.time = Extended(end)
        if self.time >= self.span.end:
            self._pass_knot()

    def _pass_knot(self) -> None:
        """Pass a breakpoint in time, and continue with the forces and brakes after it."""
        braked, point = self.rows.bed > 0.0, self.point
        self.span = Span.at(self.chain, float(self.time))
        self.rows, self.length = self._rows(self.time), 1e-3 * self.tolerance * self.quickest
        if braked.size:
            point.side = np.where(braked, point.side, np.sign(point.velocity).astype(np.int8))
            friction = np.where(point.side == STICKS, point.friction, point.side * self.rows.bed)
            point.friction = np.clip(friction, -self.rows.bed, self.rows.bed)

    def _strings(self) -> Strings | None:
        """Return the strings of the chain at the present time; None without strings."""
        chain = self.chain
        if not chain.swing:
            return None
        rest = self.rows.of_contacts(self.rest[:-1] - self.rest[1:], origin=True)
        return Strings(Extended(chain.gravity) / Extended(chain.strings), rest, self.position - self.rest)

    def _pulled(self, rows: Rows, displacement: Array) -> Rows:
        """Return the constraints with the pull of the strings as external forces.

        The beads have the displacements (..., n+1) [m].
        """
        mass = np.where(rows.inverse_mass > 0.0, 1.0 / np.where(rows.inverse_mass > 0.0, rows.inverse_mass, 1.0), 0.0)
        return replace(rows, external=rows.external - Extended(self.chain.swing) * mass * displacement)

    def _rests(self) -> bool:
        """Return True if no bead moves or is accelerated. Under steady forces the chain stays at rest."""
        point = self.point
        if (
            self.span.changes
            or self.chain.swing
            or self.steps <= FIRST_STEPS
            or point.velocity.any()
            or point.rate.any()
        ):
            return False
        acceleration = np.abs(self.rows.acceleration(point.force, point.friction))
        return bool((acceleration <= 1e-12 * np.abs(point.force).max(initial=0.0) * self.rows.inverse_mass).all())

    def is_over(self) -> bool:
        """Return True if no contact pushes or closes and, with friction, no bead moves."""
        if self.span.changes:
            return False
        if self._rests():
            return True
        point = self.point
        heaviest = float(self.rows.inverse_mass[self.rows.inverse_mass > 0.0].min())
        pushing = point.force * heaviest > self.tolerance * self.speed / self.quickest  # A smaller force is round-off.
        pushes = bool(pushing.any() or (point.branch >= PRESSED).any())
        if self.rows.bed.size:
            slides = self.rows.bed > 0.0
            acceleration = np.abs(self.rows.acceleration(point.force, point.friction))
            slows = (point.velocity != 0.0) & (acceleration > 1e-12 * self.rows.bed * self.rows.inverse_mass)
            if (slides & slows).any() or self._moves(point.velocity[slides]):
                return False
            # Contacts in a chain at rest may push if friction holds the beads.
            pushes &= bool((acceleration > 1e-12 * self.rows.bed * self.rows.inverse_mass).any())
        return not (pushes or self._moves(np.maximum(point.rate, 0.0)))

    def _moves(self, speeds: Array) -> bool:
        """Return True if one of the speeds exceeds the allowed residual of Newton's iteration."""
        return bool((np.abs(speeds) > STILL * self.tolerance * self.speed).any())

    def _step(self, end: Extended) -> None:
        """Try one step. Accept it, or shorten the next step."""
        h = Extended(np.minimum(self.length, end - self.time))
        if self._is_crossing(float(h)):
            self._cross(h)
            return
        slack = SLACK * self.tolerance * self.speed
        rows = self._stage_rows(h, self.tableau.node)
        strings = self._strings()
        stages = Stages(rows, self.tableau, self.point, h, self._left_by_newton(), strings=strings).solve()
        if stages is None:
            self.length = 0.25 * float(h)
            return
        # For the guard functions, the strings are external forces at the stages.
        taken, at_end = rows, rows if rows is self.rows else self._rows(self.time + h)
        if strings is not None:
            displacement = strings.displacement + h * (self.tableau.once @ stages.velocity)
            rows, at_end = self._pulled(rows, displacement), self._pulled(at_end, displacement[-1])
        error = local_error(self.tableau, rows, stages, float(h)) / (self.tolerance * self.speed)
        factor = SAFETY * max(error, 1e-30) ** (-0.5 / self.stages)
        if error > 1.0:
            self.length = float(h) * min(0.5, max(0.1, factor))
        elif hides_switch(self.tableau, rows, self.point, stages, float(h), slack, STILL * self.tolerance * self.speed):
            self.length = 0.5 * float(h)
        else:
            corner = next_corner(
                self.tableau, at_end, stages, float(h), self.speed, CROSSING * self.tolerance * self.speed
            )
            self._take(stages, h, taken)
            grown = float(h) * min(GROWTH, max(0.2, factor))
            if h < self.length:  # This step was shortened by the end of the simulation.
                grown = max(grown, self.length)
            self.length = min(grown, max(corner, 0.5 * self._crossing_length()))

    def _left_by_newton(self) -> float:
        """Return the precision [m/s] of the stages.

        The precision is lower with sticking beads or held contacts, which limit Newton's iteration.
        """
        part = SLACK if self.rows.bed.size or self.rows.loss.any() else NEWTON
        return max(part * self.tolerance, 4.0 * EPSILON) * self.speed

    def _crossing_length(self) -> float:
        """Return the longest step [s] that may cross an event."""
        acceleration = self.rows.acceleration(self.point.force, self.point.friction)
        jump = np.zeros_like(acceleration)
        of_contact = self.rows.preload + self.point.force * self.rows.loss
        np.add.at(jump, self.rows.joint, of_contact)
        np.add.at(jump, self.rows.joint + 1, of_contact)
        if self.rows.bed.size:
            jump += 2.0 * self.rows.bed
        most = float((np.abs(acceleration) + jump * self.rows.inverse_mass).max())
        return CROSSING * self.tolerance * self.speed / max(most, self.speed / self.quickest)

    def _is_crossing(self, h: float) -> bool:
        return h <= self._crossing_length()

    def _cross(self, h: Extended) -> None:
        """Cross an event with a step of implicit Euler, in which each constraint finds its branch at the end.

        The equations of the step are a monotone problem.
        """
        speed = float(np.abs(self.point.velocity).max()) + self.speed
        wanted, strict = SLACK * self.tolerance * self.speed, 4.0 * EPSILON * speed
        rows = self._stage_rows(h, tableau(1).node)
        stages = Stages(rows, tableau(1), self.point, h, wanted, strict, self._strings()).solve()
        if stages is not None:
            self._take(stages, h, rows)
            self.length = GROWTH * float(h)
            return
        self.length = 0.25 * float(h)
        if self.length < NO_STEP * self._crossing_length():
            raise ReferenceGaveUpError(f"at t = {float(self.time):.6g} s: no step converges")

    def _take(self, stages: Point, h: Extended, rows: Rows) -> None:
        before, self.point = self.point, stages.last()
        used = tableau(stages.velocity.shape[0])
        self.position = self.position + h * (used.once[-1] @ stages.velocity)
        self._note_events(before, stages, h, used)
        if rows is not self.rows:
            self.rows = self._rows(self.time + h)
        self._round_to_rest(before)
        self.time = self.time + h

    def _note_events(self, before: Point, stages: Point, h: Extended, used: Tableau) -> None:
        """Record the contacts whose overlap changes its sign in a step. The time is the root of the polynomial through
        the nodes.
        """
        if not self.rows.single:
            return
        changed = np.flatnonzero((before.overlap > 0.0) != (stages.overlap[-1] > 0.0))
        found = []
        for i in changed.tolist():
            node = np.append(0.0, used.node.astype(np.float64))
            overlap, rate = (
                np.append(first[i], later[:, i]).astype(np.float64)
                for first, later in ((before.overlap, stages.overlap), (before.rate, stages.rate))
            )
            part = 0.0  # A contact that touches at the start is considered to close at once.
            if overlap[0] != 0.0 != overlap[-1]:
                part = brentq(BarycentricInterpolator(node, overlap), 0.0, 1.0, xtol=1e-14)
            elif overlap[-1] == 0.0:
                part = 1.0
            speed = abs(float(BarycentricInterpolator(node, rate)(part)))
            found.append(Event(i, bool(overlap[-1] > 0.0), float(self.time + h * part), speed))
        self.events += sorted(found, key=lambda event: event.time)

    def _round_to_rest(self, before: Point) -> None:
        """Set values to 0 that differ from 0 only by round-off.

        Such values are velocities of sticking beads, and overlap rates of touching or held contacts. Gaps between beads
        that move together are also removed. A push that closes such a gap would let the contact bounce with the square
        root of the round-off.
        """
        point = self.point
        # Find the beads at rest, and set their velocities to exactly 0.
        rests = np.abs(point.velocity) <= 4.0 * EPSILON * self.speed
        if self.rows.bed.size:
            # The velocity is past 0 by less than the allowed residual, so the bead has come to rest.
            past = point.side * point.velocity < 0.0
            rests |= ((point.side == STICKS) | past) & (self.rows.bed > 0.0)
            acceleration = self.rows.acceleration(point.force, point.friction)
            # A slow bead that is not accelerated counts as at rest. Otherwise it would creep forever.
            still = np.abs(point.velocity) <= STILL * self.tolerance * self.speed
            still &= point.side * acceleration <= 1e-12 * self.rows.bed * self.rows.inverse_mass
            rests |= still & (self.rows.bed > 0.0)
            point.side[rests & (past | still)] = STICKS
        left = np.where(rests, point.velocity, 0.0)
        point.velocity -= left
        point.rate -= self.rows.closing(left)
        # Contacts between two resting beads keep their overlap.
        stays, joint = rests & (before.velocity == 0.0), self.rows.joint
        both = stays[joint] & stays[joint + 1]
        point.overlap[both] = before.overlap[both]
        point.rate[rests[joint] & rests[joint + 1]] = 0.0
        # These contacts are touching or held, or are open with a gap and a rate that are round-off.
        fixed = np.isin(point.branch, (TOUCHING, HELD)) & (np.abs(point.rate) < 10.0 * self.tolerance * self.speed)
        point.rate[fixed] = 0.0
        side_by_side = (point.branch == OPEN) & (np.abs(point.rate) <= ROUND_OFF * self.speed)
        side_by_side &= np.abs(point.overlap) <= ROUND_OFF * self.speed * self.quickest
        point.overlap[side_by_side] = point.rate[side_by_side] = 0.0


def _first_point(rows: Rows, chain: Chain, state: State) -> Point:
    overlap = rows.of_contacts(state.overlap.astype(Extended), origin=True)
    rate = rows.of_contacts(state.rate.astype(Extended))
    velocity = state.velocity(chain).astype(Extended)
    with_loss = rows.loss > 0.0
    branch = np.where(overlap > 0.0, PRESSED, OPEN).astype(np.int8)
    branch[(overlap == 0.0) & (rate == 0.0) & (rows.preload > 0.0)] = TOUCHING
    branch[with_loss & (overlap > 0.0) & (rate == 0.0)] = HELD
    branch[with_loss & (overlap > 0.0) & (rate < 0.0)] = HELD + 1
    part = np.where(branch == HELD + 1, 1.0 - rows.loss, 1.0)
    force = np.where(branch >= PRESSED, part * rows.law(overlap), 0.0)
    side = np.sign(velocity).astype(np.int8) if rows.bed.size else np.zeros(0, dtype=np.int8)
    friction = side * rows.bed
    return Point(overlap, rate, velocity, force, friction, branch, side)


def _scales(rows: Rows, point: Point, position: Array) -> tuple[float, float]:
    """Return the speed scale [m/s] and the shortest time scale [s] of the motion.

    The speed scale follows from the initial energies and forces.
    """
    inverse_reduced = rows.response.diagonal()[: rows.contacts]
    stored = float(np.sqrt(2.0 * rows.stored(point.overlap) * inverse_reduced).max())
    acceleration = np.abs(rows.acceleration(point.force, point.friction))
    speed = max(float(np.ptp(point.velocity)), stored)
    if speed == 0.0:
        speed = _driven_speed(rows, position)
    energy = 0.5 * speed**2 / inverse_reduced
    with np.errstate(divide="ignore"):
        by_power = ((1.0 + rows.exponent) * energy / rows.stiffness) ** (1.0 / (1.0 + rows.exponent))
        depth = np.minimum(energy / rows.preload, by_power)
    quickest = float(depth.min()) / speed
    most = float(acceleration.max())
    return speed, min(quickest, speed / most) if most else quickest


def _driven_speed(rows: Rows, position: Array) -> float:
    """Return the speed [m/s] that an external force gives to beads at rest.

    The beads move over the longest gap, or over the overlap at which a contact carries the external force.
    """
    push = float(np.abs(rows.external * rows.inverse_mass).max())
    carried = rows.inverse(np.full(rows.contacts, np.abs(rows.external).max()))
    distance = max(float(np.abs(np.diff(position)).max()), float(carried.min()))
    return math.sqrt(2.0 * push * distance) if push and distance else 1.0


def local_error(tableau: Tableau, rows: Rows, stages: Point, h: float) -> float:
    """Return the error of velocities [m/s] in a step.

    The error follows from the last Legendre coefficients of the accelerations, extrapolated by their decay. The order
    is twice the number of coefficients. If the coefficients do not decay, as in a step across an event, the last one is
    the error.
    """
    size = np.abs(tableau.legendre @ rows.acceleration(stages.force, stages.friction))
    if tableau.stages < 4:
        return float(h * size[-1].max())
    tail, before = np.maximum(size[-1], size[-2]), np.maximum(size[-3], size[-4])
    decay = np.minimum(1.0, tail / np.where(before > 0.0, before, 1.0))
    return float((h * tail * decay**1.0).max())


def hides_switch(
    tableau: Tableau, rows: Rows, start: Point, stages: Point, h: float, slack: float, still: float
) -> bool:
    """Return True if a guard function can change its sign inside the step.

    A change is possible if one of its Bernstein coefficients has the other sign. A guard of velocities may be past its
    zero by less than `slack` [m/s]. The sliding of a bead slower than `still` [m/s] is ignored.
    """
    kinked = (rows.preload > 0.0) | (rows.loss > 0.0)
    weight = h * rows.response.diagonal()  # Change of a constraint's velocity by a force of 1 N.
    # The branches must be the same at all stages.
    if _mixes(kinked, stages.branch, stages.force, weight[: kinked.size], slack):
        return True
    if rows.bed.size and _mixes(rows.bed > 0.0, stages.side, stages.friction, weight[kinked.size :], slack):
        return True
    # Check overlaps. The Bernstein coefficients bound the polynomial of each contact in the whole step.
    acceleration = rows.acceleration(stages.force, stages.friction)
    closing = rows.closing(acceleration)
    branch = stages.branch[0]
    overlap = h * h * (tableau.bernstein @ closing)
    overlap += start.overlap + np.linspace(0.0, 1.0, overlap.shape[0])[:, None] * (h * start.rate)
    reach = slack * h + 1e-18 * np.abs(start.overlap)
    found = bool(((stages.branch == OPEN).all(axis=0) & (overlap > reach)).any())
    found |= bool((kinked & (branch >= PRESSED) & (overlap < -reach)).any())
    # Check that contacts with loss do not reverse.
    if rows.loss.any():
        rate = start.rate + h * (tableau.bernstein_once @ closing)
        lossy = (rows.loss > 0.0) & (start.overlap > 0.0)
        found |= bool((lossy & (branch == PRESSED) & (rate < -slack)).any())
        found |= bool((lossy & (branch == RELEASED) & (rate > slack)).any())
    # Check that the force of a touching or held contact stays within its bounds.
    fixed = (branch == TOUCHING) | (branch == HELD)
    if fixed.any():
        force = tableau.bernstein_value @ stages.force
        low, high = bounds(rows, start)
        room = 1e-12 * high + slack / weight[: kinked.size]
        found |= bool((fixed & ((force < low - room) | (force > high + room))).any())
    # Check that beads on the bed do not reverse or break loose.
    if rows.bed.size:
        side = stages.side[0]
        velocity = start.velocity + h * (tableau.bernstein_once @ acceleration)
        friction = tableau.bernstein_value @ stages.friction
        bed = rows.bed if rows.bed.ndim == 1 else tableau.bernstein_value @ rows.bed
        found |= bool((side * velocity < -still).any())
        found |= bool(((side == STICKS) & (np.abs(friction) > bed * (1.0 + 1e-12))).any())
    return found


def _mixes(counts: NDArray[np.bool_], branch: Branches, dual: Array, weight: NDArray[np.float64], slack: float) -> bool:
    """Return True if constraints change their branch among the stages.

    Changes are ignored if the forces differ by no more than `slack` [m/s].
    """
    mixed = counts & (branch != branch[0]).any(axis=0)
    return bool((mixed & (weight * np.ptp(dual, axis=0) > slack)).any())


def bounds(rows: Rows, point: Point) -> tuple[Array, Array]:
    """Return the (n,) smallest and largest force of touching or held contacts."""
    law = rows.law(point.overlap)
    held = point.branch == HELD
    return np.where(held, (1.0 - rows.loss) * law, 0.0), np.where(held, law, rows.preload)


def next_corner(tableau: Tableau, rows: Rows, stages: Point, h: float, speed: float, allowed: float) -> float:
    """Return the longest next step [s] towards the first zero of a guard function.

    The zero is predicted from the value, slope and curvature at the end of the step. A step may cross the onset of a
    force without preload if the force changes no velocity by more than `allowed` [m/s].
    """
    point = stages.last()
    acceleration = rows.acceleration(point.force, point.friction)
    closing = rows.closing(acceleration)
    branch = point.branch
    # Find openings and closings as roots of a parabola through the gap.
    sign = np.where(branch == OPEN, 1.0, -1.0)
    gap = sign * point.overlap
    times = np.where(
        (gap < 0.0) & ((branch == OPEN) | (branch >= PRESSED)) & (np.abs(point.rate) > SLOW * speed),
        _first_roots(gap, sign * point.rate, sign * closing),
        NEVER,
    )
    # Velocity change by the force at the mirrored gap. If it is small, the step may continue to the other side.
    moved = 2.0 * times * rows.response.diagonal()[: rows.contacts] * rows.law(np.abs(gap))
    found = float(np.where(moved <= allowed, 2.0 * times, APPROACH * times).min())
    return min(found, APPROACH * _next_kink(tableau, rows, stages, closing, acceleration, h, allowed))


def _next_kink(
    tableau: Tableau, rows: Rows, stages: Point, closing: Array, acceleration: Array, h: float, allowed: float
) -> float:
    """Return the time [s] until the next event of a force, a contact with loss, or the bed.

    A multiplier reaches a bound, an overlap rate with loss reaches 0, or a velocity on the bed reaches 0.
    """
    point, found = stages.last(), NEVER
    branch = point.branch
    # Find the times at which contacts with loss may reverse.
    if rows.loss.any():
        turning = (
            (rows.loss > 0.0)
            & (np.abs(point.rate) > STANDS * allowed)
            & ((branch == PRESSED) | (branch == RELEASED))
            & (point.overlap > 0.0)
        )
        toward = np.where(branch == PRESSED, -1.0, 1.0)
        found = min(found, _ahead((toward * point.rate)[turning], (toward * closing)[turning]))
    # Find the times at which the force of a touching or held contact may reach a bound.
    fixed = (branch == TOUCHING) | (branch == HELD)
    degree = np.arange(tableau.stages)
    at_end = (degree * (degree + 1) / h) @ tableau.legendre  # Weights from values at the nodes to the slope at the end.
    if fixed.any():
        low, high = bounds(rows, point)
        slope = at_end @ stages.force
        found = min(found, _ahead((low - point.force)[fixed], -slope[fixed]))
        found = min(found, _ahead((point.force - high)[fixed], slope[fixed]))
    # Find the times at which beads may stop or break loose.
    if rows.bed.size:
        slides, sticks = point.side != STICKS, (point.side == STICKS) & (rows.bed > 0.0)
        found = min(found, _ahead((-point.side * point.velocity)[slides], (-point.side * acceleration)[slides]))
        slope = at_end @ stages.friction
        found = min(found, _ahead((point.friction - rows.bed)[sticks], slope[sticks]))
        found = min(found, _ahead((-point.friction - rows.bed)[sticks], -slope[sticks]))
    return found


def _ahead(value: Array, slope: Array) -> float:
    """Return the first time at which a straight line that begins at a value < 0 reaches 0."""
    rising = (value < 0.0) & (slope > 0.0)
    return float((-value[rising] / slope[rising]).min()) if rising.any() else NEVER


def _first_roots(value: Array, slope: Array, curvature: Array) -> Array:
    """Return the first times at which parabolas that begin at values < 0 reach 0."""
    square = slope**2 - 2.0 * curvature * value
    root = np.sqrt(np.maximum(square, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        time = np.where(slope > 0.0, -2.0 * value / (slope + root), (root - slope) / curvature)
    valid = (square >= 0.0) & (time > 0.0) & ((slope > 0.0) | (curvature > 0.0))
    return np.where(valid, time, NEVER)
