"""Inputs: everything a person can do to the model, as small frozen values that can be applied, recorded and replayed.

`lane` counts from 0; `bead` 0 ... n and `contact` 0 ... n-1 from left to right; None means all of them.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from typing import Any, get_args

from softcradle.physics.contact import Contact


@dataclass(frozen=True)
class Drag:
    """The hand holds a bead while the model runs: a spring from it to the pointer at `position` [m]."""

    lane: int
    bead: int
    position: float


@dataclass(frozen=True)
class Drop:
    """The hand lets go; the bead keeps its velocity: a throw."""


@dataclass(frozen=True)
class Place:
    """Put a bead at `position` [m] at once; beads in its way are shoved along, walls stop it."""

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
    """Turn a contact (None: all) into a 'power' law, a draft 'gear' or 'hard', alike at this scene's speed."""

    lane: int
    contact: int | None
    kind: str


@dataclass(frozen=True)
class Lock:
    """Lock the piston of a contact (None: all): it turns hard. Unlocking brings its old law back."""

    lane: int
    contact: int | None
    locked: bool = True


@dataclass(frozen=True)
class SetGap:
    """Set the distance between two neighbours to `gap` >= 0 [m]; everything to the right moves along."""

    lane: int
    contact: int
    gap: float


@dataclass(frozen=True)
class SetDrive:
    """Pull at a bead (None: all) with a steady `force` [N]."""

    lane: int
    bead: int | None
    force: float


@dataclass(frozen=True)
class SetFriction:
    """Set the Coulomb coefficient of the bed of a lane, >= 0; 0 is none."""

    lane: int
    friction: float


@dataclass(frozen=True)
class AddBead:
    """Insert a bead so that it becomes number `bead` (0 ... n+1), at the velocity of its neighbours.

    `gap` [m] is its distance to the row when it is added at an end; in the middle it shares the gap that is there.
    """

    lane: int
    bead: int
    mass: float = 1.0
    gap: float = 0.0
    law: Contact | None = None


@dataclass(frozen=True)
class RemoveBead:
    """Take a bead out; its right contact goes with it (its left one at the right end)."""

    lane: int
    bead: int


@dataclass(frozen=True)
class SetMethod:
    """Integrate a lane (None: all) by the method of that name; 'auto' chooses method and step by itself."""

    lane: int | None
    method: str


@dataclass(frozen=True)
class SetStep:
    """Use steps of at most `step` [s] in a lane (None: all); None chooses."""

    lane: int | None
    step: float | None


@dataclass(frozen=True)
class SetSlow:
    """Slow motion: `slow` wall seconds show one second of the model; 1 ... 1000 and beyond."""

    slow: float


@dataclass(frozen=True)
class Resume:
    """Play on from a scrubbed moment: the hand is empty and the methods start with fresh scratch memory."""


# what concerns one lane or all of them, and what concerns the session
LaneInput = (
    Place | SetVelocity | SetMass | SetContact | SetKind | Lock | SetGap | SetDrive | SetFriction | AddBead
    | RemoveBead | SetMethod | SetStep
)  # fmt: skip
Input = LaneInput | Drag | Drop | SetSlow | Resume

_BY_NAME: dict[str, type] = {kind.__name__: kind for kind in get_args(Input)}


def to_table(item: Input) -> dict[str, Any]:
    """The input as plain JSON."""
    return {"input": type(item).__name__, **asdict(item)}


def from_table(table: dict[str, Any]) -> Input:
    """The input that :func:`to_table` wrote. ValueError where it is none."""
    kind = _BY_NAME.get(str(table.get("input")))
    values = {key: value for key, value in table.items() if key != "input"}
    if kind is None or set(values) - {field.name for field in fields(kind)}:
        raise ValueError(f"not an input of a session: {table}")
    if values.get("law") is not None:
        values["law"] = Contact(**values["law"])
    made: Input = kind(**values)
    return made
