"""Contact laws of a chain for the reference solution. Segments use NumPy, user-defined laws call their functions.

A contact has one row of arrays for its pushing segments and one row for its pulling segments. The displacement of a row
is side (d - origin). Here d is the overlap, and `origin` belongs to the first segment of the row. The sections of a row
are its segments.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.contact import stored_energy
from softcradle.physics.own_law import LEAST_OVERLAP, OwnLaw
from softcradle.physics.segments import Segment

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

# Fraction of the depth at which the slope of a user-defined law is tested. If the slope grows from this overlap down to
# a thousandth of it, the law is stiff.
SHALLOW = 1e-3
# Smallest growth factor of the slope of a stiff law. A power law with the exponent 0.94 has this factor.
GROWS = 1.5


class Laws:
    """Force, slope, energy and overlap of all m rows at once. A row is the pushing or the pulling side of a contact.

    Attributes:
        joint: (m,) index of the contact to which each row belongs.
        side, origin: (m,) side and origin of the first segment of each row.
        preload: (m,) force [N] at which each row begins to yield.
        loss: (sections, m) fraction of its energy that each segment dissipates.
        begin, end: (sections, m) displacements [m] at which each segment begins and ends; inf for unused sections.
        depth: (m,) largest displacement [m] of each row if only its contact closes at the speed of the motion.
        stiff: True if the slope of a force is unbounded at small overlaps.
    """

    def __init__(self, chain: Chain, speed: float) -> None:
        sides = [
            (i, list(side))
            for i, graph in enumerate(chain.graphs)
            for side in (
                [one for one in graph if one.side > 0.0],
                [one for one in graph if one.side < 0.0][::-1],
            )
            if side
        ]
        self.joint = np.array([i for i, _ in sides])
        self.side, self.origin = np.array([side[0][:2] for _, side in sides]).T
        sections = max(len(side) for _, side in sides)
        unused = Segment(1.0, 0.0, 0.0, 0.0, 1.0)
        rows = np.array([[one[:9] for one in (*side, *[unused] * (sections - len(side)))] for _, side in sides])
        _, _, force, stiffness, exponent, loss, length, before, stop = rows.transpose(2, 1, 0)
        self._terms = np.array((force, stiffness, exponent, before, stop))
        self.loss, self.end = loss, np.cumsum(length, axis=0)
        self.begin = np.vstack((np.zeros(self.joint.size), self.end[:-1]))
        self.preload, self.stiffness, self.exponent = force[0], stiffness[0].copy(), exponent[0].copy()
        own = dict(chain.own_contacts)
        laws: list[OwnLaw | None] = [own.get(i) for i in self.joint.tolist()]
        self.own = [(law, np.flatnonzero([law == one for one in laws])) for law in chain.own_laws]
        for _, rows_of_law in self.own:
            self._terms[:, :, rows_of_law] = np.nan
        energy, power = 0.5 * speed**2 / chain.inverse_reduced_mass[self.joint], 1.0 + self.exponent
        # Use the smaller of two solutions: one for the preload only, and one for the power law only.
        with np.errstate(divide="ignore"):
            self.depth = np.minimum(energy / self.preload, (power * energy / self.stiffness) ** (1.0 / power))
        for law, of_law in self.own:
            self.depth[of_law] = [law.depth(value) for value in energy[of_law].tolist()]
            self.preload[of_law], self.stiffness[of_law], self.exponent[of_law] = law.preload, np.nan, np.nan
        by_power = (self.stiffness * (self.exponent < 1.0) > 0.0).any()
        deep = [(law, float(self.depth[i])) for law, of_law in self.own for i in of_law]
        self.stiff = bool(by_power) or any(
            law.slope(SHALLOW**2 * d) > GROWS * law.slope(SHALLOW * d) for law, d in deep
        )

    def section(self, overlap: Array, velocity: Array, least: Array) -> Whole:
        """Return for each row (m,) the section that contains its displacement, or that it enters.

        Within `least` (m,) [m] of the end of a section, the velocity decides.
        """
        outside = np.where(
            np.abs(overlap - self.begin) <= least, (velocity > 0.0) & np.isfinite(self.begin), overlap > self.begin
        )
        found: Whole = outside[1:].sum(axis=0)
        return found

    def force(self, overlap: Array, section: Whole, unloading: NDArray[np.bool_]) -> Array:
        """Return the (..., m) forces [N] of loaded rows. They are not finite outside the range of a user-defined law."""
        preload, stiffness, exponent, before, stop = self._terms[:, section, np.arange(section.size)]
        way = np.where(section > 0, overlap - self.begin[section, np.arange(section.size)], np.maximum(overlap, 0.0))
        share = np.where(unloading, 1.0 - self.loss_in(section), 1.0)
        found: Array = share * (preload + stiffness * np.maximum(way + before, 0.0) ** exponent) + stop * way
        for law, at in self.own:
            found[..., at] = law.tried(np.maximum(overlap[..., at], LEAST_OVERLAP))
        return found

    def loss_in(self, section: Whole) -> Array:
        """Return the (m,) losses of the current segments of all rows."""
        found: Array = self.loss[section, np.arange(section.size)]
        return found

    def slope(self, overlap: Array, section: Whole, unloading: NDArray[np.bool_]) -> Array:
        """Return the (m,) slopes df/dd [N/m].

        The result is 0 at overlap 0, because the slope of a power law can be infinite there.
        """
        _, stiffness, exponent, before, stop = self._terms[:, section, np.arange(section.size)]
        found, pressed = np.zeros(overlap.size), overlap > LEAST_OVERLAP
        way = (overlap - self.begin[section, np.arange(section.size)] + before)[pressed]
        share = np.where(unloading, 1.0 - self.loss_in(section), 1.0)[pressed]
        found[pressed] = (
            share * exponent[pressed] * stiffness[pressed] * way ** (exponent[pressed] - 1.0) + stop[pressed]
        )
        for law, at in self.own:
            found[at] = [law.slope(d) if d > LEAST_OVERLAP else 0.0 for d in overlap[at].tolist()]
        return found

    def dissipable(self, overlap: Array) -> Array:
        """Return the (..., m) energies [J] stored at displacements (..., m) that unloading will dissipate."""
        found = np.zeros(overlap.shape)
        for terms, loss, begin, end in zip(
            self._terms.transpose(1, 0, 2), self.loss, self.begin, self.end, strict=True
        ):
            at = np.flatnonzero(loss)
            preload, stiffness, exponent, before, _ = terms[:, at]
            way = np.clip(overlap[..., at] - begin[at], 0.0, end[at] - begin[at])
            gained = stored_energy(preload, stiffness, exponent, way + before)
            found[..., at] += loss[at] * (gained - stored_energy(preload, stiffness, exponent, before))
        return found

    def resting_overlap(self, force: Array, overlap: Array) -> Array:
        """Return the (m,) overlaps [m] at which rows carry `force` (m,). Rows with a preload keep their `overlap`."""
        found, pushed = overlap.copy(), np.maximum(force, 0.0)
        small = self.preload == 0.0
        found[small] = (pushed[small] / self.stiffness[small]) ** (1.0 / self.exponent[small])
        for law, at in self.own:
            found[at] = law.overlap(pushed[at])
        return found
