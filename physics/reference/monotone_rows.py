"""A chain as rows of monotone graphs: contacts push by overlap, the bed brakes by velocity, each set-valued at its corner.

    contact  OPEN      d < 0   f = 0                      PRESSED   w >= 0  f = F + K d**a
             TOUCHING  d = 0   0 <= f <= F                RELEASED  w <= 0  f = (1 - l) (F + K d**a)
                                                          HELD      w = 0   f between the two
    bed      SLIDES    v != 0  r = R sign(v)              STICKS    v = 0   -R <= r <= R

A row is a point on its graph: its primal value (d, w = 0, or v), its dual value (f or r), and its branch.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import GRAVITY, Chain
from softcradle.physics.reference.collocation import Array, Extended

Branches = NDArray[np.int8]

OPEN, TOUCHING, PRESSED, HELD, RELEASED = 0, 1, 2, 3, 4
BACKWARD, STICKS, FORWARD = -1, 0, 1


@dataclass(frozen=True)
class Rows:
    """The rows of a chain in extended precision: n contacts, and with friction n+1 beds.

    Attributes:
        preload, stiffness, exponent, loss: (n,) of the contacts.
        inverse_mass: (n+1,), 0 for a wall.
        bed: (n+1,) friction of a sliding bead [N], or empty.
        external: (n+1,) steady force on each bead [N].
        response: (n+b, n+b) what the dual values take from the acceleration of each row's primal value.
    """

    preload: Array
    stiffness: Array
    exponent: Array
    loss: Array
    inverse_mass: Array
    bed: Array
    external: Array
    response: NDArray[np.float64]

    @classmethod
    def of(cls, chain: Chain, external: NDArray[np.float64] | None) -> Rows:
        """The rows of `chain` under the force `external` (n+1,) on its beads."""
        n = chain.contacts
        laws = [(c.preload, c.stiffness, c.exponent, c.loss) for c in chain.power_laws]
        preload, stiffness, exponent, loss = np.array(laws, dtype=Extended).T
        mass = np.array(chain.mass, dtype=Extended)
        inverse_mass = 1.0 / mass
        bed = np.where(np.isfinite(mass), mass, 0.0) * Extended(GRAVITY) * Extended(chain.friction)
        for brake in chain.brakes:  # steady here: forces over time come in pieces
            beads = [bead for bead in brake.beads if np.isfinite(mass[bead])]
            bed[beads] += Extended(max(brake.force))
        bed = bed if chain.on_bed else np.zeros(0, dtype=Extended)
        force = np.zeros(n + 1, dtype=Extended) if external is None else external.astype(Extended)
        difference = np.eye(n, n + 1) - np.eye(n, n + 1, 1)
        rows = np.vstack((difference, np.eye(n + 1))) if chain.on_bed else difference
        response = rows * inverse_mass.astype(np.float64) @ rows.T
        return cls(preload, stiffness, exponent, loss, inverse_mass, bed, force, response)

    @property
    def contacts(self) -> int:
        """Number n of contacts."""
        return self.preload.size

    def acceleration(self, force: Array, friction: Array) -> Array:
        """(..., n+1) accelerations of the beads under contact forces (..., n) and bed friction (..., n+1 or 0)."""
        net = np.empty((*force.shape[:-1], force.shape[-1] + 1), dtype=Extended)
        net[...] = self.external
        net[..., :-1] -= force
        net[..., 1:] += force
        if self.bed.size:
            net -= friction
        return net * self.inverse_mass

    def law(self, overlap: Array) -> Array:
        """(..., n) forces of contacts that are pressed in, at overlaps >= 0."""
        found: Array = self.preload + self.stiffness * np.maximum(overlap, 0.0) ** self.exponent
        return found

    def stored(self, overlap: Array) -> Array:
        """(..., n) energies of the contacts."""
        pressed = np.maximum(overlap, 0.0)
        found: Array = (self.preload + self.stiffness * pressed**self.exponent / (1.0 + self.exponent)) * pressed
        return found

    def slope(self, overlap: Array) -> Array:
        """(..., n) derivative of `law`; 0 where it is not finite."""
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            found = self.exponent * self.stiffness * overlap ** (self.exponent - 1.0)
        return np.where(
            (overlap > 0.0) & np.isfinite(found), found, np.where(self.exponent == 1.0, self.stiffness, 0.0)
        )

    def inverse(self, force: Array) -> Array:
        """(..., n) overlaps at which `law` is `force`; 0 where the preload alone carries it."""
        excess = np.maximum(force - self.preload, 0.0)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            found = (excess / self.stiffness) ** (1.0 / self.exponent)
        return np.where(excess > 0.0, found, 0.0)
