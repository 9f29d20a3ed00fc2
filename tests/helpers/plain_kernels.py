"""Kernels called one by one as plain Python: compiled, each would be compiled for its test alone."""

import numpy as np
import pytest
from softcradle.physics import Chain, State
from softcradle.physics.kernel_records import chain_records
from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.records import ChainData, Motion

COMPILED = hasattr(bead_velocities, "py_func")

only_plain = pytest.mark.skipif(COMPILED, reason="kernels are called as plain Python: NUMBA_DISABLE_JIT=1")


def records_of(chain: Chain, state: State) -> tuple:
    """ChainData, its Dissipation, and the Motion that the kernels move: the arrays of `state` itself."""
    data = ChainData(*chain_records(chain, state))
    flags = np.zeros(chain.contacts, dtype=np.int8), np.zeros(chain.contacts, dtype=np.int8)
    motion = Motion(state.overlap, state.rate, state.anchor, state.force, state.taken, *flags)
    return data, data.dissipation, motion


def row_matrix(chain: Chain) -> np.ndarray:
    """L (n, n): the accelerations of overlaps by contact forces are -L f."""
    across = np.eye(chain.contacts, chain.contacts + 1) - np.eye(chain.contacts, chain.contacts + 1, 1)
    return across @ np.diag(chain.inverse_mass) @ across.T
