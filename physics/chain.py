"""The chain: masses on a line and the contacts between neighbours. Immutable: what moves is the State."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.contact import Contact, stored_energy

Array = NDArray[np.float64]

GRAVITY = 9.80665  # [m/s²], the standard value: bed friction is proportional to it


class Parameters(NamedTuple):
    """Laws and masses of a chain as the contiguous arrays that kernels take."""

    law: Array  # (n, 3): preload, stiffness, exponent of each contact
    inverse_mass: Array  # (n+1,) [1/kg]; 0 for a wall


@dataclass(frozen=True)
class Chain:
    """n+1 masses on a line and n contacts between neighbours, Eq. (3).

    Arguments:
        mass: (n+1,) masses [kg], n >= 1; ``math.inf`` is a wall, which keeps its velocity.
        contact: one Contact for all, or n of them; kinds mix freely.
        gap: distance [m] between neighbours at the start, one for all or n of them; 0 is just touching, and below 0 the
            contact is pressed from the start, by the overlap -gap.
        drive: (n+1,) steady external force on each bead [N], or None; it acts from t = 0 on.
        friction: Coulomb coefficient >= 0 of the bed: it holds a bead at rest with up to ``friction * mass * GRAVITY``
            and brakes a sliding one with that. It does not act on walls.

    Raises:
        ValueError: a number out of range, a wrong length, or two walls side by side.

    >>> from softcradle import power_law
    >>> Chain([1, 1, math.inf], power_law(1.0, 0.1)).contacts
    2
    """

    mass: tuple[float, ...]
    contact: tuple[Contact, ...]
    gap: tuple[float, ...]
    drive: tuple[float, ...] | None = None
    friction: float = 0.0

    def __init__(
        self,
        mass: ArrayLike,
        contact: Contact | Sequence[Contact],
        gap: ArrayLike = 0.0,
        drive: ArrayLike | None = None,
        friction: float = 0.0,
    ) -> None:
        masses = _checked_masses(mass)
        n = len(masses) - 1
        object.__setattr__(self, "mass", masses)
        object.__setattr__(self, "contact", _checked_contacts(contact, n))
        object.__setattr__(self, "gap", _checked_gaps(gap, n))
        object.__setattr__(self, "drive", None if drive is None else _checked_drive(drive, n))
        object.__setattr__(self, "friction", _checked_friction(friction))

    @property
    def contacts(self) -> int:
        """Number n of contacts; there are n+1 beads."""
        return len(self.contact)

    @property
    def walls(self) -> int:
        """Number of beads of infinite mass."""
        return sum(math.isinf(mass) for mass in self.mass)

    @cached_property
    def anchor(self) -> int:
        """Index of the heaviest bead (a wall if there is one): the bead whose position and velocity are in the State."""
        return int(np.argmax(self.mass))

    @cached_property
    def parameters(self) -> Parameters:
        """Laws and masses as read-only arrays."""
        law = np.array([(c.preload, c.stiffness, c.exponent) for c in self.contact])
        inverse_mass = 1.0 / np.array(self.mass)
        for array in (law, inverse_mass):
            array.setflags(write=False)
        return Parameters(law, inverse_mass)

    def stored_energy(self, overlap: ArrayLike) -> Array:
        """(..., n) energy [J] in each contact at overlaps (..., n) [m], see :meth:`Contact.energy`."""
        preload, stiffness, exponent = self.parameters.law.T
        return stored_energy(preload, stiffness, exponent, overlap)

    @cached_property
    def inverse_reduced_mass(self) -> Array:
        """(n,) 1/m_i + 1/m_(i+1) of the two beads of each contact [1/kg]: the diagonal of L = B M^-1 B^T."""
        inverse_mass = self.parameters.inverse_mass
        found: Array = inverse_mass[:-1] + inverse_mass[1:]
        found.setflags(write=False)
        return found

    @cached_property
    def loss(self) -> Array:
        """(n,) loss of each contact."""
        loss = np.array([contact.loss for contact in self.contact])
        loss.setflags(write=False)
        return loss

    @cached_property
    def bed(self) -> Array:
        """(n+1,) deceleration [m/s²] of a bead that slides, 0 for a wall; empty without friction."""
        bed = np.where(np.isfinite(self.mass), self.friction * GRAVITY, 0.0) if self.friction else np.zeros(0)
        bed.setflags(write=False)
        return bed

    @cached_property
    def dissipative(self) -> bool:
        """Whether the bed has friction or a contact has loss."""
        return self.friction > 0.0 or bool(self.loss.any())

    @cached_property
    def drive_force(self) -> Array | None:
        """(n+1,) the drive as a read-only array [N]; None for a chain that is not driven."""
        if self.drive is None:
            return None
        force = np.array(self.drive)
        force.setflags(write=False)
        return force


def _checked_masses(mass: ArrayLike) -> tuple[float, ...]:
    masses = np.asarray(mass, dtype=np.float64)
    if masses.ndim != 1 or len(masses) < 2:
        raise ValueError(f"a chain needs a list of at least 2 masses, not shape {masses.shape}")
    if np.isnan(masses).any() or (masses <= 0.0).any():
        raise ValueError(f"every mass must be > 0 (inf is a wall), not {masses[~(masses > 0.0)][0]!r}")
    infinite = np.isinf(masses)
    if (infinite[:-1] & infinite[1:]).any():
        raise ValueError("two walls side by side: a contact between them could never be solved")
    return tuple(masses.tolist())


def _checked_contacts(contact: Contact | Sequence[Contact], n: int) -> tuple[Contact, ...]:
    contacts = (contact,) * n if isinstance(contact, Contact) else tuple(contact)
    if len(contacts) != n:
        raise ValueError(f"{n + 1} masses need one contact for all or {n} contacts, not {len(contacts)}")
    for item in contacts:
        if not isinstance(item, Contact):
            raise ValueError(f"every contact must be a Contact, not {item!r}")
    return contacts


def _checked_gaps(gap: ArrayLike, n: int) -> tuple[float, ...]:
    gaps = np.asarray(gap, dtype=np.float64)
    if gaps.ndim > 1 or (gaps.ndim == 1 and len(gaps) != n):
        raise ValueError(f"{n + 1} masses need one gap for all or {n} gaps, not shape {gaps.shape}")
    if not np.isfinite(gaps).all():
        raise ValueError(f"every gap must be a finite number, not {gap!r}")
    return tuple(np.broadcast_to(gaps, (n,)).tolist())


def _checked_drive(drive: ArrayLike, n: int) -> tuple[float, ...] | None:
    """The forces as a tuple, or None where all are 0: such a chain is not driven."""
    forces = np.asarray(drive, dtype=np.float64)
    if forces.shape != (n + 1,):
        raise ValueError(f"{n + 1} masses need {n + 1} drive forces, not shape {forces.shape}")
    if not np.isfinite(forces).all():
        raise ValueError("every drive force must be finite")
    return tuple(forces.tolist()) if forces.any() else None


def _checked_friction(friction: float) -> float:
    value = float(friction)
    if not (math.isfinite(value) and value >= 0.0):
        raise ValueError(f"friction must be a finite number >= 0, not {friction!r}")
    return value


def one_on(n: int, contact: Contact | Sequence[Contact], mass: ArrayLike = 1.0) -> Chain:
    """A striker and a target cluster of `n` >= 1 beads, all just touching; Fig. 1. `mass` [kg]: one for all or n+1."""
    return cluster_on_cluster(1, n, contact, mass)


def cluster_on_cluster(m: int, n: int, contact: Contact | Sequence[Contact], mass: ArrayLike = 1.0) -> Chain:
    """`m` >= 1 beads that strike `n` >= 1 beads, all just touching; Appendix A (ii). `mass` [kg]: one for all or m+n."""
    if m < 1 or n < 1:
        raise ValueError(f"a cluster needs at least one bead, not {min(m, n)}")
    masses = np.full(m + n, mass, dtype=np.float64) if np.ndim(mass) == 0 else np.asarray(mass, dtype=np.float64)
    if len(masses) != m + n:
        raise ValueError(f"{m} on {n} needs one mass for all or {m + n} masses, not {len(masses)}")
    return Chain(masses, contact)


def accelerated_mass(mass: ArrayLike, struck: int) -> Array:
    """(n,) mass [kg] that each contact accelerates, seen from the contact `struck`: all beads beyond it, Eq. (4).

    The contact `struck` itself accelerates the beads to its right.
    """
    masses = np.asarray(mass, dtype=np.float64)
    right, left = np.cumsum(masses[::-1])[::-1][1:], np.cumsum(masses)[:-1]
    return np.concatenate((left[:struck], right[struck:]))


def mass_shares(mass: ArrayLike, struck: int) -> Array:
    """(n,) force of each contact as a part of that of `struck` while both sides move as rigid bodies, Eq. (4).

    A contact with a wall beyond it passes on all of the force: its share is 1.

    >>> mass_shares([1.0, 1.0, 1.0, 1.0, 1.0], 0)
    array([1.  , 0.75, 0.5 , 0.25])
    """
    masses = np.asarray(mass, dtype=np.float64)
    beyond = accelerated_mass(masses, struck)
    side = np.where(np.arange(beyond.size) < struck, np.cumsum(masses)[struck], beyond[struck])
    shares: Array = np.divide(beyond, side, out=np.ones(beyond.size), where=np.isfinite(beyond))
    return shares
