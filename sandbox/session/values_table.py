"""Table of values: numbers of every bead and every contact of a lane at the visible frame, also as CSV.

The position of a bead is its centre, as in rulers and kymographs. The positions in a chain do not include the lengths
of beads.
"""

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from softcradle.sandbox.languages import NP_
from softcradle.sandbox.quantities import (
    BEAD,
    CONTACT,
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
)
from softcradle.sandbox.session.editable_numbers import NUMBERS
from softcradle.sandbox.session.live_lane import LiveLane
from softcradle.sandbox.session.session import Session

OF_BEADS, OF_CONTACTS = (MASS, POSITION, VELOCITY, MOMENTUM, KINETIC), (OVERLAP, RATE, FORCE)
BEAD_COLUMNS = (NP_("column", "bead"), *(one.column for one in OF_BEADS))
CONTACT_COLUMNS = (NP_("column", "contact"), *(one.column for one in OF_CONTACTS), STORED.column)
SET_COLUMNS = tuple(
    number.column for number in NUMBERS if number.column not in (*BEAD_COLUMNS, *CONTACT_COLUMNS)
)  # Settings that do not change during the motion.


@dataclass(frozen=True)
class ValuesTable:
    """A table with a row of numbers for each bead or contact. The first number is the index of the bead or contact.

    The headers in `columns` are marked for translation in the context "column".
    """

    columns: tuple[str, ...]
    rows: list[tuple[float, ...]]


def columns_of(live: LiveLane, kind: str) -> tuple[str, ...]:
    """Return the headers for the beads or contacts of a lane.

    They name the quantities that change with time, and the settings that are not 0 for all beads or contacts.
    """
    return (*(BEAD_COLUMNS if kind == BEAD else CONTACT_COLUMNS), *_set_numbers(live, kind))


def values_table(session: Session, lane: int, kind: str) -> ValuesTable:
    """Return the table of the beads or contacts of a lane. Contact k lies between beads k and k + 1."""
    live = session.lanes[lane]
    columns = [one.values(live.motion, live.setup.length)[0] for one in (OF_BEADS if kind == BEAD else OF_CONTACTS)]
    if kind == BEAD:
        for inertia in columns[3:]:  # A wall has neither momentum nor energy.
            inertia[np.isinf(live.chain.mass)] = np.nan
    else:
        columns.append(live.chain.stored_energy(live.state.overlap, force=live.state.force))
    columns += map(np.array, _set_numbers(live, kind).values())
    rows = zip(*(column.tolist() for column in columns), strict=True)
    return ValuesTable(columns_of(live, kind), [(float(k), *row) for k, row in enumerate(rows)])


def _set_numbers(live: LiveLane, kind: str) -> dict[str, Sequence[float]]:
    """Return the settings of all beads or contacts, by column. Settings that are 0 or missing for all are omitted."""
    found = {one.column: one.values(live) for one in NUMBERS if one.owner == kind and one.column in SET_COLUMNS}
    return {column: values for column, values in found.items() if np.nan_to_num(values).any()}


def values_csv(session: Session) -> str:
    """Return the values of all lanes as CSV, with every digit. The time comes first, then the beads and contacts of
    each lane.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow((TIME.column, repr(session.time)))
    for lane in range(len(session.lanes)):
        for table in (values_table(session, lane, BEAD), values_table(session, lane, CONTACT)):
            writer.writerow(("lane", *table.columns))
            writer.writerows((session.label(lane) or lane, int(row[0]), *map(repr, row[1:])) for row in table.rows)
    return text.getvalue()
