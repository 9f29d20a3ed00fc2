"""Table of the kinds of contact: their names in files and in text, their parameters and their constructors."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from softcradle.scenes.toml_table import NotNegative, Positive

from softcradle import physics


@dataclass(frozen=True)
class ContactKind:
    """Kind of contact, such as "hertz" or "draft_gear".

    Attributes:
        law: name in scene files and in text. The constructor in Python has the same name.
        constructor: function that creates a contact from its parameters and its loss.
        numbers: types of the parameters by name, in the order of the constructor's arguments.
        former: name in scene files of version 0.1. These files are still accepted.
    """

    law: str
    constructor: Callable[..., physics.Contact]
    numbers: Mapping[str, Any]
    former: str = ""


KINDS = (
    # Power law f0 * overlap**alpha, Eq. (2). f0 is in N / m**alpha.
    ContactKind("power_law", physics.power_law, {"f0": Positive, "alpha": Positive}, former="power"),
    # Spring of the given stiffness [N/m] behind a piston, with a given precompression [m], Eq. (C1).
    ContactKind("draft_gear", physics.draft_gear, {"stiffness": Positive, "precompression": NotNegative}),
    # Elastic spheres: stiffness * overlap**1.5. The stiffness is in N / m**1.5.
    ContactKind("hertz", physics.hertz, {"stiffness": Positive}),
    # Linear spring that only pushes. The stiffness is in N/m.
    ContactKind("hooke", physics.hooke, {"stiffness": Positive}),
    # Limit alpha -> 0 of the power law: the force is f0 [N] at any overlap.
    ContactKind("step_force", physics.step_force, {"f0": Positive}, former="step"),
    # General law: preload [N] + stiffness * overlap**exponent. All other laws are special cases.
    ContactKind("preloaded", physics.Contact, {"preload": NotNegative, "stiffness": Positive, "exponent": Positive}),
)
KIND_BY_NAME = {name: kind for kind in KINDS for name in (kind.law, kind.former) if name}
