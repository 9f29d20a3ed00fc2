"""Inputs: all user actions on the model. An input is a small immutable value that can be applied, recorded and
replayed.

A recording stores the class name of each input. Renaming a class would break the replay of old recordings.

All indices count from the left: `lane` from 0, `bead` from 0 to n, and `contact` from 0 to n-1. None means all lanes,
beads or contacts.
"""

import math
from dataclasses import asdict, dataclass, fields, replace
from typing import Any, ClassVar

import numpy as np
from softcradle.physics.contact import Contact
from softcradle.physics.state import State, coupled_of
from softcradle.physics.timed_force import on_other_beads
from softcradle.sandbox.languages import N_, gettext
from softcradle.sandbox.session.contact_conversion import converted_contact, hard_contact, kind_of, plain_contact
from softcradle.sandbox.session.lane_setup import LaneSetup
from softcradle.sandbox.session.state_changes import (
    LARGEST,
    MOST_BEADS,
    Changed,
    ContactChange,
    check_index,
    check_law,
    displace,
    finite,
    inserted,
    place_bead,
    put,
    set_velocity,
    state_from_bead_0,
    with_chain,
    with_contacts,
)


@dataclass(frozen=True)
class Input:
    """A user action on a session.

    Attributes:
        undo_name: name of the undo step that begins with this input. An input without a name does not start a step.
    """

    undo_name: ClassVar[str] = ""


class LaneInput(Input):
    """An edit of one lane or of all lanes.

    Attributes:
        changes_start: True if the edit also changes the start of the lane. Edits of masses, contact laws and the number
            of
            beads do.
    """

    changes_start: ClassVar[bool] = False
    lane: int | None

    def edited(self, setup: LaneSetup, state: State) -> Changed:
        """Return the setup and the state after the edit. Raise ValueError with a sentence if the edit is invalid.

        The arrays of `state` may be changed in place.
        """
        raise NotImplementedError


@dataclass(frozen=True)
class Drag(Input):
    """Pull a bead while the model runs. A spring connects the bead to the pointer at `position` [m]."""

    undo_name: ClassVar[str] = N_("bead pulled")
    lane: int
    bead: int
    position: float


@dataclass(frozen=True)
class Drop(Input):
    """Release the pulled bead. The bead keeps its velocity, so it can be thrown."""


@dataclass(frozen=True)
class Place(LaneInput):
    """Move a bead to `position` [m] at once. It pushes beads in its way along, and walls stop it."""

    undo_name: ClassVar[str] = N_("bead moved")
    lane: int
    bead: int
    position: float

    def edited(self, setup: LaneSetup, state: State) -> Changed:
        check_index(N_("bead"), self.bead, setup.chain.contacts + 1)
        place_bead(setup.chain, state, self.bead, finite(N_("position"), self.position))
        return setup, state


@dataclass(frozen=True)
class SetVelocity(LaneInput):
    """Set the `velocity` [m/s] of a bead, or of all beads if `bead` is None."""

    undo_name: ClassVar[str] = N_("velocity")
    lane: int
    bead: int | None
    velocity: float

    def edited(self, setup: LaneSetup, state: State) -> Changed:
        check_index(N_("bead"), self.bead, setup.chain.contacts + 1)
        set_velocity(setup.chain, state, self.bead, finite(N_("velocity"), self.velocity))
        return setup, state


@dataclass(frozen=True)
class SetMass(LaneInput):
    """Set the `mass` [kg] of a bead, or of all beads except walls if `bead` is None. An infinite mass makes the bead a
    wall.
    """

    undo_name: ClassVar[str] = N_("mass")
    changes_start: ClassVar[bool] = True
    lane: int
    bead: int | None
    mass: float

    def edited(self, setup: LaneSetup, state: State) -> Changed:
        chain = setup.chain
        check_index(N_("bead"), self.bead, chain.contacts + 1)
        if not math.isinf(self.mass):
            finite(N_("mass"), self.mass)
        chosen = [
            i for i, mass in enumerate(chain.mass) if self.bead in (i, None) and (self.bead == i or mass < math.inf)
        ]
        masses = [self.mass if i in chosen else mass for i, mass in enumerate(chain.mass)]
        return with_chain(setup, state, replace(chain, mass=tuple(masses)))


