"""The stages of one collocation step: points on the graphs of all constraints that solve the step's equations, by
Newton's iteration.

At each stage, the unknown of a contact is its place on its graph, overlap + weight * force (Minty's parametrisation).
The weight is the coefficient of the force in the contact's own equation. Overlap and force are functions of the place
that change by no more than the place does. Therefore no iteration makes a stiff force or a slack overlap diverge, and
an event is a place like any other. The matrix uses double precision, and the residuals use extended precision.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

from benchmarks.scan.collocation import EPSILON, Array, Extended, Tableau
from benchmarks.scan.monotone_rows import (
    BACKWARD,
    FORWARD,
    HELD,
    OPEN,
    PRESSED,
    RELEASED,
    STICKS,
    TOUCHING,
    Branches,
    Rows,
)

Double = NDArray[np.float64]

# Eigenvalues or singular values below this fraction of the largest one count as 0.
SINGULAR = 1e-10
MOST_ITERATIONS = 40  # Largest number of Newton iterations. If they do not converge, a shorter step is tried.
# Number of iterations with full changes. Later changes are multiplied by DAMPED, which helps contacts that alternate
# between two branches.
UNDAMPED_ITERATIONS, DAMPED = 12, 0.5
# Smallest derivative of an overlap with respect to its place that differs from 0. The value 0 marks a fixed constraint.
LEAST = float(np.finfo(np.float64).tiny)


@dataclass
class Point:
    """State of all constraints at one time, or at s stages (leading axis).

    Attributes:
        overlap, rate (..., m), velocity (..., n+1): primal values of contacts and beads.
        force (..., m), friction (..., n+1 or 0): dual values.
        branch (..., m), side (..., n+1 or 0): branches of contacts and beds.
    """

    overlap: Array
    rate: Array
    velocity: Array
    force: Array
    friction: Array
    branch: Branches
    side: Branches

    def last(self) -> Point:
        """Return the state at the last stage."""
        return Point(*(value[-1].copy() for value in vars(self).values()))


@dataclass(frozen=True)
class Strings:
    """Strings on which the beads hang, at the start of a step.

    Attributes:
        square: gravity / length [1/s²].
        rest: (m,) overlaps of the contacts at rest [m].
        displacement: (n+1,) displacements of the beads from rest [m].
    """

    square: Extended
    rest: Array
    displacement: Array


class Stages:
    """Stage equations of one step of length `h` from `start`. The method `solve` returns the stages or None."""

    def __init__(
        self,
        rows: Rows,
        tableau: Tableau,
        start: Point,
        h: Extended,
        wanted: float,
        wanted_at_rest: float | None = None,
        strings: Strings | None = None,
    ) -> None:
        self.rows, self.start, self.h = rows, start, h
        self.once, self.twice = h * tableau.once, h * h * tableau.twice
        self.drift = start.overlap + h * tableau.node[:, None] * start.rate
        # Velocity changes of contacts and beads that the strings cause.
        self.pulled, self.pulled_beads = np.zeros_like(self.drift), np.zeros((1, start.velocity.size), dtype=Extended)
        if strings is not None:
            self._hang(strings, tableau)
        # Allowed errors of velocities [m/s] after the iteration: in general, and for velocities that are 0.
        self.wanted, self.wanted_at_rest = wanted, wanted if wanted_at_rest is None else wanted_at_rest
        self.round_off = 8.0 * EPSILON * (np.abs(start.overlap) + np.abs(h * start.rate))
        diagonal = rows.response.diagonal()[: rows.contacts]
        self.yielding = 0.5 * (h * tableau.node[:, None]) ** 2 * diagonal  # Overlap [m] that a force of 1 N removes.
        # `firm` (n+1,) marks beads that do not move in this step; it is empty without a bed. `free` contains the
        # constraints for a chain in which these beads are walls.
        self.firm, self.free = np.zeros(rows.bed.shape[-1], dtype=bool), rows
        self.once_double, self.twice_double = self.once.astype(np.float64), self.twice.astype(np.float64)

    def _hang(self, strings: Strings, tableau: Tableau) -> None:
        """Include the pull of the strings in the equations.

        The accelerations a at the stages solve (I + omega² h² A²) a = a0 - omega² y. The accelerations a0 result from
        all other forces. The displacements y from rest are those without any force.
        """
        inverse = _inverse(np.eye(tableau.stages, dtype=Extended) + strings.square * self.twice)
        free = self.drift - strings.rest
        beads = strings.displacement + self.h * tableau.node[:, None] * self.start.velocity
        self.once, self.twice = self.once @ inverse, self.twice @ inverse
        self.drift = self.drift - strings.square * (self.twice @ free)
        self.pulled = -strings.square * (self.once @ free)
        self.pulled_beads = -strings.square * (self.once @ beads)

    def solve(self) -> Point | None:
        """Return the stages, or None if Newton's iteration does not converge.

        Beads that stick at the start are fixed like walls at first. Beads that need more than the available friction
        are then released.
        """
        start, bed = self.start, self.rows.bed
        if bed.size:
            self.firm = (start.side == STICKS) & (start.velocity == 0.0) & (np.atleast_2d(bed) > 0.0).any(axis=0)
        while True:
            self.free = self.rows.with_firm(self.firm)
            stages = self._solve()
            if stages is None or not self.firm.any():
                return stages
            slips = self.firm & (np.abs(stages.friction) > bed).any(axis=0)
            if not slips.any():
                return stages
            self.firm &= ~slips

    def _solve(self) -> Point | None:
        """Return the stages with the beads in `firm` fixed."""
        stages = self._guess()
        for iteration in range(MOST_ITERATIONS):
            contact_error, bed_error = self._residuals(stages)
            wanted = self.wanted if iteration >= UNDAMPED_ITERATIONS else self.wanted_at_rest
            if self._is_small(contact_error, stages.branch, bed_error, wanted) and not self._turn(stages):
                return stages
            contact_step, bed_step = self._newton_step(stages, contact_error, bed_error)
            if not (np.isfinite(contact_step).all() and np.isfinite(bed_step).all()):
                return None
            part = DAMPED if iteration >= UNDAMPED_ITERATIONS else 1.0
            self._move_contacts(stages, part * contact_step)
            self._move_beds(stages, bed_step)
        return None

    def _guess(self) -> Point:
        """Return first values of the stages, with the forces at the start of the step.

        Contacts that are not stiff get the overlaps that these forces cause.
        """
        start, rows, shape = self.start, self.rows, self.drift.shape
        stages = Point(*(np.broadcast_to(v, (shape[0], v.size)).copy() for v in vars(start).values()))
        if rows.bed.ndim > 1:
            stages.friction = np.where(stages.side == STICKS, stages.friction, stages.side * rows.bed)
        acceleration = self.free.acceleration(start.force, start.friction)
        ahead = self.drift + self.twice.sum(axis=1)[:, None] * rows.closing(acceleration)
        loaded = (stages.branch == PRESSED) | (stages.branch == RELEASED)
        slack = loaded & (self.yielding * rows.slope(start.overlap) < 1.0) & (ahead > 0.0)
        stages.overlap = np.where(slack | ((stages.branch == OPEN) & (ahead <= 0.0)), ahead, stages.overlap)
        stages.force = np.where(slack, self._part(stages.branch) * rows.law(stages.overlap), stages.force)
        return stages

    def _part(self, branch: Branches) -> Array:
        """Return the fraction of the law's force that acts on each branch."""
        return np.where(branch == RELEASED, 1.0 - self.rows.loss, 1.0)

    def _residuals(self, stages: Point) -> tuple[Array, Array]:
        """Return the residuals of the stage equations of contacts and beds. The rates and velocities are updated."""
        if self.firm.any():
            stages.friction[:, self.firm] = self.rows.push(stages.force)[:, self.firm]
        acceleration = self.free.acceleration(stages.force, stages.friction)
        closing = self.rows.closing(acceleration)
        overlap = self.drift + self.twice @ closing
        stages.rate = self.start.rate + self.once @ closing + self.pulled
        velocity = self.start.velocity + self.once @ acceleration + self.pulled_beads
        held = stages.branch == HELD
        stages.overlap = np.where(held, overlap, stages.overlap)
        contact_error = np.where(held, -stages.rate, stages.overlap - overlap)
        stages.velocity = velocity
        bed_error = np.where(self._sticks(stages), -velocity, 0.0) if self.rows.bed.size else stages.friction
        return contact_error, bed_error

    def _sticks(self, stages: Point) -> NDArray[np.bool_]:
        """Return an (s, n+1) mask of beads that stick with unknown friction."""
        return (stages.side == STICKS) & ~self.firm & (np.atleast_2d(self.rows.bed) > 0.0).any(axis=0)

    def _is_small(self, contact_error: Array, branch: Branches, bed_error: Array, wanted: float) -> bool:
        allowed = np.where(branch == HELD, self.wanted_at_rest, np.maximum(wanted * self.h, self.round_off))
        return bool((np.abs(contact_error) <= allowed).all() and (np.abs(bed_error) <= self.wanted_at_rest).all())

    def _turn(self, stages: Point) -> bool:
        """Hold contacts with loss that move against their branch, and stop beads that move against their side.

        Return True if there were any.
        """
        turned = False
        if self.rows.loss.any():
            lossy = (self.rows.loss > 0.0) & (stages.overlap > 0.0)
            against = np.where(stages.branch == PRESSED, -stages.rate, stages.rate) > self.wanted_at_rest
            against &= lossy & ((stages.branch == PRESSED) | (stages.branch == RELEASED))
            stages.branch[against] = HELD
            turned = bool(against.any())
        if self.rows.bed.size:
            against = stages.side * stages.velocity < -self.wanted_at_rest
            stages.side[against] = STICKS
            turned |= bool(against.any())
        return turned

    def _newton_step(self, stages: Point, contact_error: Array, bed_error: Array) -> tuple[Double, Double]:
        """Return the (s, n) and (s, b) changes of places on the graphs."""
        (s, n), b = stages.force.shape, self.rows.bed.shape[-1]
        held = np.zeros((s, n + b), dtype=bool)
        held[:, :n], held[:, n:] = stages.branch == HELD, True
        primal, dual = np.empty((s, n + b)), np.empty((s, n + b))
        primal[:, :n], dual[:, :n] = self._tangent(stages)
        # Forces between beads that do not move are not determined, so they stay unchanged.
        moves_nothing = self.free.response.diagonal()[:n] == 0.0
        primal[:, :n] = np.where(moves_nothing & (primal[:, :n] == 0.0), 1.0, primal[:, :n])
        dual[:, :n][:, moves_nothing] = 0.0
        sticks = self._sticks(stages) if b else stages.side == STICKS
        primal[:, n:], dual[:, n:] = ~sticks, sticks
        rule = np.where(held[:, :, None], self.once_double[:, None, :], self.twice_double[:, None, :])
        error = np.hstack((contact_error, bed_error)) if b else contact_error
        step = solved(self.free, rule, primal, dual, -error.astype(np.float64))
        return step[:, :n], step[:, n:]

    def _tangent(self, stages: Point) -> tuple[Double, Double]:
        """Return the (s, n) derivatives of primal and dual values with respect to the place on the graph.

        For fixed constraints, the derivative is with respect to the force.
        """
        part, overlap, weight = self._part(stages.branch), stages.overlap, self.yielding
        loaded = (stages.branch == PRESSED) | (stages.branch == RELEASED)
        stiffness = np.where(loaded, weight * part * self.rows.steepness(overlap), 0.0)
        primal = np.where(loaded, np.maximum(1.0 / (1.0 + stiffness), LEAST), 1.0)
        dual = np.where(loaded, 1.0 / (weight * (1.0 + 1.0 / stiffness)), 0.0)
        fixed = (stages.branch == TOUCHING) | (stages.branch == HELD)
        return np.where(fixed, 0.0, primal).astype(np.float64), np.where(fixed, 1.0, dual).astype(np.float64)

    def _move_contacts(self, stages: Point, step: Double) -> None:
        """Move all contacts along their graphs, in place. A contact that reaches an event continues on the next branch.

        The place on a graph is overlap + weight * force. Overlap and force are functions of the place. Neither changes
        by more than the place.
        """
        rows, branch, weight = self.rows, stages.branch, self.yielding
        held, part = branch == HELD, self._part(branch)
        place = stages.overlap + weight * stages.force + np.where(held | (branch == TOUCHING), weight * step, step)
        corner = np.where(held, 0.0, weight * part * rows.preload)
        opens, touches = ~held & (place <= 0.0), ~held & (place > 0.0) & (place <= corner)
        loaded = ~held & (place > corner)
        overlap = rows.resolvent(np.where(loaded, place - corner, 1.0), weight * part)
        slack = weight * part * rows.steepness(overlap) < 1.0
        force = np.where(slack, part * rows.law(overlap), (place - overlap) / weight)
        force = np.where(loaded, force, np.where(touches, place / weight, 0.0))
        overlap = np.where(loaded, overlap, np.where(opens, place, 0.0))
        stages.force = np.where(held, stages.force + step, force)
        stages.overlap = np.where(held, stages.overlap, overlap)
        branch[touches], branch[opens] = TOUCHING, OPEN
        branch[loaded & (branch != RELEASED)] = PRESSED
        self._release(stages)

    def _release(self, stages: Point) -> None:
        """Release held contacts whose force has left its bounds. The released contacts then load or unload."""
        if not self.rows.loss.any():
            return
        law = self.rows.law(stages.overlap)
        held = stages.branch == HELD
        over, under = held & (stages.force > law), held & (stages.force < (1.0 - self.rows.loss) * law)
        stages.force = np.where(over, law, np.where(under, (1.0 - self.rows.loss) * law, stages.force))
        stages.branch[over], stages.branch[under] = PRESSED, RELEASED

    def _move_beds(self, stages: Point, step: Double) -> None:
        """Update the friction of sticking beads in place. A bead whose friction leaves its bounds slides."""
        if not self.rows.bed.size:
            return
        friction = np.where(stages.side == STICKS, stages.friction + step, stages.side * self.rows.bed)
        stages.side[(friction > self.rows.bed) & ~self.firm] = FORWARD
        stages.side[(friction < -self.rows.bed) & ~self.firm] = BACKWARD
        stages.friction = np.clip(friction, -self.rows.bed, self.rows.bed)


