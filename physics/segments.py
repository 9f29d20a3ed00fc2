"""Segments: the pieces of the monotone graph of a contact, force over overlap, and what they give in NumPy.

Each segment reaches from its origin outward, to the right if it pushes (side 1), to the left if it pulls (side -1). With the
displacement x = side (d - origin) >= 0 and y = x + before,

    loading      f = side (F + K y**a + S x)
    unloading    f = side ((1 - l) (F + K y**a) + S x)

up to x = length, where the next segment begins. `before` is the displacement of a gear at the origin of a segment on which it
goes on, beside a stop of stiffness S without loss.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


class Segment(NamedTuple):
    """One piece of the graph of a contact.

    Attributes:
        side: 1.0 if it pushes, -1.0 if it pulls.
        origin: overlap [m] at which it begins.
        preload, stiffness, exponent: F [N], K [N/m**a] and a of its power law.
        loss: part l of the energy of the power law that it absorbs on unloading.
        length: displacement [m] at which the next segment begins; inf on the last one.
        before: displacement [m] of the power law at the origin.
        stop: stiffness S [N/m] of a spring without loss, which is added.
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

    def shares(self, overlap: ArrayLike) -> tuple[Array, Array]:
        """Force [N] of the power law and of the stop at `overlap` [m], without the side; 0 if that is outside the segment."""
        x = self.side * (np.asarray(overlap, dtype=np.float64) - self.origin)
        inside = (x > 0.0) & (x <= self.length)
        x = np.where(inside, x, 0.0)
        law = self.preload + self.stiffness * (x + self.before) ** self.exponent
        return np.where(inside, law, 0.0), self.stop * x

    def energy(self, overlap: ArrayLike, power: Callable[..., Any] = np.power) -> Array:
        """Energy [J] that this segment stores between its origin and `overlap` [m], its end at most; `power` takes powers."""
        x = np.clip(self.side * (np.asarray(overlap, dtype=np.float64) - self.origin), 0.0, self.length)
        p = 1.0 + self.exponent
        gained = power(x + self.before, p) - (power(self.before, p) if self.before else 0.0)
        found: Array = self.preload * x + self.stiffness * gained / p + 0.5 * self.stop * x * x
        return found


def graph_force(segments: Sequence[Segment], overlap: ArrayLike, unloading: bool = False) -> Array:
    """Force [N] of a graph at `overlap` [m], any shape, on loading or unloading; negative if it pulls, 0 between segments."""
    found = np.zeros(np.shape(overlap))
    for segment in segments:
        law, stop = segment.shares(overlap)
        found += segment.side * ((1.0 - segment.loss if unloading else 1.0) * law + stop)
    return found + 0.0


def graph_energy(segments: Sequence[Segment], overlap: ArrayLike, power: Callable[..., Any] = np.power) -> Array:
    """Energy [J] that a graph stores at `overlap` [m], any shape."""
    return sum((segment.energy(overlap, power) for segment in segments), np.zeros(np.shape(overlap)))
