"""The coupler of a train: a joint of several contacts between the same two beads, that pushes, has slack, pulls, and goes solid.

    overlap d >= 0                  pushes by the gear `push`
    -slack < d < 0                  no force: the two beads are free
    d <= -slack                     pulls by the gear `pull`, that is pressed in by -d - slack
    a gear pressed in by > travel   is solid: the stop pushes or pulls beside it, stop * (way beyond the travel)

Each part is a Contact with an overlap of its own, side * (d - origin); the force of the joint is the sum of theirs, those of the
pulling side with the other sign. So each part loses, holds and touches as that contact does by itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.checked_input import magnitude, require_kind
from softcradle.physics.contact import Contact, Numbers, hooke
from softcradle.physics.segments import Segment, graph_energy, graph_force

Array = NDArray[np.float64]


class Part(NamedTuple):
    """One contact of a coupler.

    Attributes:
        contact: its law.
        side: 1.0 where it pushes, -1.0 where it pulls.
        origin: overlap [m] of the coupler at which it begins.
    """

    contact: Contact
    side: float
    origin: float


@dataclass(frozen=True)
class Coupler:
    """A coupler between two beads that pushes and, after its slack, pulls; its gears go solid at full travel.

    All methods but pymunk carry couplers (yoshida4 without loss); the adaptive ones and "auto" those whose gears that pull or go
    solid have exponents of 1 or more. Others raise a ValueError. Results count pulls as negative forces.

    Parameters
    ----------
    push : Contact
        The contact law that it pushes with.
    pull : Contact, optional
        The contact law that it pulls with; None pulls nothing.
    slack : float, optional
        Way [m] without force between pushing and pulling; only beside `pull`.
    travel : float, optional
        Way [m] of a gear until it is solid, of the pushing and of the pulling one; inf: never.
    stop : float, optional
        Stiffness [N/m] of the stop beyond the travel, which adds to the law of the gear and loses nothing.

    Raises
    ------
    ValueError
        A number out of range, slack without a pull, or one of travel and stop without the other.

    Examples
    --------
    >>> from softcradle import Coupler, hooke
    >>> link = Coupler(hooke(10.0), pull=hooke(20.0), slack=0.5, travel=1.0, stop=1000.0)
    >>> link.force([1.0, 1.01, -0.25, -0.75])
    array([10. , 20.1,  0. , -5. ])
    """

    push: Contact
    pull: Contact | None = None
    slack: float = 0.0
    travel: float = math.inf
    stop: float = 0.0

    def __init_subclass__(cls) -> None:
        """Raise TypeError if a class overrides `parts`, which adaptive methods do not read, and not `segments`."""
        super().__init_subclass__()
        if cls.parts is not Coupler.parts and cls.segments is Coupler.segments:
            raise TypeError(
                f"class {cls.__name__} overrides parts of Coupler: override segments, which define the graph"
            )

    def __post_init__(self) -> None:
        require_kind("coupler push", self.push, Contact)
        if self.pull is not None:
            require_kind("coupler pull", self.pull, Contact)
        for name in ("slack", "stop"):
            object.__setattr__(self, name, magnitude(f"coupler {name}", getattr(self, name), zero=True))
        if self.travel != math.inf:
            object.__setattr__(self, "travel", magnitude("coupler travel", self.travel))
        if self.slack and self.pull is None:
            raise ValueError(f"a coupler with slack {self.slack:g} m needs a pull beyond it; a gap is one of the chain")
        if (self.travel == math.inf) != (self.stop == 0.0):
            raise ValueError(
                f"a coupler needs both travel and stop, or neither, not travel {self.travel:g} m and stop {self.stop:g} N/m"
            )

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Its contacts, the pushing gear first."""
        found = [Part(self.push, 1.0, 0.0)]
        if self.pull is not None:
            found.append(Part(self.pull, -1.0, -self.slack))
        if self.stop:
            found += [Part(hooke(self.stop), side, origin + side * self.travel) for _, side, origin in found]
        return tuple(found)

    @property
    def segments(self) -> list[Segment]:
        """The pieces of its graph from left to right: solid and pulling first, solid and pushing last."""
        pulls = self._gear(self.pull, -1.0, -self.slack)[::-1] if self.pull else []
        return pulls + self._gear(self.push, 1.0, 0.0)

    @property
    def by_segments(self) -> bool:
        """Whether its class defines `segments` and not `parts`: only adaptive methods follow such a graph."""
        return type(self).segments is not Coupler.segments

    def _gear(self, law: Contact, side: float, origin: float) -> list[Segment]:
        """The segments of a gear from its origin outward: as it is pressed in, and solid."""
        found = [gear_segment(law, side, origin, length=self.travel)]
        if self.stop:
            found.append(gear_segment(law, side, origin + side * self.travel, self.travel, self.stop))
        return found

    @property
    def pulls_below(self) -> float:
        """Overlap [m] below which it pulls; -inf where it never does."""
        return -math.inf if self.pull is None else -self.slack

    @property
    def smooth(self) -> bool:
        """Whether no gear that pulls or goes solid has an exponent below 1."""
        gears = [self.pull] if self.pull else []
        return all(gear.exponent >= 1.0 for gear in (gears if self.stop == 0.0 else [self.push, *gears]))

    @property
    def preload(self) -> float:
        """Force [N] at which the pushing gear begins to yield."""
        return self.push.preload

    @property
    def loss(self) -> float:
        """The larger loss of its gears."""
        return max(part.contact.loss for part in self.parts)

    @overload
    def force(self, overlap: float) -> float: ...
    @overload
    def force(self, overlap: ArrayLike) -> Array: ...

    def force(self, overlap: ArrayLike) -> Numbers:
        """Force [N] at `overlap` [m], any shape, on loading; negative if it pulls."""
        return _like(overlap, graph_force(self.segments, overlap))

    def released(self, overlap: ArrayLike) -> Numbers:
        """Force [N] at `overlap` [m], any shape, on unloading."""
        return _like(overlap, graph_force(self.segments, overlap, unloading=True))

    @overload
    def energy(self, overlap: float) -> float: ...
    @overload
    def energy(self, overlap: ArrayLike) -> Array: ...

    def energy(self, overlap: ArrayLike) -> Numbers:
        """Energy stored [J] at `overlap` [m], any shape."""
        return self.stored_energy(overlap)

    def stored_energy(self, overlap: ArrayLike, power: Callable[..., Any] = np.power) -> Numbers:
        """Energy stored [J]; `power` as of :func:`softcradle.physics.contact.stored_energy`."""
        return _like(overlap, graph_energy(self.segments, overlap, power))


def gear_segment(
    law: Contact, side: float, origin: float, before: float = 0.0, stop: float = 0.0, length: float = math.inf
) -> Segment:
    """Return the segment of a gear with this `law`, on which it goes on from the displacement `before`, beside a `stop`."""
    return Segment(side, origin, law.preload, law.stiffness, law.exponent, law.loss, length, before, stop)


def _like(overlap: ArrayLike, found: Array) -> Numbers:
    """Return `found` as an array, or as a float if `overlap` was a number."""
    return float(found) if np.ndim(overlap) == 0 else found
