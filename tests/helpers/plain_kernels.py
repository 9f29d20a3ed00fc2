"""Helpers for tests that call single kernels in plain Python. With Numba, each kernel would be compiled for a single
test.
"""

import numpy as np
import pytest
from softcradle.physics import Chain, State
from softcradle.physics.adaptive.step_records import (
    Bounds,
    Regime,
    StepContext,
    Trial,
    empty_scratch,
    empty_steps,
    empty_trial,
)
from softcradle.physics.kernel_records import chain_and_regime, chain_records, empty_log, motion_record
from softcradle.physics.numerics import law_curve
from softcradle.physics.numerics.bead_velocities import bead_velocities
from softcradle.physics.numerics.records import LOADED, NO_GRAPHS, ChainData, Motion

COMPILED = hasattr(bead_velocities, "py_func")

only_plain = pytest.mark.skipif(COMPILED, reason="kernels are called as plain Python: NUMBA_DISABLE_JIT=1")


def records_of(chain: Chain, state: State) -> tuple[ChainData, Motion]:
    """Return the ChainData and the Motion of a chain. Kernels that change the Motion also change `state`, because both
    use the same arrays.
    """
    flags = np.zeros((2, chain.contacts), dtype=np.int8)
    return ChainData(*chain_records(chain, state)), Motion(*motion_record(state, *flags))


def effective_records(chain: Chain, state: State) -> tuple[ChainData, Regime, Motion]:
    """Return the effective chain of adaptive steps, the Regime that determines it, and the Motion."""
    data, regime = chain_and_regime(chain, state)
    return ChainData(*data), Regime(*regime, ChainData(*data).graph), records_of(chain, state)[1]


def context_of(
    data: ChainData, regime: Regime, motion: Motion, bounds: Bounds, trial: Trial | None = None, log_size: int = 0
) -> StepContext:
    """Return the context of adaptive steps with the given records and new memory."""
    n = motion.mode.size
    step, memory, log = trial or empty_trial(n), empty_scratch(n), empty_log(n, log_size)
    return StepContext(data, regime, motion, step, empty_trial(n), bounds, memory, log, empty_steps(0, n, False))


def pressed(chain: Chain, velocity: list[float], overlap: object) -> tuple[ChainData, Motion]:
    """Return the records of a chain in which all contacts are loaded. The contacts have the given overlaps [m] and the
    forces of their laws.
    """
    state = State.at_start(chain, velocity)
    state.overlap[:] = overlap
    state.force[:] = [law.force(d) for law, d in zip(chain.contact, state.overlap, strict=True)]
    data, motion = records_of(chain, state)
    motion.mode[:] = LOADED
    return data, motion


def signed_force(preload: float, stiffness: float, exponent: float, overlap: float) -> float:
    """Return the force of a loaded power law at any overlap. Below overlap 0 the law is continued as in adaptive steps."""
    return law_curve.curve_force(np.array([[preload, stiffness, exponent]]), NO_GRAPHS, 0, overlap)


def row_matrix(chain: Chain) -> np.ndarray:
    """Return the matrix L of shape (n, n). The contact forces f accelerate the overlaps by -L f."""
    across = np.eye(chain.contacts, chain.contacts + 1) - np.eye(chain.contacts, chain.contacts + 1, 1)
    return across @ np.diag(chain.inverse_mass) @ across.T
