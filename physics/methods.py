"""Table of all methods. `simulate`, tests, charts, menus and documentation all use this table."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from softcradle.physics.messages import InputError, Message

if TYPE_CHECKING:
    from softcradle.physics.chain import Chain


class Family(Enum):
    """Groups of methods. All methods of a group have the same runner, see `softcradle.physics.simulation`."""

    FIXED_STEP = "fixed_step"
    ADAPTIVE = "adaptive"
    PYMUNK = "pymunk_contacts"
    REFERENCE = "reference"


@dataclass(frozen=True)
class Method:
    """Method that integrates the motion of a chain.

    Attributes:
        name: name of the method, as in `simulate(method=...)`.
        order: order of convergence on smooth motion.
        set_valued: True if a contact with preload can rest at overlap 0 (Signorini condition). With other methods
            it chatters there.
        family: group of the method, which determines its runner.
        summary: one line for menus.
        purpose: recommended use.
        dissipative: True if the method supports bed friction and contacts with loss.
        couplers: True if the method supports couplers.
    """

    name: str
    order: int
    set_valued: bool
    family: Family
    summary: str
    purpose: str
    dissipative: bool = True
    couplers: bool = True

    @property
    def adaptive(self) -> bool:
        """True if the method chooses its steps from a tolerance. Otherwise it has a fixed step."""
        return self.family in (Family.ADAPTIVE, Family.REFERENCE)


METHODS: tuple[Method, ...] = (
    Method(
        "euler",
        1,
        False,
        Family.FIXED_STEP,
        "symplectic Euler, as in one pymunk step",
        "to see what a step of pymunk does",
    ),
    Method("verlet", 2, False, Family.FIXED_STEP, "leapfrog", "Hertz and Hooke contacts at errors of 1e-3 to 1e-5"),
    Method(
        "yoshida4",
        4,
        False,
        Family.FIXED_STEP,
        "fourth-order composition of leapfrogs",
        "Hertz and Hooke contacts at errors of 1e-5, without friction or loss",
        dissipative=False,
    ),
    Method(
        "conserving",
        2,
        True,
        Family.FIXED_STEP,
        "discrete gradient: exact energy",
        "live use and long runs: energy and momentum to round-off",
    ),
    Method(
        "radau",
        5,
        True,
        Family.ADAPTIVE,
        "implicit, adaptive, every contact law",
        "soft contacts and draft gears, to a tolerance",
    ),
    Method(
        "dop853",
        8,
        True,
        Family.ADAPTIVE,
        "explicit, adaptive, for contacts that are not soft",
        "Hertz and Hooke contacts, to a tolerance",
    ),
    Method(
        "accurate",
        8,
        True,
        Family.ADAPTIVE,
        "dop853, or radau if a contact is stiff",
        "wherever the answer matters; the default",
    ),
    Method(
        "pymunk",
        1,
        False,
        Family.PYMUNK,
        "bodies in a pymunk Space; same digits as euler",
        "to compare with the engine of a game",
        couplers=False,
    ),
    Method(
        "scipy",
        8,
        True,
        Family.REFERENCE,
        "the reference: solve_ivp between located contact switches",
        "to check the others: slow, shares no code with them",
    ),
)


AUTO = "auto"  # Method name for `simulate`. The rule in softcradle.physics.advice.auto_method then chooses the method.


def known_methods() -> list[str]:
    """Return the names that `simulate` accepts as method, "auto" first."""
    return [AUTO, *(method.name for method in METHODS)]


def refusal_of(method: str, chain: Chain) -> str:
    """Return the reason why `method` does not support `chain`, and suggest an alternative.

    Return "" if the method supports the chain. `method` is an existing name or "auto".
    """
    found = None if method == AUTO else find_method(method)
    if found and chain.piecewise and not found.couplers:
        return Message(
            "method_couplers",
            "method {method!r} takes contacts that only push, with one law from overlap 0 on, not couplers: "
            "take 'accurate', 'conserving' or 'scipy'",
            method=method,
        )
    if found and chain.swing and found.family is Family.PYMUNK:
        return Message(
            "no_strings",
            "method {method!r} moves bodies in a row without strings: take 'conserving', 'accurate' or 'scipy'",
            method=method,
        )
    # Adaptive steps measure the overlap from the origin of each segment. Strings need the overlap relative to the
    # position at rest.
    if chain.swing and chain.has_segments and (found is None or found.family is Family.ADAPTIVE):
        return Message(
            "segments_on_strings",
            "method {method!r} takes beads on strings with one contact law from overlap 0 on: take 'conserving' or 'scipy'",
            method=method,
        )
    # Adaptive methods continue the force of a segment smoothly beyond its ends. This requires an exponent of 1 or more.
    events = found is None or found.family is Family.ADAPTIVE
    if events and not all(coupler.smooth for _, coupler in chain.piecewise):
        return Message(
            "method_gears",
            "method {method!r} takes couplers whose gears that pull or go solid have exponents of 1 or more: "
            "take 'conserving' or 'scipy'",
            method=method,
        )
    if found and chain.dissipative and not found.dissipative:
        return Message(
            "method_losses",
            "method {method!r} steps back in time, in which friction would feed the motion, and carries neither bed friction "
            "nor contacts with loss: take 'conserving' or {other!r}",
            method=method,
            other="scipy" if chain.piecewise else "accurate",
        )
    return ""


def refusal_of_fineness(method: str, step: object, tolerance: object) -> str:
    """Return the reason why `method` does not accept the given step or tolerance.

    Return "" if it accepts both. None stands for a step or tolerance that is not given. `method` is an existing name or
    "auto".
    """
    fixed = any(one.name == method and not one.adaptive for one in METHODS)
    if fixed and tolerance is not None:
        return Message("step_only", "method {method!r} takes a step, not a tolerance", method=method)
    if not fixed and step is not None:
        return Message(
            "tolerance_only",
            "method {method!r} chooses its own steps: give a tolerance, the wanted error, instead of a step",
            method=method,
        )
    return ""


def find_method(name: str, others: Sequence[str] = (AUTO,)) -> Method:
    """Return the Method called `name`.

    For an unknown name, raise ValueError with the most similar name and with all valid names. `others` are further
    valid names of the caller.
    """
    if not isinstance(name, str):
        raise InputError(
            "method_name", "method must be a name such as 'accurate', not a {kind}", kind=type(name).__name__
        )
    for method in METHODS:
        if method.name == name:
            return method
    known = [*others, *(method.name for method in METHODS)]
    # Suggest the most similar name.
    near = difflib.get_close_matches(name, known, n=1)
    if near:
        raise InputError(
            "near_method",
            "unknown method {given!r}; did you mean {near!r}? there are {known}",
            given=name,
            near=near[0],
            known=", ".join(known),
        )
    raise InputError("method", "unknown method {given!r}; there are {known}", given=name, known=", ".join(known))
