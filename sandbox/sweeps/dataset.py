"""Dataset of a sweep: variables with dimensions and units, stored as Zarr or NetCDF. This module can also summarise it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.atomic_files import followed, output_file, output_folder
from softcradle.physics.extras import needed_for
from softcradle.sandbox.sweeps.measure_table import Measure, find_measure
from softcradle.sandbox.sweeps.sample_points import Points, kinds_of
from softcradle.sandbox.sweeps.work import REASON, STATUS, WARNED, PointStatus, Work
from softcradle.sandbox.user_error import StudyError

if TYPE_CHECKING:
    import xarray as xr

ENGINES = {".zarr": "zarr", ".nc": "h5netcdf"}  # Storage engine of xarray for each file suffix.
COMPRESSION = 4  # Compression level of numbers in NetCDF, from 1 to 9.
# Values of `status` for points without numbers, or without the numbers of the end of the simulation.
NO_NUMBERS = (2, 3, 5, 6)


def dataset_of(
    columns: Mapping[str, NDArray[Any]], work: Work, units: Mapping[str, str], attributes: Mapping[str, str]
) -> xr.Dataset:
    """Return the Dataset of all points. The argument `units` contains the units of the numbers that a function returns."""
    import xarray as xr

    points, several = work.points, len(work.lanes) > 1
    known = {one.name: one for one in (find_measure(one) if isinstance(one, str) else one for one in work.measures)}
    inner = {
        name: _inner_dimensions(name, column.ndim - 1, known.get(name), several) for name, column in columns.items()
    }
    sizes: dict[str, int] = {}
    for name, dimensions in inner.items():
        for dimension, length in zip(dimensions, columns[name].shape[1:], strict=True):
            sizes[dimension] = max(length, sizes.get(dimension, 0))
    variables = {}
    for name in dict.fromkeys((*known, *columns)):
        own, column = known.get(name), columns.get(name)
        if column is None and own is not None:  # This measure could not be computed at any point.
            inner[name] = _inner_dimensions(name, several + bool(own.each), own, several)
            sizes |= {key: length for key, length in work.lengths.items() if key in inner[name] and key not in sizes}
            if not sizes.keys() >= set(inner[name]):
                continue  # The number of beads is unknown.
        whole = np.full((points.count, *(sizes[dimension] for dimension in inner[name])), np.nan)
        if column is not None and column.shape == whole.shape:
            whole = column
        elif column is not None:
            whole[(slice(None), *map(slice, column.shape[1:]))] = column
        texts = {"units": own.unit, "long_name": own.meaning} if own else {"units": units.get(name, "")}
        variables[name.removeprefix(":")] = (
            (*points.dimensions, *inner[name]),
            whole.reshape(*points.shape, *whole.shape[1:]),
            OWN_COLUMNS.get(name, texts),
        )
    coordinates: dict[str, Any] = {name: np.arange(sizes[name]) for name in ("bead", "contact") if name in sizes}
    if "lane" in sizes:
        coordinates["lane"] = np.array([*work.lanes], dtype=object)
    return xr.Dataset(variables, coordinates | _axis_coordinates(points), dict(attributes))


RESERVED = ("status", "warned", "reason")  # Variables of the Dataset in addition to the measures.
OWN_COLUMNS: dict[str, dict[str, Any]] = {
    STATUS: {
        "long_name": "what became of the point",
        "flag_values": np.array(
            [status.value for status in PointStatus], dtype=np.int8
        ),  # These entries are attributes for flags according to the CF conventions.
        "flag_meanings": " ".join(status.name.lower() for status in PointStatus),
    },
    WARNED: {"long_name": "number of warnings"},
    REASON: {"long_name": 'what went wrong; "" where nothing did'},
}


def _inner_dimensions(name: str, count: int, own: Measure | None, lanes: bool) -> tuple[str, ...]:
    """Return the names of the dimensions that a column has in addition to the dimensions of the points."""
    first = ("lane",) * (own is not None and lanes)
    return first + tuple(
        own.each or f"{name}_item" if own else f"{name}_item{k or ''}" for k in range(count - len(first))
    )


def _axis_coordinates(points: Points) -> dict[str, Any]:
    """Return the coordinates of the varied parameters.

    In a grid, each parameter has its own dimension. Otherwise all parameters vary along the points.
    """
    columns = points.columns(0, points.count) if points.design != "grid" else {}
    found = {}
    for axis in points.axes:
        values = columns[axis.path] if columns else axis.array
        dimension = "point" if columns else axis.coordinate
        found[axis.coordinate] = dimension, values, {"long_name": axis.path}
    return found


def checked_output(output: str | Path, points: Points) -> Path:
    """Return the path of the output with links resolved. Raise StudyError if the points cannot be written to this path."""
    path = followed(Path(output))
    if path.suffix not in ENGINES:
        raise StudyError(f"the output of a sweep must end in {' or '.join(ENGINES)}, not {str(path)!r}")
    if path.exists() and not (path.is_dir() if path.suffix == ".zarr" else path.is_file()):
        there = "folder" if path.is_dir() else "file" if path.is_file() else "pipe or a device"
        raise StudyError(f"cannot write {path}: it is a {there}")
    if not path.absolute().parent.is_dir():
        raise StudyError(f"cannot write {path}: there is no folder {path.absolute().parent}")
    with needed_for(f"a sweep that is kept as {path.suffix}", "sweep"):
        if path.suffix == ".zarr":
            import zarr  # noqa: F401
        else:
            import h5netcdf  # noqa: F401
    for axis in points.axes:
        kinds = kinds_of(axis.values) - {type(None)}
        if axis.array.dtype == object and not (kinds <= {str} or kinds <= {int, float}):
            told = ", ".join(sorted(kind.__name__ for kind in kinds))
            raise StudyError(f"{axis.path}: an output takes values that are all numbers or all texts, not {told}")
    return path


def write_dataset(found: xr.Dataset, path: Path) -> None:
    """Write the Dataset completely or not at all. An existing Dataset is replaced. Raise OSError if writing fails."""
    if path.suffix == ".zarr":
        with output_folder(path, replaces=True) as temporary:
            # Other programs cannot read the texts of Zarr format 3.
            found.to_zarr(temporary, mode="w", zarr_format=2, consolidated=True)
        return
    packed = {"zlib": True, "complevel": COMPRESSION}
    encoding = {name: packed for name, variable in found.data_vars.items() if variable.dtype.kind in "fi"}
    with output_file(path) as temporary:
        found.to_netcdf(temporary, engine="h5netcdf", encoding=encoding)


def opened_dataset(path: Path, study: str) -> xr.Dataset:
    """Open the Dataset in a file. The numbers of the Dataset are read only when a program uses them.

    Raise StudyError if the file belongs to another study.
    """
    with needed_for("a sweep", "sweep"):
        import xarray as xr
    try:
        found = xr.open_dataset(path, engine=ENGINES[path.suffix], decode_timedelta=False)
    except (OSError, ValueError, KeyError) as error:
        raise StudyError(
            f"{path} is there and cannot be read ({type(error).__name__}): give another output, or begin afresh"
        ) from None
    if found.attrs.get("study") != study:
        found.close()
        raise StudyError(f"{path} holds another study, or one by another version: give another output, or begin afresh")
    return found


def summary_rows(found: xr.Dataset) -> list[tuple[str, str, str, str, str]]:
    """Return one row for each measure.

    A row contains the name with unit, the least, mean and greatest value, and the number of points without value.
    """
    rows = []
    for name, variable in found.drop_vars(RESERVED).data_vars.items():
        if variable.dtype.kind != "f":
            continue
        known = variable.where(np.isfinite(variable))
        without = int(known.isnull().all({*known.dims} - {*found["status"].dims}).sum())
        ends = (known.min(), known.mean(), known.max())
        least, mean, greatest = ("-" if np.isnan(number) else f"{number.item():.4g}" for number in ends)
        unit = variable.attrs.get("units", "")
        rows.append((f"{name} [{unit}]" if unit else str(name), least, mean, greatest, str(without)))
    return rows


def reasons_of(found: xr.Dataset) -> list[tuple[str, int]]:
    """Return the reasons why points lack some or all numbers, with the number of points for each reason.

    The most frequent reason is first.
    """
    status, texts = found["status"].to_numpy(), found["reason"].to_numpy()
    without = np.isin(status, NO_NUMBERS) | ((status <= PointStatus.SEPARATED) & (texts != ""))
    return Counter(str(text) for text in texts[without]).most_common()


def lost_points(found: xr.Dataset) -> int:
    """Return the number of points that are lost because the process died in every attempt."""
    return int((found["status"].to_numpy() == PointStatus.LOST).sum())
