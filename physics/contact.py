"""Contact law. A preloaded power law describes every contact of the paper, including the railway draft gear.

overlap d < 0   open      f = 0
overlap d = 0   touching  f anywhere in [0, F]   (Signorini condition: the motion determines f)
overlap d > 0   loaded    f = F + K * d**a

Here f is the force, d the overlap, F the preload, K the stiffness and a the exponent. A contact is closed if it touches
with a force > 0 or is loaded. Otherwise it is open.

A contact with loss l has hysteresis: it returns less energy than it stores. The contact pushes with f during loading
and with (1 - l) f during unloading. While its overlap is constant, it pushes with any force between these two.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import wraps
from inspect import signature
from typing import Any, ParamSpec, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from softcradle.physics.checked_input import magnitude, real_number, shown
from softcradle.physics.messages import N_, InputError, Message
from softcradle.physics.segments import Segment

Numbers = NDArray[np.float64] | float
P = ParamSpec("P")

# Smallest exponent. With a smaller exponent, the force would equal that of step_force to all digits that the methods
# resolve.
LEAST_EXPONENT = 1e-6
# Largest exponent for which the methods were tested. With exponents of 16 and more, a slightly compressed contact never
# opens again because of the limits of floating-point numbers.
MOST_EXPONENT = 10.0

NO_FORCE = Message("no_force", "contact preload and stiffness are both 0: the contact would never push")
# Names of the parameters of a contact in error messages.
NUMBERS = {
    "preload": N_("contact preload"),
    "stiffness": N_("contact stiffness"),
    "exponent": N_("contact exponent"),
    "loss": N_("contact loss"),
}


@dataclass(frozen=True, slots=True)
class Contact:
    """A contact that only pushes. While the beads overlap, ``force = preload + stiffness * overlap**exponent``.

    Parameters
    ----------
    preload : float
        Force F [N] at which the contact begins to yield. The preload is 0 for beads, and ``k * precompression`` for
        a draft gear.
    stiffness : float
        Factor K of the power law [N / m**exponent]. The stiffness is 0 for the step force.
    exponent : float
        Exponent a of the overlap, from 1e-6 to 10; alpha in Eq. (2). The exponent is 1 for Hooke's law and draft
        gears, and 3/2 for Hertz's law.
    loss : float, optional
        Fraction l in [0, 1) of the stored energy that the contact dissipates during unloading. With 0 the contact
        is elastic. For a coefficient of restitution e, the loss is ``1 - e**2``.

    Raises
    ------
    ValueError
        A number is out of range, preload and stiffness are both 0, or the loss is not below 1.

    Examples
    --------
    >>> Contact(preload=2.0, stiffness=3.0, exponent=1.0).force([-1.0, 0.5])
    array([0. , 3.5])
    """

    preload: float
    stiffness: float
    exponent: float
    loss: float = 0.0

    def __post_init__(self) -> None:
        # The dataclass is frozen, so its fields can only be set in this way.
        for name in ("preload", "stiffness"):
            object.__setattr__(self, name, magnitude(NUMBERS[name], getattr(self, name), zero=True))
        for name in ("exponent", "loss"):
            object.__setattr__(self, name, real_number(NUMBERS[name], getattr(self, name)))
        if not LEAST_EXPONENT <= self.exponent <= MOST_EXPONENT:
            raise InputError(
                "exponent",
                "contact exponent must be from {least:g} to {most:g}, not {given}; its limit 0 is step_force(f0)",
                least=LEAST_EXPONENT,
                most=MOST_EXPONENT,
                given=self.exponent,
            )
        if self.preload + self.stiffness <= 0.0:
            raise InputError(NO_FORCE)
        if not 0.0 <= self.loss < 1.0:
            raise InputError(
                "loss",
                "contact loss must be >= 0 and below 1, not {given}: at 1 the contact would never open again",
                given=self.loss,
            )

    @classmethod
    def by_contact_time(
        cls, duration: float, mass: float, speed: float, exponent: float = 1.5, loss: float = 0.0
    ) -> Contact:
        """Return the contact without preload whose contact time is `duration` when two bodies collide.

        The contact time is ``T = (1 + 1/sqrt(1-l)) (d_max/v) B(1/p, 1/2)/p`` with ``p = 1 + exponent`` and the largest
        overlap ``d_max = (p mass speed**2 / (2 K))**(1/p)``. These equations are solved for K. A Hooke contact
        (exponent 1) has the same contact time at any speed, half a period of its oscillation: ``1 / (2 frequency)``.

        Parameters
        ----------
        duration : float
            Contact time T > 0 [s].
        mass : float
            Reduced mass m1 m2 / (m1 + m2) > 0 [kg]. For two equal balls it is half the mass of a ball. For a ball that
            hits a wall it is the mass of the ball.
        speed : float
            Relative speed v > 0 before the collision [m/s].
        exponent : float, optional
            Exponent of the power law: 3/2 for Hertz's law and 1 for Hooke's law. With 1/10, a row of beads moves nearly
            like a rigid body.
        loss : float, optional
            Fraction l of the energy that the contact dissipates. A ball rebounds from a wall with ``sqrt(1 - loss)`` of
            its speed.

        Raises
        ------
        ValueError
            A number is out of range.

        Examples
        --------
        >>> Contact.by_contact_time(0.05, mass=0.5, speed=1.0, exponent=1.0).stiffness  # 0.5 (pi / 0.05)**2
        1973.92088021787...
        """
        time, mu, v = magnitude("duration", duration), magnitude("mass", mass), magnitude("speed", speed)
        unit = cls(0.0, 1.0, exponent, loss)
        power = 1.0 + unit.exponent
        way = math.sqrt(math.pi) * math.gamma(1.0 / power) / (power * math.gamma(1.0 / power + 0.5))  # B(1/p, 1/2) / p
        # Largest overlap, computed from the equation for T.
        depth = time * v / (way * (1.0 + 1.0 / math.sqrt(1.0 - unit.loss)))
        # ln K, computed from the equation for d_max. The logarithm is limited to values whose exponential is a valid
        # float.
        exact = math.log(0.5 * power * mu) + 2.0 * math.log(v) - power * math.log(depth)
        return cls(0.0, math.exp(min(max(exact, -700.0), 700.0)), exponent, loss)

    @classmethod
    def of_spheres(
        cls,
        young: float | Sequence[float],
        poisson: float | Sequence[float],
        radius: float | Sequence[float],
        loss: float = 0.0,
    ) -> Contact:
        """Return the Hertz contact of two elastic spheres: ``stiffness = 4/3 E sqrt(R)``, ``exponent = 3/2``.

        Here ``1/E = (1 - nu1**2) / E1 + (1 - nu2**2) / E2`` and ``1/R = 1/R1 + 1/R2``. Each argument is one number for
        both spheres, or a pair of numbers.

        Parameters
        ----------
        young : float or pair of float
            Young's modulus > 0 [Pa].
        poisson : float or pair of float
            Poisson's ratio, from -1 to 0.5.
        radius : float or pair of float
            Radius > 0 [m]. An infinite radius means a flat wall.
        loss : float, optional
            Fraction of the stored energy that the contact dissipates: ``1 - e**2`` for a coefficient of restitution e.

        Raises
        ------
        ValueError
            A number is out of range, or both radii are infinite.

        Examples
        --------
        Steel balls with a radius of 1 cm:

        >>> Contact.of_spheres(young=210e9, poisson=0.3, radius=0.01).stiffness
        10878565864.408...
        """
        moduli, ratios, radii = (
            _pair(name, value) for name, value in (("young", young), ("poisson", poisson), ("radius", radius))
        )
        # 1/E of both bodies, from Hertz's theory (Johnson, Contact Mechanics, section 4.2)
        yielding = 0.0
        for modulus, ratio in zip(moduli, ratios, strict=True):
            if not -1.0 <= ratio <= 0.5:
                raise InputError("poisson", "poisson must be from -1 to 0.5, not {given}", given=ratio)
            yielding += (1.0 - ratio**2) / magnitude("young", modulus)
        # 1/R of both bodies; a flat wall has curvature 0
        curvature = sum(0.0 if size == math.inf else 1.0 / magnitude("radius", size) for size in radii)
        if not curvature or not yielding:
            raise InputError(
                "no_hertz", "two flat walls, or two bodies with a poisson of -1, cannot have a Hertz contact"
            )
        return cls(0.0, 4.0 / 3.0 / yielding / math.sqrt(curvature), 1.5, loss)

    @property
    def segments(self) -> tuple[Segment]:
        """Segments of the force graph. A Contact has a single segment."""
        return (Segment(1.0, 0.0, self.preload, self.stiffness, self.exponent, self.loss),)

    @overload
    def force(self, overlap: float) -> float: ...
    @overload
    def force(self, overlap: ArrayLike) -> NDArray[np.float64]: ...

    def force(self, overlap: ArrayLike) -> Numbers:
        """Return the force [N] at `overlap` [m] during loading, any shape; Eq. (2), Eq. (C1). At overlap 0 it is 0."""
        pressed = np.maximum(np.asarray(overlap, dtype=np.float64), 0.0)
        force = np.where(pressed > 0.0, self.preload + self.stiffness * pressed**self.exponent, 0.0)
        return _like(overlap, force)

    @overload
    def energy(self, overlap: float) -> float: ...
    @overload
    def energy(self, overlap: ArrayLike) -> NDArray[np.float64]: ...

    def energy(self, overlap: ArrayLike) -> Numbers:
        """Return the stored energy [J] at `overlap` [m], any shape: ``F d + K d**(1+a) / (1+a)``. An open contact
        stores 0.

        During unloading, a contact with loss returns the fraction (1 - loss) of the stored energy and dissipates the
        rest.
        """
        return _like(overlap, stored_energy(self.preload, self.stiffness, self.exponent, overlap))

    @overload
    def overlap(self, force: float) -> float: ...
    @overload
    def overlap(self, force: ArrayLike) -> NDArray[np.float64]: ...

    def overlap(self, force: ArrayLike) -> Numbers:
        """Return the overlap [m] at which the contact pushes with `force` [N], any shape: ``((f-F)/K)**(1/a)``.

        The result is 0 for a force up to the preload. The result is infinite for a force that a step force cannot
        reach.
        """
        excess = np.maximum(np.asarray(force, dtype=np.float64) - self.preload, 0.0)
        if self.stiffness == 0.0:
            return _like(force, np.where(excess > 0.0, math.inf, 0.0))
        return _like(force, (excess / self.stiffness) ** (1.0 / self.exponent))


def stored_energy(
    preload: Numbers, stiffness: Numbers, exponent: Numbers, overlap: ArrayLike, power: Callable[..., Any] = np.power
) -> NDArray[np.float64]:
    """Return the energy [J] that contacts with the given laws store at `overlap` [m]. All arguments are broadcast
    together.

    `power` computes powers. NumPy's own function is fast, but its last digit depends on the processor. The function
    `powers` of softcradle is bitwise reproducible.
    """
    pressed = np.maximum(np.asarray(overlap, dtype=np.float64), 0.0)
    more = 1.0 + exponent
    with np.errstate(over="ignore", invalid="ignore"):  # If the motion has diverged, the energy is inf or NaN.
        return preload * pressed + stiffness * power(pressed, more) / more


def is_closed(overlap: ArrayLike, force: ArrayLike) -> NDArray[np.bool_]:
    """Return True for each closed contact, given its `overlap` [m] and `force` [N], any shape.

    A contact is closed if it is loaded, or if it touches with a force > 0. A coupler that pulls (force < 0) is also
    closed.

    >>> is_closed([-1.0, 0.0, 0.0, 1.0, -1.0], [0.0, 0.0, 2.0, 3.0, -4.0])
    array([False, False,  True,  True,  True])
    """
    overlaps, forces = np.asarray(overlap), np.asarray(force)
    return (overlaps > 0.0) | ((overlaps == 0.0) & (forces > 0.0)) | (forces < 0.0)


def _pair(name: str, value: object) -> tuple[float, float]:
    """Return one number for both spheres, or the pair of numbers, as two floats."""
    found = value if isinstance(value, Sequence) and not isinstance(value, str) else (value, value)
    if len(found) != 2:
        raise InputError("pair", "{what} must be one number or a pair, not {given}", what=name, given=shown(value))
    return real_number(name, found[0]), real_number(name, found[1])


def _like(argument: ArrayLike, result: NDArray[np.float64]) -> Numbers:
    """Return `result` as an array, or as a float if `argument` was a scalar."""
    return float(result) if np.ndim(argument) == 0 else result


def explained(make: Callable[P, Contact]) -> Callable[P, Contact]:
    """Wrap the constructor `make`. For an unknown keyword, it raises a TypeError that lists the valid arguments."""

    @wraps(make)
    def checked(*args: P.args, **keywords: P.kwargs) -> Contact:
        try:
            return make(*args, **keywords)
        except TypeError:
            # An unknown keyword gets a special message. Any other TypeError is raised again.
            taken = list(signature(make).parameters)
            unknown = [name for name in keywords if name not in taken]
            if not unknown:
                raise
        hint = ": `loss` is the part of the stored energy that the contact absorbs, 1 - e**2 for a restitution e"
        raise TypeError(f"{make.__name__} takes {', '.join(taken[:-1])} and {taken[-1]}, not {unknown[0]}{hint}")

    return checked


@explained
def power_law(f0: float, alpha: float, loss: float = 0.0) -> Contact:
    """Return the contact of a bead that pushes with ``f0 * overlap**alpha``, Eq. (2).

    The arguments are `f0` > 0 [N / m**alpha] and `alpha` > 0.
    """
    return Contact(0.0, f0, alpha, loss)


@explained
def draft_gear(stiffness: float, precompression: float, loss: float = 0.0) -> Contact:
    """Return the contact of a draft gear, a spring behind a piston, Eq. (C1). The preload of the contact is k Delta_0.

    The arguments are `stiffness` k > 0 [N/m] and `precompression` Delta_0 >= 0 [m].
    """
    spring = magnitude(N_("draft gear stiffness"), stiffness)
    return Contact(spring * magnitude(N_("draft gear precompression"), precompression, zero=True), spring, 1.0, loss)


@explained
def hertz(stiffness: float, loss: float = 0.0) -> Contact:
    """Return the contact of two elastic spheres, ``stiffness * overlap**1.5``. The stiffness is in N / m**1.5.

    `Contact.of_spheres` computes the stiffness from Young's modulus, Poisson's ratio and radius.
    """
    return Contact(0.0, stiffness, 1.5, loss)


@explained
def hooke(stiffness: float, loss: float = 0.0) -> Contact:
    """Return the contact of a linear spring that only pushes, ``stiffness * overlap``. The stiffness is in N/m.

    This contact describes the interface of Appendix A (iii).
    """
    return Contact(0.0, stiffness, 1.0, loss)


@explained
def step_force(f0: float, loss: float = 0.0) -> Contact:
    """Return the limit alpha -> 0 of :func:`power_law`. The force is `f0` [N] at any overlap.

    A contact that just touches has any force from 0 to f0.
    """
    return Contact(f0, 0.0, 1.0, loss)
