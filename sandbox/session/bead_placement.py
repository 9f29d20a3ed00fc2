"""Placement of beads in a State: only the overlaps that change are written, so that all others keep every digit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.state import State, from_anchor

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
