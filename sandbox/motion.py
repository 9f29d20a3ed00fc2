"""Motion: what one chain did as arrays, a row a time. Drawing, live plots and the export of a session read it."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain
from softcradle.physics.state import from_anchor

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Motion:
    """States of one chain at T times; all in SI units or the paper's.

    Attributes:
        chain: the Chain.
        time: (T,) [s], ascending.
        overlap, rate, force: (T, n) [m], [m/s] and [N].
        anchor: (T, 2) position [m] and velocity [m/s] of bead ``chain.anchor``.
        absorbed: (T,) energy [J] that contacts with loss and the bed have absorbed; empty for a chain without either.
        balance: (T, 2) energy [J] and momentum [N s] that must not change, of a motion that is over: its errors are their change.
        method: how it was made, for a label.
    """

    chain: Chain
    time: Array
    overlap: Array
    rate: Array
    anchor: Array
    force: Array
    absorbed: Array = field(default_factory=lambda: np.zeros(0))
    balance: Array = field(default_factory=lambda: np.zeros((0, 2)))
    method: str = ""

    @cached_property
    def position(self) -> Array:
        """(T, n+1) positions [m], bead lengths taken out."""
        return from_anchor(self.overlap, self.anchor[:, 0], self.chain.anchor)

    def middles(self, length: float) -> Array:
        """(T, n+1) places of the middles of the beads, each `length` long [m]."""
        return self.position + length * (np.arange(self.chain.contacts + 1) + 0.5)

    @cached_property
    def velocity(self) -> Array:
        """(T, n+1) bead velocities [m/s]."""
        return from_anchor(self.rate, self.anchor[:, 1], self.chain.anchor)

    @cached_property
    def kinetic(self) -> Array:
        """(T, n+1) kinetic energy of each bead [J]; 0 for a wall."""
        return 0.5 * self.chain.finite_mass * self.velocity**2

    @cached_property
    def stored(self) -> Array:
        """(T,) energy in all contacts [J]."""
        energy: Array = self.chain.stored_energy(self.overlap).sum(axis=1)
        return energy

    @cached_property
    def momentum(self) -> Array:
        """(T, n+1) momentum of each bead [N s]; 0 for a wall."""
        return self.chain.finite_mass * self.velocity

    @cached_property
    def energy(self) -> Array:
        """(T,) kinetic and stored energy of the chain [J]."""
        energy: Array = self.kinetic.sum(axis=1) + self.stored
        return energy

    @cached_property
    def energy_error(self) -> Array:
        """(T,) greatest change of the energy so far, relative to the greatest kinetic energy; nan where it is not known."""
        return _worst_so_far(self.balance[:, 0], self.kinetic.sum(axis=1).max())

    @cached_property
    def momentum_error(self) -> Array:
        """(T,) greatest change of the momentum so far, relative to the sum of the beads' momenta without sign."""
        return _worst_so_far(self.balance[:, 1], np.abs(self.momentum).sum(axis=1).max())


def _worst_so_far(value: Array, unit: float) -> Array:
    deviation = np.abs(value - value[0])
    return np.maximum.accumulate(deviation) / unit if unit > 0.0 else deviation
