"""Floating-point warnings around kernels."""

from __future__ import annotations

from contextlib import AbstractContextManager

import numpy as np


def kernel_arithmetic() -> AbstractContextManager[object]:
    """Within it, kernels that run as plain Python warn no more of infinite intermediate results than compiled ones do."""
    return np.errstate(all="ignore")
