"""Conversion of a Chain and a State to the records of the kernels, and of the kernels' log of switches to arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.chain import GRAVITY, Chain, per_chain
from softcradle.physics.messages import InputError
from softcradle.physics.numerics.records import (
    COUNTERS,
    NO_DISSIPATION,
    NO_FLAGS,
    NO_GRAPHS,
    NO_KNOTS,
    NO_STRINGS,
    NOTHING,
    POWER,
    SEGMENTS,
    SWITCH,
    TABLE,
    Dissipation,
    Graphs,
    Knots,
    Strings,
    SwitchLog,
)
from softcradle.physics.segments import Segment
from softcradle.physics.state import State, coupled_of, rest_of
from softcradle.physics.status import CodedWarning, WarningCode, Warnings

Array = NDArray[np.float64]

FIRST_LOG = 4096  # Initial number of rows of the log of contact switches
# Number of rows of the log of `advance`. More switches within a frame are chattering. Such switches are counted, but
# not stored.
FRAME_LOG = 256
ROWS_A_STEP = 4  # Number of free rows of the log for each step until the next pause. At a pause, the log can grow.
MOST_LOG = 4_000_000  # Largest number of rows of the log. These rows take 64 MB.


def chain_records(chain: Chain, state: State) -> tuple[Any, ...]:
    """Return the fields of ChainData. The external forces are the current ones of `state`.

    All arrays are writable, because kernels also create writable arrays. For read-only arrays, numba would compile
    every kernel a second time.
    """
    law, inverse_mass = law_rows(chain).copy(), chain.inverse_mass.copy()
    # Chains with several segments are solved like chains with dissipation.
    dissipates = chain.dissipative or chain.has_segments
    dissipation = Dissipation(chain.loss.copy(), chain.bed.copy()) if dissipates else NO_DISSIPATION
    special = graphs_of(chain, state), knots_of(chain, state), dissipation, strings_of(chain)
    push = state.external(chain)
    # Kernels write the time-dependent forces into this array.
    if chain.timed:
        push = np.zeros(chain.contacts + 1) if push is None else push.copy()
    if push is None:
        return law, inverse_mass, NOTHING, NOTHING, chain.anchor, *special
    # Accelerations of the overlaps and of the anchor bead by the external forces.
    acceleration = push * inverse_mass
    external = np.append(acceleration[:-1] - acceleration[1:], acceleration[chain.anchor])
    return law, inverse_mass, push, external, chain.anchor, *special


@per_chain
def law_rows(chain: Chain) -> Array:
    """Return preload, stiffness and exponent (n, 3) of each contact. For a user-defined law, they are those of its
    onset.
    """
    rows = chain.law_rows.copy()
    for i, law in chain.own_contacts:
        rows[i] = law.onset
    return rows


@per_chain
def graph_rows(chain: Chain) -> tuple[Any, ...]:
    """Return the fields of Graphs, except `coupled`.

    The arrays are empty if each contact is a single power law that starts at overlap 0.
    """
    if not (chain.has_segments or chain.own_laws):
        kind, _, *rows = NO_GRAPHS
        return kind, rows
    # Each table is stored only once. The rows of pieces and breakpoints are counted over all tables.
    tables = {id(one.table): one.table for graph in chain.graphs for one in graph if one.table is not None}
    pieces = np.cumsum([0, *(len(table.force) for table in tables.values())]).tolist()
    points = np.cumsum([0, *(len(table.bend) for table in tables.values())]).tolist()
    places = dict(zip(tables, zip(pieces, pieces[1:], points, points[1:], strict=False), strict=True))
    kind = np.array([_kind(graph) for graph in chain.graphs], dtype=np.int8)
    # The segments of all contacts, one after the other. Each segment has the range of rows of its table.
    segments = [segment for graph in chain.graphs for segment in graph]
    force_from = [one.stiffness * one.table_from**one.exponent for one in segments]
    segment = np.array([(*one[:9], one.table_from, force) for one, force in zip(segments, force_from, strict=True)])
    table = np.array([places.get(id(one.table), (0, 0, 0, 0)) for one in segments], dtype=np.int64)
    edges = [np.column_stack((table.edge[:-1], table.edge[1:])) for table in tables.values()]
    parts = zip(*((table.force, table.energy, table.bend) for table in tables.values()), strict=True)
    force, energy, breakpoint = map(np.concatenate, parts) if tables else (np.zeros((0, 0)),) * 3
    first = np.cumsum([0, *map(len, chain.graphs)])
    return kind, (
        first,
        segment,
        table,
        np.concatenate(edges) if tables else np.zeros((0, 2)),
        force,
        energy,
        breakpoint,
    )


def _kind(graph: tuple[Segment, ...]) -> int:
    """Return the number by which kernels distinguish different kinds of force graphs."""
    # Kernels have faster paths for a single power law or table.
    if len(graph) > 1 or not graph[0].is_whole_law:
        return SEGMENTS
    return POWER if graph[0].table is None else TABLE


def graphs_of(chain: Chain, state: State) -> Graphs:
    """Return the Graphs of a chain. The flags of coupled couplers are those of `state`, so kernels change them in
    place.
    """
    kind, rows = graph_rows(chain)
    return Graphs(kind, coupled_of(chain, state), *rows) if kind.size else NO_GRAPHS


def knots_of(chain: Chain, state: State) -> Knots:
    """Return the breakpoints of time-dependent forces and brakes. The arrays are empty for other chains."""
    if not chain.timed:
        return NO_KNOTS
    push, beads = state.external(chain), chain.contacts + 1
    steady = np.zeros(beads) if push is None else push.copy()
    friction = np.where(np.isfinite(chain.mass), chain.friction * GRAVITY, 0.0) if chain.brakes else np.zeros(0)
    return Knots(*chain.knot_rows, steady, friction, np.zeros(beads), np.zeros(friction.size), np.zeros(beads))


def strings_of(chain: Chain) -> Strings:
    """Return the record of the strings. Its arrays are empty for a chain without strings."""
    return Strings(np.append(*rest_of(chain)), chain.swing) if chain.swing else NO_STRINGS


def chain_and_regime(chain: Chain, state: State) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """Return the fields of the effective chain of adaptive steps, and the fields of its Regime without the graph.

    For a chain without dissipation, both share their arrays.
    """
    law, inverse_mass, push, external, anchor, graph, knots, dissipation, strings = chain_records(chain, state)
    others = graph, knots, NO_DISSIPATION, strings
    # Without dissipation the effective chain never changes.
    if not (chain.dissipative or chain.has_segments):
        regime = (law, inverse_mass, NOTHING, NOTHING, NO_FLAGS, NO_FLAGS, NO_FLAGS)
        return (law, inverse_mass, push, external, anchor, *others), regime
    # Empty arrays mark features that the chain does not have. Kernels skip these features.
    loss = dissipation.loss if dissipation.loss.any() or chain.has_segments else NOTHING
    bed = dissipation.bed if dissipation.bed.any() else NOTHING
    slide, easing, segment = np.zeros(bed.size, dtype=np.int8), np.zeros(loss.size, dtype=np.int8), NO_FLAGS
    if chain.has_segments:  # Each contact starts on its innermost pushing segment.
        segment = np.array([sum(one.side < 0.0 for one in graph) for graph in chain.graphs], dtype=np.int8)
        law = np.zeros((chain.contacts, 6))
    regime = (law, inverse_mass, loss, bed, slide, easing, segment)
    # Kinetic friction acts as an external acceleration of the effective chain.
    if bed.size and not external.size:
        external = np.zeros(bed.size)
    return (law.copy(), inverse_mass.copy(), push, external, anchor, *others), regime


def require_finite_motion(chain: Chain, state: State) -> None:
    """Raise ValueError if a contact has an overlap at which its user-defined law is not finite."""
    if chain.own_laws and not (np.isfinite(state.overlap).all() and np.isfinite(state.rate).all()):
        names = ", ".join(repr(law.name) for law in chain.own_laws)
        raise InputError(
            "own_law_failed",
            "contact law {names} gave no number in the course of the motion, which ended after {time:.6g} s: "
            "force and energy must be finite at every overlap of the motion",
            names=names,
            time=state.time,
        )


def motion_record(state: State, mode: Any = NO_FLAGS, held: Any = NO_FLAGS) -> tuple[Any, ...]:
    """Return the fields of Motion. The fields are the arrays of `state` itself, so kernels change the state in place."""
    return state.overlap, state.rate, state.anchor, state.force, state.taken, mode, held


def empty_log(contacts: int, size: int) -> SwitchLog:
    """Return a log with `size` rows for a chain whose contacts are all open."""
    closed, counter = np.zeros(contacts, dtype=np.int8), np.zeros(COUNTERS, dtype=np.int64)
    return SwitchLog(np.empty(size, dtype=np.int64), np.empty(size), closed, counter)


def larger_log(log: SwitchLog) -> int:
    """Return the number of rows of a larger log if `log` was too small for a run.

    Return 0 if the log was large enough, or if it may not grow any more.
    """
    wanted, size = int(log.counter[SWITCH]), log.contact.size
    return min(4 * wanted, MOST_LOG) if wanted > size and size < MOST_LOG else 0


def with_free_rows(log: SwitchLog) -> SwitchLog:
    """Return the log. If half of its rows are used and it may grow, return a log with four times as many rows."""
    size = log.contact.size
    if not 0 < size < min(2 * int(log.counter[SWITCH]), MOST_LOG):
        return log
    rows = min(4 * size, MOST_LOG)
    return log._replace(contact=np.resize(log.contact, rows), time=np.resize(log.time, rows))


def kept_switches(log: SwitchLog) -> tuple[NDArray[np.int64], Array]:
    """Return the contacts (S,) and times (S,) [s] of the stored switches."""
    kept = min(int(log.counter[SWITCH]), log.contact.size)
    return log.contact[:kept], log.time[:kept]


def log_warnings(log: SwitchLog) -> Warnings:
    """Return a warning if contacts switched more often than the log has rows."""
    switches, kept = int(log.counter[SWITCH]), log.contact.size
    if switches <= kept:
        return ()
    sentence = f"contacts switched {switches} times, only the first {kept} are listed"
    return (CodedWarning(WarningCode.LOG_FULL, sentence, {"switches": switches, "listed": kept}),)
