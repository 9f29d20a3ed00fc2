"""Moments as plain JSON, every digit kept: the base of a recording."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import Chain
from softcradle.physics.contact import Contact
from softcradle.physics.state import State
from softcradle.sandbox.session.history import LEDGER, Moment
from softcradle.sandbox.session.lane_setup import LaneSetup, Setup

ARRAYS = ("overlap", "rate", "anchor", "force")


def moment_table(moment: Moment) -> dict[str, Any]:
    """`moment` as a table that JSON can hold."""
    return {
        "time": moment.time,
        "slow": moment.setup.slow,
        "hand": moment.hand,
        "lanes": [_lane_table(lane) for lane in moment.setup.lanes],
        "states": [_state_table(state) for state in moment.states],
        "ledgers": [ledger.tolist() for ledger in moment.ledgers],
    }


def moment_from(table: dict[str, Any]) -> Moment:
    """The Moment that :func:`moment_table` wrote; ValueError, KeyError or TypeError where it is none."""
    lane, bead, position = table["hand"]
    return Moment(
        time=float(table["time"]),
        setup=Setup(tuple(_lane(lane) for lane in table["lanes"]), float(table["slow"])),
        hand=(float(lane), float(bead), float(position)),
        states=tuple(_state(state) for state in table["states"]),
        ledgers=tuple(_ledger(ledger) for ledger in table["ledgers"]),
    )


def _ledger(columns: list[float]) -> NDArray[np.float64]:
    """The ledger, with columns that an earlier softcradle did not know at 0."""
    return np.array([*columns, *[0.0] * (LEDGER - len(columns))], dtype=np.float64)


def _lane_table(setup: LaneSetup) -> dict[str, Any]:
    plain = asdict(replace(setup, start=_NO_STATE))
    return {**plain, "start": _state_table(setup.start)}


def _lane(table: dict[str, Any]) -> LaneSetup:
    chain = {**table["chain"], "contact": [Contact(**numbers) for numbers in table["chain"]["contact"]]}
    locked = tuple(None if numbers is None else Contact(**numbers) for numbers in table["locked"])
    return LaneSetup(**{**table, "chain": Chain(**chain), "locked": locked, "start": _state(table["start"])})


def _state_table(state: State) -> dict[str, Any]:
    return {"time": state.time, **{name: getattr(state, name).tolist() for name in ARRAYS}}


def _state(table: dict[str, Any]) -> State:
    arrays: dict[str, Any] = {name: np.array(table[name], dtype=np.float64) for name in ARRAYS}
    return State(float(table["time"]), **arrays)


_NO_STATE = State(0.0, np.zeros(0), np.zeros(0), np.zeros(2), np.zeros(0))
