"""Changes of a lane by edits. Beads are moved, immutable parts are replaced, and unusable numbers are rejected."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain, Joint
from softcradle.physics.contact import Contact
from softcradle.physics.state import State, coupled_at, coupled_of, from_anchor
from softcradle.sandbox.languages import N_, gettext
from softcradle.sandbox.session.lane_setup import LaneSetup

Array = NDArray[np.float64]
Flags = NDArray[np.int8]


def place_bead(chain: Chain, state: State, bead: int, position: float) -> None:
    """Move `bead` to `position` [m], or up to a wall. Beads in its way are pushed along until they just touch."""
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
    """Move every bead by its `displacement` (n+1,) [m]. If the overlap of a contact changes, its force follows from the
    new overlap.
    """
    change = displacement[:-1] - displacement[1:]
    state.overlap += change
    state.anchor[0] += displacement[chain.anchor]
    for contact in np.flatnonzero(change).tolist():
        state.put_force(chain, contact)


def set_velocity(chain: Chain, state: State, bead: int | None, velocity: float) -> None:
    """Set the `velocity` [m/s] of `bead`, or of all beads if `bead` is None."""
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
    chain: Chain, time: float, contacts: tuple[Array, Array, Array], bead_0: tuple[float, float], coupled: Flags
) -> State:
    """Return a State of `chain` with the given overlaps, rates and forces (n,).

    `bead_0` contains the position and the velocity of bead 0. `coupled` (n,) or (0,) contains the flags of contacts
    that have coupled.
    """
    overlap, rate, force = contacts
    anchor = np.array(
        [from_anchor(values, start, 0)[chain.anchor] for values, start in zip((overlap, rate), bead_0, strict=True)]
    )
    return State(time, overlap, rate, anchor, force, coupled=coupled)


MOST_BEADS = 400  # Largest number of beads of a lane.
LARGEST = 1e12  # Largest number that can be entered. With larger numbers, sums of positions would lose their digits.
Changed = tuple[LaneSetup, State]


class ContactChange(NamedTuple):
    """A contact after an edit: its law, the law that unlocking restores, and the law from which it was converted."""

    law: Contact
    locked: Contact | None = None
    origin: Contact | None = None


def inserted(chain: Chain, longer: Chain, state: State, bead: int, gap: float) -> State:
    """Return the state with an additional bead. Its velocity is the mean velocity of its neighbours."""
    n = chain.contacts
    position, velocity = state.position(chain), state.velocity(chain)
    first, coupled = (float(position[0]), float(velocity[0])), coupled_of(chain, state)
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
    # Both halves of a divided contact keep its flag. For a new contact at an end, the flag follows from its initial
    # state.
    if coupled.size:
        begins = bead in (0, n + 1) and coupled_at(longer, overlap, force)[at]
        coupled = np.insert(coupled, at, begins if bead in (0, n + 1) else coupled[bead - 1])
    found = state_from_bead_0(longer, state.time, (overlap, rate, force), first, coupled)
    found.put_force(longer, at)
    return found


def with_contacts(setup: LaneSetup, state: State, index: int | None, change: Callable[[int], ContactChange]) -> Changed:
    """Return the lane with contact `index` replaced by the result of `change`. If `index` is None, every contact is
    replaced.

    A compressed contact gets the force that its new law gives for its overlap. A contact that just touches keeps its
    force, within the limits of the new law. The force of such a contact does not follow from its overlap.
    """
    check_index(N_("contact"), index, setup.chain.contacts)
    contacts, locked = list(setup.chain.contact), list(setup.locked)
    origin = [setup.origin_of(i) for i in range(len(contacts))]
    for i in range(len(contacts)) if index is None else (index,):
        law, locked[i], origin[i] = change(i)
        if law != contacts[i]:
            contacts[i], overlap = law, float(state.overlap[i])
            state.force[i] = law.force(overlap) if overlap else min(max(float(state.force[i]), 0.0), law.preload)
    kept = tuple(origin) if any(origin) else ()
    return setup.with_chain(replace(setup.chain, contact=tuple(contacts)), tuple(locked), kept), state


def put(contacts: tuple[Joint, ...], index: int, law: Contact) -> tuple[Joint, ...]:
    """Return the contacts with the law `law` at `index`."""
    return *contacts[:index], law, *contacts[index + 1 :]


def with_chain(setup: LaneSetup, state: State, chain: Chain) -> Changed:
    """Return the lane with another `chain` of the same number of beads. The state is converted if the anchor bead
    changes.
    """
    anchor = chain.anchor
    if anchor != setup.chain.anchor:
        both = state.position(setup.chain)[anchor], state.velocity(setup.chain)[anchor]
        state.anchor[:] = both
    return setup.with_chain(chain), state


def check_index(name: str, index: int | None, count: int) -> None:
    """Raise ValueError if `index` is outside `count` beads or contacts."""
    if index is not None and not 0 <= index < count:
        raise ValueError(
            gettext(
                "{name} {index} does not exist; the numbers go from 0 to {last}",
                name=gettext(name),
                index=index,
                last=count - 1,
            )
        )


def check_law(law: Joint) -> None:
    """Raise ValueError if a contact law has unusable numbers, for example because of a typing error.

    The exponent is not checked, because a Contact has checked it already.
    """
    if not isinstance(law, Contact):
        return
    for name, number in ((N_("preload"), law.preload), (N_("stiffness"), law.stiffness)):
        finite(name, number)


def finite(name: str, number: float) -> float:
    """Return `number`. Raise ValueError if it exceeds LARGEST."""
    if not (math.isfinite(number) and abs(number) <= LARGEST):
        raise ValueError(
            gettext(
                "{name} must be a number of magnitude at most {most:g}, not {given!r}",
                name=gettext(name),
                most=LARGEST,
                given=number,
            )
        )
    return float(number)
