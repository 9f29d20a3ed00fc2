"""The numbers of a function at many points as plain columns: what studies take of a sweep, without xarray."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from softcradle.sandbox.sweeps.chunk_work import PointStatus
from softcradle.sandbox.sweeps.run_sweep import journal_path, open_journal
from softcradle.sandbox.sweeps.sample_points import Points
from softcradle.sandbox.sweeps.study_error import StudyError
from softcradle.sandbox.sweeps.study_text import study_text, sweep_work
from softcradle.sandbox.sweeps.sweep_places import Places, Progress, compute_missing


def swept_columns(
    function: Callable[..., Mapping[str, Any]],
    points: Points,
    kept: Path | None = None,
    progress: Progress | None = None,
    workers: int | None = None,
    chunk_seconds: float = 1.0,
) -> dict[str, NDArray[Any]]:
    """(N, ...) columns of the numbers that `function` gives at all points, by name; processes compute them where that pays.

    With `kept`, the points are in the file of this name and ``.partial`` as they are done, and a sweep that was stopped goes on
    from there; it stays until the caller removes it. Points of another study in it are dropped. Raises StudyError where the
    function raises an error at a point.
    """
    work = sweep_work(function, points, ())
    study = study_text(work, "")
    with open_journal(kept, study, kept is not None and _is_of_another(journal_path(kept), study)) as journal:
        compute_missing(work, journal, Places(work, "auto", None, workers), progress, chunk_seconds)
        found = journal.rows(0, points.count)
    broken = np.flatnonzero(found.columns.pop("status") >= PointStatus.REFUSED)
    found.columns.pop("warned")
    if broken.size:
        values = {name: column[0] for name, column in points.columns(broken[0], broken[0] + 1).items()}
        raise StudyError(
            f"{', '.join(f'{name} {value}' for name, value in values.items())}: {found.reasons[broken[0]]}"
        )
    return found.columns


def _is_of_another(path: Path, study: str) -> bool:
    """Whether a journal is there and was begun for another study."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.readline() != study.encode() + b"\n"
