"""From a Chain and a State to the effective chain of adaptive steps and the Regime that it is made from."""

from __future__ import annotations

from typing import Any

import numpy as np
from softcradle.physics.chain import Chain
from softcradle.physics.kernel_records import NO_FLAGS, chain_records
from softcradle.physics.numerics.records import NO_DISSIPATION, NOTHING
from softcradle.physics.state import State


def chain_and_regime(chain: Chain, state: State) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """The fields of the effective chain and of its Regime; without dissipation they share their arrays."""
    law, inverse_mass, push, external, anchor, *others, dissipation = chain_records(chain, state)
    others.append(NO_DISSIPATION)
    if not chain.dissipative:
        regime = (law, inverse_mass, push, NOTHING, NOTHING, NO_FLAGS, NO_FLAGS)
        return (law, inverse_mass, push, external, anchor, *others), regime
    loss = dissipation.loss if dissipation.loss.any() else NOTHING
    bed = dissipation.bed if dissipation.bed.any() else NOTHING
    slide, easing = np.zeros(bed.size, dtype=np.int8), np.zeros(loss.size, dtype=np.int8)
    regime = (law, inverse_mass, push, loss, bed, slide, easing)
    if bed.size and not external.size:
        external = np.zeros(bed.size)
    return (law.copy(), inverse_mass.copy(), push, external, anchor, *others), regime
