"""Inputs: everything a person can do to the model, as small frozen values that are applied, recorded and replayed.

A recording names them by their classes: a renamed class could no longer be replayed.

`lane` counts from 0; `bead` 0 ... n and `contact` 0 ... n-1 from left to right; None means all of them.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from typing import Any, get_args

from softcradle.physics.contact import Contact


@dataclass(frozen=True)
class Drag:
    """Pull a bead while the model runs: by a spring from it to the pointer at `position` [m]."""

    lane: int
    bead: int
    position: float


@dataclass(frozen=True)
class Drop:
    """Release the bead that is pulled; it keeps its velocity: a throw."""


@dataclass(frozen=True)
class Place:
    """Put a bead at `position` [m] at once; beads in its way are pushed along, walls stop it."""

    lane: int
    bead: int
    position: float


@dataclass(frozen=True)
class SetVelocity:
    """Give a bead (None: all) a `velocity` [m/s]."""

    lane: int
    bead: int | None
    velocity: float


@dataclass(frozen=True)
class SetMass:
    """Give a bead (None: all but walls) a `mass` [kg]; inf makes it a wall."""

    lane: int
    bead: int | None
    mass: float


@dataclass(frozen=True)
class SetContact:
    """Give a contact (None: all) the law `law`; see `dataclasses.replace` to change one number of it."""

    lane: int
    contact: int | None
    law: Contact


@dataclass(frozen=True)
class SetKind:
    """Convert a contact (None: all) into a 'power' law, a draft 'gear' or a 'hard' one, alike at this scene's speed."""

    lane: int
    contact: int | None
    kind: str


@dataclass(frozen=True)
class Lock:
    """Lock the piston of a contact (None: all): it becomes hard. Unlocking restores its law."""

    lane: int
    contact: int | None
    locked: bool = True


@dataclass(frozen=True)
class SetGap:
    """Set the distance between two neighbours to `gap` [m], an overlap if negative; everything to the right moves along."""

    lane: int
    contact: int
    gap: float


@dataclass(frozen=True)
class SetDrive:
    """Drive a bead (None: all) by a steady `force` [N]."""

    lane: int
    bead: int | None
    force: float


@dataclass(frozen=True)
class SetFriction:
    """Set the Coulomb coefficient of the bed of a lane, >= 0; 0 is a bed without friction."""

    lane: int
    friction: float


@dataclass(frozen=True)
class AddBead:
    """Insert a bead so that it becomes number `bead` (0 ... n+1), at the velocity of its neighbours.

    `gap` [m] is its distance to the chain where it is added at an end; between two beads it halves their gap.
    """

    lane: int
    bead: int
    mass: float = 1.0
    gap: float = 0.0
    law: Contact | None = None


@dataclass(frozen=True)
class RemoveBead:
    """Remove a bead and its right contact (its left one at the right end)."""

    lane: int
    bead: int


@dataclass(frozen=True)
class SetMethod:
    """Integrate a lane (None: all) by the method of that name; 'auto': method and step are chosen."""

    lane: int | None
    method: str


@dataclass(frozen=True)
class SetStep:
    """Use steps of at most `step` [s] in a lane (None: all); step None: it is chosen."""

    lane: int | None
    step: float | None


@dataclass(frozen=True)
class SetSlow:
    """Slow motion: `slow` seconds of wall time show one second of the model."""

    slow: float


@dataclass(frozen=True)
class Resume:
    """Play on from a frame of the history: no bead is held, and the methods start with fresh scratch memory."""


# A LaneInput concerns one lane or all of them; the others concern the session.
LaneInput = (
    Place | SetVelocity | SetMass | SetContact | SetKind | Lock | SetGap | SetDrive | SetFriction | AddBead
    | RemoveBead | SetMethod | SetStep
)  # fmt: skip
Input = LaneInput | Drag | Drop | SetSlow | Resume

_INPUTS: dict[str, type] = {input_class.__name__: input_class for input_class in get_args(Input)}


def to_table(item: Input) -> dict[str, Any]:
    """The input as plain JSON."""
    return {"input": type(item).__name__, **asdict(item)}


def from_table(table: dict[str, Any]) -> Input:
    """The input that :func:`to_table` wrote. ValueError where it is none."""
    input_class = _INPUTS.get(str(table.get("input")))
    values = {key: value for key, value in table.items() if key != "input"}
    if input_class is None or set(values) - {field.name for field in fields(input_class)}:
        raise ValueError(f"not an input of a session: {table}")
    if values.get("law") is not None:
        values["law"] = Contact(**values["law"])
    item: Input = input_class(**values)
    return item
