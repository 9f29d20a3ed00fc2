"""Optional packages ("extras"). If one is missing, the error message explains how to install it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

EXTRA_OF = {  # Name of each optional package, and the extra of pyproject.toml that installs it
    "numba": "fast",
    "av": "film",
    "PIL": "film",
    "pygame": "film",
    "pygame_gui": "window",
    "matplotlib": "figures",
    "pandas": "notebook",
    "xarray": "notebook",
    "IPython": "notebook",
    "anywidget": "widget",
    "zarr": "sweep",
    "h5netcdf": "sweep",
    "h5py": "sweep",
    "babel": "dev",
    "dask": "dask",
    "distributed": "dask",
}


@contextmanager
def needed_for(what: str, extra: str | None = None) -> Iterator[None]:
    """Raise an ImportError with one sentence if a package of an extra is missing in the block.

    Arguments:
        what: subject of the sentence: the function that needs the package.
        extra: the extra that installs everything that `what` needs. None means the extra of the missing package.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if package not in EXTRA_OF:
            raise
        line = f"pip install 'softcradle[{extra or EXTRA_OF[package]}]'"
        raise ImportError(f"{what} needs {package}, which is not installed: {line}", name=package) from None
