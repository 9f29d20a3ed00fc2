"""Segments and contacts that are defined by a table of segments.

The force graph of a contact is a monotone curve of the force f over the overlap d. A segment is one piece of this
curve. Each segment extends from its origin outwards: to the right if it pushes (side 1), to the left if it pulls (side
-1). With the displacement x = side (d - origin) >= 0 and y = x + before, the force is

    loading      f = side (F + K y**a + S x)
    unloading    f = side ((1 - l) (F + K y**a) + S x)

up to x = length. The next segment begins at this displacement. F is the preload, K the stiffness, a the exponent and l
the loss of a gear. If the same gear acts on several segments, `before` is its displacement at the origin of the
segment. S is the stiffness of an additional stop without loss. A user-defined contact law has a table of polynomials
instead of the power law.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.law_table import LawTable
from softcradle.physics.messages import InputError

Array = NDArray[np.float64]

# Relative decrease of the force from one segment to the next that is still accepted. Such a decrease is round-off of
# the numbers that define the segments.
CONTINUOUS = 1e-9


class Segment(NamedTuple):
    """One piece of the force graph of a contact.

    Attributes:
        side: 1.0 if it pushes, -1.0 if it pulls.
        origin: overlap [m] at which it begins.
        preload, stiffness, exponent: F [N], K [N/m**a] and a of its power law.
        loss: fraction l of the energy of the power law that it dissipates during unloading.
        length: displacement [m] at which the next segment begins. The length of the last segment is infinite.
        before: displacement [m] that the power law already has at the origin.
        stop: stiffness S [N/m] of an additional spring without loss.
        table: polynomials that replace the power law, or None.
        table_from: displacement [m] below which the power law replaces the table.
    """

    side: float
    origin: float
    preload: float
    stiffness: float
    exponent: float
    loss: float = 0.0
    length: float = math.inf
    before: float = 0.0
    stop: float = 0.0
    table: LawTable | None = None
    table_from: float = 0.0

    @property
    def is_whole_law(self) -> bool:
        """True if this segment alone is a contact that only pushes, starting at overlap 0."""
        return self.side > 0.0 and self.origin == self.before == self.stop == 0.0 and self.length == math.inf

    @property
    def end(self) -> float:
        """Overlap [m] at which the next segment begins."""
        return self.origin + self.side * self.length

    def force_at(self, x: ArrayLike, unloading: bool = False) -> Array:
        """Return the absolute force [N] at the displacement `x` >= 0 [m].

        At 0 it is the limit from the right.
        """
        way = np.asarray(x, dtype=np.float64)
        law = self.preload + self.stiffness * (way + self.before) ** self.exponent
        found: Array = (1.0 - self.loss if unloading else 1.0) * law + self.stop * way
        return found

    def energy(self, overlap: ArrayLike, power: Callable[..., Any] = np.power) -> Array:
        """Return the energy [J] that this segment stores between its origin and `overlap` [m].

        Overlaps beyond the end of the segment count as its end. `power` is the function that computes powers.
        """
        x = np.clip(self.side * (np.asarray(overlap, dtype=np.float64) - self.origin), 0.0, self.length)
        p = 1.0 + self.exponent
        gained = power(x + self.before, p) - (power(self.before, p) if self.before else 0.0)
        found: Array = self.preload * x + self.stiffness * gained / p + 0.5 * self.stop * x * x
        return found


class PiecewiseContact:
    """A contact defined by a table of segments. A subclass defines `segments`. All methods except pymunk support it.

    The segments are listed from left to right: first the pulling ones, then the pushing ones. The first pushing segment
    begins at overlap 0. Each other segment begins at the end of its inner neighbour. The force never decreases with the
    overlap.
    """

    # True if the contact is coupled at the start, so that it can pull. None means that it is coupled unless the gap is
    # larger than the slack.
    coupled: bool | None = None

    @property
    def name(self) -> str:
        """Name of the contact in tables and pictures: the name of its class."""
        return type(self).__name__

    @property
    def segments(self) -> Sequence[Segment]:
        """Segments of the force graph, from left to right."""
        raise NotImplementedError(f"class {type(self).__name__} must define segments, the pieces of its graph")

    @cached_property
    def pushing(self) -> tuple[Segment, ...]:
        """Pushing segments, from overlap 0 outwards."""
        return tuple(segment for segment in self.segments if segment.side > 0.0)

    @cached_property
    def pulling(self) -> tuple[Segment, ...]:
        """Pulling segments, from the end of the slack outwards."""
        return tuple(segment for segment in self.segments if segment.side < 0.0)[::-1]

    @property
    def pulls_below(self) -> float:
        """Overlap [m] below which the contact pulls. The value is -inf if the contact never pulls."""
        return self.pulling[0].origin if self.pulling else -math.inf

    @property
    def smooth(self) -> bool:
        """True if certain segments have exponents of at least 1: all pulling segments, and all segments on a side with
        several segments.
        """
        return all(
            segment.exponent >= 1.0
            for side in (self.pushing[1:] and self.pushing, self.pulling)
            for segment in side or ()
        )

    @property
    def preload(self) -> float:
        """Force [N] at which the contact begins to yield when it is compressed."""
        return self.pushing[0].preload

    @property
    def loss(self) -> float:
        """Largest loss of all segments."""
        return max(segment.loss for segment in self.segments)

    @property
    def stop_stiffness(self) -> float:
        """Largest stiffness [N/m] of the outer segments at their origins. The value is 0 without outer segments."""
        return max(
            (_stiffness_at_origin(one) for side in (self.pushing, self.pulling) for one in side[1:]), default=0.0
        )

    def starts_coupled(self, overlap: float) -> bool:
        """Return True if the contact is coupled at the start, at `overlap` [m]. Beads that touch are always coupled."""
        return overlap >= 0.0 or (overlap >= self.pulls_below if self.coupled is None else self.coupled)

    @overload
    def force(self, overlap: float) -> float: ...
    @overload
    def force(self, overlap: ArrayLike) -> Array: ...

    def force(self, overlap: ArrayLike) -> Array | float:
        """Return the force [N] at `overlap` [m] during loading, any shape. The force is negative if the contact pulls."""
        return self._force(overlap, unloading=False)

    def released(self, overlap: ArrayLike) -> Array | float:
        """Return the force [N] at `overlap` [m] during unloading, any shape."""
        return self._force(overlap, unloading=True)

    def _force(self, overlap: ArrayLike, unloading: bool) -> Array | float:
        overlaps = np.asarray(overlap, dtype=np.float64)
        # The force is 0 in the slack between the first pushing and the first pulling segment.
        found = np.zeros(overlaps.shape)
        # The order is outwards, so the outermost segment determines the force.
        for segment in (*self.pushing, *self.pulling):
            x = segment.side * (overlaps - segment.origin)
            found = np.where(x > 0.0, segment.side * segment.force_at(np.maximum(x, 0.0), unloading), found)
        return _like(overlap, found + 0.0)

    @overload
    def energy(self, overlap: float) -> float: ...
    @overload
    def energy(self, overlap: ArrayLike) -> Array: ...

    def energy(self, overlap: ArrayLike) -> Array | float:
        """Return the stored energy [J] at `overlap` [m], any shape."""
        return self.stored_energy(overlap)

    def stored_energy(self, overlap: ArrayLike, power: Callable[..., Any] = np.power) -> Array | float:
        """Return the stored energy [J] at `overlap` [m], any shape.

        `power` is the function that computes powers, as in :func:`softcradle.physics.contact.stored_energy`.
        """
        return _like(overlap, sum(segment.energy(overlap, power) for segment in self.segments))


@dataclass(frozen=True)
class SegmentTable(PiecewiseContact):
    """A contact defined by a list of segments, see :class:`PiecewiseContact`."""

    rows: tuple[Segment, ...]
    coupled: bool | None = None

    @property
    def segments(self) -> tuple[Segment, ...]:
        """Segments of the contact, as given."""
        return self.rows


def require_graph(what: str, contact: PiecewiseContact) -> None:
    """Raise ValueError if the segments of `contact` do not form one monotone graph.

    `what` names the contact in the error message.
    """
    # Check the order of the segments.
    if not contact.pushing or contact.pushing[0].origin != 0.0:
        raise InputError("no_push", "{what} must have a segment that pushes from overlap 0 on", what=what)
    if list(contact.segments) != [*contact.pulling[::-1], *contact.pushing]:
        raise InputError(
            "segment_order", "{what} must have its segments from left to right, pulling segments first", what=what
        )
    # Each side must be continuous and extend to infinity. Its force must not decrease.
    for side in (contact.pushing, contact.pulling):
        for inner, outer in pairwise(side):
            if not math.isclose(inner.end, outer.origin, rel_tol=CONTINUOUS):
                raise InputError(
                    "segment_gap",
                    "{what}: a segment ends at {end:g} m, and the next begins at {begin:g} m",
                    what=what,
                    end=inner.end,
                    begin=outer.origin,
                )
            before, after = float(inner.force_at(inner.length)), float(outer.force_at(0.0))
            if after < before * (1.0 - CONTINUOUS):
                raise InputError(
                    "falling_force",
                    "{what}: the force falls from {before:g} to {after:g} N at {place:g} m",
                    what=what,
                    before=before,
                    after=after,
                    place=outer.origin,
                )
        if side and side[-1].length != math.inf:
            raise InputError(
                "last_segment",
                "{what}: the last segment must have the length inf, not {given:g} m",
                what=what,
                given=side[-1].length,
            )
    # Check the values of single segments.
    for segment in contact.segments:
        if segment.table is not None and not (segment.is_whole_law and len(contact.segments) == 1 and not segment.loss):
            raise InputError(
                "table_segment", "{what}: a segment with a table must be the only one, and without loss", what=what
            )
        if segment.stop < 0.0 and _stiffness_at_origin(segment) < 0.0:
            raise InputError(
                "falling_segment",
                "{what}: the force falls on the segment from {place:g} m on",
                what=what,
                place=segment.origin,
            )


def _stiffness_at_origin(segment: Segment) -> float:
    """Return the slope df/dd [N/m] of a segment at its origin; 0 if it is infinite there."""
    # The slope of the power law is K for a = 1. For a < 1 it is infinite at the origin of the law, which is returned as
    # 0.
    y, a = segment.before, segment.exponent
    by_law = segment.stiffness if a == 1.0 else a * segment.stiffness * y ** (a - 1.0) if y else 0.0
    return by_law + segment.stop


def _like(overlap: ArrayLike, found: Any) -> Array | float:
    """Return `found` as an array, or as a float if `overlap` was a number."""
    return float(found) if np.ndim(overlap) == 0 else found
