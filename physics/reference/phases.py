"""Phases of the reference: while no row of a chain changes its mode, the right-hand side is smooth.

A row is a contact, each part of a coupler for itself, or a bead on the bed. With its overlap d, or the velocity v of the bead:

    OPEN      d < 0           f = 0                       until d = 0
    TOUCHING  d = 0, w = 0    f the multiplier of w' = 0  until f leaves [0, C]
    LOADED    d > 0           f = F + K d**a              until d = 0, with loss until w < 0
    HELD      d > 0, w = 0    f the multiplier of w' = 0  until f leaves [(1 - l) (F + K d**a), F + K d**a]
    RELEASED  d > 0, w < 0    f = (1 - l) (F + K d**a)    until d = 0 or w > 0
    SLIDES    v != 0          r = R sign(v)               until v = 0
    STICKS    v = 0           r the multiplier of v' = 0  until r leaves [-R, R]

    d' = w,   w' = B M^-1 (push - B^T f)          B: (p, n+1), the velocities of the rows from those of the beads

The capacity C is the law's force at the least overlap that the tolerance distinguishes from 0, so it exceeds the preload F:
inside a rigid-like cluster the beads behind a soft interface start with overlaps of 1e-100, which no step could follow.
Which rows move on at a switch is Gauss's principle: accelerations nearest to the free ones, with multipliers in their bounds.
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
from softcradle.physics.state import State, from_anchor

Array = NDArray[np.float64]
Modes = NDArray[np.int8]
Which = NDArray[np.bool_]

OPEN, TOUCHING, LOADED, HELD, RELEASED = 0, 1, 2, 3, 4  # of contacts
FREE, BACKWARD, STICKS, FORWARD = 5, 6, 7, 8  # of beads, FREE where nothing brakes
FIXED = TOUCHING, HELD, STICKS
# of each kind of row: the mode at the least multiplier, that between the bounds, the mode at the largest
AT_REST = {"corner": (OPEN, TOUCHING, LOADED), "turn": (RELEASED, HELD, LOADED), "bed": (BACKWARD, STICKS, FORWARD)}

RELATIVE_SMOOTH = 1e-4  # local error of a step in parts of the wanted error, so that thousands of steps stay below it
RELATIVE_STIFF = 1e-3  # the same with stiff contacts, whose steps are damped
FINEST = 3e-14  # smallest relative tolerance that double precision allows
SLACK = 1e-12  # of its largest: a multiplier further than this outside of its bounds ends the phase
BALANCE_ROUND_OFF = 1e-15  # of the forces that a multiplier balances: it is known no better
SINGULAR = 1e-13  # of the largest eigenvalue: motions that multipliers share below it are one
TINY = float(np.finfo(np.float64).tiny)
SETTLED = 8.0  # times the energy at which bounces with loss would go on for ever, each by what the one before was late
STILL = 1e-9  # part of any push that a bead feels which the fixed rows hold in its place: round-off
MOST_EVALUATIONS = 3_000_000  # of a run: some minutes, at about 100 us each


class OutOfEvaluationsError(Exception):
    """The run has used all evaluations that it may."""


class System:
    """A chain as NumPy arrays: its p rows, their laws and bounds, and what the tolerance distinguishes.

    The state vector y (m+n+2,) is overlaps of the m contacts, rates of the n joints, anchor position, anchor velocity.
    """

    def __init__(self, chain: Chain, state: State, tolerance: float, duration: float | None) -> None:
        self.speed = speed = speed_scale(chain, state.velocity(chain), duration)
        self.laws = laws = Laws(chain, speed)
        self.chain, self.n, self.m = chain, chain.contacts, laws.joint.size
        external = state.external(chain)
        self.steady = np.zeros(self.n + 1) if external is None else external
        self.bed = chain.finite_mass * GRAVITY * chain.friction
        difference = np.eye(self.n, self.n + 1) - np.eye(self.n, self.n + 1, 1)
        contacts = laws.side[:, None] * difference[laws.joint]
        self.rows = np.vstack((contacts, np.eye(self.n + 1))) if chain.on_bed else contacts
        self.coupling = self.rows * chain.inverse_mass @ self.rows.T
        self.response = np.where(self.coupling.diagonal() > 0.0, self.coupling.diagonal(), 1.0)
        self.evaluations, self.most_evaluations = 0, MOST_EVALUATIONS
        # an overlap d of energy F d changes velocities by the square root of d
        self.least_overlap = laws.depth * tolerance**2
        self.least_rate = 1e-3 * tolerance * speed
        self.capacity = laws.force(self.least_overlap)
        # with loss a bounce at less comes to no more than the least overlap, by which each is located late
        with np.errstate(divide="ignore", invalid="ignore"):
            square = SETTLED * self.response[: self.m] * self.capacity * self.least_overlap / laws.loss
        self.least_bounce = np.where(laws.loss > 0.0, np.sqrt(square), 0.0)
        self.relative = relative = max((RELATIVE_STIFF if laws.stiff else RELATIVE_SMOOTH) * tolerance, FINEST)
        anchor = [float(laws.depth.max()) * relative, speed * relative]
        self.absolute = np.concatenate((0.1 * self.least_overlap, np.full(self.n, 0.1 * relative * speed), anchor))

    def start(self, state: State) -> Array:
        """The state vector of `state`."""
        overlap = self.laws.side * (state.overlap[self.laws.joint] - self.laws.origin)
        return np.concatenate((overlap, state.rate, state.anchor))

    def velocity(self, y: Array) -> Array:
        """(..., n+1) velocities [m/s] of the beads."""
        return from_anchor(y[..., self.m : self.m + self.n], y[..., -1], self.chain.anchor)

    def row_velocity(self, y: Array) -> Array:
        """(..., p) velocities [m/s] of the rows: of contacts from the rates, which are small where overlaps are."""
        rate = self.laws.side * y[..., self.m : self.m + self.n][..., self.laws.joint]
        return np.concatenate((rate, self.velocity(y)), axis=-1) if self.chain.on_bed else rate

    def on_joints(self, force: Array) -> Array:
        """(..., n) forces between neighbours [N] from those (..., m or p) of contacts; negative where they pull."""
        on = (self.laws.joint[:, None] == np.arange(self.n)) * self.laws.side[:, None]
        return force[..., : self.m] @ on + 0.0

    def push(self, time: Any, span: Span) -> Array:
        """(..., n+1) forces from outside [N] at `time` (...)."""
        return self.steady + span.push_at(time) if self.chain.forces else self.steady

    def brake(self, time: Any, span: Span) -> Array:
        """(..., n+1) friction [N] of sliding beads at `time` (...), by bed and brakes."""
        return self.bed + span.brake_at(time) * np.isfinite(self.chain.mass) if self.chain.brakes else self.bed

    def least_turn(self, overlap: Array) -> Array:
        """(..., m) rates [m/s] below which contacts with loss do not move: the less, the less they are pressed."""
        return self.least_rate * np.clip(overlap / self.laws.depth, 0.0, 1.0)


@dataclass
class Phase:
    """An interval of time in which no row changes its mode.

    `solved` (p, p) gives the multipliers of fixed rows from the pushes, `carried` (p, p) from the forces of the others. They
    let no joint (n,) move that `stands` and no bead (n+1,) that is `still`.
    """

    system: System
    span: Span
    mode: Modes

    def __post_init__(self) -> None:
        system, mode, m = self.system, self.mode, self.system.m
        fixed = np.isin(mode, FIXED)
        self.fixed = fixed
        self.part = np.select([mode[:m] == LOADED, mode[:m] == RELEASED], [np.ones(m), 1.0 - system.laws.loss], 0.0)
        self.side = np.where(mode[m:] == FORWARD, 1.0, np.where(mode[m:] == BACKWARD, -1.0, 0.0))
        # the sign with which a guard of overlaps or of velocities is positive, 0 where there is none
        self.way = np.where(self.part > 0.0, 1.0, np.where(mode[:m] == OPEN, -1.0, 0.0))
        turn = np.where(mode[:m] == RELEASED, -1.0, (mode[:m] == LOADED) * 1.0) * (system.laws.loss > 0.0)
        self.turn = np.concatenate((turn, self.side))
        self.stands = np.zeros(system.n, dtype=bool)
        self.stands[system.laws.joint[fixed[:m]]] = True
        self.carried, self.solved = np.zeros((mode.size, mode.size)), np.zeros((mode.size, mode.size))
        if fixed.any():
            at, size = np.ix_(fixed, fixed), np.sqrt(system.response[fixed])
            scaled = system.coupling[at] / np.outer(size, size)
            # pseudo-inverse: between two walls, or beads that stick, the multipliers are not unique
            self.solved[at] = np.linalg.pinv(scaled, SINGULAR, hermitian=True) / np.outer(size, size)
            self.carried = -self.solved @ system.coupling
            self.carried[:, fixed] = 0.0
        moves = np.eye(system.n + 1) - system.chain.inverse_mass[:, None] * (system.rows.T @ self.solved @ system.rows)
        self.still = np.abs(moves).max(axis=1) < STILL
        self.stands |= self.still[:-1] & self.still[1:]

    def given(self, time: Any, y: Array) -> Array:
        """(..., p) forces [N] of all rows that are not fixed: by the laws, and by friction."""
        system = self.system
        found: Array = np.where(self.part > 0.0, self.part * system.laws.force(y[..., : system.m]), 0.0)
        if not self.side.size:
            return found
        brake = np.broadcast_to(self.side * system.brake(time, self.span), (*found.shape[:-1], self.side.size))
        return np.concatenate((found, brake), axis=-1)

    def force(self, time: Any, y: Array) -> Array:
        """(..., p) forces [N] of all rows, multipliers where they are fixed."""
        found, system = self.given(time, y), self.system
        if self.fixed.any():
            pushed = (system.push(time, self.span) * system.chain.inverse_mass) @ system.rows.T
            found = found + found @ self.carried.T + pushed @ self.solved.T
        return found

    def slope(self, time: float, y: Array) -> Array:
        """Right-hand side: (m+n+2,) time derivative of y."""
        system, m = self.system, self.system.m
        system.evaluations += 1
        if system.evaluations > system.most_evaluations:
            raise OutOfEvaluationsError
        net = system.push(time, self.span) - self.force(time, y) @ system.rows
        acceleration = net * system.chain.inverse_mass
        acceleration[self.still] = 0.0
        rate = y[m:-2]
        closing = np.where(self.stands, 0.0, acceleration[:-1] - acceleration[1:])
        return np.concatenate(
            (system.laws.side * rate[system.laws.joint], closing, (y[-1], acceleration[system.chain.anchor]))
        )

    def jacobian(self, y: Array) -> Array:
        """(m+n+2, m+n+2) derivative of the slope."""
        system, m, n = self.system, self.system.m, self.system.n
        stiffness = self.part * system.laws.slope(y[:m])
        by_overlap = (np.eye(self.mode.size, m) + self.carried[:, :m]) * stiffness
        acceleration = -(system.rows.T @ by_overlap) * system.chain.inverse_mass[:, None]
        acceleration[self.still] = 0.0
        matrix = np.zeros((y.size, y.size))
        matrix[np.arange(m), m + system.laws.joint] = system.laws.side
        matrix[m : m + n, :m] = np.where(self.stands[:, None], 0.0, acceleration[:-1] - acceleration[1:])
        matrix[-2, -1] = 1.0
        matrix[-1, :m] = acceleration[system.chain.anchor]
        return matrix

    def guards(self, time: Any, y: Array) -> tuple[Array, Array, Array]:
        """How far each row is from its next switch: by overlap (..., m), by velocity (..., p), by its multiplier (..., p).

        In parts of depth, speed and bound; negative past it, infinite where it cannot be. With the slack a row that has just
        switched does not switch back by round-off.
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

    def noise(self, force: Array) -> Array:
        """(..., p) round-off of the multipliers among the `force` (..., p) of all rows."""
        return BALANCE_ROUND_OFF * (np.abs(force) @ np.abs(self.system.coupling)) / self.system.response

    def carries(self, time: Any, y: Array) -> Which:
        """(..., m) whether each contact pushes: beyond the least overlaps, or with more than the round-off of multipliers."""
        force, m = self.force(time, y), self.system.m
        held: Which = (force > self.noise(force))[..., :m] & self.fixed[:m]
        pressed: Which = (self.part > 0.0) & (y[..., :m] > 2.0 * self.system.least_overlap)
        return held | pressed

    def bounds(self, time: Any, y: Array) -> tuple[Array, Array]:
        """(..., p) least and largest multiplier [N] of fixed rows."""
        system, m = self.system, self.system.m
        held = self.mode[:m] == HELD
        law = np.where(held, system.laws.force(y[..., :m]), system.capacity)
        low = np.where(held, (1.0 - system.laws.loss) * law, 0.0)
        if not self.side.size:
            return low, law
        brake = np.maximum(system.brake(time, self.span), TINY)
        brake = np.broadcast_to(brake, (*law.shape[:-1], self.side.size))
        return np.concatenate((low, -brake), -1), np.concatenate((law, brake), -1)

    def margin(self, time: Any, y: Array) -> Array:
        """(..., p) the least of the `guards` of each row."""
        by_overlap, by_velocity, inside = self.guards(time, y)
        found: Array = np.minimum(by_velocity, inside)
        found[..., : self.system.m] = np.minimum(found[..., : self.system.m], by_overlap)
        return found

    def shown_overlap(self, overlap: Array, force: Array) -> Array:
        """(m,) overlaps for samples: a contact without preload that counts as touching has the overlap of its force."""
        resting = self.mode[: self.system.m] == TOUCHING
        if not resting.any():
            return overlap
        return np.where(resting, self.system.laws.resting_overlap(force, overlap), overlap)


