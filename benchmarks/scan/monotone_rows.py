"""A chain as unilateral constraints with maximal monotone graphs: contacts push by overlap, and the bed brakes by
velocity.

    contact  OPEN      d < 0   f = 0                      PRESSED   w >= 0  f = F + K d**a
             TOUCHING  d = 0   0 <= f <= F                RELEASED  w <= 0  f = (1 - l) (F + K d**a)
                                                          HELD      w = 0   f between the two
    bed      SLIDES    v != 0  r = R sign(v)              STICKS    v = 0   -R <= r <= R

Each constraint (row) is a point on its graph, with a primal value (d, w = 0, or v), a dual value (f or r), and a
branch. The force is set-valued at the event between two branches. A coupler consists of several contacts between the
same two beads, each with its own row. A row with side -1 pulls, and its d is side * (d - origin) of the joint.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import GRAVITY, Chain, Joint
from softcradle.physics.contact import Contact, hooke
from softcradle.physics.coupler import Coupler
from softcradle.physics.own_law import OwnLaw

from benchmarks.scan.collocation import Array, Extended

Branches = NDArray[np.int8]

OPEN, TOUCHING, PRESSED, HELD, RELEASED = 0, 1, 2, 3, 4
LEAST = np.finfo(Extended).tiny  # Smallest overlap at which a slope is evaluated [m].
# Largest number of Newton iterations for a convex equation. The start differs from the root by at most log 2.
RESOLVENT_ITERATIONS = 9
# The iteration stops if the change of the logarithm is below this limit. The next change would be its square.
SETTLED = 1e-10
BACKWARD, STICKS, FORWARD = -1, 0, 1


@dataclass(frozen=True)
class Rows:
    """Constraints of a chain in extended precision: m contacts, at least one per pair of neighbours, and n+1 beds with
    friction.

    Attributes:
        joint: (m,) index of the pair of neighbours of each contact.
        side, origin: (m,) orientation and origin of a part of a coupler; 1 and 0 for other contacts.
        preload, stiffness, exponent, loss: (m,) laws of the contacts.
        inverse_mass: (n+1,) inverse masses, 0 for a wall.
        bed: (n+1,) friction of a sliding bead [N], or empty.
        external: (n+1,) steady force on each bead [N].
        response: (m+b, m+b) matrix that gives the accelerations of the primal values from the dual values.
    """

    joint: NDArray[np.intp]
    side: Array
    origin: Array
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
        """Return the constraints of `chain` under the force `external` (n+1,) on its beads."""
        n = chain.contacts
        parts = [(i, *part) for i, contact in enumerate(chain.contact) for part in _parts(contact)]
        joint = np.array([i for i, *_ in parts])
        side, origin = np.array([part[2:] for part in parts], dtype=Extended).T
        laws = [(law.preload, law.stiffness, law.exponent, law.loss) for _, law, _, _ in parts]
        preload, stiffness, exponent, loss = np.array(laws, dtype=Extended).T
        mass = np.array(chain.mass, dtype=Extended)
        inverse_mass = 1.0 / mass
        bed = np.where(np.isfinite(mass), mass, 0.0) * Extended(GRAVITY) * Extended(chain.friction)
        bed = bed if chain.on_bed else np.zeros(0, dtype=Extended)
        force = np.zeros(n + 1, dtype=Extended) if external is None else external.astype(Extended)
        response = _response(joint, side, inverse_mass, chain.on_bed)
        return cls(joint, side, origin, preload, stiffness, exponent, loss, inverse_mass, bed, force, response)

    def under(self, push: Array, brake: Array) -> Rows:
        """Return the constraints with additional external forces and friction (..., n+1) [N].

        The forces belong to one time or to all stages.
        """
        bed = self.bed + np.where(self.inverse_mass > 0.0, brake, 0.0) if self.bed.size else self.bed
        return replace(self, external=self.external + push, bed=bed)

    @property
    def contacts(self) -> int:
        """Number m of contacts. Each part of a coupler counts as a contact."""
        return self.preload.size

    @cached_property
    def order(self) -> NDArray[np.intp]:
        """(m+b,) indices of contacts and beds from one end of the chain to the other."""
        beds = np.arange(self.bed.shape[-1])
        return np.argsort(np.concatenate((self.joint + 0.5, beds)), kind="stable")

    @cached_property
    def answers(self) -> dict[int, tuple[NDArray[np.intp], NDArray[np.float64]]]:
        """Places p in `order`, and responses between the rows at p and p + k, for each distance k."""
        response = self.response[np.ix_(self.order, self.order)]
        first, second = response.nonzero()
        reach, count = int(np.abs(first - second).max(initial=0)), self.order.size
        places = {k: np.arange(max(0, -k), min(count, count - k)) for k in range(-reach, reach + 1)}
        return {k: (place, response[place, place + k]) for k, place in places.items()}

    @cached_property
    def single(self) -> bool:
        """True if each pair of neighbours has exactly one contact."""
        return bool(self.joint.size == self.inverse_mass.size - 1)

    def of_contacts(self, joints: Array, origin: bool = False) -> Array:
        """Return the values (..., m) of the contacts for differences (..., n) of neighbouring beads.

        If `origin` is True, the origin of each contact is subtracted. Overlaps require this subtraction.
        """
        found: Array = joints[..., self.joint] - self.origin if origin else joints[..., self.joint]
        return self.side * found

    def closing(self, beads: Array) -> Array:
        """Return the (..., m) rates at which the contacts close if the beads have the values (..., n+1)."""
        return self.of_contacts(beads[..., :-1] - beads[..., 1:])

    def on_joints(self, force: Array) -> Array:
        """Return the (..., n) forces between neighbours that result from contact forces (..., m). Negative forces pull."""
        if self.single:
            return self.side * force
        total = np.zeros((self.inverse_mass.size - 1, *force.shape[:-1]), dtype=force.dtype)
        np.add.at(total, self.joint, np.moveaxis(self.side * force, -1, 0))
        return np.moveaxis(total, 0, -1)

    def push(self, force: Array) -> Array:
        """Return the (..., n+1) forces on the beads that result from contact forces (..., m) and external forces."""
        joints = self.on_joints(force)
        net = np.empty(
            np.broadcast_shapes((*joints.shape[:-1], self.inverse_mass.size), self.external.shape), dtype=Extended
        )
        net[...] = self.external
        net[..., :-1] -= joints
        net[..., 1:] += joints
        return net

    def acceleration(self, force: Array, friction: Array) -> Array:
        """Return the (..., n+1) accelerations of the beads.

        The contact forces have the shape (..., m), and the bed friction has the shape (..., n+1 or 0).
        """
        net = self.push(force)
        if self.bed.size:
            net -= friction
        return net * self.inverse_mass

    def with_firm(self, firm: NDArray[np.bool_]) -> Rows:
        """Return the constraints for a chain in which the beads `firm` (n+1,) are fixed like walls."""
        if not firm.any():
            return self
        inverse_mass = np.where(firm, 0.0, self.inverse_mass)
        return replace(
            self, inverse_mass=inverse_mass, response=_response(self.joint, self.side, inverse_mass, self.bed.size > 0)
        )

    def law(self, overlap: Array) -> Array:
        """Return the (..., n) forces of loading contacts at overlaps >= 0."""
        found: Array = self.preload + self.stiffness * np.maximum(overlap, 0.0) ** self.exponent
        return found

    def stored(self, overlap: Array) -> Array:
        """Return the (..., n) energies stored in the contacts."""
        pressed = np.maximum(overlap, 0.0)
        found: Array = (self.preload + self.stiffness * pressed**self.exponent / (1.0 + self.exponent)) * pressed
        return found

    def slope(self, overlap: Array) -> Array:
        """Return the (..., n) derivative of `law`, or 0 if it is not finite."""
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            found = self.exponent * self.stiffness * overlap ** (self.exponent - 1.0)
        return np.where(
            (overlap > 0.0) & np.isfinite(found), found, np.where(self.exponent == 1.0, self.stiffness, 0.0)
        )

    def steepness(self, overlap: Array) -> Array:
        """Return the (..., n) derivative of `law` at overlaps > 0. Infinite values are possible."""
        found: Array = self.exponent * self.stiffness * np.maximum(overlap, LEAST) ** (self.exponent - 1.0)
        return found

    def resolvent(self, excess: Array, weight: Array) -> Array:
        """Return the (..., n) overlaps d > 0 with d + weight * stiffness * d**exponent = `excess` > 0.

        The equation is solved by Newton's iteration in log d.
        """
        pull = weight * self.stiffness
        most = np.minimum(excess, np.where(pull > 0.0, (excess / pull) ** (1.0 / self.exponent), excess))
        place = np.log(np.maximum(most, LEAST))
        for _ in range(RESOLVENT_ITERATIONS):
            own, law = np.exp(place), pull * np.exp(self.exponent * place)
            change = (own + law - excess) / (own + self.exponent * law)
            place = place - change
            if np.abs(change).max(initial=0.0) < SETTLED:
                break
        overlap = np.exp(place)
        law = pull * overlap**self.exponent
        slack = self.exponent * law < overlap
        found: Array = np.where(slack, np.maximum(excess - law, 0.5 * overlap), overlap)
        return found

    def inverse(self, force: Array) -> Array:
        """Return the (..., n) overlaps at which `law` equals `force`, or 0 if the preload carries the force."""
        excess = np.maximum(force - self.preload, 0.0)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            found = (excess / self.stiffness) ** (1.0 / self.exponent)
        return np.where(excess > 0.0, found, 0.0)


def _response(joint: NDArray[np.intp], side: Array, inverse_mass: Array, on_bed: bool) -> NDArray[np.float64]:
    """Return the (m+b, m+b) matrix `response` of the class `Rows`."""
    n = inverse_mass.size - 1
    difference = (np.eye(n, n + 1) - np.eye(n, n + 1, 1))[joint] * side.astype(np.float64)[:, None]
    rows = np.vstack((difference, np.eye(n + 1))) if on_bed else difference
    found: NDArray[np.float64] = rows * inverse_mass.astype(np.float64) @ rows.T
    return found


def _parts(contact: Joint) -> tuple[tuple[Contact, float, float], ...]:
    """Return (law, side, origin) of each contact between two neighbours."""
    if isinstance(contact, OwnLaw):
        raise ValueError(f"the reference in extended precision takes no law of your own, {contact.name!r}")
    if not isinstance(contact, Coupler):
        assert isinstance(contact, Contact)
        return ((contact, 1.0, 0.0),)
    gears = [(contact.push, 1.0, 0.0), *([(contact.pull, -1.0, -contact.slack)] if contact.pull else [])]
    stops = [(hooke(contact.stop), side, at + side * contact.travel) for _, side, at in gears] if contact.stop else []
    return *gears, *stops
