"""Table of the kinds of contact: their names in files and in lines of text, their parameters and their constructors."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from softcradle.scenes.toml_table import NotNegative, Positive

from softcradle import physics


@dataclass(frozen=True)
class ContactKind:
    """Kind of contact.

    Attributes:
        law: name in scene files and in lines of text; also the name of the constructor in Python.
        constructor: function that makes the contact from its parameters and its loss.
        numbers: types of the parameters by name, in the order of the constructor.
        former: name in scene files of version 0.1, which are still accepted.
    """

    law: str
    constructor: Callable[..., physics.Contact]
    numbers: Mapping[str, Any]
    former: str = ""


KINDS = (
    # power law f0 * overlap**alpha, Eq. (2); f0 [N / m**alpha]
    ContactKind("power_law", physics.power_law, {"f0": Positive, "alpha": Positive}, former="power"),
    # spring of the given stiffness [N/m] behind a piston, precompressed by precompression [m], Eq. (C1)
    ContactKind("draft_gear", physics.draft_gear, {"stiffness": Positive, "precompression": NotNegative}),
    # elastic spheres, stiffness * overlap**1.5; stiffness [N / m**1.5]
    ContactKind("hertz", physics.hertz, {"stiffness": Positive}),
    # linear spring that only pushes; stiffness [N/m]
    ContactKind("hooke", physics.hooke, {"stiffness": Positive}),
    # limit alpha -> 0 of the power law: the force f0 [N] at any overlap
    ContactKind("step_force", physics.step_force, {"f0": Positive}, former="step"),
    # general law preload [N] + stiffness * overlap**exponent, of which all others are special cases
    ContactKind("preloaded", physics.Contact, {"preload": NotNegative, "stiffness": Positive, "exponent": Positive}),
)
KIND_BY_NAME = {name: kind for kind in KINDS for name in (kind.law, kind.former) if name}