@dataclass(frozen=True)
class SetContact(LaneInput):
    """Set the law of a contact to `law`, or the laws of all contacts if `contact` is None.

    Use `dataclasses.replace` to change a single number of the present law.
    """

    undo_name: ClassVar[str] = N_("contact")
    changes_start: ClassVar[bool] = True
    lane: int
    contact: int | None
    law: Contact

    def edited(self, setup: LaneSetup, state: State) -> Changed:
        check_law(self.law)
        return with_contacts(setup, state, self.contact, lambda index: ContactChange(self.law))


@dataclass(frozen=True)
class SetKind(LaneInput):
    """Convert a contact, or all contacts if `contact` is None. The kinds are 'power', 'gear' (draft gear) and 'hard'.

    The new contact stops an impact at the speed of the scene within the same depth as the old contact. A hard contact
    stops it within a twentieth of this depth.
    """

    undo_name: ClassVar[str] = N_("kind of contact")
    changes_start: ClassVar[bool] = True
    lane: int
    contact: int | None
    kind: str

    def edited(self, setup: LaneSetup, state: State) -> Changed:
        def converted(index: int) -> ContactChange:
            present = plain_contact(setup.chain, index)
            origin = setup.origin_of(index) or present
            chain = replace(setup.chain, contact=put(setup.chain.contact, index, origin))
            law = converted_contact(chain, index, self.kind, setup.speed, setup.length)
            return ContactChange(present if kind_of(present) == self.kind else law, origin=origin)

        return with_contacts(setup, state, self.contact, converted)


@dataclass(frozen=True)
class Lock(LaneInput):
    """Lock or unlock the piston of a contact, or of all contacts if `contact` is None.

    A locked contact is hard. Unlocking restores its previous law.
    """

    undo_name: ClassVar[str] = N_("lock")
    changes_start: ClassVar[bool] = True
    lane: int
    contact: int | None
    locked: bool = True

    def edited(self, setup: LaneSetup, state: State) -> Changed:
        def locked(index: int) -> ContactChange:
            contact, soft, origin = plain_contact(setup.chain, index), setup.locked[index], setup.origin_of(index)
            if self.locked:
                hard = contact if soft else hard_contact(setup.chain, index, setup.speed)
                return ContactChange(hard, locked=soft or contact, origin=origin)
            return ContactChange(soft or contact, origin=origin)

        return with_contacts(setup, state, self.contact, locked)


@dataclass(frozen=True)
class SetGap(LaneInput):
    """Set the distance between two neighbouring beads to `gap` [m]. A negative gap is an overlap.

    All beads on the right move along.
    """

    undo_name: ClassVar[str] = N_("gap")
    lane: int
    contact: int
    gap: float

    def edited(self, setup: LaneSetup, state: State) -> Changed:
        check_index(N_("contact"), self.contact, setup.chain.contacts)
        if not self.gap <= LARGEST:
            raise ValueError(
                gettext("a gap must be a number up to {most:g}, not {given!r}", most=LARGEST, given=self.gap)
            )
        if not -self.gap < min(setup.length, LARGEST):
            raise ValueError(
                gettext(
                    "an overlap must be below the length of a bead, {length:g} m, not {given!r}",
                    length=setup.length,
                    given=-self.gap,
                )
            )
        displacement = np.zeros(setup.chain.contacts + 1)
        displacement[self.contact + 1 :] = self.gap + float(state.overlap[self.contact])
        displace(setup.chain, state, displacement)
        state.overlap[self.contact] = 0.0 - self.gap
        return setup, state


