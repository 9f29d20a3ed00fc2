"""ChainBatch: very many chains of one shape as arrays with one row per chain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.chain import ADJACENT_WALLS, GRAVITY, Chain
from softcradle.physics.checked_input import LARGEST, SMALLEST, number_array, require_kind, shown
from softcradle.physics.contact import LEAST_EXPONENT, MOST_EXPONENT, NO_FORCE, Contact
from softcradle.physics.messages import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class ChainBatch:
    """Batch of C chains with n+1 masses and n contacts each, stored as arrays. A ChainBatch is the input of
    `ensemble_ends`.

    Every argument except `mass` is broadcast to its shape, so one number or one row can apply to all chains. The force
    of a contact is ``preload + stiffness * overlap**exponent``, as for a :class:`Contact`. Everything else is as for a
    :class:`Chain`.

    Parameters
    ----------
    mass : array_like, shape (C, n+1)
        Masses [kg]; ``math.inf`` is a wall.
    preload, stiffness, exponent : array_like, shape (C, n)
        Law of each contact: force [N], stiffness [N/m**exponent] and exponent.
    gap : array_like, shape (C, n), optional
        Distances [m] between neighbours at the start. A negative gap is an overlap.
    loss : array_like, shape (C, n), optional
        Fraction of the stored energy that each contact dissipates when it unloads.
    drive : array_like, shape (C, n+1), optional
        Steady external force on each bead [N].
    friction : array_like, shape (C,), optional
        Coulomb coefficient of the bed.

    Raises
    ------
    ValueError
        If a number is out of range, shapes do not fit, or two walls are neighbours.

    Examples
    --------
    >>> import numpy as np
    >>> exponents = np.linspace(0.05, 0.5, 1000)[:, None]
    >>> batch = ChainBatch(np.ones((1000, 5)), 0.0, 1.0, exponents)
    >>> batch.chains, batch.contacts
    (1000, 4)
    """

    mass: Array
    preload: Array
    stiffness: Array
    exponent: Array
    gap: Array
    loss: Array
    drive: Array
    friction: Array

    def __init__(
        self,
        mass: ArrayLike,
        preload: ArrayLike,
        stiffness: ArrayLike,
        exponent: ArrayLike,
        gap: ArrayLike = 0.0,
        loss: ArrayLike = 0.0,
        drive: ArrayLike = 0.0,
        friction: ArrayLike = 0.0,
    ) -> None:
        masses = number_array("mass", mass)
        if masses.ndim != 2 or masses.shape[1] < 2:
            raise ValueError(f"the masses of a batch must be of shape (chains, beads), not {masses.shape}")
        count, beads = masses.shape
        per_contact = {"preload": preload, "stiffness": stiffness, "exponent": exponent, "gap": gap, "loss": loss}
        rows = {name: _rows(name, value, (count, beads - 1)) for name, value in per_contact.items()}
        rows |= {"mass": _rows("mass", masses, (count, beads)), "drive": _rows("drive", drive, (count, beads))}
        rows["friction"] = _rows("friction", friction, (count,))
        for name, value in rows.items():
            value.setflags(write=False)
            object.__setattr__(self, name, value)
        self._check()

    @classmethod
    def of(cls, chains: Sequence[Chain]) -> ChainBatch:
        """Return a batch that consists of the given chains.

        Parameters
        ----------
        chains : sequence of Chain
            Chains of one length.

        Raises
        ------
        ValueError
            If the lengths differ, or if a chain has couplers, user-defined laws, forces over time, brakes or strings.

        Examples
        --------
        >>> from softcradle import ChainBatch, hertz, one_on
        >>> ChainBatch.of([one_on(4, hertz(k)) for k in (1.0, 2.0)]).chains
        2
        """
        for chain in chains:
            require_kind("every chain", chain, Chain)
            _require_plain(chain)
        if not chains:
            raise ValueError("a batch needs at least one chain")
        lengths = sorted({chain.contacts for chain in chains})
        if len(lengths) > 1:
            raise ValueError(
                f"the chains of a batch must be of one length, not of {lengths[0]} and {lengths[-1]} contacts"
            )
        law = np.array([chain.law_rows for chain in chains])
        beads = lengths[0] + 1
        drive = np.array([np.zeros(beads) if chain.drive is None else chain.drive for chain in chains])
        friction = [chain.friction for chain in chains]
        mass, gap, loss = ([getattr(chain, name) for chain in chains] for name in ("mass", "gap", "loss"))
        return cls(mass, law[..., 0], law[..., 1], law[..., 2], gap, loss, drive, friction)

    def __repr__(self) -> str:
        return f"ChainBatch({self.chains} chains of {self.contacts} contacts)"

    @property
    def chains(self) -> int:
        """Number C of chains."""
        return self.mass.shape[0]

    @property
    def contacts(self) -> int:
        """Number n of contacts of each chain."""
        return self.mass.shape[1] - 1

    def chain(self, index: int) -> Chain:
        """Return one chain of the batch.

        Parameters
        ----------
        index : int
            Index of the chain.
        """
        rows = zip(self.preload[index], self.stiffness[index], self.exponent[index], self.loss[index], strict=True)
        contacts = [Contact(*row) for row in rows]
        return Chain(self.mass[index], contacts, self.gap[index], self.drive[index], self.friction[index])

    @cached_property
    def law_rows(self) -> Array:
        """The (C, n, 3) preloads, stiffnesses and exponents of the contacts."""
        return np.stack([self.preload, self.stiffness, self.exponent], axis=-1)

    @cached_property
    def inverse_mass(self) -> Array:
        """The (C, n+1) inverse masses [1/kg]; 0 for a wall."""
        return 1.0 / self.mass

    @cached_property
    def bed(self) -> Array:
        """The (C, n+1) decelerations [m/s²] of sliding beads; 0 for a wall or without friction."""
        return np.where(np.isfinite(self.mass), (self.friction * GRAVITY)[:, None], 0.0)

    @cached_property
    def anchor(self) -> NDArray[np.int64]:
        """The (C,) index of the heaviest bead of each chain."""
        return np.argmax(self.mass, axis=1)

    @cached_property
    def driven(self) -> NDArray[np.bool_]:
        """Boolean array (C,): True for chains with a drive on a bead."""
        return np.asarray(self.drive.any(axis=1))

    @cached_property
    def on_bed(self) -> NDArray[np.bool_]:
        """Boolean array (C,): True for chains whose sliding beads are braked by the bed."""
        return self.friction > 0.0

    @cached_property
    def lossy(self) -> NDArray[np.bool_]:
        """Boolean array (C,): True for chains with a contact with loss."""
        return np.asarray(self.loss.any(axis=1))

    @cached_property
    def dissipative(self) -> NDArray[np.bool_]:
        """Boolean array (C,): True for chains with a braking bed or with a contact with loss."""
        return np.asarray(np.any([self.on_bed, self.lossy], axis=0))

    def _check(self) -> None:
        """Raise ValueError if a number is outside the range that a Chain accepts."""
        wall = np.isinf(self.mass) & (self.mass > 0.0)
        _require(
            "every mass (inf is a wall)", self.mass, wall | _within(self.mass), f"from {SMALLEST:g} to {LARGEST:g}"
        )
        if (wall[:, :-1] & wall[:, 1:]).any():
            raise InputError(ADJACENT_WALLS)
        for name in ("preload", "stiffness", "friction"):
            value = getattr(self, name)
            _require(name, value, (value == 0.0) | _within(value), f"0 or from {SMALLEST:g} to {LARGEST:g}")
        limits = f"from {LEAST_EXPONENT:g} to {MOST_EXPONENT:g}"
        _require(
            "exponent", self.exponent, (self.exponent >= LEAST_EXPONENT) & (self.exponent <= MOST_EXPONENT), limits
        )
        _require("loss", self.loss, (self.loss >= 0.0) & (self.loss < 1.0), ">= 0 and below 1")
        for name in ("gap", "drive"):
            _require(name, getattr(self, name), np.abs(getattr(self, name)) <= LARGEST, f"up to {LARGEST:g}")
        if not (self.preload + self.stiffness > 0.0).all():
            raise InputError(NO_FORCE)


def _require_plain(chain: Chain) -> None:
    """Raise ValueError if the chain has a feature that the arrays of a batch cannot represent."""
    for found, what in (
        (chain.piecewise, "couplers"),
        (chain.own_laws, "laws of your own"),
        (chain.timed, "forces over time"),
    ):
        if found:
            raise ValueError(f"a batch takes chains of preloaded power laws, not {what}: take ensemble")
    if chain.brakes:
        raise ValueError("a batch takes chains on a bed with one friction, not brakes: take ensemble")
    if chain.swing:
        raise ValueError("a batch takes chains without strings: take ensemble")


def _within(value: Array) -> NDArray[np.bool_]:
    return (value >= SMALLEST) & (value <= LARGEST)


def _rows(name: str, value: ArrayLike, shape: tuple[int, ...]) -> Array:
    """Return `value` broadcast to `shape`, as a new array."""
    found = number_array(name, value)
    try:
        return np.broadcast_to(found, shape).copy()
    except ValueError:
        raise ValueError(f"{name} must fit the shape {shape} of this batch, not {found.shape}") from None


def _require(name: str, value: Array, allowed: NDArray[np.bool_], limits: str) -> None:
    if not allowed.all():
        raise ValueError(f"{name} must be {limits}, not {shown(value[~allowed].flat[0])}")
