"""The one tuple of methods: it parametrises `simulate`, tests, charts, menus and documentation alike."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Family(Enum):
    """Methods that one runner carries out, see `softcradle.physics.dispatch`."""

    FIXED_STEP = "fixed_step"
    ADAPTIVE = "adaptive"
    PYMUNK = "pymunk_contacts"
    REFERENCE = "reference"


@dataclass(frozen=True)
class Method:
    """A way to integrate a chain.

    Attributes:
        name: what `simulate(method=...)` takes.
        order: order of convergence on smooth motion.
        adaptive: True: takes a tolerance and chooses its steps; False: takes a fixed step.
        set_valued: True: a contact with preload may rest at overlap 0; False: it chatters there.
        family: the runner that carries it out.
        summary: one line for menus.
        dissipative: True: carries bed friction and contacts with loss.
    """

    name: str
    order: int
    adaptive: bool
    set_valued: bool
    family: Family
    summary: str
    dissipative: bool = True


METHODS: tuple[Method, ...] = (
    Method("euler", 1, False, False, Family.FIXED_STEP, "symplectic Euler, what one pymunk step does"),
    Method("verlet", 2, False, False, Family.FIXED_STEP, "leapfrog"),
    Method("yoshida4", 4, False, False, Family.FIXED_STEP, "fourth-order composition of leapfrogs", False),
    Method("conserving", 2, False, True, Family.FIXED_STEP, "discrete gradient: energy exact at any step"),
    Method("radau", 5, True, True, Family.ADAPTIVE, "implicit, adaptive, every contact law"),
    Method("dop853", 8, True, True, Family.ADAPTIVE, "explicit, adaptive, for contacts that are not soft"),
    Method("accurate", 8, True, True, Family.ADAPTIVE, "dop853 where no contact is stiff, radau where one is"),
    Method("pymunk", 1, False, False, Family.PYMUNK, "bodies in a pymunk Space; the digits of euler"),
    Method("scipy", 8, True, True, Family.REFERENCE, "the reference: solve_ivp between located contact switches"),
)


AUTO = "auto"  # for `simulate`: the cheapest of them that holds the wanted error, see softcradle.physics.advice.choose


def refusal(method: Method) -> str:
    """Why `method` does not take a dissipative chain, and what does; empty where it does."""
    if method.dissipative:
        return ""
    reason = "steps back in time, in which friction would feed the motion, and " if method.name == "yoshida4" else ""
    return f"method {method.name!r} {reason}carries neither bed friction nor contacts with loss: take 'conserving' or 'accurate'"


def find_method(name: str) -> Method:
    """The Method called `name`; ValueError with the names there are."""
    for method in METHODS:
        if method.name == name:
            return method
    raise ValueError(f"unknown method {name!r}; there are {', '.join(m.name for m in METHODS)}")