@dataclass(frozen=True)
class SetDrive(LaneInput):
    """Apply a constant external `force` [N] to a bead, or to all beads if `bead` is None."""

    undo_name: ClassVar[str] = N_("drive")
    lane: int
    bead: int | None
    force: float

    def edited(self, setup: LaneSetup, state: State) -> Changed:
        chain = setup.chain
        check_index(N_("bead"), self.bead, chain.contacts + 1)
        force = finite(N_("force"), self.force)
        drive = [
            force if self.bead in (i, None) else old for i, old in enumerate(chain.drive or (0.0,) * len(chain.mass))
        ]
        return with_chain(setup, state, replace(chain, drive=tuple(drive)))


@dataclass(frozen=True)
class SetFriction(LaneInput):
    """Set the coefficient of Coulomb friction between the beads of a lane and the bed. It is >= 0; 0 means no friction."""

    undo_name: ClassVar[str] = N_("friction")
    lane: int
    friction: float

    def edited(self, setup: LaneSetup, state: State) -> Changed:
        if not 0.0 <= self.friction <= LARGEST:
            raise ValueError(
                gettext(
                    "friction must be a number from 0 to {most:g}, not {given!r}", most=LARGEST, given=self.friction
                )
            )
        return with_chain(setup, state, replace(setup.chain, friction=float(self.friction)))


@dataclass(frozen=True)
class AddBead(LaneInput):
    """Insert a bead with the number `bead` (0 ... n+1). Its velocity is the mean velocity of its neighbours.

    At an end of the chain, `gap` [m] is the distance between the new bead and the chain. Between two beads, the new
    bead divides their gap into halves.
    """

    undo_name: ClassVar[str] = N_("bead added")
    changes_start: ClassVar[bool] = True
    lane: int
    bead: int
    mass: float = 1.0
    gap: float = 0.0
    law: Contact | None = None

    def edited(self, setup: LaneSetup, state: State) -> Changed:
        chain, n = setup.chain, setup.chain.contacts
        check_index(N_("bead"), self.bead, n + 2)
        if n + 2 > MOST_BEADS:
            raise ValueError(gettext("a lane holds at most {most} beads", most=MOST_BEADS))
        if not math.isinf(self.mass):
            finite(N_("mass"), self.mass)
        # Index of the contact that the new bead divides, or of the nearest contact if the bead is added at an end.
        near = min(max(self.bead - 1, 0), n - 1)
        law = chain.contact[near] if self.law is None else self.law
        check_law(law)
        masses = [*chain.mass[: self.bead], self.mass, *chain.mass[self.bead :]]
        contacts, gaps = list(chain.contact), list(chain.gap)
        at = min(self.bead, n)
        contacts.insert(at, law)
        gaps.insert(at, 0.0)
        locked = (*setup.locked[:at], None, *setup.locked[at:])
        origin = (*setup.origin[:at], None, *setup.origin[at:]) if setup.origin else ()
        drive = None if chain.drive is None else (*chain.drive[: self.bead], 0.0, *chain.drive[self.bead :])
        moved = [i + (i >= self.bead) for i in range(n + 1)]
        forces, brakes = on_other_beads(chain.forces, moved), on_other_beads(chain.brakes, moved)
        longer = replace(
            chain,
            mass=tuple(masses),
            contact=tuple(contacts),
            gap=tuple(gaps),
            drive=drive,
            forces=forces,
            brakes=brakes,
        )  # Friction and strings of the chain do not change.
        return setup.with_chain(longer, locked, origin), inserted(
            chain, longer, state, self.bead, abs(finite(N_("gap"), self.gap))
        )


