"""Chain: masses on a line, and the contacts between neighbours. A chain is immutable. A State contains its motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import update_wrapper
from itertools import pairwise
from typing import Any, Generic, SupportsFloat, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.checked_input import (
    LARGEST,
    SMALLEST,
    magnitude,
    number_array,
    require_kind,
    shown,
    whole_number,
)
from softcradle.physics.contact import Contact, stored_energy
from softcradle.physics.coupler import Coupler
from softcradle.physics.messages import N_, InputError, Message
from softcradle.physics.notebook_views import Shown
from softcradle.physics.own_law import Law, OwnLaw, is_law
from softcradle.physics.segments import PiecewiseContact, Segment, require_graph
from softcradle.physics.timed_force import TimedForce, checked_forces, summed

Array = NDArray[np.float64]
T = TypeVar("T")

Joint = Contact | OwnLaw | PiecewiseContact  # Any contact between two beads, as a chain stores it.
# Any contact that the constructor of Chain accepts. A user-defined law that is not yet an OwnLaw is included.
OneLaw = Contact | PiecewiseContact | Law | Callable[[float], SupportsFloat]
Laws = OneLaw | Sequence[OneLaw]  # One contact for all pairs of neighbours, or one contact for each pair.

MOST_SHOWN = 4  # Largest number of different values in the text that describes a chain.
# Largest number of beads of a cluster. This limit prevents a typing error from exhausting the memory.
MOST_BEADS = 10_000_000
ADJACENT_WALLS = Message("adjacent_walls", "two walls side by side: a contact between them could never be solved")
GRAVITY = 9.80665  # Standard gravity [m/s²]. Bed friction and the restoring force of strings are proportional to it.


class per_chain(Generic[T]):  # noqa: N801 - it is written as a decorator
    """Decorator for a function of a chain whose result is computed once per chain and then stored.

    The decorated function can be an attribute of Chain, or a function with a chain as its only argument. The value is
    stored in the `__dict__` of the chain. Python looks for an attribute in `__dict__` before it calls this descriptor.
    """

    def __init__(self, compute: Callable[[Chain], T]) -> None:
        update_wrapper(self, compute)
        self.compute, self.name = compute, f"{compute.__module__}.{compute.__qualname__}"

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, chain: Chain | None, owner: type) -> T:
        if chain is None:  # Documentation tools access the attribute on the class instead of an instance.
            return cast("T", self)
        found = chain.__dict__[self.name] = self.compute(chain)
        return found

    def __call__(self, chain: Chain) -> T:
        """Return the value for `chain`. Compute it at the first call."""
        known = chain.__dict__
        return known[self.name] if self.name in known else self.__get__(chain, Chain)


@dataclass(frozen=True, repr=False)
class Chain(Shown):
    """A chain: n+1 masses on a line and n contacts between neighbours, Eq. (3).

    Parameters
    ----------
    mass : array_like, shape (n+1,)
        Masses [kg], n >= 1. A mass of ``math.inf`` makes the bead a wall, which keeps its velocity.
    contact : Contact, law or sequence of them
        One contact for all pairs of neighbours, or n of them. Different kinds may be mixed. A :class:`Coupler`,
        which also pulls, is allowed. A user-defined law is allowed as an :class:`OwnLaw`, or as a function or
        object from which an OwnLaw can be made.
    gap : float or array_like, optional
        Distance [m] between neighbours at the start, one for all or n of them. With a gap of 0 two beads just
        touch. A contact with a negative gap is compressed at the start, by the overlap -gap.
    drive : array_like, shape (n+1,), optional
        Constant external force on each bead [N], which acts from t = 0 on. None means no force.
    friction : float, optional
        Coulomb coefficient >= 0 of the bed. Friction holds a bead at rest with a force of up to ``friction * mass *
        GRAVITY`` and brakes a sliding bead with this force. Friction does not act on walls.
    forces : TimedForce or sequence of them, optional
        Time-dependent forces on chosen beads. These forces add to the drive.
    brakes : TimedForce or sequence of them, optional
        Time-dependent brakes on chosen beads. A brake acts like friction, in addition to the bed.
    strings : float, optional
        Length [m] of the strings on which all beads hang, as in a Newton's cradle. None means no strings. Each bead
        swings about its place at the start with the angular frequency ``sqrt(gravity / strings)``. This formula
        holds for small angles. The period of a real pendulum is longer, by 1.7 % at 30 degrees and by 0.2 % at 10
        degrees. A bead of infinite mass stays at rest.
    gravity : float, optional
        Acceleration [m/s²] that acts on beads on strings.

    Raises
    ------
    ValueError
        A number is out of range, a sequence has a wrong length, two walls are neighbours, or a chain on strings has
        a bed or brakes.

    Examples
    --------
    >>> from softcradle import power_law
    >>> Chain([1, 1, math.inf], power_law(1.0, 0.1)).contacts
    2
    """

    mass: tuple[float, ...]
    contact: tuple[Joint, ...]
    gap: tuple[float, ...]
    drive: tuple[float, ...] | None = None
    friction: float = 0.0
    forces: tuple[TimedForce, ...] = ()
    brakes: tuple[TimedForce, ...] = ()
    strings: float | None = None
    gravity: float = GRAVITY

    def __init__(
        self,
        mass: ArrayLike,
        contact: Laws,
        gap: ArrayLike = 0.0,
        drive: ArrayLike | None = None,
        friction: float = 0.0,
        forces: TimedForce | Sequence[TimedForce] = (),
        brakes: TimedForce | Sequence[TimedForce] = (),
        strings: float | None = None,
        gravity: float = GRAVITY,
    ) -> None:
        masses = _checked_masses(mass)
        n = len(masses) - 1
        object.__setattr__(self, "mass", masses)
        object.__setattr__(self, "contact", _checked_contacts(contact, n))
        object.__setattr__(self, "gap", _checked_gaps(gap, n))
        # A drive of zeros is stored as None.
        driven = None if drive is None else bead_forces("drive", drive, n + 1)
        object.__setattr__(self, "drive", None if driven is None or not driven.any() else tuple(driven.tolist()))
        object.__setattr__(self, "friction", magnitude("friction", friction, zero=True))
        object.__setattr__(self, "forces", checked_forces("forces", forces, masses))
        object.__setattr__(self, "brakes", checked_forces("brakes", brakes, masses, brakes=True))
        object.__setattr__(
            self, "strings", None if strings is None else magnitude(N_("the length of the strings"), strings)
        )
        object.__setattr__(self, "gravity", magnitude("gravity", gravity))
        if self.strings and self.on_bed:
            raise InputError(
                "strings_on_bed", "beads on strings do not lie on a bed: give either strings, or friction and brakes"
            )

    def __repr__(self) -> str:
        parts = [f"mass={_shortened(self.mass)}", f"contact={_shortened(self.contact)}"]
        parts += [f"gap={_shortened(self.gap)}"] if any(self.gap) else []
        parts += [f"drive={_shortened(self.drive)}"] if self.drive else []
        parts += [f"friction={self.friction!r}"] if self.friction else []
        parts += [f"forces={_shortened(self.forces)}"] if self.forces else []
        parts += [f"brakes={_shortened(self.brakes)}"] if self.brakes else []
        parts += [f"strings={self.strings!r}"] if self.strings else []
        parts += [f"gravity={self.gravity!r}"] if self.strings and self.gravity != GRAVITY else []
        return f"Chain({', '.join(parts)})"

    def __getstate__(self) -> dict[str, Any]:
        """Return the fields of the chain for copies and pickles, without the stored results of `per_chain`."""
        return {item.name: getattr(self, item.name) for item in fields(self)}

    @per_chain
    def contacts(self) -> int:
        """Number n of contacts; there are n+1 beads."""
        return len(self.contact)

    @per_chain
    def walls(self) -> int:
        """Number of beads of infinite mass."""
        return self.mass.count(math.inf)

    @per_chain
    def anchor(self) -> int:
        """Index of the reference bead, whose position and velocity are stored in the State.

        The reference bead is the heaviest bead, or a wall if the chain has one.
        """
        return self.mass.index(max(self.mass))

    @per_chain
    def own_laws(self) -> tuple[OwnLaw, ...]:
        """The different user-defined laws among the contacts, in the order of their first use."""
        return tuple(dict.fromkeys(law for _, law in self.own_contacts))

    @per_chain
    def own_contacts(self) -> tuple[tuple[int, OwnLaw], ...]:
        """Index and law of each contact that has a user-defined law."""
        return tuple((i, contact) for i, contact in enumerate(self.contact) if isinstance(contact, OwnLaw))

    @per_chain
    def couplers(self) -> tuple[tuple[int, Coupler], ...]:
        """Index and coupler of each contact that is a coupler."""
        return tuple((i, contact) for i, contact in self.piecewise if isinstance(contact, Coupler))

    @per_chain
    def piecewise(self) -> tuple[tuple[int, PiecewiseContact], ...]:
        """Index and contact of each contact that is defined by segments. Couplers are such contacts."""
        return tuple((i, contact) for i, contact in enumerate(self.contact) if isinstance(contact, PiecewiseContact))

    @per_chain
    def graphs(self) -> tuple[tuple[Segment, ...], ...]:
        """The segments of each contact, from left to right."""
        return tuple(tuple(contact.segments) for contact in self.contact)

    @per_chain
    def has_segments(self) -> bool:
        """True if the force graph of any contact is more than a single law that starts at overlap 0."""
        return any(len(graph) > 1 or not graph[0].is_whole_law for graph in self.graphs)

    @per_chain
    def pulls(self) -> bool:
        """True if a contact can pull."""
        return any(contact.pulling for _, contact in self.piecewise)

    @per_chain
    def power_laws(self) -> tuple[Contact, ...]:
        """The contacts of a chain in which all contacts are preloaded power laws.

        Raises:
            ValueError: a contact is a coupler or has a user-defined law.
        """
        others = [
            (i, Message("has_own_law", "has the user-defined law {law!r}", law=law.name))
            for i, law in self.own_contacts
        ]
        kinds = [(i, Message("is_kind", "is a {kind}", kind=type(one).__name__)) for i, one in self.piecewise]
        for i, what in [*others, *kinds]:
            raise InputError(
                "power_laws_only",
                "contact {left}-{right} {what}: this takes contacts force = preload + stiffness * overlap**exponent only",
                left=i,
                right=i + 1,
                what=what,
            )
        return tuple(contact for contact in self.contact if isinstance(contact, Contact))

    @property
    def power_law_rows(self) -> Array:
        """The `law_rows` of a chain in which all contacts are preloaded power laws. Other chains raise a ValueError."""
        assert self.power_laws
        return self.law_rows

    @per_chain
    def law_rows(self) -> Array:
        """Preload, stiffness and exponent of each contact, as a read-only array (n, 3).

        For a user-defined law, stiffness and exponent are NaN. For a contact with several segments, the values are
        those of its first pushing segment.
        """
        laws = [contact.pushing[0] if isinstance(contact, PiecewiseContact) else contact for contact in self.contact]
        rows = [(c.preload, getattr(c, "stiffness", math.nan), getattr(c, "exponent", math.nan)) for c in laws]
        return _read_only(np.array(rows))

    @per_chain
    def inverse_mass(self) -> Array:
        """(n+1,) inverse masses [1/kg], read-only; 0 for a wall."""
        return _read_only(1.0 / np.array(self.mass))

    @per_chain
    def finite_mass(self) -> Array:
        """(n+1,) masses [kg], read-only. A wall has the value 0, because its kinetic energy is not counted."""
        return _read_only(np.array([mass if mass < math.inf else 0.0 for mass in self.mass]))

    def stored_energy(
        self, overlap: ArrayLike, power: Callable[..., Any] = np.power, force: ArrayLike | None = None
    ) -> Array:
        """Return the energy (..., n) [J] in each contact at overlaps (..., n) [m]; see :meth:`Contact.energy` for
        `power`.

        A coupler that has not coupled yet can be stretched beyond its slack without pulling. If the `force` (..., n)
        [N] of the contacts is given, the energy of such a coupler is 0.
        """
        apart = np.asarray(overlap) <= 0.0
        if not self.piecewise and apart.all():  # All contacts are open at the start and at the end of most motions.
            return apart * np.zeros(self.contacts)
        # Compute all contacts as power laws at once. The energies of other contacts are replaced below.
        preload, stiffness, exponent = self.law_rows.T
        if self.own_laws:  # The energy of user-defined laws is computed below.
            exponent = np.where(np.isnan(exponent), 1.0, exponent)
        found = stored_energy(preload, stiffness, exponent, overlap, power)
        for i, law in self.own_contacts:
            found[..., i] = law.energy(np.asarray(overlap)[..., i])
        for i, contact in self.piecewise:
            way = np.asarray(overlap)[..., i]
            found[..., i] = contact.stored_energy(way, power)
            if force is not None and contact.pulling:
                # Couplers that have not coupled yet: they are stretched beyond their slack, but do not pull.
                free = (way < contact.pulls_below) & (np.asarray(force)[..., i] >= 0.0)
                found[..., i] = np.where(free, 0.0, found[..., i])
        return found

    @per_chain
    def inverse_reduced_mass(self) -> Array:
        """(n,) inverse reduced masses 1/m_i + 1/m_(i+1) [1/kg] of the two beads of each contact.

        These values are the diagonal of the matrix L = B M^-1 B^T.
        """
        return _read_only(self.inverse_mass[:-1] + self.inverse_mass[1:])

    @per_chain
    def loss(self) -> Array:
        """(n,) fraction of the stored energy that each contact dissipates during unloading."""
        return _read_only(np.array([contact.loss for contact in self.contact]))

    @per_chain
    def bed(self) -> Array:
        """(n+1,) deceleration [m/s²] of each sliding bead by the bed and the brakes; 0 for a wall.

        Time-dependent brakes count with their largest value. The array is empty without bed and brakes.
        """
        bed = np.where(np.isfinite(self.mass), self.friction * GRAVITY, 0.0) if self.on_bed else np.zeros(0)
        for brake in self.brakes:
            bed[list(brake.beads)] += max(brake.force) * self.inverse_mass[list(brake.beads)]
        return _read_only(bed)

    @property
    def on_bed(self) -> bool:
        """True if friction of the bed or brakes decelerate sliding beads."""
        return self.friction > 0.0 or bool(self.brakes)

    @property
    def takes_momentum(self) -> bool:
        """True if the bed, brakes or strings change the momentum of the beads."""
        return self.on_bed or self.swing > 0.0

    @per_chain
    def dissipative(self) -> bool:
        """True if beads are braked or a contact has loss."""
        return self.on_bed or any(contact.loss for contact in self.contact)

    @per_chain
    def swing(self) -> float:
        """Square [1/s²] of the angular frequency of beads on strings, gravity / length; 0 without strings."""
        return self.gravity / self.strings if self.strings else 0.0

    @property
    def driven(self) -> bool:
        """True if an external force acts on a bead, constant or over time."""
        return self.drive is not None or bool(self.forces)

    @property
    def lasts(self) -> bool:
        """True if an external force acts until the end of time."""
        return self.drive is not None or any(item.lasts for item in self.forces)

    @per_chain
    def timed(self) -> bool:
        """True if an external force or a brake changes with time."""
        return bool(self.forces) or not all(brake.steady for brake in self.brakes)

    @per_chain
    def knots(self) -> tuple[float, ...]:
        """Times [s] of the breakpoints of all forces and brakes over time, ascending."""
        return tuple(sorted({time for item in (*self.forces, *self.brakes) for time in item.time}))

    def impulse(self, time: ArrayLike) -> Any:
        """Return the momentum [N s] that time-dependent forces have transferred to the beads by `time` [s], any shape."""
        none = np.zeros(np.shape(time))
        return sum((item.impulse(time) * len(item.beads) for item in self.forces), none)

    @per_chain
    def knot_rows(self) -> tuple[Array, Array, Array]:
        """Times (K,) [s] of all breakpoints, with the forces (K, n+1) [N] and the decelerations by brakes (K, n+1)
        [m/s²].

        A step of a force appears as two breakpoints at the same time. Between two breakpoints, forces and decelerations
        are linear in time. Without brakes the array of decelerations has 0 columns.
        """
        beads, jumps = self.contacts + 1, {item.time[0] for item in (*self.forces, *self.brakes)}
        jumps |= {a for item in (*self.forces, *self.brakes) for a, b in pairwise(item.time) if a == b}
        # The first breakpoint is a step from force 0. A step appears twice in the list of times.
        times = sorted((*self.knots, *jumps))
        # At a step, the first of the two equal times gets the value just before the step.
        just_before = [
            math.nextafter(a, -math.inf) if a in jumps and a == b else a for a, b in pairwise((*times, math.nan))
        ]
        rows = [summed(items, np.array(just_before), beads) for items in (self.forces, self.brakes)]
        return np.array(times), rows[0], rows[1] * self.inverse_mass if self.brakes else np.zeros((len(times), 0))

    @per_chain
    def drives(self) -> Array:
        """(K, n+1) external forces [N] on the beads at all breakpoints; no rows without external forces."""
        steady = np.zeros((1, self.contacts + 1)) if self.drive is None else np.array([self.drive])
        if not self.forces:
            return steady[: self.drive is not None]
        return np.concatenate([steady, steady + self.knot_rows[1]])

    @per_chain
    def drive_force(self) -> Array | None:
        """(n+1,) the drive [N] as a read-only array; None for a chain without drive."""
        return None if self.drive is None else _read_only(np.array(self.drive))


def _read_only(values: Array) -> Array:
    values.setflags(write=False)
    return values


def _shortened(values: Sequence[object]) -> str:
    """Return the values as a short text.

    If all values are equal, the text contains one value and the count. Otherwise it contains the first values.
    """
    if all(value == values[0] for value in values):
        return f"{len(values)} x {values[0]!r}"
    return f"[{', '.join(map(repr, values[:MOST_SHOWN]))}{', ...' if len(values) > MOST_SHOWN else ''}]"


def _checked_masses(mass: ArrayLike) -> tuple[float, ...]:
    masses = number_array("mass", mass)
    if masses.ndim != 1 or len(masses) < 2:
        raise InputError("masses", "a chain needs a list of at least 2 masses, not {given}", given=shown(mass))
    found = tuple(masses.tolist())
    for value in found:
        if not (SMALLEST <= value <= LARGEST or value == math.inf):
            magnitude(N_("every mass (inf is a wall)"), value)
    if math.inf in found and (math.inf, math.inf) in pairwise(found):
        raise InputError(ADJACENT_WALLS)
    return found


def _checked_contacts(contact: Laws, n: int) -> tuple[Joint, ...]:
    one = isinstance(contact, Joint) or is_law(contact)
    if not (one or isinstance(contact, Sequence)) or isinstance(contact, str):
        raise InputError(
            "contact",
            "contact must be a Contact or a list of them, such as power_law(1.0, 0.1); not {given}",
            given=shown(contact),
        )
    contacts = (_contact(contact),) * n if one else tuple(map(_contact, cast("Sequence[object]", contact)))
    for law in {id(law): law for law in contacts if isinstance(law, PiecewiseContact)}.values():
        require_graph(Message("contact_kind", "contact {kind}", kind=type(law).__name__), law)
    if len(contacts) != n:
        raise InputError(
            "contact_count",
            "{masses} masses need one contact for all or {needed} contacts, not {given}",
            masses=n + 1,
            needed=n,
            given=len(contacts),
        )
    return contacts


def _contact(item: object) -> Joint:
    """Convert a contact to the form in which a chain stores it.

    A Contact or a contact of several segments is returned unchanged. A user-defined law is returned as an OwnLaw.
    """
    if isinstance(item, Joint):
        return item
    if is_law(item):
        return OwnLaw(cast("Law", item))
    require_kind(N_("every contact"), item, Contact)
    return cast("Contact", item)


def _checked_gaps(gap: ArrayLike, n: int) -> tuple[float, ...]:
    if isinstance(gap, float) and gap == 0.0:
        return (0.0,) * n
    gaps = number_array("gap", gap)
    if gaps.ndim > 1 or (gaps.ndim == 1 and len(gaps) != n):
        raise InputError(
            "gap_count",
            "{masses} masses need one gap for all or {needed} gaps, not shape {given}",
            masses=n + 1,
            needed=n,
            given=str(gaps.shape),
        )
    if not (np.abs(gaps) <= LARGEST).all():
        raise InputError(
            "gap", "every gap must be a number up to {most:g}, not {given}", most=LARGEST, given=shown(gap)
        )
    return tuple(np.broadcast_to(gaps, (n,)).tolist())


def bead_forces(what: str, forces: ArrayLike, beads: int) -> Array:
    """Return `forces` as (beads,) finite numbers [N], or raise ValueError."""
    found = number_array(what, forces)
    if found.shape != (beads,):
        raise InputError(
            "force_count",
            "{beads} masses need {beads} {what} forces, not {given}",
            what=what,
            beads=beads,
            given=shown(forces),
        )
    if not (np.abs(found) <= LARGEST).all():
        raise InputError(
            "force",
            "every {what} force must be a number up to {most:g}, not {given}",
            what=what,
            most=LARGEST,
            given=shown(forces),
        )
    return found


def one_on(n: int, contact: Laws, mass: ArrayLike = 1.0) -> Chain:
    """Return a chain of one striker and a target cluster of `n` >= 1 beads, Fig. 1. All neighbours just touch.

    `mass` [kg] is one number for all beads, or n+1 numbers.
    """
    return cluster_on_cluster(1, n, contact, mass)


def cluster_on_cluster(m: int, n: int, contact: Laws, mass: ArrayLike = 1.0) -> Chain:
    """Return a chain of `m` >= 1 strikers and `n` >= 1 targets, Appendix A (ii). All neighbours just touch.

    `mass` [kg] is one number for all beads, or m+n numbers.
    """
    m, n = whole_number(N_("the number of strikers"), m), whole_number(N_("the number of targets"), n)
    if m < 1 or n < 1:
        raise InputError("cluster", "a cluster needs at least one bead, not {given}", given=min(m, n))
    if m + n > MOST_BEADS:
        raise InputError("beads", "a chain has at most {most} beads, not {given}", most=MOST_BEADS, given=m + n)
    masses = number_array("mass", mass)
    if masses.shape not in ((), (m + n,)):
        raise InputError(
            "mass_count",
            "{strikers} on {targets} needs one mass for all or {needed} masses, not {given}",
            strikers=m,
            targets=n,
            needed=m + n,
            given=shown(mass),
        )
    return Chain(masses if masses.ndim else masses.repeat(m + n), contact)


def accelerated_mass(mass: ArrayLike, struck: int) -> Array:
    """Return the (n,) mass [kg] that each contact accelerates, Eq. (5).

    The accelerated mass is the mass of all beads that lie beyond the contact, seen from contact `struck`. The contact
    `struck` itself accelerates the beads on its right.
    """
    masses = np.asarray(mass, dtype=np.float64)
    right, left = np.cumsum(masses[::-1])[::-1][1:], np.cumsum(masses)[:-1]
    return np.concatenate((left[:struck], right[struck:]))


def mass_shares(mass: ArrayLike, struck: int) -> Array:
    """Return the (n,) contact forces, divided by the force of contact `struck`, Eq. (5).

    Both sides are assumed to move as rigid bodies. If a wall lies beyond a contact, the contact transmits the whole
    force, so its value is 1.

    >>> mass_shares([1.0, 1.0, 1.0, 1.0, 1.0], 0)
    array([1.  , 0.75, 0.5 , 0.25])
    """
    masses = np.asarray(mass, dtype=np.float64)
    beyond = accelerated_mass(masses, struck)
    side = np.where(np.arange(beyond.size) < struck, np.cumsum(masses)[struck], beyond[struck])
    return np.divide(beyond, side, out=np.ones(beyond.size), where=np.isfinite(beyond))
