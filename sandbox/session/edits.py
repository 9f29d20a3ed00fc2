"""Edits: what an Input changes in a lane. Immutable parts are replaced whole; a refused edit changes nothing."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import singledispatch
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain, Joint
from softcradle.physics.contact import Contact
from softcradle.physics.state import State, from_anchor
from softcradle.physics.timed_force import on_other_beads
from softcradle.sandbox.languages import N_, gettext
from softcradle.sandbox.session import inputs
from softcradle.sandbox.session.contact_conversion import converted_contact, hard_contact, kind_of, plain_contact
from softcradle.sandbox.session.lane_setup import LaneSetup

Array = NDArray[np.float64]


def place_bead(chain: Chain, state: State, bead: int, position: float) -> None:
    """Move `bead` to `position` [m], or up to a wall; beads in its way are pushed along, just touching."""
    shift = position - float(state.position(chain)[bead])
    side = 1 if shift > 0.0 else -1
    ahead = np.arange(bead + side, chain.contacts + 1 if side > 0 else -1, side)
    gaps = np.maximum(0.0, -state.overlap[ahead - 1 if side > 0 else ahead])
    room = np.cumsum(gaps)
    walls = np.flatnonzero(np.isinf(np.array(chain.mass)[ahead]))
    way = min(abs(shift), float(room[walls[0]])) if walls.size else abs(shift)
    displacement = np.zeros(chain.contacts + 1)
    displacement[bead] = side * way
    displacement[ahead] = side * np.maximum(0.0, way - room)
    displace(chain, state, displacement)


def displace(chain: Chain, state: State, displacement: Array) -> None:
    """Move every bead by `displacement` (n+1,) [m]; contacts that this changes get the force of their new overlap."""
    change = displacement[:-1] - displacement[1:]
    state.overlap += change
    state.anchor[0] += displacement[chain.anchor]
    for contact in np.flatnonzero(change).tolist():
        state.force[contact] = chain.contact[contact].force(float(state.overlap[contact]))


def set_velocity(chain: Chain, state: State, bead: int | None, velocity: float) -> None:
    """Give `bead`, or all beads (None), the velocity [m/s]."""
    if bead is None:
        state.rate[:] = 0.0
        state.anchor[1] = velocity
        return
    change = velocity - float(state.velocity(chain)[bead])
    if bead > 0:
        state.rate[bead - 1] -= change
    if bead < chain.contacts:
        state.rate[bead] += change
    if bead == chain.anchor:
        state.anchor[1] = velocity


def state_from_bead_0(
    chain: Chain, time: float, contacts: tuple[Array, Array, Array], bead_0: tuple[float, float]
) -> State:
    """A State of `chain` from overlaps, rates and forces (n,), with bead 0 at position and velocity `bead_0`."""
    overlap, rate, force = contacts
    anchor = np.array(
        [from_anchor(values, start, 0)[chain.anchor] for values, start in zip((overlap, rate), bead_0, strict=True)]
    )
    return State(time, overlap, rate, anchor, force)


MOST_BEADS = 400  # of a lane that beads are added to
LARGEST = 1e12  # of a typed number: beyond it sums of positions lose their digits
Changed = tuple[LaneSetup, State]


class ContactChange(NamedTuple):
    """A contact after an edit: its law, the one to restore when it is unlocked, the one that it was converted from."""

    law: Contact
    locked: Contact | None = None
    origin: Contact | None = None


@singledispatch
def edited(item: object, setup: LaneSetup, state: State) -> Changed:
    """Setup and state after `item`; `state` may be changed in place. ValueError with a sentence: refused."""
    raise TypeError(f"not an edit of a lane: {item!r}")


def edited_start(item: inputs.LaneInput, setup: LaneSetup) -> State:
    """The start of the lane after `item`: masses and the number of beads change it, positions and velocities do not."""
    if isinstance(item, inputs.SetMass | inputs.AddBead | inputs.RemoveBead):
        return edited(item, setup, setup.start.copy())[1]
    return setup.start


@edited.register
def _(item: inputs.Place, setup: LaneSetup, state: State) -> Changed:
    _check_index(N_("bead"), item.bead, setup.chain.contacts + 1)
    place_bead(setup.chain, state, item.bead, _finite(N_("position"), item.position))
    return setup, state


@edited.register
def _(item: inputs.SetVelocity, setup: LaneSetup, state: State) -> Changed:
    _check_index(N_("bead"), item.bead, setup.chain.contacts + 1)
    set_velocity(setup.chain, state, item.bead, _finite(N_("velocity"), item.velocity))
    return setup, state


@edited.register
def _(item: inputs.SetMass, setup: LaneSetup, state: State) -> Changed:
    chain = setup.chain
    _check_index(N_("bead"), item.bead, chain.contacts + 1)
    if not math.isinf(item.mass):
        _finite(N_("mass"), item.mass)
    chosen = [i for i, mass in enumerate(chain.mass) if item.bead in (i, None) and (item.bead == i or mass < math.inf)]
    masses = [item.mass if i in chosen else mass for i, mass in enumerate(chain.mass)]
    return _with_chain(setup, state, replace(chain, mass=tuple(masses)))


@edited.register
def _(item: inputs.SetContact, setup: LaneSetup, state: State) -> Changed:
    _check_law(item.law)
    return _with_contacts(setup, state, item.contact, lambda index: ContactChange(item.law))


@edited.register
def _(item: inputs.SetKind, setup: LaneSetup, state: State) -> Changed:
    def converted(index: int) -> ContactChange:
        present = plain_contact(setup.chain, index)
        origin = setup.origin_of(index) or present
        chain = replace(setup.chain, contact=_put(setup.chain.contact, index, origin))
        law = converted_contact(chain, index, item.kind, setup.speed, setup.length)
        return ContactChange(present if kind_of(present) == item.kind else law, origin=origin)

    return _with_contacts(setup, state, item.contact, converted)


@edited.register
def _(item: inputs.Lock, setup: LaneSetup, state: State) -> Changed:
    def locked(index: int) -> ContactChange:
        contact, soft, origin = plain_contact(setup.chain, index), setup.locked[index], setup.origin_of(index)
        if item.locked:
            hard = contact if soft else hard_contact(setup.chain, index, setup.speed)
            return ContactChange(hard, locked=soft or contact, origin=origin)
        return ContactChange(soft or contact, origin=origin)

    return _with_contacts(setup, state, item.contact, locked)


@edited.register
def _(item: inputs.SetGap, setup: LaneSetup, state: State) -> Changed:
    _check_index(N_("contact"), item.contact, setup.chain.contacts)
    if not item.gap <= LARGEST:
        raise ValueError(gettext("a gap must be a number up to {most:g}, not {given!r}", most=LARGEST, given=item.gap))
    if not -item.gap < min(setup.length, LARGEST):
        raise ValueError(
            gettext(
                "an overlap must be below the length of a bead, {length:g} m, not {given!r}",
                length=setup.length,
                given=-item.gap,
            )
        )
    displacement = np.zeros(setup.chain.contacts + 1)
    displacement[item.contact + 1 :] = item.gap + float(state.overlap[item.contact])
    displace(setup.chain, state, displacement)
    state.overlap[item.contact] = 0.0 - item.gap
    return setup, state


@edited.register
def _(item: inputs.SetDrive, setup: LaneSetup, state: State) -> Changed:
    chain = setup.chain
    _check_index(N_("bead"), item.bead, chain.contacts + 1)
    force = _finite(N_("force"), item.force)
    drive = [force if item.bead in (i, None) else old for i, old in enumerate(chain.drive or (0.0,) * len(chain.mass))]
    return _with_chain(setup, state, replace(chain, drive=tuple(drive)))


@edited.register
def _(item: inputs.SetFriction, setup: LaneSetup, state: State) -> Changed:
    if not 0.0 <= item.friction <= LARGEST:
        raise ValueError(
            gettext("friction must be a number from 0 to {most:g}, not {given!r}", most=LARGEST, given=item.friction)
        )
    return _with_chain(setup, state, replace(setup.chain, friction=float(item.friction)))


@edited.register
def _(item: inputs.SetMethod, setup: LaneSetup, state: State) -> Changed:
    return setup.with_method(item.method), state


@edited.register
def _(item: inputs.SetStep, setup: LaneSetup, state: State) -> Changed:
    if item.step is not None and not 0.0 < item.step <= LARGEST:
        raise ValueError(gettext("a step must be a time > 0, not {given!r}", given=item.step))
    return setup.with_step(item.step), state


@edited.register
def _(item: inputs.AddBead, setup: LaneSetup, state: State) -> Changed:
    chain, n = setup.chain, setup.chain.contacts
    _check_index(N_("bead"), item.bead, n + 2)
    if n + 2 > MOST_BEADS:
        raise ValueError(gettext("a lane holds at most {most} beads", most=MOST_BEADS))
    if not math.isinf(item.mass):
        _finite(N_("mass"), item.mass)
    near = min(max(item.bead - 1, 0), n - 1)  # the contact that it divides, or the one beside it
    law = chain.contact[near] if item.law is None else item.law
    _check_law(law)
    masses = [*chain.mass[: item.bead], item.mass, *chain.mass[item.bead :]]
    contacts, gaps = list(chain.contact), list(chain.gap)
    at = min(item.bead, n)
    contacts.insert(at, law)
    gaps.insert(at, 0.0)
    locked = (*setup.locked[:at], None, *setup.locked[at:])
    origin = (*setup.origin[:at], None, *setup.origin[at:]) if setup.origin else ()
    drive = None if chain.drive is None else (*chain.drive[: item.bead], 0.0, *chain.drive[item.bead :])
    moved = [i + (i >= item.bead) for i in range(n + 1)]
    forces, brakes = on_other_beads(chain.forces, moved), on_other_beads(chain.brakes, moved)
    longer = Chain(masses, contacts, gaps, drive, chain.friction, forces, brakes)
    return setup.with_chain(longer, locked, origin), _inserted(
        chain, longer, state, item.bead, abs(_finite(N_("gap"), item.gap))
    )


def _inserted(chain: Chain, longer: Chain, state: State, bead: int, gap: float) -> State:
    """The state with one bead more, which has the mean velocity of its neighbours."""
    n = chain.contacts
    position, velocity = state.position(chain), state.velocity(chain)
    first = float(position[0]), float(velocity[0])
    if bead in (0, n + 1):
        at = 0 if bead == 0 else n
        overlap, rate = np.insert(state.overlap, at, -gap), np.insert(state.rate, at, 0.0)
        first = (first[0] - gap, first[1]) if bead == 0 else first
    else:
        at = bead
        between = float(state.overlap[bead - 1])
        shared = between if between > 0.0 else 0.5 * between
        overlap, rate = np.insert(state.overlap, at, shared), np.insert(state.rate, at, 0.5 * state.rate[bead - 1])
        overlap[bead - 1], rate[bead - 1] = shared, 0.5 * state.rate[bead - 1]
    force = np.insert(state.force, at, 0.0)
    force[at] = longer.contact[at].force(float(overlap[at]))
    return state_from_bead_0(longer, state.time, (overlap, rate, force), first)


@edited.register
def _(item: inputs.RemoveBead, setup: LaneSetup, state: State) -> Changed:
    chain, n = setup.chain, setup.chain.contacts
    _check_index(N_("bead"), item.bead, n + 1)
    if n < 2:
        raise ValueError(gettext("a lane needs at least 2 beads"))
    removed = min(item.bead, n - 1)
    rest = [i for i in range(n) if i != removed]
    masses = [mass for i, mass in enumerate(chain.mass) if i != item.bead]
    drive = None if chain.drive is None else [force for i, force in enumerate(chain.drive) if i != item.bead]
    moved = [None if i == item.bead else i - (i > item.bead) for i in range(n + 1)]
    forces, brakes = on_other_beads(chain.forces, moved), on_other_beads(chain.brakes, moved)
    contacts, gaps = [chain.contact[i] for i in rest], [chain.gap[i] for i in rest]
    shorter = Chain(masses, contacts, gaps, drive, chain.friction, forces, brakes)
    position, velocity = state.position(chain), state.velocity(chain)
    overlap, rate, force = state.overlap[rest], state.rate[rest], state.force[rest]
    if 0 < item.bead < n:
        overlap[item.bead - 1] += state.overlap[item.bead]
        rate[item.bead - 1] += state.rate[item.bead]
        force[item.bead - 1] = shorter.contact[item.bead - 1].force(float(overlap[item.bead - 1]))
    start = 1 if item.bead == 0 else 0
    first = float(position[start]), float(velocity[start])
    locked, origin = tuple(setup.locked[i] for i in rest), tuple(setup.origin_of(i) for i in rest)
    kept = origin if any(origin) else ()
    return setup.with_chain(shorter, locked, kept), state_from_bead_0(
        shorter, state.time, (overlap, rate, force), first
    )


def _with_contacts(
    setup: LaneSetup, state: State, index: int | None, change: Callable[[int], ContactChange]
) -> Changed:
    """The lane with contact `index` (None: each) replaced by what `change` makes of it."""
    _check_index(N_("contact"), index, setup.chain.contacts)
    contacts, locked = list(setup.chain.contact), list(setup.locked)
    origin = [setup.origin_of(i) for i in range(len(contacts))]
    for i in range(len(contacts)) if index is None else (index,):
        contacts[i], locked[i], origin[i] = change(i)
    kept = tuple(origin) if any(origin) else ()
    return setup.with_chain(replace(setup.chain, contact=tuple(contacts)), tuple(locked), kept), state


def _put(contacts: tuple[Joint, ...], index: int, law: Contact) -> tuple[Joint, ...]:
    return *contacts[:index], law, *contacts[index + 1 :]


def _with_chain(setup: LaneSetup, state: State, chain: Chain) -> Changed:
    """The lane with `chain`, which has as many beads; the state follows to another anchor bead."""
    anchor = chain.anchor
    if anchor != setup.chain.anchor:
        both = state.position(setup.chain)[anchor], state.velocity(setup.chain)[anchor]
        state.anchor[:] = both
    return setup.with_chain(chain), state


def _check_index(name: str, index: int | None, count: int) -> None:
    if index is not None and not 0 <= index < count:
        raise ValueError(
            gettext(
                "there is no {name} {index}; they are numbered 0 to {last}",
                name=gettext(name),
                index=index,
                last=count - 1,
            )
        )


def _check_law(law: Joint) -> None:
    """Refuse a law whose numbers are beyond any use, a slip of the keyboard; a Contact has checked its exponent itself."""
    if not isinstance(law, Contact):
        return
    for name, number in ((N_("preload"), law.preload), (N_("stiffness"), law.stiffness)):
        _finite(name, number)


def _finite(name: str, number: float) -> float:
    if not (math.isfinite(number) and abs(number) <= LARGEST):
        raise ValueError(
            gettext(
                "{name} must be a number within {most:g}, not {given!r}", name=gettext(name), most=LARGEST, given=number
            )
        )
    return float(number)
