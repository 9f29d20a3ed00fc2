"""A pick: a bead or a contact of a lane, as it is found under the pointer or selected."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Pick:
    """Number of the lane, "bead" or "contact", and its index."""

    lane: int
    kind: str
    index: int
