"""Edits of values: the input that gives a bead or contact the number that was typed into its row of the tables of values."""

from __future__ import annotations

import math
from collections.abc import Callable

from softcradle.sandbox.languages import gettext
from softcradle.sandbox.session.inputs import Input, Place, SetGap, SetMass, SetVelocity
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.session.session import Session
from softcradle.sandbox.session.values_table import middles

Edit = Callable[[LiveLane, int, int, float], Input]


def _mass(live: LiveLane, lane: int, bead: int, value: float) -> Input:
    return SetMass(lane, bead, value)


def _position(live: LiveLane, lane: int, bead: int, value: float) -> Input:
    return Place(lane, bead, value - (float(middles(live)[bead]) - float(live.position[bead])))


def _velocity(live: LiveLane, lane: int, bead: int, value: float) -> Input:
    return SetVelocity(lane, bead, value)


def _momentum(live: LiveLane, lane: int, bead: int, value: float) -> Input:
    return SetVelocity(lane, bead, value / live.chain.mass[bead])


def _kinetic_energy(live: LiveLane, lane: int, bead: int, value: float) -> Input:
    """The bead keeps its direction; one at rest goes to the right."""
    if value < 0.0:
        raise ValueError(gettext("a kinetic energy must be a number from 0 on, not {given!r}", given=value))
    speed = math.sqrt(2.0 * value / live.chain.mass[bead])
    return SetVelocity(lane, bead, -speed if live.velocity[bead] < 0.0 else speed)


def _overlap(live: LiveLane, lane: int, contact: int, value: float) -> Input:
    return SetGap(lane, contact, 0.0 - value)


def _rate(live: LiveLane, lane: int, contact: int, value: float) -> Input:
    """The bead on the right takes the difference."""
    return SetVelocity(lane, contact + 1, float(live.velocity[contact]) - value)


# By column; force and stored energy follow from the overlap and the law of the contact.
EDITS: dict[str, Edit] = {
    "mass (kg)": _mass,
    "position (m)": _position,
    "velocity (m/s)": _velocity,
    "momentum (N s)": _momentum,
    "kinetic energy (J)": _kinetic_energy,
    "overlap (m)": _overlap,
    "rate (m/s)": _rate,
}
NOT_OF_WALLS = ("momentum (N s)", "kinetic energy (J)")


def can_be_edited(live: LiveLane, column: str, index: int) -> bool:
    """Whether a number can be typed into the column of bead or contact `index`."""
    return column in EDITS and not (column in NOT_OF_WALLS and math.isinf(live.chain.mass[index]))


def edit_of(session: Session, lane: int, column: str, index: int, value: float) -> Input:
    """The input that sets the column of bead or contact `index` to `value`. ValueError with a sentence: refused."""
    return EDITS[column](session.lanes[lane], lane, index, value)
