"""Where the Dataset of a sweep is written, block by block: in memory, as Zarr, as NetCDF; units are attributes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.atomic_files import output_file, output_folder
from softcradle.physics.extras import needed_for
from softcradle.sandbox.sweeps.dataset_layout import Layout, Region, block_values, blocks, chunk_shape
from softcradle.sandbox.sweeps.journal import Journal

if TYPE_CHECKING:
    import xarray as xr

KINDS = (".zarr", ".nc")  # endings of files
COMPRESSION = 4  # of gzip, 1 to 9


class Sink(Protocol):
    """Where a Dataset is written."""

    def begin(self, layout: Layout) -> None:
        """Make all variables, and write the coordinates that do not depend on the point."""

    def write(self, name: str, region: Region, values: NDArray[Any]) -> None:
        """Write a block of a variable."""

    def finish(self) -> Any:
        """Write what is left; the Dataset, where it is in memory."""


def fill(sink: Sink, layout: Layout, journal: Journal, progress: Callable[[int], None] | None = None) -> Any:
    """Write all points block by block, and return what the sink made."""
    sink.begin(layout)
    for begin, end, region in blocks(layout.points.shape):
        chunk, columns = journal.rows(begin, end), layout.points.columns(begin, end)
        shape = [part.stop - part.start for part in region if isinstance(part, slice)]
        for variable in layout.variables:
            values = block_values(variable, chunk, columns, layout)
            sink.write(variable.name, region, values.reshape(*shape, *values.shape[1:]))
        if progress is not None:
            progress(end - begin)
    return sink.finish()


class MemorySink:
    """A Dataset in memory."""

    def begin(self, layout: Layout) -> None:
        """Make all variables."""
        self._layout = layout
        self._arrays: dict[str, NDArray[Any]] = {
            v.name: np.empty([layout.sizes[d] for d in v.dimensions], dtype=object if v.kind is str else v.kind)
            for v in layout.variables
        }

    def write(self, name: str, region: Region, values: NDArray[Any]) -> None:
        """Write a block of a variable."""
        self._arrays[name][region] = values

    def finish(self) -> xr.Dataset:
        """The Dataset."""
        import xarray as xr

        layout = self._layout
        found = {v.name: (v.dimensions, _plain(self._arrays[v.name]), dict(v.attributes)) for v in layout.variables}
        still = {v.name: (v.dimensions, _plain(v.values), dict(v.attributes)) for v in layout.coordinates}
        moving = {name: found.pop(name) for name in layout.moving}
        return xr.Dataset(found, still | moving, dict(layout.attributes))


def _plain(values: NDArray[Any]) -> NDArray[Any]:
    """Texts as NumPy's own, so that they are compared and printed as such."""
    return values.astype(str) if values.dtype == object else values


class ZarrSink:
    """A Zarr store, in the second format: the third has no texts that other programs read."""

    def __init__(self, folder: Path) -> None:
        with needed_for("a sweep that is kept as Zarr", "sweep"):
            import zarr
        self._zarr, self._folder = zarr, folder
        self._group = zarr.create_group(folder, zarr_format=2)

    def begin(self, layout: Layout) -> None:
        """Make all arrays, and write the coordinates."""
        from zarr.dtype import VariableLengthUTF8

        self._group.attrs.update(dict(layout.attributes))
        for variable in (*layout.variables, *layout.coordinates):
            still, shape = variable.values is not None, tuple(layout.sizes[name] for name in variable.dimensions)
            self._group.create_array(
                variable.name,
                shape=shape,
                chunks=tuple(max(1, length) for length in shape) if still else chunk_shape(variable, layout),
                dtype=VariableLengthUTF8() if variable.kind is str else np.dtype(variable.kind),
                fill_value=np.nan if variable.kind is np.float64 else None,
                attributes={
                    "_ARRAY_DIMENSIONS": list(variable.dimensions),
                    **_json(layout.stored_attributes(variable)),
                },
            )
            if still:
                self._group[variable.name][...] = variable.values

    def write(self, name: str, region: Region, values: NDArray[Any]) -> None:
        """Write a block of an array."""
        self._group[name][region] = values

    def finish(self) -> None:
        """Write the metadata of all arrays in one place."""
        self._zarr.consolidate_metadata(self._folder, zarr_format=2)


class NetcdfSink:
    """A NetCDF file, of the fourth version."""

    def __init__(self, path: Path) -> None:
        with needed_for("a sweep that is kept as NetCDF", "sweep"):
            import h5netcdf
        self._file = h5netcdf.File(path, "w")

    def begin(self, layout: Layout) -> None:
        """Make all variables, and write the coordinates."""
        import h5py

        self._file.dimensions = dict(layout.sizes)
        self._file.attrs.update(layout.attributes)
        for variable in (*layout.variables, *layout.coordinates):
            still = variable.values is not None
            made = self._file.create_variable(
                variable.name,
                variable.dimensions,
                h5py.string_dtype() if variable.kind is str else np.dtype(variable.kind),
                chunks=None if still else chunk_shape(variable, layout),
                fillvalue=np.nan if variable.kind is np.float64 else None,
                **({} if still or variable.kind is str else {"compression": "gzip", "compression_opts": COMPRESSION}),
            )
            made.attrs.update(layout.stored_attributes(variable))
            if still:
                made[...] = variable.values

    def write(self, name: str, region: Region, values: NDArray[Any]) -> None:
        """Write a block of a variable."""
        self._file.variables[name][region] = values

    def finish(self) -> None:
        """Close the file."""
        self._file.close()


def _json(attributes: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in attributes.items()}


@contextmanager
def file_sink(path: Path) -> Iterator[Sink]:
    """The sink for a file of that name, which is whole when the block ends without error, or is not there."""
    if path.suffix == ".zarr":
        with output_folder(path) as temporary:
            yield ZarrSink(temporary)
    else:
        with output_file(path) as temporary:
            temporary.unlink()
            sink = NetcdfSink(temporary)
            yield sink
            sink.finish()


def open_dataset(path: Path) -> xr.Dataset:
    """The Dataset in a file; its numbers are read when they are asked for."""
    with needed_for("a sweep", "sweep"):
        import xarray as xr
    if path.suffix == ".zarr":
        return xr.open_zarr(path, chunks=None, consolidated=True)
    return xr.open_dataset(path, engine="h5netcdf")
