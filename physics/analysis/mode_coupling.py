"""Mode-coupling model, Sec. III and Appendix A: the collective modes of a collision, and all overlaps computed from
them.

A cluster that moves as one body distributes the incoming momentum: the force behind bead i is the force at the head of
the cluster times the mass fraction behind it, Eq. (5). So all overlaps of a cluster follow from its first one, Eqs. (7)
and (A1). The remaining unknowns are three overlaps: Phi between the clusters, and psi and psi-bar, the first overlap
inside each cluster. With M = m2 + ... + mn, Eqs. (8), (A3) read

    Phi'' = -(1/m0 + 1/m1) f01(Phi) + (1/m1) f12(psi)
    psi'' =  (1/m1) f01(Phi) - (1/m1 + 1/M) f12(psi)

This is Newton's equation (3) of a chain of three beads m0, m1, M with the contacts f01 and f12. All beads of the
cluster behind its first bead are lumped into the bead M. So the reduced chain is an ordinary Chain. For a cluster that
strikes a cluster it has four beads. For a cluster with a steady external force it has two. The reduced chain conserves
the energy ``H = q'.L^-1.q'/2 + E01(Phi) + E12(psi)``, q = (Phi, psi), because L is symmetric.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.chain import Chain, mass_shares
from softcradle.physics.simulation import simulate
from softcradle.physics.state import checked_velocity, from_anchor
from softcradle.physics.trajectory import Trajectory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Reduction:
    """Modes of a chain, and the reduced chain of these modes, Eqs. (A1), (A3).

    Attributes:
        chain: the whole chain.
        modes: indices of the neighbouring contacts that are modes: psi-bar (if any), Phi (if any), psi (if any).
        struck: index of the contact of Phi, or None for a driven cluster without a striker.
    """

    chain: Chain
    modes: tuple[int, ...]
    struck: int | None

    @classmethod
    def of(cls, chain: Chain, velocity: ArrayLike) -> Reduction:
        """Return the reduction of two colliding clusters, or of one cluster that is driven at an end.

        Raises:
            ValueError: if the start is neither of these cases, if a contact inside a cluster is not a power law, or if
                its beads are not free.
        """
        if chain.timed or chain.dissipative:
            raise ValueError(
                "mode coupling needs steady forces and free beads: no forces over time, no loss, no bed and no brakes"
            )
        struck = _struck(chain, checked_velocity(chain, velocity))
        ends = (0, 1) if struck is None else (max(struck - 1, 0), min(struck + 2, chain.contacts))
        found = cls(chain, tuple(range(*ends)), struck)
        for i in set(range(chain.contacts)) - {struck}:
            if chain.power_laws[i].preload > 0.0 or chain.power_laws[i].stiffness == 0.0:
                raise ValueError(f"mode coupling needs power laws inside a cluster, contact {i} has a preload")
            if chain.gap[i] != 0.0:
                raise ValueError(
                    f"mode coupling needs clusters that just touch, contact {i} has a gap of {chain.gap[i]:g}"
                )
        lumped = [j for lump in found.lumps if lump.stop - lump.start > 1 for j in range(lump.start, lump.stop)]
        for j in lumped:  # By Eq. (5), the force at the head of a cluster is distributed in proportion to mass.
            if math.isinf(chain.mass[j]) or (chain.drive is not None and chain.drive[j] != 0.0):
                raise ValueError(f"mode coupling needs free beads inside a cluster, bead {j} is a wall or driven")
        return found

    @cached_property
    def lumps(self) -> tuple[slice, ...]:
        """Beads of the whole chain that form each bead of the reduced chain."""
        edges = (0, *(i + 1 for i in self.modes), self.chain.contacts + 1)
        return tuple(slice(a, b) for a, b in pairwise(edges))

    @cached_property
    def reduced(self) -> Chain:
        """Chain of the modes: lumped masses, the contacts that are modes, and the drive of beads that are not lumped."""
        chain = self.chain
        drive = None if chain.drive is None else [sum(chain.drive[lump]) for lump in self.lumps]
        masses = [sum(chain.mass[lump]) for lump in self.lumps]
        return Chain(masses, [chain.power_laws[i] for i in self.modes], [chain.gap[i] for i in self.modes], drive)

    @cached_property
    def carrier(self) -> NDArray[np.int_]:
        """(n,) index of the reduced contact whose force each contact of the whole chain transmits."""
        return np.arange(self.chain.contacts).clip(self.modes[0], self.modes[-1]) - self.modes[0]

    @cached_property
    def share(self) -> Array:
        """(n,) force of each contact, divided by the force of its carrier, Eq. (5). The share is 1 for the modes."""
        first, last = self.modes[0], self.modes[-1]
        before, beyond = mass_shares(self.chain.mass, first), mass_shares(self.chain.mass, last)
        return np.concatenate((before[:first], np.ones(last - first), beyond[last:]))

    def overlaps(self, overlap: Array, rate: Array) -> tuple[Array, Array]:
        """Return the overlaps and rates (T, n) of the whole chain, Eqs. (7), (A1).

        These values follow from `overlap` and `rate` (T, r) of the reduced chain.

        If the mode of a cluster is open, the cluster transmits no force, and its overlaps are 0.
        """
        modes, rates = overlap[:, self.carrier], rate[:, self.carrier]
        is_mode = np.isin(np.arange(self.chain.contacts), self.modes)
        pressed = np.maximum(modes, 0.0)
        factor, power = self.profile
        with np.errstate(divide="ignore", invalid="ignore"):
            inner = factor * pressed**power
            inner_rate = np.where(pressed > 0.0, power * inner / pressed * rates, 0.0)
        return np.where(is_mode, modes, inner), np.where(is_mode, rates, inner_rate)

    @cached_property
    def profile(self) -> tuple[Array, Array]:
        """Coefficients C and r, each (n,), of the depth law ``overlap = C * mode**r``, Eq. (A1)."""
        _, stiffness, exponent = self.chain.power_law_rows.T
        carrier = self.carrier + self.modes[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            factor = (self.share * stiffness[carrier] / stiffness) ** (1.0 / exponent)
        return factor, exponent[carrier] / exponent


@dataclass(frozen=True, eq=False)
class ModeCoupling:
    """Solution of the mode-coupling equations.

    Attributes
    ----------
    reduction : Reduction
        Contacts that are modes.
    reduced : Trajectory
        Motion of the reduced chain.
    trajectory : Trajectory
        Motion of the whole chain: overlaps, rates and forces follow from the modes by Eqs. (5), (7), (A1). The bead
        positions follow from the overlaps. The momentum inside a cluster is therefore only as accurate as the
        model.
    """

    reduction: Reduction
    reduced: Trajectory
    trajectory: Trajectory

    @property
    def time(self) -> Array:
        """(T,) sample times [s]."""
        return self.reduced.time

    @property
    def phi(self) -> Array | None:
        """(T,) Phi [m], the overlap of the two clusters, Eq. (4); None for a driven cluster."""
        return self._mode(self.reduction.struck)

    @property
    def psi(self) -> Array | None:
        """(T,) psi [m], the first overlap inside the struck (or driven) cluster, Eq. (6); None for a single bead."""
        struck = self.reduction.struck
        return self._mode(self.reduction.modes[0] if struck is None else struck + 1)

    @property
    def psi_bar(self) -> Array | None:
        """(T,) psi-bar [m], the last overlap inside the striking cluster, App. A (ii); None for a single bead."""
        struck = self.reduction.struck
        return None if struck is None else self._mode(struck - 1)

    @property
    def acceleration(self) -> Array:
        """(T, r) second derivatives of the modes [m/s^2], the right-hand sides of Eqs. (8), (A3)."""
        chain = self.reduced.chain
        net = np.zeros((self.time.size, chain.contacts + 1))
        if chain.drive_force is not None:
            net += chain.drive_force
        net[:, :-1] -= self.reduced.force
        net[:, 1:] += self.reduced.force
        bead = net * chain.inverse_mass
        return bead[:, :-1] - bead[:, 1:]

    def returns(self, contact: int) -> float:
        """Return the time [s] at which the mode of `contact` (an index of the whole chain) first returns to zero.

        The result is infinite if the mode never returns to zero.
        """
        intervals = self.reduced.contact_intervals[self.reduction.modes.index(contact)]
        return intervals[0][1] if intervals else float("inf")

    def _mode(self, contact: int | None) -> Array | None:
        modes = self.reduction.modes
        return self.reduced.overlap[:, modes.index(contact)] if contact in modes else None


def mode_coupling(
    chain: Chain,
    velocity: ArrayLike,
    duration: float | None = None,
    method: str = "accurate",
    step: float | None = None,
    samples: int | ArrayLike = 201,
    tolerance: float = 1e-8,
) -> ModeCoupling:
    """Solve the mode-coupling equations (8), (A3) of `chain` and compute all its overlaps and forces from the modes.

    Parameters
    ----------
    chain : Chain
        One cluster that strikes another, or one cluster with a drive on its first bead.
    velocity : array_like
        (n+1,) initial velocities [m/s].
    duration : float, optional
        Duration [s]. Without it, the run ends when every mode has returned to zero.
    method : str, optional
        As in `simulate`.
    step : float, optional
        As in `simulate` [s].
    samples : int or array_like, optional
        As in `simulate`.
    tolerance : float, optional
        As in `simulate`.

    Returns
    -------
    ModeCoupling
        The modes, and the motion of the whole chain that follows from them.

    Raises
    ------
    ValueError
        If the start is neither of these cases. If a cluster contains a wall, a contact that is not a power law, or
        a driven bead other than its first one. If the chain has loss, a bed or forces over time. Also as in
        `simulate`.

    >>> from softcradle import one_on, power_law
    >>> found = mode_coupling(one_on(4, power_law(1.0, 0.1)), [1, 0, 0, 0, 0])
    >>> print(f"{found.phi.max():.4f} {found.psi.max():.4f}")
    0.4498 0.0513
    """
    reduction = Reduction.of(chain, velocity)
    speeds = [np.asarray(velocity, dtype=np.float64)[lump][0] for lump in reduction.lumps]
    reduced = simulate(reduction.reduced, speeds, duration, method, step, samples, tolerance)
    return ModeCoupling(reduction, reduced, _whole(reduction, reduced))


def _whole(reduction: Reduction, reduced: Trajectory) -> Trajectory:
    chain, head = reduction.chain, reduction.modes[0]
    overlap, rate = reduction.overlaps(reduced.overlap, reduced.rate)
    position = from_anchor(overlap, reduced.position[:, 0], head)
    velocity = from_anchor(rate, reduced.velocity[:, 0], head)
    final = np.repeat(reduced.final_velocity, [lump.stop - lump.start for lump in reduction.lumps])
    return replace(
        reduced,
        chain=chain,
        overlap=overlap,
        rate=rate,
        anchor=np.column_stack((position[:, chain.anchor], velocity[:, chain.anchor])),
        force=reduction.share * reduced.force[:, reduction.carrier],
        final_velocity=final,
        contact_intervals=tuple(reduced.contact_intervals[i] for i in reduction.carrier),
        method=f"mode coupling, {reduced.method}",
        # The error estimate of the method does not contain the error of the model.
        velocity_error=np.full(final.size, np.nan),
    )


def _struck(chain: Chain, velocity: Array) -> int | None:
    """Return the index of the only contact that closes at the start.

    The result is None if nothing moves and the first bead is driven.
    """
    closing = np.flatnonzero(np.diff(velocity))
    if closing.size == 0 and chain.drive is not None and not any(chain.drive[1:]):
        return None
    if closing.size != 1 or velocity[closing[0]] < velocity[closing[0] + 1]:
        raise ValueError("mode coupling needs one cluster that strikes another, or a drive on the first bead of one")
    return int(closing[0])
