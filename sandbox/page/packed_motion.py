"""The packed motion: adaptive samples of a lane as base64 text of typed arrays, which the page's script reads."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from itertools import islice
from typing import Any

import numpy as np
from softcradle.sandbox.draw import Scales
from softcradle.sandbox.motion import Array, Motion
from softcradle.sandbox.page.adaptive_samples import Rows, adaptive_rows
from softcradle.sandbox.user_error import UserError

USUAL_BYTES = 600_000  # of all packed motions of a page; base64 makes 800 kB of them, and a page stays below 1 MB
MOST_BYTES = 6_000_000  # where the samples of a long chain are as coarse as may be and still need more
COARSEST = 5  # times that samples are made coarser before curves would look wrong
CODES = 32767  # the largest code of a velocity or force; 0 is 0


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
