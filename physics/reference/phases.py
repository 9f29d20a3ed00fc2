"""Phases of the reference solution. During a phase, no unilateral constraint changes its mode, so the right-hand side
is smooth.

A constraint ("row") is either one side of a contact (pushing or pulling) or the friction of a bead on the bed. A side
has the displacement d, its rate w and the force f. A bead has the velocity v and the friction r. F is the preload, K
the stiffness, a the exponent, l the loss, R the largest friction, and C the capacity. The modes are:

    OPEN      d < 0           f = 0                       until d = 0
    TOUCHING  d = 0, w = 0    f the multiplier of w' = 0  until f leaves [0, C]
    LOADED    d > 0           f = F + K d**a              until d = 0, with loss until w < 0
    HELD      d > 0, w = 0    f the multiplier of w' = 0  until f leaves [(1 - l) (F + K d**a), F + K d**a]
    RELEASED  d > 0, w < 0    f = (1 - l) (F + K d**a)    until d = 0 or w > 0
    SLIDES    v != 0          r = R sign(v)               until v = 0
    STICKS    v = 0           r the multiplier of v' = 0  until r leaves [-R, R]

A side with several segments is on one of them. A phase ends when it passes on to the next segment. A pulling side is
OPEN until its coupler has coupled.

    d' = w,   w' = B M^-1 (push - B^T f)          B: (p, n+1), maps the velocities of the beads to the
    velocities of the rows

On strings, the term omega² (r - d) is added to w', where r is the overlap at rest.

The capacity C is the force of the law at the smallest overlap that the tolerance distinguishes from 0. The capacity
exceeds the preload F. Without this capacity, overlaps inside a rigid-like cluster behind a soft interface would start
at 1e-100, and no step could follow them. At a switch, Gauss's principle decides which constraints move on. This
principle requires accelerations as close as possible to the free ones, with multipliers inside their bounds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear
from scipy.sparse.csgraph import connected_components
from softcradle.physics.chain import GRAVITY, Chain
from softcradle.physics.reference.laws import Laws
from softcradle.physics.reference.spans import Span
from softcradle.physics.scales import speed_scale
from softcradle.physics.state import State, coupled_of, from_anchor, rest_of

Array = NDArray[np.float64]
Modes = NDArray[np.int8]
Which = NDArray[np.bool_]

OPEN, TOUCHING, LOADED, HELD, RELEASED = 0, 1, 2, 3, 4  # modes of contacts
FREE, BACKWARD, STICKS, FORWARD = 5, 6, 7, 8  # modes of beads. A bead is FREE if nothing brakes it.
FIXED = TOUCHING, HELD, STICKS
# Three modes for each kind of constraint: with the multiplier at its lower bound, between its bounds, and at its upper
# bound.
AT_REST = {"corner": (OPEN, TOUCHING, LOADED), "turn": (RELEASED, HELD, LOADED), "bed": (BACKWARD, STICKS, FORWARD)}

# Allowed local error of a step, as a fraction of the wanted error of the run. With this small fraction, the errors of
# thousands of steps together stay below the wanted error.
RELATIVE_SMOOTH = 1e-4
RELATIVE_STIFF = 1e-3  # The same fraction for stiff contacts. Their steps damp errors, so the fraction may be larger.
# Factor of the local error if a contact side has several segments. Beyond a stop, a small part of the displacement
# matters.
OUTER = 0.1
FINEST = 3e-14  # Smallest relative tolerance that is possible in double precision.
SLACK = 1e-12  # Distance of a multiplier from its bounds that ends the phase, relative to the largest multiplier.
BALANCE_ROUND_OFF = 1e-15  # Rounding error of a multiplier, relative to the forces that it balances.
# Fraction of the largest eigenvalue. Constraints with a smaller eigenvalue count as linearly dependent.
SINGULAR = 1e-13
TINY = float(np.finfo(np.float64).tiny)
# Factor of the smallest bounce energy with loss. Smaller bounces would never end, because each is as small as the error
# of its start time.
SETTLED = 8.0
# Fraction of each external force on a bead. If fixed constraints leave less than this fraction, they hold the bead. It
# allows for rounding errors.
STILL = 1e-9
# Largest number of evaluations of a run. Each takes about 100 us, so the run takes some minutes.
MOST_EVALUATIONS = 3_000_000


class OutOfEvaluationsError(Exception):
    """Error for a run that has used all its allowed evaluations."""


class System:
    """Chain as NumPy arrays: the laws and bounds of its p constraints, and the smallest values that the tolerance
    distinguishes from 0.

    The state vector y (m+n+2,) contains the overlaps of the m sides of contacts, the rates of the n joints between
    neighbours, and the position and velocity of the anchor bead.
    """

    def __init__(self, chain: Chain, state: State, tolerance: float, duration: float | None) -> None:
        self.speed = speed = speed_scale(chain, state.velocity(chain), duration)
        self.laws = laws = Laws(chain, speed)
        self.chain, self.n, self.m = chain, chain.contacts, laws.joint.size
        external = state.external(chain)
        self.steady = np.zeros(self.n + 1) if external is None else external
        self.bed = chain.finite_mass * GRAVITY * chain.friction
        self.rest, self.place = rest_of(chain)  # Overlaps and anchor position of beads on strings at rest
        self.first = np.unique(laws.joint, return_index=True)[1]  # the pushing side of each joint
        # Matrix that maps the velocities of beads to the velocities of constraints. Its rows are differences of
        # neighbours. On a bed, it also has a row for each bead.
        difference = np.eye(self.n, self.n + 1) - np.eye(self.n, self.n + 1, 1)
        contacts = laws.side[:, None] * difference[laws.joint]
        self.rows = np.vstack((contacts, np.eye(self.n + 1))) if chain.on_bed else contacts
        self.coupling = self.rows * chain.inverse_mass @ self.rows.T
        self.response = np.where(self.coupling.diagonal() > 0.0, self.coupling.diagonal(), 1.0)
        self.evaluations, self.most_evaluations = 0, MOST_EVALUATIONS
        # An overlap d with the energy F d changes velocities in proportion to sqrt(d). Therefore the smallest overlap
        # is proportional to the square of the tolerance.
        self.least_overlap = laws.depth * tolerance**2
        self.least_rate = 1e-3 * tolerance * speed
        self.coupled = np.ones(self.n, dtype=bool)
        if chain.has_segments:
            self.coupled = coupled_of(chain, state) != 0
        first = np.zeros(self.m, dtype=np.int64)
        self.capacity = laws.force(self.least_overlap, first, first > 0)
        # With loss, a slower bounce would not exceed the smallest overlap. This overlap is also the error with which
        # its start is located.
        with np.errstate(divide="ignore", invalid="ignore"):
            square = SETTLED * self.response[: self.m] * self.capacity * self.least_overlap / laws.loss[0]
        self.least_bounce = np.where(laws.loss[0] > 0.0, np.sqrt(square), 0.0)
        part = (RELATIVE_STIFF if laws.stiff else RELATIVE_SMOOTH) * (OUTER if len(laws.begin) > 1 else 1.0)
        self.relative = relative = max(part * tolerance, FINEST)
        # Absolute tolerances of the integrator for the overlaps, the rates, and the position and velocity of the anchor
        # bead.
        anchor = [float(laws.depth.max()) * relative, speed * relative]
        self.absolute = np.concatenate((0.1 * self.least_overlap, np.full(self.n, 0.1 * relative * speed), anchor))

    def start(self, state: State) -> Array:
        """Return the state vector of `state`."""
        overlap = self.laws.side * (state.overlap[self.laws.joint] - self.laws.origin)
        return np.concatenate((overlap, state.rate, state.anchor))

    def velocity(self, y: Array) -> Array:
        """Return the (..., n+1) velocities [m/s] of the beads."""
        return from_anchor(y[..., self.m : self.m + self.n], y[..., -1], self.chain.anchor)

    def pull(self, y: Array) -> Array:
        """Return the (..., n) accelerations [m/s²] of the joints by the strings. The accelerations are directed towards
        the overlaps at rest.
        """
        overlap = self.laws.origin[self.first] + self.laws.side[self.first] * y[..., self.first]
        return self.chain.swing * (self.rest - overlap)

    def string_forces(self, y: Array) -> Array:
        """Return the (n+1,) forces [N] of the strings on the beads."""
        pulled = from_anchor(self.pull(y), self.chain.swing * (self.place - y[-2]), self.chain.anchor)
        return self.chain.finite_mass * pulled

    def row_velocity(self, y: Array) -> Array:
        """Return the (..., p) velocities [m/s] of the constraints.

        The velocities of contacts are computed from the overlap rates, because these are accurate even if they are
        small.
        """
        rate = self.laws.side * y[..., self.m : self.m + self.n][..., self.laws.joint]
        return np.concatenate((rate, self.velocity(y)), axis=-1) if self.chain.on_bed else rate

    def section(self, y: Array) -> NDArray[np.int64]:
        """Return the (m,) index of the segment that each side of a contact is on, or that it enters."""
        return self.laws.section(y[: self.m], self.row_velocity(y)[: self.m], 2.0 * self.least_overlap)

    def on_joints(self, force: Array) -> Array:
        """Return the (..., n) forces between neighbours [N]. The forces are negative if contacts pull.

        The argument contains the forces of the sides of contacts (..., m), or of all constraints (..., p).
        """
        on = (self.laws.joint[:, None] == np.arange(self.n)) * self.laws.side[:, None]
        return force[..., : self.m] @ on + 0.0

    def acts(self) -> Which:
        """Return True for each side (m,) of a contact that can act. A pulling side acts only if its coupler has
        coupled.
        """
        return (self.laws.side > 0.0) | self.coupled[self.laws.joint]

    def push(self, time: Any, span: Span) -> Array:
        """Return the (..., n+1) external forces [N] at `time` (...)."""
        return self.steady + span.push_at(time) if self.chain.forces else self.steady

    def brake(self, time: Any, span: Span) -> Array:
        """Return the (..., n+1) friction [N] of sliding beads at `time` (...). The friction includes the bed and the
        brakes.
        """
        return self.bed + span.brake_at(time) * np.isfinite(self.chain.mass) if self.chain.brakes else self.bed

    def least_turn(self, overlap: Array) -> Array:
        """Return the (..., m) rates [m/s] below which contacts with loss count as resting.

        These rates are proportional to the overlap.
        """
        return self.least_rate * np.clip(overlap / self.laws.depth, 0.0, 1.0)


@dataclass
class Phase:
    """Interval of time in which no constraint changes its mode, and no contact changes its segment `section` (m,).

    Constraints at rest are fixed by multipliers. `solved` (p, p) maps the external forces to these multipliers, and
    `carried` (p, p) maps the forces of the other constraints to these multipliers. The multipliers prevent motion of
    the joints marked in `stands` (n,) and of the beads marked in `still` (n+1,).
    """

    system: System
    span: Span
    mode: Modes
    section: NDArray[np.int64]

    def __post_init__(self) -> None:
        system, mode, m = self.system, self.mode, self.system.m
        pushes = (system.laws.side > 0.0) & (mode[:m] != OPEN)
        system.coupled[system.laws.joint[pushes]] = True
        self.loss = system.laws.loss_in(self.section)
        fixed = np.isin(mode, FIXED)
        self.fixed = fixed
        self.unloading = mode[:m] == RELEASED
        self.pressed = self.unloading | (mode[:m] == LOADED)
        self.side = np.where(mode[m:] == FORWARD, 1.0, np.where(mode[m:] == BACKWARD, -1.0, 0.0))
        # Sign for which the distance by overlap is positive; 0 if the mode does not end by its overlap.
        self.way = np.where(self.pressed, 1.0, np.where((mode[:m] == OPEN) & system.acts(), -1.0, 0.0))
        turn = np.where(mode[:m] == RELEASED, -1.0, (mode[:m] == LOADED) * 1.0) * (self.loss > 0.0)
        self.turn = np.concatenate((turn, self.side))
        self.stands = np.zeros(system.n, dtype=bool)
        self.stands[system.laws.joint[fixed[:m]]] = True
        self.carried, self.solved = np.zeros((mode.size, mode.size)), np.zeros((mode.size, mode.size))
        if fixed.any():
            at, size = np.ix_(fixed, fixed), np.sqrt(system.response[fixed])
            scaled = system.coupling[at] / np.outer(size, size)
            # Use the pseudo-inverse. Multipliers are not unique between two walls, or between beads that stick.
            self.solved[at] = np.linalg.pinv(scaled, SINGULAR, hermitian=True) / np.outer(size, size)
            self.carried = -self.solved @ system.coupling
            self.carried[:, fixed] = 0.0
        moves = np.eye(system.n + 1) - system.chain.inverse_mass[:, None] * (system.rows.T @ self.solved @ system.rows)
        self.still = np.abs(moves).max(axis=1) < STILL
        self.stands |= self.still[:-1] & self.still[1:]

    def given(self, time: Any, y: Array) -> Array:
        """Return the (..., p) forces [N] of all constraints that are not fixed. These forces follow from contact laws
        and friction.
        """
        system = self.system
        force = system.laws.force(y[..., : system.m], self.section, self.unloading)
        found: Array = np.where(self.pressed, force, 0.0)
        if not self.side.size:
            return found
        brake = np.broadcast_to(self.side * system.brake(time, self.span), (*found.shape[:-1], self.side.size))
        return np.concatenate((found, brake), axis=-1)

    def force(self, time: Any, y: Array) -> Array:
        """Return the (..., p) forces [N] of all constraints. The forces of fixed constraints are multipliers."""
        found, system = self.given(time, y), self.system
        if self.fixed.any():
            pushed = (system.push(time, self.span) * system.chain.inverse_mass) @ system.rows.T
            if system.chain.swing:
                pushed = pushed + system.laws.side * system.pull(y)[..., system.laws.joint]
            found = found + found @ self.carried.T + pushed @ self.solved.T
        return found

    def slope(self, time: float, y: Array) -> Array:
        """Return the right-hand side: the (m+n+2,) time derivative of y."""
        system, m = self.system, self.system.m
        system.evaluations += 1
        if system.evaluations > system.most_evaluations:
            raise OutOfEvaluationsError
        net = system.push(time, self.span) - self.force(time, y) @ system.rows
        acceleration = net * system.chain.inverse_mass
        acceleration[self.still] = 0.0
        rate = y[m:-2]
        closing = acceleration[:-1] - acceleration[1:]
        if system.chain.swing:
            closing = closing + system.pull(y)
            acceleration[system.chain.anchor] += system.chain.swing * (system.place - y[-2])
        closing = np.where(self.stands, 0.0, closing)
        return np.concatenate(
            (system.laws.side * rate[system.laws.joint], closing, (y[-1], acceleration[system.chain.anchor]))
        )

    def jacobian(self, y: Array) -> Array:
        """Return the (m+n+2, m+n+2) derivative of the right-hand side."""
        system, m, n = self.system, self.system.m, self.system.n
        stiffness = self.pressed * system.laws.slope(y[:m], self.section, self.unloading)
        by_overlap = (np.eye(self.mode.size, m) + self.carried[:, :m]) * stiffness
        acceleration = -(system.rows.T @ by_overlap) * system.chain.inverse_mass[:, None]
        acceleration[self.still] = 0.0
        matrix = np.zeros((y.size, y.size))
        matrix[np.arange(m), m + system.laws.joint] = system.laws.side
        matrix[m : m + n, :m] = np.where(self.stands[:, None], 0.0, acceleration[:-1] - acceleration[1:])
        matrix[-2, -1] = 1.0
        matrix[-1, :m] = acceleration[system.chain.anchor]
        if system.chain.swing:
            hangs = np.flatnonzero(~self.stands)
            matrix[m + hangs, system.first[hangs]] -= system.chain.swing * system.laws.side[system.first[hangs]]
            matrix[-1, -2] -= system.chain.swing
        return matrix

    def guards(self, time: Any, y: Array) -> tuple[Array, Array, Array]:
        """Return the distance of each constraint from its next switch: by its overlap (..., m), its velocity (..., p)
        and its multiplier (..., p).

        The three distances are relative to the depth, the speed and the bound of the multiplier. A distance is negative
        after the switch, and infinite if the switch is impossible. A small tolerance prevents a constraint from
        switching back immediately because of rounding errors.
        """
        system, m = self.system, self.system.m
        overlap = y[..., :m]
        by_overlap = np.where(self.way != 0.0, (self.way * overlap + system.least_overlap) / system.laws.depth, np.inf)
        least = np.concatenate(
            (system.least_turn(overlap), np.full((*overlap.shape[:-1], self.side.size), system.least_rate)), -1
        )
        velocity = self.turn * system.row_velocity(y)
        by_velocity = np.where(self.turn != 0.0, (velocity + least) / system.speed, np.inf)
        if not self.fixed.any():
            return by_overlap, by_velocity, np.full(by_velocity.shape, np.inf)
        force = self.force(time, y)
        low, high = self.bounds(time, y)
        inside = (np.minimum(force - low, high - force) + self.noise(force)) / np.maximum(high, TINY) + SLACK
        return by_overlap, by_velocity, np.where(self.fixed, inside, np.inf)

    def by_section(self, y: Array) -> Array:
        """Return the (..., m) distance of each side of a contact from the ends of its segment, as a fraction of its
        depth.

        The distance is one of the `guards`.
        """
        system, m = self.system, self.system.m
        laws, rows, overlap = system.laws, np.arange(m), y[..., :m]
        begin, end = laws.begin[self.section, rows], laws.end[self.section, rows]
        inside = np.minimum(np.where(self.section > 0, overlap - begin, np.inf), end - overlap)
        return np.where(self.mode[:m] >= LOADED, (inside + system.least_overlap) / laws.depth, np.inf)

    def noise(self, force: Array) -> Array:
        """Return the (..., p) rounding errors of the multipliers among the `force` (..., p) of all constraints."""
        return BALANCE_ROUND_OFF * (np.abs(force) @ np.abs(self.system.coupling)) / self.system.response

    def carries(self, time: Any, y: Array) -> Which:
        """Return True for each contact side (..., m) that pushes.

        Its overlap must exceed the smallest one, or its multiplier must exceed the rounding error.
        """
        force, m = self.force(time, y), self.system.m
        held: Which = (force > self.noise(force))[..., :m] & self.fixed[:m]
        pressed: Which = self.pressed & (y[..., :m] > 2.0 * self.system.least_overlap)
        return held | pressed

    def bounds(self, time: Any, y: Array) -> tuple[Array, Array]:
        """Return the (..., p) smallest and largest multipliers [N] of fixed constraints."""
        system, m = self.system, self.system.m
        held = self.mode[:m] == HELD
        law = np.where(held, system.laws.force(y[..., :m], self.section, ~held), system.capacity)
        low = np.where(held, system.laws.force(y[..., :m], self.section, held), 0.0)
        if not self.side.size:
            return low, law
        brake = np.maximum(system.brake(time, self.span), TINY)
        brake = np.broadcast_to(brake, (*law.shape[:-1], self.side.size))
        return np.concatenate((low, -brake), -1), np.concatenate((law, brake), -1)

    def margin(self, time: Any, y: Array) -> Array:
        """Return the (..., p) smallest distance of each constraint from a switch, see `guards`."""
        by_overlap, by_velocity, inside = self.guards(time, y)
        found: Array = np.minimum(by_velocity, inside)
        by_overlap = np.minimum(by_overlap, self.by_section(y))
        found[..., : self.system.m] = np.minimum(found[..., : self.system.m], by_overlap)
        return found

    def shown_overlap(self, overlap: Array, force: Array) -> Array:
        """Return the (m,) overlaps for samples.

        A contact without preload that counts as touching gets the overlap at which its law has the current force.
        """
        resting = self.mode[: self.system.m] == TOUCHING
        if not resting.any():
            return overlap
        return np.where(resting, self.system.laws.resting_overlap(force, overlap), overlap)


def first_phase(system: System, span: Span, time: float, y: Array) -> Phase:
    """Return the phase at the start of a run. Overlaps and velocities determine it."""
    m = system.m
    mode = np.full(system.rows.shape[0], FREE, dtype=np.int8)
    backs = (system.laws.loss_in(system.section(y)) > 0.0) & (system.row_velocity(y)[:m] < 0.0)
    pressed = (y[:m] > 0.0) & system.acts()
    mode[:m] = np.where(pressed, np.where(backs, RELEASED, LOADED), OPEN)
    phase = Phase(system, span, mode, system.section(y))
    return next_phase(phase, span, time, y, (np.abs(y[:m]) <= system.least_overlap) & system.acts())


def switched_phase(phase: Phase, time: float, y: Array) -> Phase:
    """Return the phase right after a switch.

    The constraints closest to their switch, or beyond it, are the ones that switch.
    """
    by_overlap, by_velocity, inside = phase.guards(time, y)
    past = max(0.0, float(min(by_overlap.min(), by_velocity.min(), inside.min(), phase.by_section(y).min())))
    return next_phase(phase, phase.span, time, y, by_overlap <= past, by_velocity <= past)


def next_phase(before: Phase, span: Span, time: float, y: Array, closing: Which, turning: Which | None = None) -> Phase:
    """Return the phase after `before`. The overlaps of contacts in `closing` are set to exactly 0 in `y`.

    The contacts `closing` (m,) have reached overlap 0, and the constraints `turning` (p,) have reached velocity 0.
    """
    system, m, mode = before.system, before.system.m, before.mode.copy()
    overlap, velocity = y[:m], system.row_velocity(y)
    if turning is not None:
        velocity[turning] = 0.0
    _brake(system, span, time, mode, velocity)
    section = system.section(y)
    loss = system.laws.loss_in(section)
    # Constraints whose velocity is too small for the tolerance, and contacts whose next bounce would be too small.
    slow = np.abs(velocity) <= 2.0 * system.least_rate
    slow[:m] |= np.abs(velocity[:m]) <= system.least_bounce
    # These contacts are being compressed from overlap 0. The switch of another constraint must not stop them.
    yields = (mode[:m] == LOADED) & (velocity[:m] > 0.0)
    corner = (mode[:m] == TOUCHING) | (
        slow[:m] & ~yields & (np.abs(overlap) <= 2.0 * system.least_overlap) & system.acts()
    )
    # Contacts with loss that come to rest while compressed. Such contacts are between loading and unloading.
    turns = (mode[:m] == LOADED) | (mode[:m] == RELEASED)
    turns &= (loss > 0.0) & (np.abs(velocity[:m]) <= 2.0 * system.least_turn(overlap))
    turns |= mode[:m] == HELD
    # Contacts that reach overlap 0 at some speed change directly to LOADED or OPEN.
    overlap[closing | corner] = 0.0
    mode[:m][closing & ~corner] = np.where(velocity[:m] >= 0.0, LOADED, OPEN)[closing & ~corner]
    corner |= closing & slow[:m]
    kinds = {
        "corner": np.append(corner, np.zeros(mode.size - m, dtype=bool)),
        "turn": np.append(turns & ~corner & ~closing, np.zeros(mode.size - m, dtype=bool)),
        "bed": (mode >= BACKWARD) & (slow | (mode == STICKS)),
    }
    resting = np.logical_or.reduce(list(kinds.values()))
    # First assume that all other constraints rest. Then Gauss's principle decides which constraints move on, and in
    # which direction.
    if resting.any():
        for kind, rows in kinds.items():
            mode[rows] = AT_REST[kind][1]
        rests = Phase(system, span, mode, section)
        _stop(rests, y)
        overlap[corner] = system.least_overlap[corner]
        chosen = _moving(rests, time, y, resting)
        for kind, rows in kinds.items():
            mode[rows] = np.array(AT_REST[kind])[1 + chosen[rows]]
        overlap[corner & (mode[:m] != LOADED)] = 0.0
    return Phase(system, span, mode, section)


def _brake(system: System, span: Span, time: float, mode: Modes, velocity: Array) -> None:
    """Update, in place, the modes of beads at which braking begins or ends."""
    beads, m = mode[system.m :], system.m
    if beads.size:
        braked = system.brake(time, span) > 0.0
        begins = braked & (beads == FREE)
        beads[begins] = np.where(velocity[m:] >= 0.0, FORWARD, BACKWARD)[begins]
        beads[~braked] = FREE


def _stop(rests: Phase, y: Array) -> None:
    """Set the velocities of constraints at rest to 0, in place.

    Impulses between the beads change the velocities, so momentum is conserved.
    """
    system, rate = rests.system, y[rests.system.m : -2]
    left = (rests.solved @ system.row_velocity(y)) @ system.rows * system.chain.inverse_mass
    rate -= left[:-1] - left[1:]
    y[-1] -= left[system.chain.anchor]
    rate[rests.stands] = 0.0
    if rests.still[system.chain.anchor]:
        y[-1] = 0.0


def _moving(rests: Phase, time: float, y: Array, resting: Which) -> NDArray[np.int8]:
    """Return for each constraint (p,) the direction in which it moves on.

    The direction is -1 or 1 if the multiplier of a `resting` constraint is at a bound, and 0 if the constraint stays at
    rest. Gauss's principle minimises |M^(-1/2) (push - B^T f)| over multipliers f inside their bounds. A constraint at
    its smallest multiplier opens or turns back. A constraint at its largest multiplier is compressed. Constraints that
    share no bead are solved in separate groups, because their forces may differ by orders of magnitude.
    """
    system, chosen = rests.system, np.zeros(resting.size, dtype=np.int8)
    root = np.sqrt(system.chain.inverse_mass)
    given, push = rests.given(time, y), system.push(time, rests.span)
    if system.chain.swing:
        push = push + system.string_forces(y)
    free = root * (push - given @ system.rows)
    balanced = root * (np.abs(push) + np.abs(given) @ np.abs(system.rows))
    low, high = rests.bounds(time, y)
    places = np.flatnonzero(resting)
    count, group = connected_components(system.coupling[np.ix_(places, places)] != 0.0, directed=False)
    for one in range(count):
        at = places[group == one]
        size = np.sqrt(system.response[at])
        matrix = (root * system.rows[at] / size[:, None]).T
        moved = matrix.any(axis=1)
        scale = float(balanced[moved].max()) or 1.0
        # Allow for rounding errors, so that a multiplier at its bound stays there.
        room = 0.5 * BALANCE_ROUND_OFF * (np.abs(matrix).T @ balanced) / scale + TINY
        bounds = low[at] * size / scale - room, high[at] * size / scale + room
        found = lsq_linear(matrix[moved], free[moved] / scale, bounds, "bvls", tol=1e-15, max_iter=10 * at.size)
        chosen[at] = found.active_mask
    return chosen
