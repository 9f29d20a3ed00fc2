"""From a Chain and a State to the effective chain of adaptive steps and the Regime that it is made from."""

from __future__ import annotations

from typing import Any

import numpy as np
from softcradle.physics.chain import Chain
from softcradle.physics.coupler import Coupler
from softcradle.physics.kernel_records import NO_FLAGS, chain_records, law_rows
from softcradle.physics.numerics.records import NO_DISSIPATION, NOTHING
from softcradle.physics.state import State

NO_SEGMENTS = (NO_FLAGS, np.zeros((0, 9)), np.zeros(0, dtype=np.int64))  # of a chain without couplers


def chain_and_regime(chain: Chain, state: State) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """The fields of the effective chain and of its Regime; without dissipation they share their arrays."""
    law, inverse_mass, push, external, anchor, *others, dissipation = chain_records(chain, state)
    others.append(NO_DISSIPATION)
    if not (chain.dissipative or chain.couplers):
        regime = (law, inverse_mass, push, NOTHING, NOTHING, NO_FLAGS, NO_FLAGS, *NO_SEGMENTS)
        return (law, inverse_mass, push, external, anchor, *others), regime
    loss = dissipation.loss if dissipation.loss.any() or chain.couplers else NOTHING
    bed = dissipation.bed if dissipation.bed.any() else NOTHING
    slide, easing = np.zeros(bed.size, dtype=np.int8), np.zeros(loss.size, dtype=np.int8)
    joints = NO_SEGMENTS
    if chain.couplers:
        joints, law = _segments(chain), np.zeros((chain.contacts, 6))
    regime = (law, inverse_mass, push, loss, bed, slide, easing, *joints)
    if bed.size and not external.size:
        external = np.zeros(bed.size)
    return (law.copy(), inverse_mass.copy(), push, external, anchor, *others), regime


def _segments(chain: Chain) -> tuple[Any, ...]:
    """The segments of all contacts, each on the one in which it pushes first."""
    rows: list[tuple[float, ...]] = []
    first, segment = np.zeros(chain.contacts + 1, dtype=np.int64), np.zeros(chain.contacts, dtype=np.int8)
    for i, contact in enumerate(chain.contact):
        if isinstance(contact, Coupler):
            rows += contact.segments
            segment[i] = sum(side < 0.0 for side, *_ in contact.segments)
        else:
            rows.append((1.0, 0.0, *law_rows(chain)[i].tolist(), 0.0, 0.0, float(chain.loss[i]), np.inf))
        first[i + 1] = len(rows)
    return segment, np.array(rows), first
