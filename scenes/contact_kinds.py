"""The kinds of contact by name: what files and lines of text call them, their numbers, and what makes them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from softcradle.scenes.toml_table import NotNegative, Positive

from softcradle import physics


@dataclass(frozen=True)
class ContactKind:
    """One kind of contact.

    Attributes:
        law: its name in scene files, in a line of text, and that of its constructor in Python.
        constructor: makes the contact from its numbers and its loss.
        numbers: the names of its numbers in the order of the constructor, each with the values that it may have.
        former: the name in scene files of version 0.1, which are read.
    """

    law: str
    constructor: Callable[..., physics.Contact]
    numbers: Mapping[str, Any]
    former: str = ""


KINDS = (
    # f0 * overlap**alpha, Eq. (2); f0 [N / m**alpha]
    ContactKind("power_law", physics.power_law, {"f0": Positive, "alpha": Positive}, former="power"),
    # a spring of stiffness [N/m] precompressed by precompression [m] behind a piston, Eq. (C1)
    ContactKind("draft_gear", physics.draft_gear, {"stiffness": Positive, "precompression": NotNegative}),
    # elastic spheres, stiffness * overlap**1.5; stiffness [N / m**1.5]
    ContactKind("hertz", physics.hertz, {"stiffness": Positive}),
    # a one-sided linear spring; stiffness [N/m]
    ContactKind("hooke", physics.hooke, {"stiffness": Positive}),
    # the limit alpha -> 0: f0 [N] at any overlap
    ContactKind("step_force", physics.step_force, {"f0": Positive}, former="step"),
    # preload [N] + stiffness * overlap**exponent, the law that all others are cases of
    ContactKind("preloaded", physics.Contact, {"preload": NotNegative, "stiffness": Positive, "exponent": Positive}),
)
KIND_BY_NAME = {name: kind for kind in KINDS for name in (kind.law, kind.former) if name}
