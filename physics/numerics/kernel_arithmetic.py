"""Floating-point warnings around kernels that run as plain Python."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext

import numpy as np
from softcradle.physics.numerics.float_bits import COMPILED


def kernel_arithmetic() -> AbstractContextManager[object]:
    """Within it, kernels that run as plain Python warn no more of infinite intermediate results than compiled ones do."""
    return nullcontext() if COMPILED else np.errstate(all="ignore")
