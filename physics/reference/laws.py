"""The contact laws of a chain as the reference evaluates them: power laws in NumPy, laws of one's own by their functions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.own_law import LEAST_OVERLAP

Array = NDArray[np.float64]

# of the depth: a law of one's own whose slope is greater there than at the depth is stiff for small overlaps
SHALLOW = 1e-3


class Laws:
    """Force, slope and overlap of all contacts at once.

    Attributes:
        preload: (n,) force [N] at which each contact begins to yield.
        stiff: whether the slope of a force has no bound at small overlaps.
    """

    def __init__(self, chain: Chain, depth: Array) -> None:
        self.preload, self.stiffness, self.exponent = chain.law_rows.T
        self.own = [
            (law, np.array([i for i, own in chain.own_contacts if own == law], dtype=np.intp)) for law in chain.own_laws
        ]
        by_power = (self.stiffness * (self.exponent < 1.0) > 0.0).any()
        self.stiff = bool(by_power) or any(
            law.slope(SHALLOW * float(depth[i])) > law.slope(float(depth[i])) for i, law in chain.own_contacts
        )

    def force(self, overlap: Array) -> Array:
        """(n,) forces [N] of loaded contacts."""
        found: Array = self.preload + self.stiffness * np.maximum(overlap, 0.0) ** self.exponent
        for law, at in self.own:
            found[at] = law.force(np.maximum(overlap[at], LEAST_OVERLAP))
        return found

    def slope(self, overlap: Array) -> Array:
        """(n,) slopes df/dd [N/m]; at overlap 0, where that of a power law may be infinite, 0."""
        found = np.zeros(overlap.size)
        pressed = overlap > LEAST_OVERLAP
        factor = self.exponent[pressed] * self.stiffness[pressed]
        found[pressed] = factor * overlap[pressed] ** (self.exponent[pressed] - 1.0)
        for law, at in self.own:
            found[at] = [law.slope(d) if d > LEAST_OVERLAP else 0.0 for d in overlap[at].tolist()]
        return found

    def resting_overlap(self, force: Array, overlap: Array) -> Array:
        """(n,) overlaps [m] at which contacts carry `force` (n,): those without preload are pressed a little, others touch."""
        found, pushed = overlap.copy(), np.maximum(force, 0.0)
        small = self.preload == 0.0
        found[small] = (pushed[small] / self.stiffness[small]) ** (1.0 / self.exponent[small])
        for law, at in self.own:
            found[at] = law.overlap(pushed[at])
        return found
