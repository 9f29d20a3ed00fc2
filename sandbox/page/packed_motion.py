"""The packed motion: the fewest rows between which straight lines follow every curve, as base64 text of typed arrays."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.draw import Scales
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.user_error import UserError

USUAL_BYTES = 600_000  # of all packed motions of a page; base64 makes 800 kB of them, and a page stays below 1 MB
MOST_BYTES = 6_000_000  # where the samples of a long chain are as coarse as may be and still need more
COARSEST = 5  # times that samples are made coarser before curves would look wrong
CODES = 32767  # the largest code of a velocity or force; 0 is 0
LINE_ERROR = 2.5e-4  # of an axis: largest distance between a curve and its straight lines; a third of a pixel of 1200
SAME_DEPTH = 4e-3  # relative error of an overlap between samples, below a change of its label's second digit
COARSER = 2.0  # factor on both, again and again, for motions that need too many samples
Rows = NDArray[np.intp]


def packed_lanes(lanes: Sequence[Motion], scales: Scales) -> list[dict[str, Any]]:
    """The `lanes` of a page, packed: so coarse that they need USUAL_BYTES together, but not coarser than may be.

    Raises:
        UserError: they then need more than MOST_BYTES.
    """
    choices = zip(*(adaptive_rows(motion, scales) for motion in lanes), strict=True)
    for rows in islice(choices, 1 + COARSEST):
        size = sum(map(_size, lanes, rows))
        if size <= USUAL_BYTES:
            break
    if size > MOST_BYTES:
        beads = max(motion.chain.contacts + 1 for motion in lanes)
        raise UserError(f"the motion of {beads} beads is too much for one page: choose a shorter duration or a film")
    return [_packed(motion, chosen, scales) for motion, chosen in zip(lanes, rows, strict=True)]


def _size(motion: Motion, rows: Rows) -> int:
    return len(rows) * (8 * motion.chain.contacts + 18)


def _packed(motion: Motion, rows: Rows, scales: Scales) -> dict[str, Any]:
    """Columns one after the other: time, anchor, stored, absorbed, overlaps as floats; velocities, forces as codes."""
    depth = np.maximum(np.abs(motion.overlap).max(axis=0), np.finfo(float).tiny)
    absorbed = motion.absorbed if motion.absorbed.size else np.zeros(len(motion.time))
    floats = [motion.time, motion.anchor[:, 0], motion.stored, absorbed, *(motion.overlap / depth).T]
    shares = [*(motion.velocity / fastest(scales)).T, *(motion.force / scales.force).T]
    return {
        "rows": len(rows),
        "anchor": motion.chain.anchor,
        "depth": depth.tolist(),
        "data": _base64([column[rows] for column in floats], [column[rows] for column in shares]),
    }


def fastest(scales: Scales) -> float:
    """The speed [m/s] that has the largest code; a bead at rest has code 0."""
    return max(map(abs, scales.velocity))


def _base64(floats: Sequence[Array], shares: Sequence[Array]) -> str:
    codes = np.rint(np.clip(np.array(shares), -1.0, 1.0) * CODES)
    data = np.array(floats).astype("<f4").tobytes() + codes.astype("<i2").tobytes()
    return base64.b64encode(data).decode()


def adaptive_rows(motion: Motion, scales: Scales) -> Iterator[Rows]:
    """Rows of `motion` that draw all its curves on the axes of `scales`: ascending, ends included, at first LINE_ERROR apart.

    Then fewer and fewer of them, each time COARSER times as far apart.
    """
    curves, allowed = _curves(motion, scales)
    rows = needed_rows(motion.time, curves, allowed)
    while True:
        yield rows
        allowed = COARSER * allowed
        rows = rows[needed_rows(motion.time[rows], curves[rows], allowed[rows])]


def _curves(motion: Motion, scales: Scales) -> tuple[Array, Array]:
    """(T, c) all curves, and (T, c) the error allowed for each of their values."""
    overlap = motion.overlap
    lens = np.maximum(np.abs(overlap).max(axis=0), np.finfo(float).tiny)  # an inset shows its contact's own scale
    smallest = 10.0 ** (scales.decades[0] - 1)
    depth = np.maximum(SAME_DEPTH * np.abs(overlap), smallest)
    parts = [
        (motion.position, LINE_ERROR * (scales.window[1] - scales.window[0])),
        (motion.velocity, LINE_ERROR * (scales.velocity[1] - scales.velocity[0])),
        (motion.force, LINE_ERROR * scales.force),
        (overlap, np.where(overlap > 0.0, np.minimum(depth, 2.0 * LINE_ERROR * lens), 2.0 * LINE_ERROR * lens)),
        (motion.stored[:, None], LINE_ERROR * scales.energy),
    ]
    if motion.absorbed.size:
        parts.append((motion.absorbed[:, None], LINE_ERROR * scales.energy))
    curves = np.concatenate([values for values, _ in parts], axis=1)
    allowed = np.concatenate([np.broadcast_to(error, values.shape) for values, error in parts], axis=1)
    return curves, allowed


def needed_rows(time: Array, curves: Array, allowed: Array) -> Rows:
    """Rows between which straight lines miss no value of `curves` (T, c) by more than `allowed` (T, c).

    Each stretch is cut at the value that its line misses most (Douglas and Peucker), until none is missed.
    """
    kept = {0, len(time) - 1}
    stretches = [(0, len(time) - 1)]
    while stretches:
        first, last = stretches.pop()
        if last - first < 2:
            continue
        inside = slice(first + 1, last)
        span = time[last] - time[first]
        share = ((time[inside] - time[first]) / span if span > 0.0 else np.zeros(last - first - 1))[:, None]
        line = curves[first] + share * (curves[last] - curves[first])
        missed = (np.abs(curves[inside] - line) / allowed[inside]).max(axis=1)
        worst = int(np.argmax(missed))
        if missed[worst] > 1.0:
            middle = first + 1 + worst
            kept.add(middle)
            stretches += [(first, middle), (middle, last)]
    return np.array(sorted(kept), dtype=np.intp)