def first_phase(system: System, span: Span, time: float, y: Array) -> Phase:
    """The phase at the start of a run, from overlaps and velocities alone."""
    m = system.m
    mode = np.full(system.rows.shape[0], FREE, dtype=np.int8)
    backs = (system.laws.loss > 0.0) & (system.row_velocity(y)[:m] < 0.0)
    mode[:m] = np.where(y[:m] > 0.0, np.where(backs, RELEASED, LOADED), OPEN)
    return next_phase(Phase(system, span, mode), span, time, y, np.abs(y[:m]) <= system.least_overlap)


def switched_phase(phase: Phase, time: float, y: Array) -> Phase:
    """The phase right after the switch of the rows that are nearest to theirs, or past it."""
    by_overlap, by_velocity, inside = phase.guards(time, y)
    past = max(0.0, float(min(by_overlap.min(), by_velocity.min(), inside.min())))
    return next_phase(phase, phase.span, time, y, by_overlap <= past, by_velocity <= past)


def next_phase(before: Phase, span: Span, time: float, y: Array, closing: Which, turning: Which | None = None) -> Phase:
    """The phase after `before`: contacts `closing` (m,) are at overlap 0, rows `turning` (p,) at velocity 0, exactly in `y`."""
    system, m, mode = before.system, before.system.m, before.mode.copy()
    overlap, velocity = y[:m], system.row_velocity(y)
    if turning is not None:
        velocity[turning] = 0.0
    _brake(system, span, time, mode, velocity)
    slow = np.abs(velocity) <= 2.0 * system.least_rate
    slow[:m] |= np.abs(velocity[:m]) <= system.least_bounce
    # pressed in from a corner that it has left: the switch of another row does not hold it
    yields = (mode[:m] == LOADED) & (velocity[:m] > 0.0)
    corner = (mode[:m] == TOUCHING) | (slow[:m] & ~yields & (np.abs(overlap) <= 2.0 * system.least_overlap))
    turns = (mode[:m] == LOADED) | (mode[:m] == RELEASED)
    turns &= (system.laws.loss > 0.0) & (np.abs(velocity[:m]) <= 2.0 * system.least_turn(overlap))
    turns |= mode[:m] == HELD
    overlap[closing | corner] = 0.0
    mode[:m][closing & ~corner] = np.where(velocity[:m] >= 0.0, LOADED, OPEN)[closing & ~corner]
    corner |= closing & slow[:m]
    kinds = {
        "corner": np.append(corner, np.zeros(mode.size - m, dtype=bool)),
        "turn": np.append(turns & ~corner & ~closing, np.zeros(mode.size - m, dtype=bool)),
        "bed": (mode >= BACKWARD) & (slow | (mode == STICKS)),
    }
    resting = np.logical_or.reduce(list(kinds.values()))
    if resting.any():
        for kind, rows in kinds.items():
            mode[rows] = AT_REST[kind][1]
        rests = Phase(system, span, mode)
        _stop(rests, y)
        overlap[corner] = system.least_overlap[corner]
        chosen = _moving(rests, time, y, resting)
        for kind, rows in kinds.items():
            mode[rows] = np.array(AT_REST[kind])[1 + chosen[rows]]
        overlap[corner & (mode[:m] != LOADED)] = 0.0
    return Phase(system, span, mode)


