"""What the stages of one step tell: its local error, whether a corner lies inside it, and how far the next corners are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.reference.collocation import Array, Tableau
from softcradle.physics.reference.monotone_rows import HELD, OPEN, PRESSED, RELEASED, STICKS, TOUCHING, Branches, Rows
from softcradle.physics.reference.stage_equations import Point

NEVER = np.inf
APPROACH = 15.0 / 16.0  # of the time to a corner: the longest step towards it
STANDS = 0.01  # of the velocity that a crossing may move: a contact that turns slower stands still
SLOW = 1e-9  # of the speed scale: loaded contacts that open slower than this are not landed upon, only followed


def local_error(tableau: Tableau, rows: Rows, stages: Point, h: float) -> float:
    """Error of velocities [m/s] of a step: the last Legendre coefficients of the accelerations, continued as they decay.

    The order is twice the number of coefficients; where they do not decay, as across a switch, the last is the error.
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
    """Whether a guard may change its sign inside the step: one of its Bernstein coefficients has the other sign.

    `slack` [m/s]: a guard of velocities that is past its zero by less does not count; nor a slide of a bead slower than `still`.
    """
    kinked = (rows.preload > 0.0) | (rows.loss > 0.0)
    weight = h * rows.response.diagonal()  # change of a row's velocity by a force of 1 N
    if _mixes(kinked, stages.branch, stages.force, weight[: kinked.size], slack):
        return True
    if rows.bed.size and _mixes(rows.bed > 0.0, stages.side, stages.friction, weight[kinked.size :], slack):
        return True
    acceleration = rows.acceleration(stages.force, stages.friction)
    closing = rows.closing(acceleration)
    branch = stages.branch[0]
    overlap = h * h * (tableau.bernstein @ closing)
    overlap += start.overlap + np.linspace(0.0, 1.0, overlap.shape[0])[:, None] * (h * start.rate)
    reach = slack * h + 1e-18 * np.abs(start.overlap)
    found = bool(((stages.branch == OPEN).all(axis=0) & (overlap > reach)).any())
    found |= bool((kinked & (branch >= PRESSED) & (overlap < -reach)).any())
    if rows.loss.any():
        rate = start.rate + h * (tableau.bernstein_once @ closing)
        lossy = (rows.loss > 0.0) & (start.overlap > 0.0)
        found |= bool((lossy & (branch == PRESSED) & (rate < -slack)).any())
        found |= bool((lossy & (branch == RELEASED) & (rate > slack)).any())
    fixed = (branch == TOUCHING) | (branch == HELD)
    if fixed.any():
        force = tableau.bernstein_value @ stages.force
        low, high = bounds(rows, start)
        room = 1e-12 * high + slack / weight[: kinked.size]
        found |= bool((fixed & ((force < low - room) | (force > high + room))).any())
    if rows.bed.size:
        side = stages.side[0]
        velocity = start.velocity + h * (tableau.bernstein_once @ acceleration)
        friction = tableau.bernstein_value @ stages.friction
        bed = rows.bed if rows.bed.ndim == 1 else tableau.bernstein_value @ rows.bed
        found |= bool((side * velocity < -still).any())
        found |= bool(((side == STICKS) & (np.abs(friction) > bed * (1.0 + 1e-12))).any())
    return found


def _mixes(counts: NDArray[np.bool_], branch: Branches, dual: Array, weight: NDArray[np.float64], slack: float) -> bool:
    """Whether rows change their branch among the stages, with forces that differ by more than `slack` [m/s]."""
    mixed = counts & (branch != branch[0]).any(axis=0)
    return bool((mixed & (weight * np.ptp(dual, axis=0) > slack)).any())


def bounds(rows: Rows, point: Point) -> tuple[Array, Array]:
    """(n,) least and largest force of contacts that touch or are held."""
    law = rows.law(point.overlap)
    held = point.branch == HELD
    return np.where(held, (1.0 - rows.loss) * law, 0.0), np.where(held, law, rows.preload)


def next_corner(tableau: Tableau, rows: Rows, stages: Point, h: float, speed: float, allowed: float) -> float:
    """Longest next step [s] towards the first zero of a guard that its value, slope and curvature at the end foretell.

    Across the onset of a force that has no corner, a step may go on that moves no velocity by more than `allowed` [m/s].
    """
    point = stages.last()
    acceleration = rows.acceleration(point.force, point.friction)
    closing = rows.closing(acceleration)
    branch = point.branch
    sign = np.where(branch == OPEN, 1.0, -1.0)
    gap = sign * point.overlap
    times = np.where(
        (gap < 0.0) & ((branch == OPEN) | (branch >= PRESSED)) & (np.abs(point.rate) > SLOW * speed),
        _first_roots(gap, sign * point.rate, sign * closing),
        NEVER,
    )
    moved = 2.0 * times * rows.response.diagonal()[: rows.contacts] * rows.law(np.abs(gap))
    found = float(np.where(moved <= allowed, 2.0 * times, APPROACH * times).min())
    return min(found, APPROACH * _next_kink(tableau, rows, stages, closing, acceleration, h, allowed))


def _next_kink(
    tableau: Tableau, rows: Rows, stages: Point, closing: Array, acceleration: Array, h: float, allowed: float
) -> float:
    """Time [s] until a multiplier reaches a bound, or a rate with loss or a velocity on the bed reaches 0."""
    point, found = stages.last(), NEVER
    branch = point.branch
    if rows.loss.any():
        turning = (
            (rows.loss > 0.0)
            & (np.abs(point.rate) > STANDS * allowed)
            & ((branch == PRESSED) | (branch == RELEASED))
            & (point.overlap > 0.0)
        )
        toward = np.where(branch == PRESSED, -1.0, 1.0)
        found = min(found, _ahead((toward * point.rate)[turning], (toward * closing)[turning]))
    fixed = (branch == TOUCHING) | (branch == HELD)
    degree = np.arange(tableau.stages)
    at_end = (degree * (degree + 1) / h) @ tableau.legendre  # from values at the nodes to the slope at the end
    if fixed.any():
        low, high = bounds(rows, point)
        slope = at_end @ stages.force
        found = min(found, _ahead((low - point.force)[fixed], -slope[fixed]))
        found = min(found, _ahead((point.force - high)[fixed], slope[fixed]))
    if rows.bed.size:
        slides, sticks = point.side != STICKS, (point.side == STICKS) & (rows.bed > 0.0)
        found = min(found, _ahead((-point.side * point.velocity)[slides], (-point.side * acceleration)[slides]))
        slope = at_end @ stages.friction
        found = min(found, _ahead((point.friction - rows.bed)[sticks], slope[sticks]))
        found = min(found, _ahead((-point.friction - rows.bed)[sticks], -slope[sticks]))
    return found


def _ahead(value: Array, slope: Array) -> float:
    """First time at which a line that begins at a value < 0 reaches 0."""
    rising = (value < 0.0) & (slope > 0.0)
    return float((-value[rising] / slope[rising]).min()) if rising.any() else NEVER


def _first_roots(value: Array, slope: Array, curvature: Array) -> Array:
    """First times at which parabolas that begin at values < 0 reach 0."""
    square = slope**2 - 2.0 * curvature * value
    root = np.sqrt(np.maximum(square, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        time = np.where(slope > 0.0, -2.0 * value / (slope + root), (root - slope) / curvature)
    valid = (square >= 0.0) & (time > 0.0) & ((slope > 0.0) | (curvature > 0.0))
    return np.where(valid, time, NEVER)
