"""Kernels called one by one as plain Python: compiled, each would be compiled for its test alone."""

import numpy as np
import pytest
from softcradle.physics import Chain, State
from softcradle.physics.adaptive.step_records import Regime
from softcradle.physics.kernel_records import chain_and_regime, chain_records, motion_record
from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.records import LOADED, ChainData, Motion

COMPILED = hasattr(bead_velocities, "py_func")

only_plain = pytest.mark.skipif(COMPILED, reason="kernels are called as plain Python: NUMBA_DISABLE_JIT=1")


def records_of(chain: Chain, state: State) -> tuple[ChainData, Motion]:
    """ChainData, and the Motion that the kernels move: the arrays of `state` itself."""
    flags = np.zeros((2, chain.contacts), dtype=np.int8)
    return ChainData(*chain_records(chain, state)), Motion(*motion_record(state, *flags))


def effective_records(chain: Chain, state: State) -> tuple[ChainData, Regime, Motion]:
    """The effective chain of adaptive steps, what it is made from, and the Motion."""
    data, regime = chain_and_regime(chain, state)
    return ChainData(*data), Regime(*regime), records_of(chain, state)[1]


def pressed(chain: Chain, velocity: list[float], overlap: object) -> tuple[ChainData, Motion]:
    """Records of a chain whose contacts are loaded: with these overlaps, and the forces that their laws give them."""
    state = State.at_start(chain, velocity)
    state.overlap[:] = overlap
    state.force[:] = [law.force(d) for law, d in zip(chain.contact, state.overlap, strict=True)]
    data, motion = records_of(chain, state)
    motion.mode[:] = LOADED
    return data, motion


def row_matrix(chain: Chain) -> np.ndarray:
    """L (n, n): the accelerations of overlaps by contact forces are -L f."""
    across = np.eye(chain.contacts, chain.contacts + 1) - np.eye(chain.contacts, chain.contacts + 1, 1)
    return across @ np.diag(chain.inverse_mass) @ across.T
