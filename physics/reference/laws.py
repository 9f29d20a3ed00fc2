"""The contacts of a chain as the reference evaluates them: power laws in NumPy, laws of one's own by their functions.

A coupler is several contacts between the same two beads, each with an overlap of its own, side * (overlap of the joint - origin).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.contact import Contact, stored_energy
from softcradle.physics.coupler import Coupler
from softcradle.physics.own_law import LEAST_OVERLAP, OwnLaw

Array = NDArray[np.float64]

SHALLOW = 1e-3  # of the depth: a law of one's own whose slope grows from there on down to a thousandth of it is stiff
GROWS = 1.5  # times: the slope of a power law with the exponent .94


class Laws:
    """Force, slope, energy and overlap of all m contacts at once, each part of a coupler for itself.

    Attributes:
        joint: (m,) which two neighbours each contact is between.
        side, origin: (m,) 1 and 0 for a contact that is no part of a coupler.
        preload: (m,) force [N] at which each contact begins to yield.
        loss: (m,) part of its energy that each takes.
        depth: (m,) overlap [m] to which a contact that is struck alone at the speed of the motion is pressed.
        stiff: whether the slope of a force has no bound at small overlaps.
    """

    def __init__(self, chain: Chain, speed: float) -> None:
        parts = [
            (i, *part)
            for i, contact in enumerate(chain.contact)
            for part in (contact.parts if isinstance(contact, Coupler) else ((contact, 1.0, 0.0),))
        ]
        self.joint = np.array([i for i, *_ in parts])
        self.side, self.origin = np.array([part[2:] for part in parts]).T
        laws: list[Contact | OwnLaw] = [law for _, law, _, _ in parts]
        self.preload, self.loss = np.array([(law.preload, law.loss) for law in laws]).T
        self.stiffness, self.exponent = np.array(
            [(law.stiffness, law.exponent) if isinstance(law, Contact) else (np.nan, np.nan) for law in laws]
        ).T
        self.own = [(law, np.flatnonzero([law == one for one in laws])) for law in chain.own_laws]
        energy, power = 0.5 * speed**2 / chain.inverse_reduced_mass[self.joint], 1.0 + self.exponent
        with np.errstate(divide="ignore"):  # the smaller of both one-term solutions
            self.depth = np.minimum(energy / self.preload, (power * energy / self.stiffness) ** (1.0 / power))
        for law, at in self.own:
            self.depth[at] = [law.depth(value) for value in energy[at].tolist()]
        by_power = (self.stiffness * (self.exponent < 1.0) > 0.0).any()
        deep = [(law, float(self.depth[i])) for law, at in self.own for i in at]
        self.stiff = bool(by_power) or any(
            law.slope(SHALLOW**2 * d) > GROWS * law.slope(SHALLOW * d) for law, d in deep
        )

    def force(self, overlap: Array) -> Array:
        """(..., m) forces [N] of loaded contacts at overlaps (..., m); no finite ones beyond the reach of a law."""
        found: Array = self.preload + self.stiffness * np.maximum(overlap, 0.0) ** self.exponent
        for law, at in self.own:
            found[..., at] = law.tried(np.maximum(overlap[..., at], LEAST_OVERLAP))
        return found

    def slope(self, overlap: Array) -> Array:
        """(m,) slopes df/dd [N/m]; at overlap 0, where that of a power law may be infinite, 0."""
        found = np.zeros(overlap.size)
        pressed = overlap > LEAST_OVERLAP
        factor = self.exponent[pressed] * self.stiffness[pressed]
        found[pressed] = factor * overlap[pressed] ** (self.exponent[pressed] - 1.0)
        for law, at in self.own:
            found[at] = [law.slope(d) if d > LEAST_OVERLAP else 0.0 for d in overlap[at].tolist()]
        return found

    def energy(self, overlap: Array) -> Array:
        """(..., m) energies [J] stored at overlaps (..., m)."""
        found = stored_energy(self.preload, self.stiffness, self.exponent, overlap)
        for law, at in self.own:
            found[..., at] = law.energy(overlap[..., at])
        return found

    def resting_overlap(self, force: Array, overlap: Array) -> Array:
        """(m,) overlaps [m] at which contacts carry `force` (m,): those without preload are pressed a little, others touch."""
        found, pushed = overlap.copy(), np.maximum(force, 0.0)
        small = self.preload == 0.0
        found[small] = (pushed[small] / self.stiffness[small]) ** (1.0 / self.exponent[small])
        for law, at in self.own:
            found[at] = law.overlap(pushed[at])
        return found
