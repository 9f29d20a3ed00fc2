"""Files and tables of trajectories: .npz files, .csv files, xarray and pandas.

An .npz file is complete: reading it restores an equal Trajectory. The file contains one array for each array of a
Trajectory. For readers without softcradle, it also contains `position` and `velocity`. The array `contact_intervals`
(K, 3) has rows (contact, closed [s], opened [s]). `metadata` is a JSON text in which numbers may be `Infinity` (such as
the mass of a wall) or `NaN`. Python's json module reads them, but strict JSON readers do not. Nothing is pickled.
"""

from __future__ import annotations

import csv
import json
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from os import PathLike
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.atomic_files import output_file
from softcradle.physics.chain import Chain, Joint
from softcradle.physics.contact import Contact, hooke
from softcradle.physics.coupler import Coupler
from softcradle.physics.extras import needed_for
from softcradle.physics.law_table import table_of
from softcradle.physics.messages import InputError
from softcradle.physics.own_law import OwnLaw, TabledLaw
from softcradle.physics.segments import PiecewiseContact, Segment, SegmentTable
from softcradle.physics.status import CodedWarning, Status, WarningCode, Warnings
from softcradle.physics.timed_force import TimedForce
from softcradle.physics.version import version

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

# Version of the file format. Features that older formats do not have, with the number of the last such format: loss and
# friction (1), status and codes of warnings (2), time-dependent forces (3), couplers (4), user-defined laws (5), the
# speed to which the tolerance is relative (6), contacts of segments and couplers that couple later (7).
FORMAT = 8
# Key of a contact with a user-defined law. The names of the arrays of the law's table begin with the same word.
OWN_LAW = "own_law"

DIMENSIONS = {"bead": ("time", "bead"), "contact": ("time", "contact"), "": ("time",)}

T = TypeVar("T")
Array = NDArray[np.float64]
NO_LAWS: Mapping[str, Array] = {}
Path = str | PathLike[str]
Intervals = tuple[tuple[tuple[float, float], ...], ...]


class Columns(NamedTuple):
    """Columns of a table for one quantity. There is one column for each name, with the title ``quantity + name
    [unit]``.

    The values have the shape (T,) or (T, len(names)). `each` is the kind of object to which a column belongs: "bead",
    "contact", or "" for a single column.
    """

    quantity: str
    unit: str
    names: Sequence[str]
    values: Array
    each: str = ""


def save_motion(path: Path, values: Mapping[str, Any], extra: Mapping[str, Array]) -> None:
    """Write a Trajectory to the .npz file `path`. The file is written completely or not at all.

    `values` are the fields of the Trajectory, and `extra` are additional arrays for other readers.

    Raises:
        OSError: the file cannot be written.
    """
    # Arrays are stored directly, everything else as JSON.
    both = {**values, **extra}
    arrays: dict[str, Any] = {name: value for name, value in both.items() if isinstance(value, np.ndarray)}
    plain = {name: value for name, value in values.items() if name not in arrays}
    arrays["contact_intervals"] = _interval_rows(plain.pop("contact_intervals"))
    chain, warnings = plain.pop("chain"), [asdict(warning) for warning in plain.pop("warnings")]
    arrays |= _law_arrays(chain)
    metadata = {
        "format": FORMAT, "versions": versions(), "chain": _chain_table(chain), "warnings": warnings, **plain
    }  # fmt: skip
    arrays["metadata"] = np.array(json.dumps(metadata))
    with output_file(path) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, **arrays)