def _brake(system: System, span: Span, time: float, mode: Modes, velocity: Array) -> None:
    """Give each bead that begins or ceases to be braked its mode, in place."""
    beads, m = mode[system.m :], system.m
    if beads.size:
        braked = system.brake(time, span) > 0.0
        begins = braked & (beads == FREE)
        beads[begins] = np.where(velocity[m:] >= 0.0, FORWARD, BACKWARD)[begins]
        beads[~braked] = FREE


def _stop(rests: Phase, y: Array) -> None:
    """Set the velocities of rows at rest to 0, in place, by the pushes that they give each other: momentum stays what it is."""
    system, rate = rests.system, y[rests.system.m : -2]
    left = (rests.solved @ system.row_velocity(y)) @ system.rows * system.chain.inverse_mass
    rate -= left[:-1] - left[1:]
    y[-1] -= left[system.chain.anchor]
    rate[rests.stands] = 0.0
    if rests.still[system.chain.anchor]:
        y[-1] = 0.0


def _moving(rests: Phase, time: float, y: Array, resting: Which) -> NDArray[np.int8]:
    """(p,) which way `resting` rows move on: -1 or 1 those whose multipliers are at their bounds, 0 those that stay at rest.

    Gauss's principle, min |M^(-1/2) (push - B^T f)| over multipliers f in their bounds: a row at its least multiplier opens or
    turns back, one at its largest is pressed in. Rows that share no bead are groups of their own, with forces of their own size.
    """
    system, chosen = rests.system, np.zeros(resting.size, dtype=np.int8)
    root = np.sqrt(system.chain.inverse_mass)
    given, push = rests.given(time, y), system.push(time, rests.span)
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
        # a multiplier at its bound stays one
        room = 0.5 * BALANCE_ROUND_OFF * (np.abs(matrix).T @ balanced) / scale + TINY
        bounds = low[at] * size / scale - room, high[at] * size / scale + room
        found = lsq_linear(matrix[moved], free[moved] / scale, bounds, "bvls", tol=1e-15, max_iter=10 * at.size)
        chosen[at] = found.active_mask
    return chosen
