"""Chain: masses on a line and the contacts between neighbours. A chain is immutable; its motion is in a State."""

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
# Any contact that the constructor accepts, including a user-defined law that is not yet an OwnLaw.
OneLaw = Contact | PiecewiseContact | Law | Callable[[float], SupportsFloat]
Laws = OneLaw | Sequence[OneLaw]  # One contact for all neighbours, or one for each pair.

MOST_SHOWN = 4  # Largest number of different values in the text of a chain.
MOST_BEADS = 10_000_000  # Largest number of beads of a cluster: a typing error must not exhaust the memory.
ADJACENT_WALLS = Message("adjacent_walls", "two walls side by side: a contact between them could never be solved")
GRAVITY = 9.80665  # Standard gravity [m/s²]: bed friction and the pull of strings are proportional to it.


class per_chain(Generic[T]):  # noqa: N801 - it is written as a decorator
    """Decorator for a value that depends only on the chain: computed once per chain, as an attribute of Chain or a function.

    The value is stored in the `__dict__` of the chain, where Python finds it before it calls this descriptor again.
    """

    def __init__(self, compute: Callable[[Chain], T]) -> None:
        update_wrapper(self, compute)
        self.compute, self.name = compute, f"{compute.__module__}.{compute.__qualname__}"

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, chain: Chain | None, owner: type) -> T:
        if chain is None:  # accessed on the class, as documentation tools do
            return cast("T", self)
        found = chain.__dict__[self.name] = self.compute(chain)
        return found

    def __call__(self, chain: Chain) -> T:
        """Return the value for `chain`."""
        known = chain.__dict__
        return known[self.name] if self.name in known else self.__get__(chain, Chain)


