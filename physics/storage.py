"""Trajectories on disk: an .npz file that holds everything and is read back equal, and a .csv table for other programs.

The .npz file holds one array per array of the Trajectory, `position` and `velocity` for readers without softcradle,
`contact_intervals` (K, 3) with rows (contact, closed [s], opened [s]), and `metadata`, a JSON text. Nothing is pickled.
"""

from __future__ import annotations

import csv
import json
import platform
import zipfile
from collections.abc import Iterator
from dataclasses import asdict, fields
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.physics.atomic_files import output_file
from softcradle.physics.chain import Chain
from softcradle.physics.contact import Contact
from softcradle.physics.trajectory import Interval, Trajectory
from softcradle.physics.version import version

FORMAT, READ = 2, (1, 2)  # format 1 knew neither loss nor friction
ARRAYS = ("time", "overlap", "rate", "anchor", "force", "final_velocity")
ABSORBED = ("absorbed_by_contacts", "absorbed_by_bed")
APART = {"chain", "contact_intervals", *ARRAYS, *ABSORBED}  # fields of a Trajectory that are not plain JSON
ABSORBED_COLUMNS = ("absorbed by contacts [J]", "absorbed by bed [J]")

Path = str | PathLike[str]


def save_trajectory(trajectory: Trajectory, path: Path) -> None:
    """Write `trajectory` to the .npz file `path`, whole or not at all. OSError where that cannot be."""
    arrays = {name: getattr(trajectory, name) for name in (*ARRAYS, *ABSORBED, "position", "velocity")}
    arrays["contact_intervals"] = _interval_rows(trajectory)
    arrays["metadata"] = np.array(json.dumps(_metadata(trajectory)))
    with output_file(path) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)


def load_trajectory(path: Path) -> Trajectory:
    """The Trajectory that :func:`save_trajectory` wrote to `path`.

    Raises:
        OSError: the file cannot be read.
        ValueError: it is no trajectory of softcradle, or one of a later version.
    """
    contents, metadata = _read(path)
    plain: dict[str, Any] = {name: metadata[name] for name in _plain_fields() if name in metadata}
    plain["warnings"] = tuple(plain["warnings"])
    chain = _chain(metadata["chain"])
    intervals = _intervals(contents["contact_intervals"], chain.contacts)
    arrays: dict[str, Any] = {name: contents[name] for name in (*ARRAYS, *ABSORBED) if name in contents}
    return Trajectory(chain=chain, contact_intervals=intervals, **arrays, **plain)


def write_csv(trajectory: Trajectory, path: Path) -> None:
    """Write one row a sample to the .csv file `path`, whole or not at all; the header names quantity and unit."""
    with output_file(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(_header(trajectory.chain.contacts))
        writer.writerows(_table(trajectory).tolist())


def versions() -> dict[str, str]:
    """Versions of what made a result: softcradle, numpy, python."""
    return {"softcradle": version(), "numpy": np.__version__, "python": platform.python_version()}


def _plain_fields() -> list[str]:
    return [field.name for field in fields(Trajectory) if field.name not in APART]


def _metadata(trajectory: Trajectory) -> dict[str, Any]:
    plain = {name: getattr(trajectory, name) for name in _plain_fields()}
    return {"format": FORMAT, "versions": versions(), "chain": asdict(trajectory.chain), **plain}


def _interval_rows(trajectory: Trajectory) -> NDArray[np.float64]:
    rows = [(i, *interval) for i, intervals in enumerate(trajectory.contact_intervals) for interval in intervals]
    return np.array(rows, dtype=np.float64).reshape(-1, 3)


def _read(path: Path) -> tuple[dict[str, NDArray[np.float64]], dict[str, Any]]:
    """Arrays and metadata of an .npz file; ValueError where it is something else."""
    try:
        with open(path, "rb") as opened, np.load(opened, allow_pickle=False) as file:
            contents = {name: file[name] for name in file.files}
        metadata = json.loads(str(contents.pop("metadata")))
        found = metadata["format"]
    except (KeyError, TypeError, AttributeError, EOFError, zipfile.BadZipFile, ValueError):
        raise ValueError(f"{path}: not a trajectory that softcradle saved") from None
    if found not in READ:
        raise ValueError(f"{path}: saved in format {found}, this softcradle reads format {FORMAT}")
    return contents, metadata


def _chain(stored: dict[str, Any]) -> Chain:
    return Chain(**{**stored, "contact": [Contact(**numbers) for numbers in stored["contact"]]})


def _intervals(rows: NDArray[np.float64], contacts: int) -> tuple[tuple[Interval, ...], ...]:
    found: list[list[Interval]] = [[] for _ in range(contacts)]
    for contact, closed, opened in rows.tolist():
        found[int(contact)].append((closed, opened))
    return tuple(map(tuple, found))


def _header(contacts: int) -> list[str]:
    def bead(quantity: str, unit: str) -> Iterator[str]:
        return (f"{quantity} {i} [{unit}]" for i in range(contacts + 1))

    def pair(quantity: str, unit: str) -> Iterator[str]:
        return (f"{quantity} {i}-{i + 1} [{unit}]" for i in range(contacts))

    ends = ("kinetic energy [J]", "contact energy [J]", "momentum [N s]", *ABSORBED_COLUMNS)
    return [
        "time [s]", *bead("position", "m"), *bead("velocity", "m/s"), *pair("overlap", "m"), *pair("force", "N"), *ends
    ]  # fmt: skip


def _table(trajectory: Trajectory) -> NDArray[np.float64]:
    """(T, 4 n + 8): the columns that :func:`_header` names."""
    t = trajectory
    energies = t.kinetic_energy, t.contact_energy, t.momentum, t.absorbed_by_contacts, t.absorbed_by_bed
    return np.column_stack([t.time, t.position, t.velocity, t.overlap, t.force, *energies])
