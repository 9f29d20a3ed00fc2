"""Optional packages (extras), and the error message that explains how to install a missing one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

EXTRA_OF = {  # Package: extra of pyproject.toml that installs it
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
        what: what needs the package, the subject of the sentence.
        extra: the extra that installs everything that `what` needs; None: the extra of the missing package.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if package not in EXTRA_OF:
            raise
        line = f"pip install 'softcradle[{extra or EXTRA_OF[package]}]'"
        raise ImportError(f"{what} needs {package}, which is not installed: {line}", name=package) from None
