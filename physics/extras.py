"""The extras: packages that are not installed with softcradle alone, and the sentence that says how to get them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

EXTRA_OF = {  # package: the extra of pyproject.toml that brings it
    "numba": "fast",
    "av": "film",
    "PIL": "film",
    "pygame": "film",
    "pygame_gui": "window",
    "matplotlib": "figures",
    "pandas": "notebook",
    "xarray": "notebook",
    "IPython": "notebook",
    "zarr": "sweep",
    "h5netcdf": "sweep",
    "h5py": "sweep",
    "dask": "dask",
    "distributed": "dask",
}


@contextmanager
def needed_for(what: str, extra: str | None = None) -> Iterator[None]:
    """Raise an ImportError of one sentence where a package of an extra is missing in the block.

    Arguments:
        what: what needs the package, the subject of the sentence.
        extra: the extra that brings all that `what` needs; None: the one that brings the missing package.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if package not in EXTRA_OF:
            raise
        line = f"pip install 'softcradle[{extra or EXTRA_OF[package]}]'"
        raise ImportError(f"{what} needs {package}, which is not installed: {line}", name=package) from None
