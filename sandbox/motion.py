"""Motion of one chain as arrays with one row for each time. Drawings, live plots and the export of a session use these
arrays.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain
from softcradle.physics.state import displacement, from_anchor, hanging_energy

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Motion:
    """States of one chain at T times, in SI units or in the units of the paper.

    Attributes:
        chain: the chain.
        time: (T,) ascending times [s].
        overlap, rate, force: (T, n) overlaps [m], rates of the overlaps [m/s] and contact forces [N].
        anchor: (T, 2) position [m] and velocity [m/s] of the bead ``chain.anchor``.
        absorbed: (T,) energy [J] absorbed so far by contacts with loss and by the bed. The array is empty if the chain
            has neither.
        balance: (T, 2) energy [J] and momentum [N s] that are conserved in theory. Changes of these values are the
            errors of the method. The array is empty for a motion that is still being computed.
        method: name of the method, for a label.
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
        """The (T, n+1) positions [m] of the beads, not counting the lengths of beads. Two beads that just touch have
        the same position.
        """
        return from_anchor(self.overlap, self.anchor[:, 0], self.chain.anchor)

    def middles(self, length: float) -> Array:
        """Return the (T, n+1) positions [m] of the centres of the beads. Each bead is `length` [m] long."""
        return self.position + length * (np.arange(self.chain.contacts + 1) + 0.5)

    @cached_property
    def velocity(self) -> Array:
        """The (T, n+1) velocities of the beads [m/s]."""
        return from_anchor(self.rate, self.anchor[:, 1], self.chain.anchor)

    @cached_property
    def kinetic(self) -> Array:
        """The (T, n+1) kinetic energies of the beads [J]. The kinetic energy of a wall is 0."""
        return 0.5 * self.chain.finite_mass * self.velocity**2

    @cached_property
    def stored(self) -> Array:
        """The (T,) energy [J] stored in all contacts and in the strings of a cradle."""
        energy: Array = self.chain.stored_energy(self.overlap, force=self.force).sum(axis=1)
        return energy + hanging_energy(self.chain, self.overlap, self.anchor[:, 0]) if self.chain.swing else energy

    @cached_property
    def displacement(self) -> Array:
        """The (T, n+1) displacements [m] of beads on strings from their positions at rest."""
        return displacement(self.chain, self.overlap, self.anchor[:, 0])

    @cached_property
    def momentum(self) -> Array:
        """The (T, n+1) momenta of the beads [N s]. The momentum of a wall is 0."""
        return self.chain.finite_mass * self.velocity

    @cached_property
    def energy(self) -> Array:
        """The (T,) sum of the kinetic and the stored energy of the chain [J]."""
        energy: Array = self.kinetic.sum(axis=1) + self.stored
        return energy

    @cached_property
    def energy_error(self) -> Array:
        """The (T,) largest change of the conserved energy so far, relative to the largest kinetic energy. The error is
        NaN if the conserved energy is not known.
        """
        return _worst_so_far(self.balance[:, 0], self.kinetic.sum(axis=1).max())

    @cached_property
    def momentum_error(self) -> Array:
        """The (T,) largest change of the conserved momentum so far, relative to the largest sum of abs(m v)."""
        return _worst_so_far(self.balance[:, 1], np.abs(self.momentum).sum(axis=1).max())


def _worst_so_far(value: Array, unit: float) -> Array:
    deviation = np.abs(value - value[0])
    return np.maximum.accumulate(deviation) / unit if unit > 0.0 else deviation
