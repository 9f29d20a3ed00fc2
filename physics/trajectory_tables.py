"""Trajectories for other libraries: an xarray Dataset and a pandas DataFrame, with units; both are of the extra [notebook]."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from softcradle.physics.extras import needed_for
from softcradle.physics.trajectory_file import Columns, titles

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from numpy.typing import NDArray

DIMENSIONS = {"bead": ("time", "bead"), "contact": ("time", "contact"), "": ("time",)}


def dataset(columns: Sequence[Columns], attributes: Mapping[str, Any]) -> xr.Dataset:
    """One variable a quantity, over time and bead or contact."""
    with needed_for("to_xarray()", "notebook"):
        import xarray as xr
    time, *others = columns
    variables = {
        part.quantity.replace(" ", "_"): (DIMENSIONS[part.each], part.values, {"units": part.unit}) for part in others
    }
    wide = {part.each: part.values.shape[1] for part in others if part.each}
    coordinates = {
        "time": ("time", time.values, {"units": time.unit}),
        **{name: np.arange(n) for name, n in wide.items()},
    }
    return xr.Dataset(variables, coordinates, dict(attributes))


def data_frame(columns: Sequence[Columns], attributes: Mapping[str, Any]) -> pd.DataFrame:
    """One row a sample, the columns of the .csv file, time as the index."""
    with needed_for("to_pandas()", "notebook"):
        import pandas as pd
    values: NDArray[np.float64] = np.column_stack([part.values for part in columns])
    frame = pd.DataFrame(values, columns=titles(columns)).set_index("time [s]")
    frame.attrs.update(attributes)
    return frame
