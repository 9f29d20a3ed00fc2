"""What a sweep found in a few lines: the range of every measure, and why points have no numbers; read block by block."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING

import numpy as np
from softcradle.sandbox.sweeps.dataset_layout import BLOCK

if TYPE_CHECKING:
    from collections.abc import Iterator

    import xarray as xr

GIVEN_UP = (2, 3, 5, 6)  # values of status: the point has no numbers, or not those of its end


def summary_rows(found: xr.Dataset) -> list[tuple[str, str, str, str, str]]:
    """Name with unit, least, mean, greatest number and how many are missing, of every measure."""
    rows = []
    for name, variable in found.data_vars.items():
        if name in ("status", "warned", "reason") or variable.dtype.kind != "f":
            continue
        least, greatest, total, count = math.inf, -math.inf, 0.0, 0
        for part in _parts(variable):
            known = part[np.isfinite(part)]
            if known.size:
                least, greatest = min(least, float(known.min())), max(greatest, float(known.max()))
                total, count = total + float(known.sum()), count + known.size
        unit = variable.attrs.get("units", "")
        numbers = (f"{least:.4g}", f"{total / count:.4g}", f"{greatest:.4g}") if count else ("-", "-", "-")
        rows.append((f"{name} [{unit}]" if unit else str(name), *numbers, str(variable.size - count)))
    return rows


def reasons_of(found: xr.Dataset) -> list[tuple[str, int]]:
    """Why points have no numbers, the most frequent reason first; digits left out, because each has its own."""
    counts: Counter[str] = Counter()
    for status, reason in zip(_parts(found["status"]), _parts(found["reason"]), strict=True):
        counts.update(str(text) for text in reason[np.isin(status, GIVEN_UP)])
    return counts.most_common()


def _parts(variable: xr.DataArray) -> Iterator[np.ndarray]:
    """The numbers of a variable, some rows of its first dimension at a time."""
    rows = max(1, BLOCK * variable.shape[0] // max(variable.size, 1)) if variable.shape else 1
    for begin in range(0, variable.shape[0], rows):
        yield variable[begin : begin + rows].to_numpy().ravel()
