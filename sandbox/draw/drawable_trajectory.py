"""The track: the history of one lane as the drawing needs it. A row of it is the state at one time."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from softcradle.physics import Chain, Trajectory
from softcradle.sandbox.draw.number_format import scientific

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Track:
    """What one chain did, sample by sample; all in SI units or the paper's.

    Attributes:
        chain: the Chain.
        time: (T,) [s], ascending.
        position, velocity: (T, n+1) [m], bead lengths taken out, and [m/s].
        overlap, force: (T, n) [m] and [N].
        method: how it was made, for the badge.
        absorbed: (T,) energy [J] that contacts with loss and the bed have taken; empty where nothing rubs.
        energy_error, momentum_error: (T,) greatest deviation so far, relative to the first row.
    """

    chain: Chain
    time: Array
    position: Array
    velocity: Array
    overlap: Array
    force: Array
    method: str = ""
    absorbed: Array = field(default_factory=lambda: np.zeros(0))

    @cached_property
    def kinetic(self) -> Array:
        """(T, n+1) kinetic energy of each bead [J]; 0 for a wall."""
        return 0.5 * self._mass * self.velocity**2

    @cached_property
    def stored(self) -> Array:
        """(T,) energy in all contacts [J]."""
        contacts = zip(self.chain.contact, self.overlap.T, strict=True)
        energies: Array = np.array([contact.energy(overlap) for contact, overlap in contacts])
        total: Array = energies.sum(axis=0)
        return total

    @cached_property
    def momentum(self) -> Array:
        """(T, n+1) momentum of each bead [N s]; 0 for a wall."""
        return self._mass * self.velocity

    @cached_property
    def energy_error(self) -> Array:
        """(T,) greatest relative change so far of the energy, what was absorbed and what a drive gave counted in."""
        energy = self.kinetic.sum(axis=1) + self.stored - self._given(self.position)
        if self.absorbed.size:
            energy = energy + self.absorbed
        return _worst_so_far(energy, self.kinetic.sum(axis=1).max())

    @cached_property
    def momentum_error(self) -> Array:
        """(T,) greatest change of the momentum so far, relative to the sum of the beads' momenta without sign."""
        momentum = self.momentum.sum(axis=1) - self._given(np.where(self._mass > 0.0, self.time[:, None], 0.0))
        return _worst_so_far(momentum, np.abs(self.momentum).sum(axis=1).max())

    def _given(self, path: Array) -> Array:
        """(T,) what the drive, which acts from t = 0 on, has given along `path` (T, n+1): work, or impulse."""
        if self.chain.drive_force is None:
            return np.zeros(len(self.time))
        start = np.searchsorted(self.time, 0.0)
        return np.where(self.time > 0.0, (path - path[start]) @ self.chain.drive_force, 0.0)

    @cached_property
    def _mass(self) -> Array:
        mass = np.array(self.chain.mass)
        return np.where(np.isfinite(mass), mass, 0.0)


def _worst_so_far(value: Array, unit: float) -> Array:
    deviation = np.abs(value - value[0])
    return np.maximum.accumulate(deviation) / unit if unit > 0.0 else deviation


def track_of(trajectory: Trajectory, lead: Array | None = None) -> Track:
    """The track of `trajectory`, with free flight before it at the times `lead` < 0 (see :func:`longest_lead`)."""
    times = np.empty(0) if lead is None else lead - trajectory.time[0]
    start, flight = trajectory.velocity[0], times[:, None]
    ahead = np.zeros((len(times), trajectory.chain.contacts))
    taken = trajectory.absorbed_by_contacts + trajectory.absorbed_by_bed
    return Track(
        chain=trajectory.chain,
        time=np.concatenate((times, trajectory.time)),
        position=np.concatenate((trajectory.position[0] + flight * start, trajectory.position)),
        velocity=np.concatenate((ahead[:, :1] + start, trajectory.velocity)),
        overlap=np.concatenate((trajectory.overlap[0] + flight * trajectory.rate[0], trajectory.overlap)),
        force=np.concatenate((ahead, trajectory.force)),
        method=f"{trajectory.method}, step {scientific(trajectory.step)} s" if trajectory.step else trajectory.method,
        absorbed=np.concatenate((ahead[:, 0], taken)) if trajectory.chain.dissipative else np.zeros(0),
    )


def longest_lead(chain: Chain, velocity: Array) -> float:
    """Time [s] before the start during which all beads flew freely: inf, or until two that now part were in touch.

    0 on a bed that rubs: what moved there was faster before.
    """
    if chain.friction:
        return 0.0
    parting, gap = np.maximum(np.diff(velocity), 0.0), np.array(chain.gap)
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.min(np.where(parting > 0.0, gap / parting, np.inf)))
