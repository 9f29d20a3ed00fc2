"""User-defined contact law: a Python function of the overlap, or an object with `force` and optionally `energy`.

overlap d <= 0   f = 0            (at d = 0 anything up to the limit of the law there, its preload)
overlap d > 0    f = force(d)     >= 0, finite as far as the contact is pressed; if it falls with d, a run warns

Here d is the overlap and f the force. If the law has no `energy`, the force is integrated once.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Protocol, SupportsFloat, cast, overload, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.checked_input import shown
from softcradle.physics.contact import Contact, Numbers
from softcradle.physics.law_table import LawTable, law_table
from softcradle.physics.messages import N_, InputError
from softcradle.physics.segments import PiecewiseContact, Segment

Array = NDArray[np.float64]

LEAST_OVERLAP = 2.0**-900  # Overlap [m], below 1e-270, at which the force of the law counts as its preload.
# Number of overlaps at which a law is tested before a run: as many evenly spaced as logarithmically spaced overlaps.
PROBES = 33
# Number of decades below the expected depth that are covered by the logarithmically spaced test points.
PROBED_DECADES = 12
# Relative accuracy of the overlap at which the force begins to decrease. A warning reports this overlap.
FALL_WIDTH = 1e-6
RISE = 1e-9  # Relative decrease of the force that counts as real. Smaller decreases are round-off.
TRUE_ENERGY = 1e-6  # Largest relative difference between the energy of a law and the integral of its force.
# Largest relative error of the table of a valid law. With a larger error, the force is mostly round-off.
OWN_DIGITS = 1e-9
# Smallest difference between force and preload that is distinguishable from round-off, as a fraction of the preload.
FEW_DIGITS = 1e-6
LEAST_FORCE = 1e-250  # Smallest force [N] with full precision. Smaller forces may have lost digits.
NEARLY_LINEAR = 1e-4  # Largest difference from 1 of an exponent that counts as 1.
SLOPE_WIDTH = 1e-5  # Interval for the difference quotient of the force, as a fraction of the overlap.


@runtime_checkable
class Law(Protocol):
    """Interface of a contact law: an object with a method `force` that returns the force [N] at an overlap > 0 [m]."""

    def force(self, overlap: Any, /) -> SupportsFloat:
        """Return the force [N] at `overlap` > 0 [m]."""


class TabledLaw:
    """User-defined contact law that consists only of its table. A file stores a law in this form."""

    def __init__(self, name: str, table: LawTable) -> None:
        """Store the table, and the name of the function or class from which the table was made."""
        self.__name__, self.table = name, table

    def force(self, overlap: Any) -> Any:
        """Return the force [N] at overlaps > 0 [m], any shape."""
        found = self.table.values(self.table.force, np.atleast_1d(overlap))
        return found if np.ndim(overlap) else float(found[0])


@dataclass(frozen=True, repr=False)
class OwnLaw:
    """A user-defined contact that only pushes. While the beads overlap, its force is ``law.force(overlap)``.

    A Chain also accepts the law itself. All methods support such contacts.

    Parameters
    ----------
    law : object or callable
        An object with a method ``force(overlap)`` that returns the force [N] at an overlap > 0 [m], or a function
        that returns this force. The function must accept a single number. A table of the force is built once, and
        the steps use the table. If the function also accepts arrays, the table is built faster. For a smooth law
        the table is accurate to 1e-13. The table also reproduces kinks.
    energy : callable, optional
        Function that returns the stored energy [J] for results. None means ``law.energy`` if it exists, otherwise
        the integral of the table. The steps always use the integral of the table.

    Raises
    ------
    ValueError
        `law` is neither an object with a force nor a function, or its force does not take exactly one argument.
        Also raised for a Contact or Coupler, because a force function cannot represent its loss or its pull.

    Examples
    --------
    >>> import math
    >>> from softcradle import OwnLaw, one_on, simulate
    >>> toda = OwnLaw(lambda overlap: math.expm1(overlap))  # exponential springs
    >>> simulate(one_on(2, toda), [1, 0, 0], method="conserving").final_velocity.round(2)
    array([-0.1 ,  0.12,  0.99])
    """

    law: Law | Callable[[float], SupportsFloat]
    energy_of: Callable[[float], SupportsFloat] | None = None
    loss: ClassVar[float] = 0.0  # A user-defined law is elastic: it returns all the energy that it stores.

    def __init__(
        self, law: Law | Callable[[float], SupportsFloat], energy: Callable[[float], SupportsFloat] | None = None
    ) -> None:
        if isinstance(law, (Contact, PiecewiseContact)):
            raise InputError(
                "own_law", "a chain takes {given} as it is: it is not a user-defined law", given=shown(law)
            )
        if not is_law(law) or isinstance(law, OwnLaw):
            raise InputError(
                "own_law_force",
                "a user-defined law must be a function or have a method force(overlap), not {given}",
                given=shown(law),
            )
        # The energy is optional. Force and energy must take exactly one argument.
        found = getattr(law, "energy", None) if energy is None else energy
        if found is not None and not callable(found):
            raise InputError(
                "own_law_energy",
                "the energy of a law must be a function of the overlap, not {given}",
                given=shown(found),
            )
        _require_one_argument(N_("force"), law.force if isinstance(law, Law) else law)
        if found is not None:
            _require_one_argument(N_("energy"), found)
        object.__setattr__(self, "law", law)
        object.__setattr__(self, "energy_of", found)

    def __repr__(self) -> str:
        return f"OwnLaw({self.name})"

    def __hash__(self) -> int:
        try:
            return hash((self.law, self.energy_of))
        except TypeError:  # The law is not hashable. An example is a dataclass, which is compared by its fields.
            return hash(type(self.law))

    @property
    def name(self) -> str:
        """Name of the law: the name of its function or class. A lambda function gets the name "own law"."""
        name = str(getattr(self.law, "__name__", type(self.law).__name__))
        return "own law" if name == "<lambda>" else name

    @cached_property
    def force_of(self) -> Callable[[float], SupportsFloat]:
        """Force of the law, as the function that the user supplied."""
        return self.law.force if isinstance(self.law, Law) else self.law

    @cached_property
    def preload(self) -> float:
        """Force [N] at which the contact begins to yield: the limit of the force at overlap 0.

        For ``F + K d**a`` the result is F. This also holds for an exponent so small that the force is far above F at
        every overlap.
        """
        # Aitken extrapolation of the force from three tiny overlaps that form a geometric sequence.
        last, middle, first = self._force(np.array([LEAST_OVERLAP ** (k / 3.0) for k in (3, 2, 1)])).tolist()
        if first == 0.0 or middle == last:
            return last
        fall, further = (first - middle) / first, (middle - last) / first
        found = last - first * further * further / (fall - further) if fall > further else last
        return found if found > max(OWN_DIGITS * last, LEAST_FORCE) else 0.0

    @property
    def onset(self) -> tuple[float, float, float]:
        """Power law ``F + K d**a`` that approximates the law at small overlaps: preload F [N], stiffness K [N/m**a],
        exponent a.

        If the slope of the law at overlap 0 is 0, then K = 0 and a = 1.
        """
        return self._begins[0]

    @property
    def digits_from(self) -> float:
        """Overlap [m] below which `onset` replaces the table.

        At smaller overlaps, the difference between force and preload in the table is only round-off.
        """
        return self._begins[1]

    @cached_property
    def _begins(self) -> tuple[tuple[float, float, float], float]:
        """The onset of the law, and the overlap [m] above which the table is more accurate than the onset."""
        table, preload = self.table, self.preload
        overlaps = table.edge[1:-1]
        # Find the first pieces in which the difference between force and preload is larger than round-off.
        above = table.values(table.force, overlaps) - preload
        seen = (above > max(FEW_DIGITS * preload, LEAST_FORCE)) & (table.error < OWN_DIGITS)[1:]
        if not seen.any():
            return (preload, 0.0, 1.0), 0.0
        at = float(overlaps[np.argmax(seen)])
        # The exponent follows from the forces at this overlap and at twice this overlap.
        half, once, twice = (table.values(table.force, at * np.array([0.5, 1.0, 2.0])) - preload).tolist()
        if not 0.0 < half < once < twice:
            return (preload, 0.0, 1.0), 0.0
        exponent = math.log2(twice / once)
        exponent = 1.0 if abs(exponent - 1.0) < NEARLY_LINEAR else exponent
        return (preload, once / at**exponent, exponent), at if preload > 0.0 else 0.0

    @property
    def segments(self) -> tuple[Segment]:
        """Segments of the force graph. A user-defined law has a single segment with a table."""
        return (Segment(1.0, 0.0, *self.onset, table=self.table, table_from=self.digits_from),)

    @cached_property
    def table(self) -> LawTable:
        """Polynomials that represent the law in the kernels.

        The polynomials equal the force to round-off, except at steps of the force; see the field `error` of the table.
        """
        if isinstance(self.law, TabledLaw):
            return self.law.table
        return law_table(self.tried)

    @overload
    def force(self, overlap: float) -> float: ...
    @overload
    def force(self, overlap: ArrayLike) -> Array: ...

    def force(self, overlap: ArrayLike) -> Numbers:
        """Return the force [N] at `overlap` [m], any shape. The force of an open contact is 0.

        Raise ValueError if the law does not return a finite force >= 0.
        """
        return self._where_pressed(overlap, self._force)

    def tried(self, overlap: Array) -> Array:
        """Return the force [N] at overlaps > 0 [m] that a solver tries, any shape. The result is NaN if the function
        fails.
        """
        flat = self._values(self.force_of, overlap.ravel(), self._takes_arrays)
        return flat.reshape(overlap.shape)

    @overload
    def energy(self, overlap: float) -> float: ...
    @overload
    def energy(self, overlap: ArrayLike) -> Array: ...

    def energy(self, overlap: ArrayLike) -> Numbers:
        """Return the stored energy [J] at `overlap` [m], any shape. The energy of an open contact is 0."""
        return self._where_pressed(overlap, self._energy)

    @overload
    def overlap(self, force: float) -> float: ...
    @overload
    def overlap(self, force: ArrayLike) -> Array: ...

    def overlap(self, force: ArrayLike) -> Numbers:
        """Return the overlap [m] at which the contact pushes with `force` [N], any shape. The result is 0 below the
        preload.

        If the law never reaches the force, the result is inf, or the last overlap at which the law has a value.
        """
        forces, table = np.asarray(force, dtype=np.float64), self.table
        found = [
            table.overlap(table.force, value) if value > self.preload else 0.0 for value in forces.ravel().tolist()
        ]
        return found[0] if forces.ndim == 0 else np.reshape(found, forces.shape)

    def depth(self, energy: float) -> float:
        """Return the overlap [m] at which the contact stores `energy` [J]. The result is infinite if the contact never
        stores so much energy.
        """
        return self.table.overlap(self.table.energy, energy) if energy > 0.0 else 0.0

    def slope(self, overlap: float) -> float:
        """Return the slope df/dd [N/m] of the force at an overlap > 0 [m], as a difference quotient.

        The result is NaN if the function fails.
        """
        low, high = overlap * (1.0 - SLOPE_WIDTH), overlap * (1.0 + SLOPE_WIDTH)
        below, above = self.tried(np.array([low, high])).tolist()
        return float(max(above - below, 0.0) / (high - low))

    @cached_property
    def _takes_arrays(self) -> bool:
        return _takes_arrays(self.force_of)

    @cached_property
    def _energy_takes_arrays(self) -> bool:
        return self.energy_of is not None and _takes_arrays(self.energy_of)

    def _force(self, overlaps: Array) -> Array:
        """Return the forces (k,) at overlaps (k,) > 0. Raise ValueError if a force is not valid."""
        return self._checked(N_("force"), self.tried(overlaps), overlaps, "N")

    def _energy(self, overlaps: Array) -> Array:
        if self.energy_of is None:
            return self._checked(N_("energy"), self.table.values(self.table.energy, overlaps), overlaps, "J")
        found = self._values(self.energy_of, overlaps, self._energy_takes_arrays)
        # An energy computed as a difference may be slightly negative because of round-off.
        found = np.where(np.isfinite(found), np.maximum(found, 0.0), found)
        return self._checked(N_("energy"), found, overlaps, "J")

    def _checked(self, what: str, values: Array, overlaps: Array, unit: str) -> Array:
        wrong = ~(np.isfinite(values) & (values >= 0.0))
        if wrong.any():
            k = int(np.argmax(wrong))
            raise InputError(
                "own_law_value",
                "contact law {law!r} gives the {what} {value:g} {unit} at an overlap of {overlap:.6g} m: "
                "a contact only pushes, with a finite number >= 0",
                law=self.name,
                what=what,
                value=values[k],
                unit=unit,
                overlap=overlaps[k],
            )
        return values

    @staticmethod
    def _values(function: Callable[[float], SupportsFloat], overlaps: Array, arrays: bool) -> Array:
        with np.errstate(all="ignore"):  # Values that are not finite raise an error later, or end the integration.
            if arrays:
                # The function failed for one element. Compute the other elements one by one.
                with suppress(ArithmeticError, ValueError):
                    found: Any = cast(Any, function)(overlaps)
                    return np.array(np.broadcast_to(np.asarray(found, dtype=np.float64), overlaps.shape))
            return np.array([_number(function, overlap) for overlap in overlaps.tolist()])

    @staticmethod
    def _where_pressed(overlap: ArrayLike, function: Callable[[Array], Array]) -> Numbers:
        overlaps = np.asarray(overlap, dtype=np.float64)
        found = np.zeros(overlaps.shape)
        pressed = overlaps > 0.0
        if pressed.any():
            found[pressed] = function(overlaps[pressed])
        return float(found) if overlaps.ndim == 0 else found

    def require_usable(self, depth: float) -> None:
        """Raise ValueError if force or energy is invalid at an overlap up to `depth` [m].

        Force and energy must be numbers >= 0, and the energy must be the integral of the force.
        """
        overlaps = self.probes(depth)
        forces, energies = self._force(overlaps), self._energy(overlaps)
        if self.energy_of is None:
            return
        # Gauss-Legendre quadrature of the force in each interval between the test points
        node, weight = np.polynomial.legendre.leggauss(20)
        low, high = overlaps[:-1], overlaps[1:]
        inside = 0.5 * (low + high)[:, None] + 0.5 * (high - low)[:, None] * node
        work = 0.5 * (high - low) * (self._force(inside.ravel()).reshape(inside.shape) @ weight)
        # Compare with the differences of the energy. Compare the first energy with force times overlap.
        apart = np.abs(np.diff(energies) - work)
        least = float(forces[0] * overlaps[0])
        k = int(np.argmax(apart))
        if apart[k] > TRUE_ENERGY * energies[-1] or energies[0] > 2.0 * least + TRUE_ENERGY * energies[-1]:
            rise = energies[k + 1] - energies[k]
            raise InputError(
                "own_law_integral",
                "contact law {law!r}: its energy is not the integral of its force from overlap 0 on; from "
                "{low:.3g} to {high:.3g} m it rises by {rise:.3g} J, the force gives {work:.3g} J",
                law=self.name,
                low=low[k],
                high=high[k],
                rise=rise,
                work=work[k],
            )

    def falls(self, depth: float) -> float:
        """Return the smallest overlap [m] at which the force begins to decrease. Only overlaps up to `depth` [m] are
        searched.

        Return 0 if the force never decreases.
        """
        overlaps = self.probes(depth)
        forces = self._force(overlaps)
        down = np.flatnonzero(np.diff(forces) < -RISE * forces.max())
        if not down.size:
            return 0.0
        # Find the largest force in the interval around the first decrease. Each iteration shrinks the interval by a
        # factor of PROBES / 2.
        low, high = float(overlaps[max(down[0] - 1, 0)]), float(overlaps[down[0] + 1])
        while high - low > FALL_WIDTH * high:
            overlaps = np.linspace(low, high, PROBES)
            forces = self._force(overlaps)
            last = PROBES - 1 - int(np.argmax(forces[::-1]))
            low, high = float(overlaps[max(last - 1, 0)]), float(overlaps[min(last + 1, PROBES - 1)])
        return 0.5 * (low + high)

    @staticmethod
    def probes(depth: float) -> Array:
        """Return the overlaps (k,) [m] at which the law is tested, in ascending order. The largest is `depth`."""
        by_power = depth * 10.0 ** np.linspace(-PROBED_DECADES, 0.0, PROBES)
        return np.unique(np.concatenate((by_power, np.linspace(0.0, depth, PROBES)[1:])))


def is_law(value: object) -> bool:
    """Return True if `value` can be a contact law: an object with a force, or a function."""
    if isinstance(value, type):
        return False
    return callable(getattr(value, "force", None)) or callable(value)


def _require_one_argument(what: str, function: Callable[[float], SupportsFloat]) -> None:
    """Raise ValueError if `function` does not take exactly one argument, the overlap.

    `what` names the function in the message: the force or the energy of a law.
    """
    try:
        taken = inspect.signature(function)
    except (TypeError, ValueError):  # some functions written in C do not provide a signature
        return
    try:
        taken.bind(0.0)
    except TypeError:
        raise InputError(
            "own_law_argument",
            "the {what} of a contact law must be a function of one number, the overlap; {function} takes {taken}",
            what=what,
            function=getattr(function, "__name__", "?"),
            taken=str(taken),
        ) from None


def _number(function: Callable[[float], SupportsFloat], overlap: float) -> float:
    """Return the value of `function` at one overlap, or NaN if the function fails."""
    try:
        return float(function(overlap))
    except (ArithmeticError, ValueError):  # Examples are an overflow in math.exp and a domain error in math.log.
        return math.nan


def _takes_arrays(function: Callable[[float], SupportsFloat]) -> bool:
    """Return True if `function` accepts arrays, and returns the same values for an array as for its elements one by
    one.
    """
    probe = np.array([1e-3, 0.1, 0.5])
    try:
        with np.errstate(all="ignore"):
            together: Any = cast(Any, function)(probe.copy())
            found = np.broadcast_to(np.asarray(together, dtype=np.float64), probe.shape)
    except Exception:  # A function that expects numbers may raise any exception for an array.
        return False
    # Evaluate the overlaps one by one as well. A function is called with arrays only if both results are equal.
    alone = np.array([_number(function, value) for value in probe.tolist()])
    return bool(np.allclose(found, alone, rtol=1e-13, atol=0.0, equal_nan=True))
