"""Snapshots. A snapshot is one complete frame of a session. Its JSON form keeps every digit, so a recording can start
from it.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.contact import Contact
from softcradle.physics.state import State
from softcradle.physics.trajectory_file import chain_from_table
from softcradle.sandbox.session.lane_setup import DURATION, LaneSetup, Setup
from softcradle.sandbox.session.ledger import LEDGER_COLUMNS, VELOCITY_ERROR
from softcradle.scenes import Scene

Array = NDArray[np.float64]

STATE_ARRAYS = ("overlap", "rate", "anchor", "force")


class HeldBead(NamedTuple):
    """The bead held by the pointer: its lane (-1 if none is held), its number, and the position of the pointer [m]."""

    lane: float
    bead: float
    position: float


NOTHING_HELD = HeldBead(-1.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Snapshot:
    """One frame of a session: time [s], setup, the bead held by the pointer, and for each lane its State and ledger
    (13,).
    """

    time: float
    setup: Setup
    held: HeldBead
    states: tuple[State, ...]
    ledgers: tuple[Array, ...]

    def copy(self) -> Snapshot:
        """Return the same frame with its own arrays. The scratch memory of the methods is not copied."""
        states = tuple(state.copy() for state in self.states)
        return replace(self, states=states, ledgers=tuple(ledger.copy() for ledger in self.ledgers))


def snapshot_table(snapshot: Snapshot) -> dict[str, Any]:
    """Return `snapshot` as a table of plain JSON values."""
    return {
        "time": snapshot.time,
        "slow": snapshot.setup.slow,
        "hand": snapshot.held,
        "lanes": [_lane_table(lane) for lane in snapshot.setup.lanes],
        "states": [_state_table(state) for state in snapshot.states],
        "ledgers": [ledger.tolist() for ledger in snapshot.ledgers],
    }


def snapshot_from_table(table: dict[str, Any], scene: Scene) -> Snapshot:
    """Return the Snapshot of `scene` from a table written by :func:`snapshot_table`.

    Raise ValueError, KeyError or TypeError for any other table.
    """
    lane, bead, position = table["hand"]
    return Snapshot(
        time=float(table["time"]),
        setup=Setup(tuple(_lane(lane, scene) for lane in table["lanes"]), float(table["slow"])),
        held=HeldBead(float(lane), float(bead), float(position)),
        states=tuple(_state(state) for state in table["states"]),
        ledgers=tuple(_ledger(ledger) for ledger in table["ledgers"]),
    )


def _ledger(columns: list[float]) -> Array:
    """Return the ledger with the given `columns`. Files of earlier versions lack the last columns.

    A missing error estimate counts as not known. Other missing columns are 0.
    """
    ledger = np.zeros(LEDGER_COLUMNS)
    ledger[VELOCITY_ERROR] = -1.0
    ledger[: len(columns)] = columns
    return ledger


def _lane_table(setup: LaneSetup) -> dict[str, Any]:
    plain = asdict(replace(setup, start=_NO_STATE))
    del plain["length"], plain["duration"]  # The scene contains length and duration.
    if not setup.origin:  # Omit an empty origin, because earlier versions of softcradle cannot read it.
        del plain["origin"]
    # Omit forces and brakes if there are none, because earlier versions of softcradle cannot read them.
    for name in ("forces", "brakes"):
        if not plain["chain"][name]:
            del plain["chain"][name]
    if plain["chain"]["strings"] is None:
        del plain["chain"]["strings"], plain["chain"]["gravity"]
    return {**plain, "start": _state_table(setup.start)}


def _lane(table: dict[str, Any], scene: Scene) -> LaneSetup:
    locked = tuple(None if numbers is None else Contact(**numbers) for numbers in table["locked"])
    origin = tuple(None if numbers is None else Contact(**numbers) for numbers in table.get("origin", ()))
    changed = {"chain": chain_from_table(table["chain"]), "locked": locked, "origin": origin}
    changed |= {"start": _state(table["start"]), "length": scene.view.length, "duration": scene.duration or DURATION}
    return LaneSetup(**{**table, **changed})


def _state_table(state: State) -> dict[str, Any]:
    coupled = {"coupled": state.coupled.tolist()} if state.coupled.size else {}
    return {"time": state.time, **{name: getattr(state, name).tolist() for name in STATE_ARRAYS}, **coupled}


def _state(table: dict[str, Any]) -> State:
    arrays: dict[str, Any] = {name: np.array(table[name], dtype=np.float64) for name in STATE_ARRAYS}
    return State(float(table["time"]), **arrays, coupled=np.array(table.get("coupled", ()), dtype=np.int8))


_NO_STATE = State(0.0, np.zeros(0), np.zeros(0), np.zeros(2), np.zeros(0))