def solved(rows: Rows, rule: Double, primal: Double, dual: Double, right: Double) -> Double:
    """Return the (s, p) changes of places on the graphs of p constraints at s stages.

    The result is NaN if the equations have no solution. The equations state that `right` (s, p) equals the change of a
    constraint at a stage. This change has two parts. The first part is `primal` (s, p) times the constraint's own change of
    place. The second part is the effect of the changes `dual` (s, p) of all constraints through their response and the
    `rule` (s, p, s) of the stage.
    """
    if _is_determined(rows, primal):
        return _banded(rows, rule, primal, dual, right)
    return _least(_full(rows, rule, primal, dual), right.ravel()).reshape(primal.shape)


def _is_determined(rows: Rows, primal: Double) -> bool:
    """Return True if the motion determines all multipliers.

    Multipliers between sticking beads or between two walls are not determined.
    """
    fixed = (primal == 0.0).all(axis=0)
    if fixed.sum() < 2:
        return True
    coupling = rows.response[np.ix_(fixed, fixed)]
    size = np.sqrt(coupling.diagonal())
    if not size.all():
        return False
    return bool(np.linalg.eigvalsh(coupling / np.outer(size, size))[0] > SINGULAR)


def _full(rows: Rows, rule: Double, primal: Double, dual: Double) -> Double:
    """Return the whole matrix, ordered by stages."""
    matrix = rule[:, :, :, None] * rows.response[None, :, None, :] * dual[None, None]
    found: Double = matrix.reshape(primal.size, primal.size)
    found[np.diag_indices(primal.size)] += primal.ravel()
    return found