@dataclass(frozen=True, repr=False)
class Chain(Shown):
    """A chain: n+1 masses on a line and n contacts between neighbours, Eq. (3).

    Parameters
    ----------
    mass : array_like, shape (n+1,)
        Masses [kg], n >= 1; ``math.inf`` is a wall, which keeps its velocity.
    contact : Contact, law or sequence of them
        One contact for all pairs, or n of them; different kinds may be mixed. A user-defined law (an :class:`OwnLaw`,
            or a
        function or object from which an OwnLaw can be made) and a :class:`Coupler`, which also pulls, are allowed.
    gap : float or array_like, optional
        Distance [m] between neighbours at the start, one for all or n of them. With 0 they just touch. Below 0 the
        contact is compressed at the start, by the overlap -gap.
    drive : array_like, shape (n+1,), optional
        Constant external force on each bead [N], or None; it acts from t = 0 on.
    friction : float, optional
        Coulomb coefficient >= 0 of the bed. Friction holds a bead at rest with a force of up to
        ``friction * mass * GRAVITY`` and brakes a sliding bead with this force. It does not act on walls.
    forces : TimedForce or sequence of them, optional
        Forces over time on chosen beads, which add to the drive.
    brakes : TimedForce or sequence of them, optional
        Brakes over time on chosen beads: friction of single beads in addition to the bed.
    strings : float, optional
        Length [m] of the strings on which all beads hang, as in a Newton's cradle; None without strings. Each bead swings
        about its place at the start with the angular frequency ``sqrt(gravity / strings)``. This holds for small angles: the
        period of a real pendulum is 1.7 % longer at 30 degrees, and 0.2 % at 10 degrees. A bead of infinite mass stays at
        rest.
    gravity : float, optional
        Acceleration [m/s²] that acts on beads on strings.

    Raises
    ------
    ValueError
        A number is out of range, a length is wrong, two walls are side by side, or beads on strings have a bed or brakes.

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
        # a drive of zeros counts as no drive
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
        """Return the fields for copies and pickles, without computed values."""
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
        """Index of the heaviest bead, or of a wall: the reference bead, whose position and velocity are in the State."""
        return self.mass.index(max(self.mass))

    @per_chain
    def own_laws(self) -> tuple[OwnLaw, ...]:
        """The different user-defined laws among the contacts, in order; empty without user-defined laws."""
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
        """Index and contact of each contact that is defined by segments, such as a coupler."""
        return tuple((i, contact) for i, contact in enumerate(self.contact) if isinstance(contact, PiecewiseContact))

    @per_chain
    def graphs(self) -> tuple[tuple[Segment, ...], ...]:
        """The segments of each contact, from left to right."""
        return tuple(tuple(contact.segments) for contact in self.contact)

    @per_chain
    def has_segments(self) -> bool:
        """True if the graph of a contact has more segments than one law from overlap 0 on."""
        return any(len(graph) > 1 or not graph[0].is_whole_law for graph in self.graphs)

    @per_chain
    def pulls(self) -> bool:
        """True if a contact can pull."""
        return any(contact.pulling for _, contact in self.piecewise)

    @per_chain
    def power_laws(self) -> tuple[Contact, ...]:
        """The contacts, if all are preloaded power laws.

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
        """The `law_rows` of a chain with preloaded power laws only; otherwise a ValueError as for `power_laws`."""
        assert self.power_laws
        return self.law_rows

    @per_chain
    def law_rows(self) -> Array:
        """(n, 3) preload, stiffness and exponent of each contact, read-only; the last two are NaN for a user-defined law.

        For a contact with several segments they belong to the first pushing segment.
        """
        laws = [contact.pushing[0] if isinstance(contact, PiecewiseContact) else contact for contact in self.contact]
        rows = [(c.preload, getattr(c, "stiffness", math.nan), getattr(c, "exponent", math.nan)) for c in laws]
        return _read_only(np.array(rows))

    @per_chain
    def inverse_mass(self) -> Array:
        """(n+1,) [1/kg], read-only; 0 for a wall."""
        return _read_only(1.0 / np.array(self.mass))

    @per_chain
    def finite_mass(self) -> Array:
        """(n+1,) [kg], read-only; 0 for a wall, whose kinetic energy is not counted."""
        return _read_only(np.array([mass if mass < math.inf else 0.0 for mass in self.mass]))

    def stored_energy(
        self, overlap: ArrayLike, power: Callable[..., Any] = np.power, force: ArrayLike | None = None
    ) -> Array:
        """Return the energy (..., n) [J] in each contact at overlaps (..., n) [m]; see :meth:`Contact.energy` for `power`.

        If the `force` (..., n) [N] of the contacts is given, a coupler that is stretched beyond its slack but does not
        pull, because it has not coupled yet, stores no energy.
        """
        apart = np.asarray(overlap) <= 0.0
        if not self.piecewise and apart.all():  # all contacts are open, as at the start and the end of most motions
            return apart * np.zeros(self.contacts)
        # all power laws at once; the other contacts are replaced below
        preload, stiffness, exponent = self.law_rows.T
        if self.own_laws:  # their energy is computed below
            exponent = np.where(np.isnan(exponent), 1.0, exponent)
        found = stored_energy(preload, stiffness, exponent, overlap, power)
        for i, law in self.own_contacts:
            found[..., i] = law.energy(np.asarray(overlap)[..., i])
        for i, contact in self.piecewise:
            way = np.asarray(overlap)[..., i]
            found[..., i] = contact.stored_energy(way, power)
            if force is not None and contact.pulling:
                # not coupled: beyond the slack, but without a pull
                free = (way < contact.pulls_below) & (np.asarray(force)[..., i] >= 0.0)
                found[..., i] = np.where(free, 0.0, found[..., i])
        return found

    @per_chain
    def inverse_reduced_mass(self) -> Array:
        """(n,) 1/m_i + 1/m_(i+1) of the two beads of each contact [1/kg]: the diagonal of L = B M^-1 B^T."""
        return _read_only(self.inverse_mass[:-1] + self.inverse_mass[1:])

    @per_chain
    def loss(self) -> Array:
        """(n,) loss of each contact."""
        return _read_only(np.array([contact.loss for contact in self.contact]))

    @per_chain
    def bed(self) -> Array:
        """(n+1,) deceleration [m/s²] of a sliding bead by the bed and the brakes; 0 for a wall, empty without both.

        Brakes over time count with their largest value.
        """
        bed = np.where(np.isfinite(self.mass), self.friction * GRAVITY, 0.0) if self.on_bed else np.zeros(0)
        for brake in self.brakes:
            bed[list(brake.beads)] += max(brake.force) * self.inverse_mass[list(brake.beads)]
        return _read_only(bed)

    @property
    def on_bed(self) -> bool:
        """True if sliding beads are braked, by friction of the bed or by brakes."""
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
        """True if an external force acts without end."""
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
        """Return the momentum [N s] that forces over time have given to the beads by `time` [s], any shape."""
        none = np.zeros(np.shape(time))
        return sum((item.impulse(time) * len(item.beads) for item in self.forces), none)

    @per_chain
    def knot_rows(self) -> tuple[Array, Array, Array]:
        """Breakpoints (K,) [s], steps twice, with the forces (K, n+1) [N] and decelerations by brakes (K, n+1) [m/s²] there.

        Between two breakpoints both are linear. Without brakes the array of decelerations has 0 columns.
        """
        beads, jumps = self.contacts + 1, {item.time[0] for item in (*self.forces, *self.brakes)}
        jumps |= {a for item in (*self.forces, *self.brakes) for a, b in pairwise(item.time) if a == b}
        # The first breakpoint counts as a step from 0. A step appears twice in the list of times.
        times = sorted((*self.knots, *jumps))
        # at a step, the first of its two times has the value just before it
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
        """(n+1,) the drive as a read-only array [N]; None for a chain without drive."""
        return None if self.drive is None else _read_only(np.array(self.drive))


