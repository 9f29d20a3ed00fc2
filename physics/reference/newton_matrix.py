"""The linear equations of Newton's iteration for the stages of a step: each row answers its neighbours in the chain alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded
from softcradle.physics.reference.monotone_rows import Rows

Double = NDArray[np.float64]

SINGULAR = 1e-10  # of the largest eigenvalue or singular value: one below it counts as 0


def solved(rows: Rows, rule: Double, primal: Double, dual: Double, right: Double) -> Double:
    """(s, p) steps along the graphs of p rows at s stages; NaN where the equations have no solution.

    The change of a row at a stage is `primal` (s, p) times its step, plus what the changes `dual` (s, p) times the steps of all
    rows do by their response and the `rule` (s, p, s) of the stage; all of it is `right` (s, p).
    """
    if _is_determined(rows, primal):
        return _banded(rows, rule, primal, dual, right)
    return _least(_full(rows, rule, primal, dual), right.ravel()).reshape(primal.shape)


def _is_determined(rows: Rows, primal: Double) -> bool:
    """Whether the motion determines all multipliers: not between beads that stick, or between two walls."""
    fixed = (primal == 0.0).all(axis=0)
    if fixed.sum() < 2:
        return True
    coupling = rows.response[np.ix_(fixed, fixed)]
    size = np.sqrt(coupling.diagonal())
    if not size.all():
        return False
    return bool(np.linalg.eigvalsh(coupling / np.outer(size, size))[0] > SINGULAR)


def _full(rows: Rows, rule: Double, primal: Double, dual: Double) -> Double:
    """The whole matrix, stage by stage."""
    matrix = rule[:, :, :, None] * rows.response[None, :, None, :] * dual[None, None]
    found: Double = matrix.reshape(primal.size, primal.size)
    found[np.diag_indices(primal.size)] += primal.ravel()
    return found


def _banded(rows: Rows, rule: Double, primal: Double, dual: Double, right: Double) -> Double:
    """The solution from a band about the diagonal: rows in the order of the chain, the stages of each side by side."""
    stages, count = primal.shape
    order, reach = rows.order, max(rows.answers)
    rule, dual = rule[:, order], dual[:, order]
    width = (reach + 1) * stages - 1
    band, size = np.zeros((2 * width + 1, count * stages)), np.zeros((count, stages))
    stage = np.arange(stages)
    blocks = []
    for k, (first, response) in rows.answers.items():
        block = rule[:, first] * (response[:, None] * dual.T[first + k])  # (s, p, s)
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
    """The smallest of the solutions of equations that do not determine one."""
    size = _size(np.abs(matrix).max(axis=1))
    scaled = matrix / size[:, None]
    columns = _size(np.abs(scaled).max(axis=0))
    try:
        found: Double = np.linalg.lstsq(scaled / columns, right / size, rcond=SINGULAR)[0] / columns
    except np.linalg.LinAlgError:
        return np.full(right.size, np.nan)
    return found


def _size(values: Double) -> Double:
    """The values, 1 in place of 0."""
    return np.where(values == 0.0, 1.0, values)