def _banded(rows: Rows, rule: Double, primal: Double, dual: Double, right: Double) -> Double:
    """Solve the equations with a band matrix.

    Constraints are in the order of the chain, and the stages of each constraint are neighbours.
    """
    stages, count = primal.shape
    order, reach = rows.order, max(rows.answers)
    rule, dual = rule[:, order], dual[:, order]
    width = (reach + 1) * stages - 1
    band, size = np.zeros((2 * width + 1, count * stages)), np.zeros((count, stages))
    stage = np.arange(stages)
    blocks = []
    for k, (first, response) in rows.answers.items():
        block = rule[:, first] * (response[:, None] * dual.T[first + k])  # Block of shape (s, p, s).
        if k == 0:
            block[stage, :, stage] += primal[:, order]
        size[first] = np.maximum(size[first], np.abs(block).max(axis=2).T)
        blocks.append((k, first, block))
    size = _size(size)
    for k, first, block in blocks:
        row, column = first[None, :, None] * stages + stage[:, None, None], (first + k)[None, :, None] * stages + stage
        band[width + row - column, column] = block / size[first].T[:, :, None]
    try:
        step = solve_banded((width, width), band, (right.T[order] / size).ravel(), check_finite=False)
    except np.linalg.LinAlgError:
        return np.full((stages, count), np.nan)
    found = np.empty((stages, count))
    found[:, order] = step.reshape(count, stages).T
    return found


def _least(matrix: Double, right: Double) -> Double:
    """Return the smallest solution of equations that do not determine a unique one."""
    size = _size(np.abs(matrix).max(axis=1))
    scaled = matrix / size[:, None]
    columns = _size(np.abs(scaled).max(axis=0))
    try:
        found: Double = np.linalg.lstsq(scaled / columns, right / size, rcond=SINGULAR)[0] / columns
    except np.linalg.LinAlgError:
        return np.full(right.size, np.nan)
    return found


def _inverse(matrix: Array) -> Array:
    """Return the inverse of a well conditioned matrix in extended precision, by two steps of Newton's iteration."""
    found = np.linalg.inv(matrix.astype(np.float64)).astype(Extended)
    for _ in range(2):
        found = found @ (2.0 * np.eye(len(matrix), dtype=Extended) - matrix @ found)
    return found


def _size(values: Double) -> Double:
    """Return the values with each 0 replaced by 1."""
    return np.where(values == 0.0, 1.0, values)
