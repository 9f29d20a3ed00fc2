"""Contact laws of a chain for the reference: power laws in NumPy, user-defined laws through their own functions.

A coupler consists of several contacts between the same two beads. Each has its own overlap, side * (overlap of the
joint - origin).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.contact import Contact, stored_energy
from softcradle.physics.coupler import Coupler
from softcradle.physics.own_law import LEAST_OVERLAP, OwnLaw

Array = NDArray[np.float64]

# Fraction of the depth. A user-defined law is stiff if its slope grows between this overlap and a thousandth of it.
SHALLOW = 1e-3
GROWS = 1.5  # Smallest growth of the slope of a stiff law. It is that of a power law with the exponent 0.94.


class Laws:
    """Force, slope, energy and overlap of all m contacts at once. Each part of a coupler is a separate contact.

    Attributes:
        joint: (m,) index of the pair of neighbours of each contact.
        side, origin: (m,) sign and shift of the overlap; 1 and 0 for a contact that is not part of a coupler.
        preload: (m,) force [N] up to which each contact does not yield.
        loss: (m,) share of the stored energy that each contact absorbs.
        depth: (m,) largest overlap [m] if the contact alone is struck at the speed of the motion.
        stiff: True if the slope of a force is unbounded at small overlaps.
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
        # The smaller of the solutions for the preload alone and for the power law alone.
        with np.errstate(divide="ignore"):
            self.depth = np.minimum(energy / self.preload, (power * energy / self.stiffness) ** (1.0 / power))
        for law, at in self.own:
            self.depth[at] = [law.depth(value) for value in energy[at].tolist()]
        by_power = (self.stiffness * (self.exponent < 1.0) > 0.0).any()
        deep = [(law, float(self.depth[i])) for law, at in self.own for i in at]
        self.stiff = bool(by_power) or any(
            law.slope(SHALLOW**2 * d) > GROWS * law.slope(SHALLOW * d) for law, d in deep
        )

    def force(self, overlap: Array) -> Array:
        """Return the (..., m) forces [N] of loaded contacts at overlaps (..., m). They are not finite beyond the range
        of a law.
        """
        found: Array = self.preload + self.stiffness * np.maximum(overlap, 0.0) ** self.exponent
        for law, at in self.own:
            found[..., at] = law.tried(np.maximum(overlap[..., at], LEAST_OVERLAP))
        return found

    def slope(self, overlap: Array) -> Array:
        """Return the (m,) slopes df/dd [N/m]. At overlap 0 the slope of a power law may be infinite; the result is then 0."""
        found = np.zeros(overlap.size)
        pressed = overlap > LEAST_OVERLAP
        factor = self.exponent[pressed] * self.stiffness[pressed]
        found[pressed] = factor * overlap[pressed] ** (self.exponent[pressed] - 1.0)
        for law, at in self.own:
            found[at] = [law.slope(d) if d > LEAST_OVERLAP else 0.0 for d in overlap[at].tolist()]
        return found

    def energy(self, overlap: Array) -> Array:
        """Return the (..., m) energies [J] stored at overlaps (..., m)."""
        found = stored_energy(self.preload, self.stiffness, self.exponent, overlap)
        for law, at in self.own:
            found[..., at] = law.energy(overlap[..., at])
        return found

    def resting_overlap(self, force: Array, overlap: Array) -> Array:
        """Return the (m,) overlaps [m] at which contacts carry `force` (m,). Contacts with preload keep the given
        `overlap`.
        """
        found, pushed = overlap.copy(), np.maximum(force, 0.0)
        small = self.preload == 0.0
        found[small] = (pushed[small] / self.stiffness[small]) ** (1.0 / self.exponent[small])
        for law, at in self.own:
            found[at] = law.overlap(pushed[at])
        return found