def _read_only(values: Array) -> Array:
    values.setflags(write=False)
    return values


def _shortened(values: Sequence[object]) -> str:
    """Return the values as text: a single value with the count if all are equal, otherwise the first values."""
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
    """Return a Contact or a contact of several segments unchanged, and a user-defined law as an OwnLaw."""
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
    """Return a striker and a target cluster of `n` >= 1 beads, all just touching; Fig. 1. `mass` [kg]: one for all or n+1."""
    return cluster_on_cluster(1, n, contact, mass)


def cluster_on_cluster(m: int, n: int, contact: Laws, mass: ArrayLike = 1.0) -> Chain:
    """Return `m` >= 1 beads that strike `n` >= 1 beads, all just touching; Appendix A (ii). `mass` [kg]: one for all or m+n."""
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
    """Return the (n,) mass [kg] that each contact accelerates: all beads beyond it, seen from contact `struck`, Eq. (5).

    The contact `struck` itself accelerates the beads to its right.
    """
    masses = np.asarray(mass, dtype=np.float64)
    right, left = np.cumsum(masses[::-1])[::-1][1:], np.cumsum(masses)[:-1]
    return np.concatenate((left[:struck], right[struck:]))


def mass_shares(mass: ArrayLike, struck: int) -> Array:
    """Return the (n,) contact forces relative to contact `struck` if both sides move as rigid bodies, Eq. (5).

    A contact with a wall beyond it transmits all of the force, so its share is 1.

    >>> mass_shares([1.0, 1.0, 1.0, 1.0, 1.0], 0)
    array([1.  , 0.75, 0.5 , 0.25])
    """
    masses = np.asarray(mass, dtype=np.float64)
    beyond = accelerated_mass(masses, struck)
    side = np.where(np.arange(beyond.size) < struck, np.cumsum(masses)[struck], beyond[struck])
    return np.divide(beyond, side, out=np.ones(beyond.size), where=np.isfinite(beyond))