def load_motion(path: Path, make: Callable[..., T]) -> T:
    """Read the fields that :func:`save_motion` wrote to `path`, and return ``make(**fields)``.

    Raises:
        OSError: the file cannot be read.
        ValueError: the file is not a trajectory of softcradle, or was written by a later version.
    """
    try:
        with open(path, "rb") as opened, np.load(opened, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        plain = json.loads(str(arrays.pop("metadata")))
        found = plain["format"]
        if found in range(1, FORMAT + 1):
            return make(**_fields(arrays, plain))
    except OSError:
        raise
    except Exception:
        # A damaged file can cause an error at any stage: zip, decompression, arrays, JSON, or `make`.
        raise InputError("no_trajectory", "{path}: not a trajectory that softcradle saved", path=path) from None
    raise InputError(
        "trajectory_format",
        "{path}: saved in format {found}, this softcradle reads formats up to {most}",
        path=path,
        found=found,
        most=FORMAT,
    )


def _fields(arrays: dict[str, Array], plain: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of a Trajectory from the arrays and the metadata of a file."""
    # Readers without softcradle use these two arrays. The arrays are not needed for loading.
    for name in ("position", "velocity"):
        arrays.pop(name, None)
    chain = chain_from_table(plain.pop("chain"), arrays)
    arrays = {name: value for name, value in arrays.items() if not name.startswith(OWN_LAW)}
    return {
        **arrays,
        **{name: value for name, value in plain.items() if name not in ("format", "versions")},
        "chain": chain,
        "contact_intervals": _intervals(arrays["contact_intervals"], chain.contacts),
        "status": Status(plain.get("status", Status.DONE)),
        "warnings": _warnings(plain["warnings"]),
    }


def write_csv(path: Path, columns: Sequence[Columns]) -> None:
    """Write one row per sample to the .csv file `path`. The file is written completely or not at all.

    The header contains quantities and units.
    """
    with output_file(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(titles(columns))
        writer.writerows(np.column_stack([part.values for part in columns]).tolist())


def titles(columns: Sequence[Columns]) -> list[str]:
    """Return the title of each column. A title consists of quantity, name and unit."""
    return [f"{part.quantity}{name} [{part.unit}]" for part in columns for name in part.names]


def versions() -> dict[str, str]:
    """Return the versions of the software that produced a result: softcradle, numpy and python."""
    return {"softcradle": version(), "numpy": np.__version__, "python": platform.python_version()}


def _warnings(stored: list[Any]) -> Warnings:
    """Return the warnings that are stored in a file.

    Files of formats 1 and 2 contain sentences without codes. Later versions may have codes that are unknown here.
    """
    codes = {code.value: code for code in WarningCode}
    return tuple(
        CodedWarning(WarningCode.UNKNOWN, entry)
        if isinstance(entry, str)
        else CodedWarning(codes.get(entry["code"], WarningCode.UNKNOWN), entry["sentence"], entry["numbers"])
        for entry in stored
    )


def _interval_rows(intervals: Intervals) -> Array:
    rows = [(i, *interval) for i, spans in enumerate(intervals) for interval in spans]
    return np.array(rows, dtype=np.float64).reshape(-1, 3)


def _chain_table(chain: Chain) -> dict[str, Any]:
    """Return a chain as a table for JSON.

    It is ``asdict(chain)``, except that a user-defined law is replaced by its number and its name.
    """
    contacts = [_contact_table(item, chain) for item in chain.contact]
    return {**asdict(replace(chain, contact=(hooke(1.0),) * chain.contacts)), "contact": contacts}


def _contact_table(item: Joint, chain: Chain) -> dict[str, Any]:
    if isinstance(item, OwnLaw):
        return {OWN_LAW: chain.own_laws.index(item), "name": item.name}
    if (
        isinstance(item, PiecewiseContact) and type(item) is not Coupler
    ):  # The class of the law may not exist when the file is read.
        return {"segments": [segment[:9] for segment in item.segments], "coupled": item.coupled}
    return asdict(item)


def _law_arrays(chain: Chain) -> dict[str, Array]:
    """Return the arrays of the user-defined laws. The energy is not stored, because it is the integral of the force."""
    return {
        f"{OWN_LAW}{k}_{name}": getattr(law.table, name)
        for k, law in enumerate(chain.own_laws)
        for name in ("edge", "force", "error", "bend")
    }


def chain_from_table(stored: dict[str, Any], arrays: Mapping[str, Array] = NO_LAWS) -> Chain:
    """Return the chain from the results of `_chain_table` and `_law_arrays`.

    Keys that are missing in files of earlier versions get their defaults.
    """
    timed = {name: [TimedForce(**item) for item in stored.get(name, ())] for name in ("forces", "brakes")}
    laws: dict[int, OwnLaw] = {}
    contacts = [_contact(item, laws, arrays) for item in stored["contact"]]
    return Chain(**{**stored, **timed, "contact": contacts})


def _contact(stored: dict[str, Any], laws: dict[int, OwnLaw], arrays: Mapping[str, Array]) -> Joint:
    """Return the contact that is described by `stored`.

    `laws` collects the user-defined laws by number, because several contacts may share one law.
    """
    # User-defined law. The table of the law is read once, and all contacts with this law share it.
    if OWN_LAW in stored:
        number = stored[OWN_LAW]
        if number not in laws:
            fields = (arrays[f"{OWN_LAW}{number}_{name}"] for name in ("edge", "force", "error", "bend"))
            laws[number] = OwnLaw(TabledLaw(stored["name"], table_of(*fields)))
        return laws[number]
    # Contact that is defined by a table of segments.
    if "segments" in stored:
        return SegmentTable(tuple(Segment(*row) for row in stored["segments"]), stored["coupled"])
    # Contact with a power law. Otherwise the contact is a coupler with gears.
    if "push" not in stored:
        return Contact(**stored)
    gears = {name: None if stored[name] is None else Contact(**stored[name]) for name in ("push", "pull")}
    return Coupler(**{**stored, **gears})


def _intervals(rows: Array, contacts: int) -> Intervals:
    found: list[list[tuple[float, float]]] = [[] for _ in range(contacts)]
    for contact, closed, opened in rows.tolist():
        found[int(contact)].append((closed, opened))
    return tuple(map(tuple, found))


def dataset(columns: Sequence[Columns], attributes: Mapping[str, Any]) -> xr.Dataset:
    """Return a Dataset with one variable per quantity, over time and bead or contact."""
    with needed_for("to_xarray()", "notebook"):
        import xarray as xr
    # Each variable is an array over time, and over the beads or contacts to which it belongs.
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
    """Return a table with one row per sample, the columns of the .csv file, and time as index."""
    with needed_for("to_pandas()", "notebook"):
        import pandas as pd
    values: Array = np.column_stack([part.values for part in columns])
    frame = pd.DataFrame(values, columns=titles(columns)).set_index("time [s]")
    frame.attrs.update(attributes)
    return frame
