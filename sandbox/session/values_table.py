"""The table of values: every bead and every contact of a lane at the frame shown, and as CSV.

The position of a bead is that of its middle, which rulers and kymographs show; the chain's own leaves the lengths of beads out.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from softcradle.sandbox.languages import NP_
from softcradle.sandbox.motion import Array
from softcradle.sandbox.quantities import (
    FORCE,
    KINETIC,
    MASS,
    MOMENTUM,
    OVERLAP,
    POSITION,
    RATE,
    STORED,
    TIME,
    VELOCITY,
    Quantity,
)
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.session.session import Session

OF_BEADS, OF_CONTACTS = (MASS, POSITION, VELOCITY, MOMENTUM, KINETIC), (OVERLAP, RATE, FORCE)
BEAD_COLUMNS = (NP_("column", "bead"), *(one.column for one in OF_BEADS))
CONTACT_COLUMNS = (NP_("column", "contact"), *(one.column for one in OF_CONTACTS), STORED.column)


@dataclass(frozen=True)
class ValuesTable:
    """Headers, marked in the context "column", and a row of numbers for each bead or contact; the first number is its index."""

    columns: tuple[str, ...]
    rows: list[tuple[float, ...]]


def bead_table(session: Session, lane: int) -> ValuesTable:
    """The beads of a lane."""
    live = session.lanes[lane]
    columns = _columns(live, OF_BEADS)
    for inertia in columns[3:]:  # a wall has no momentum or energy of its own
        inertia[np.isinf(live.chain.mass)] = np.nan
    rows = zip(*(column.tolist() for column in columns), strict=True)
    return ValuesTable(BEAD_COLUMNS, [(float(bead), *row) for bead, row in enumerate(rows)])


def _columns(live: LiveLane, quantities: Sequence[Quantity]) -> list[Array]:
    """The values (k,) of quantities at the frame shown."""
    motion = live.motion
    return [quantity.values(motion, live.setup.length)[0] for quantity in quantities]


def middles(live: LiveLane) -> Array:
    """(n+1,) places of the middles of the beads [m]."""
    places: Array = live.motion.middles(live.setup.length)[0]
    return places


def contact_table(session: Session, lane: int) -> ValuesTable:
    """The contacts of a lane; contact k is between beads k and k + 1."""
    live = session.lanes[lane]
    stored = live.chain.stored_energy(live.state.overlap)
    columns = [column.tolist() for column in (*_columns(live, OF_CONTACTS), stored)]
    return ValuesTable(CONTACT_COLUMNS, [(float(k), *row) for k, row in enumerate(zip(*columns, strict=True))])


def value_of(session: Session, lane: int, kind: str, index: int, column: str) -> float:
    """The number in one column of a bead or contact."""
    table = (bead_table if kind == "bead" else contact_table)(session, lane)
    return table.rows[index][table.columns.index(column)]


def values_csv(session: Session) -> str:
    """All lanes as CSV with every digit: the time, then beads, then contacts of each lane."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow((TIME.column, repr(session.time)))
    for lane in range(len(session.lanes)):
        for table in (bead_table(session, lane), contact_table(session, lane)):
            writer.writerow(("lane", *table.columns))
            writer.writerows((session.label(lane) or lane, int(row[0]), *map(repr, row[1:])) for row in table.rows)
    return text.getvalue()