@dataclass(frozen=True)
class RemoveBead(LaneInput):
    """Remove a bead together with its right contact. At the right end, the left contact is removed."""

    undo_name: ClassVar[str] = N_("bead removed")
    changes_start: ClassVar[bool] = True
    lane: int
    bead: int

    def edited(self, setup: LaneSetup, state: State) -> Changed:
        chain, n = setup.chain, setup.chain.contacts
        check_index(N_("bead"), self.bead, n + 1)
        if n < 2:
            raise ValueError(gettext("a lane needs at least 2 beads"))
        removed = min(self.bead, n - 1)
        rest = [i for i in range(n) if i != removed]
        masses = [mass for i, mass in enumerate(chain.mass) if i != self.bead]
        drive = None if chain.drive is None else [force for i, force in enumerate(chain.drive) if i != self.bead]
        moved = [None if i == self.bead else i - (i > self.bead) for i in range(n + 1)]
        forces, brakes = on_other_beads(chain.forces, moved), on_other_beads(chain.brakes, moved)
        contacts, gaps = [chain.contact[i] for i in rest], [chain.gap[i] for i in rest]
        shorter = replace(
            chain,
            mass=tuple(masses),
            contact=tuple(contacts),
            gap=tuple(gaps),
            drive=None if drive is None else tuple(drive),
            forces=forces,
            brakes=brakes,
        )
        position, velocity = state.position(chain), state.velocity(chain)
        overlap, rate, force = state.overlap[rest], state.rate[rest], state.force[rest]
        if 0 < self.bead < n:
            overlap[self.bead - 1] += state.overlap[self.bead]
            rate[self.bead - 1] += state.rate[self.bead]
        start = 1 if self.bead == 0 else 0
        first = float(position[start]), float(velocity[start])
        locked, origin = tuple(setup.locked[i] for i in rest), tuple(setup.origin_of(i) for i in rest)
        kept, coupled = origin if any(origin) else (), coupled_of(chain, state)
        coupled = coupled[rest] if shorter.has_segments else coupled[:0]
        found = state_from_bead_0(shorter, state.time, (overlap, rate, force), first, coupled)
        if 0 < self.bead < n:
            found.put_force(shorter, self.bead - 1)
        return setup.with_chain(shorter, locked, kept), found


@dataclass(frozen=True)
class SetMethod(LaneInput):
    """Set the integration method of a lane, or of all lanes if `lane` is None. With 'auto', the program chooses method
    and step.
    """

    undo_name: ClassVar[str] = N_("method")
    lane: int | None
    method: str

    def edited(self, setup: LaneSetup, state: State) -> Changed:
        return setup.with_method(self.method), state


@dataclass(frozen=True)
class SetStep(LaneInput):
    """Limit the time step of a lane to `step` [s], or of all lanes if `lane` is None.

    If `step` is None, the program chooses the step.
    """

    undo_name: ClassVar[str] = N_("step")
    lane: int | None
    step: float | None

    def edited(self, setup: LaneSetup, state: State) -> Changed:
        if self.step is not None and not 0.0 < self.step <= LARGEST:
            raise ValueError(gettext("a step must be a time > 0, not {given!r}", given=self.step))
        return setup.with_step(self.step), state


@dataclass(frozen=True)
class SetSlow(Input):
    """Set the slow motion. One second of model time is shown in `slow` seconds of wall time."""

    slow: float


@dataclass(frozen=True)
class Resume(Input):
    """Continue from a frame of the history. No bead is held, and the methods start with empty scratch memory."""


INPUTS: dict[str, type[Input]] = {
    one.__name__: one for one in (Drag, Drop, SetSlow, Resume, *LaneInput.__subclasses__())
}


def to_table(item: Input) -> dict[str, Any]:
    """Return the input as a table of plain JSON values."""
    return {"input": type(item).__name__, **asdict(item)}


def from_table(table: dict[str, Any]) -> Input:
    """Return the input from a table written by :func:`to_table`. Raise ValueError for any other table."""
    input_class = INPUTS.get(str(table.get("input")))
    values = {key: value for key, value in table.items() if key != "input"}
    if input_class is None or set(values) - {field.name for field in fields(input_class)}:
        raise ValueError(gettext("not an input of a session: {table}", table=str(table)))
    if values.get("law") is not None:
        values["law"] = Contact(**values["law"])
    item: Input = input_class(**values)
    return item
