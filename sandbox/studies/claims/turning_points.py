"""Turning points of a curve."""

from __future__ import annotations

import numpy as np
from softcradle.sandbox.studies.data_table import Array

ROUND_OFF = 1e-12  # of the range of a curve: smaller steps between samples do not count


def turning_points(values: Array) -> int:
    """How often `values` (T,) change from rising to falling or back."""
    steps = np.diff(values)
    signs = np.sign(steps[np.abs(steps) > ROUND_OFF * np.ptp(values)])
    return int((np.diff(signs) != 0).sum())
