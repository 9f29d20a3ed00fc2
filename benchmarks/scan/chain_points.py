"""The scan as a sweep in which each point is a chain.

The numbers of a point are the verdict and, if it is new, the reference solution.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from softcradle.physics.status import WarningCode

from benchmarks.scan.extended_precision import Event
from benchmarks.scan.families import motion
from benchmarks.scan.truth import SOURCES, Path, Truth, truth_of, with_path
from benchmarks.scan.verdict import RunVerdict, judge
from softcradle import warm

Entry = dict[str, Any]
VERDICTS, CODES = list(RunVerdict), [code.value for code in WarningCode]
TRUTH = "truth "  # Prefix of the column names of a new reference solution.


def chain_numbers(
    truths: Mapping[str, Entry], method: str, tolerance: float, family: str, seed: int
) -> dict[str, object]:
    """Judge the simulation of one chain by its reference solution.

    If `truths` does not contain the reference solution, it is computed first.
    """
    compiled()
    chosen, new = motion(family, seed), {}
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        known = truths.get(chosen.key)
        truth = Truth.from_json(known) if known else truth_of(chosen)
        if known and "path" not in known:
            truth = with_path(chosen, truth)
        if not known or "path" not in known:
            new = {"velocity": truth.velocity, "doubt": truth.doubt, "source": SOURCES.index(truth.source)}
            new |= _path_numbers(truth.path)
        entry = judge(chosen, truth, method, tolerance)
    entry["verdict"], entry["truth"] = VERDICTS.index(entry["verdict"]), SOURCES.index(entry["truth"])
    entry["warnings"] = [CODES.index(code) for code in entry["warnings"]]
    return entry | {TRUTH + name: value for name, value in new.items()}


def _path_numbers(path: Path | None) -> dict[str, Any]:
    """Return the numbers of a path, or NaN if the path is not known."""
    if path is None:
        return {"position": np.full(1, np.nan), "path": np.full(2, np.nan), "events": np.full(4, np.nan)}
    events = np.array(path.events, dtype=np.float64).ravel()
    return {
        "position": path.position,
        "path": np.array((path.doubt, path.end)),
        "events": events if events.size else np.full(4, np.nan),
    }


@cache
def compiled() -> None:
    """Compile all kernels once in each process. The time of a chain then does not include compiling."""
    warm()


def entries(row: Mapping[str, Any], family: str, seed: int) -> tuple[Entry | None, Entry]:
    """Return the reference solution and the verdict of a chain from the numbers of its point.

    The reference solution is None if it was known before.
    """
    return _truth(row, family, seed), _verdict(row, family, seed)


def _truth(row: Mapping[str, Any], family: str, seed: int) -> Entry | None:
    if np.isnan(row.get(TRUTH + "source", np.nan)):
        return None
    chosen = motion(family, seed)
    beads = slice(0, chosen.chain.contacts + 1)
    velocity, doubt, source = (row[TRUTH + name] for name in ("velocity", "doubt", "source"))
    # A path of None means that the path was computed but could not be confirmed.
    entry = {"key": chosen.key, "path": None}
    return entry | Truth(velocity[beads], doubt[beads], SOURCES[int(source)], _path(row, beads)).as_json()


def _path(row: Mapping[str, Any], beads: slice) -> Path | None:
    doubt, end = row[TRUTH + "path"][:2]
    if np.isnan(end):
        return None
    events = row[TRUTH + "events"].reshape(-1, 4)
    known = [Event(int(i), bool(closes), time, speed) for i, closes, time, speed in events.tolist() if not np.isnan(i)]
    return Path(row[TRUTH + "position"][beads], float(doubt), float(end), tuple(known))


def _verdict(row: Mapping[str, Any], family: str, seed: int) -> Entry:
    entry = {name: value for name, value in row.items() if not name.startswith(TRUTH)}
    codes = [CODES[int(code)] for code in entry["warnings"] if not np.isnan(code)]
    told = {"verdict": VERDICTS[int(entry["verdict"])].value, "truth": SOURCES[int(entry["truth"])], "warnings": codes}
    numbers = {name: value.item() for name, value in entry.items() if name not in told}
    numbers |= {"slow": bool(numbers["slow"]), "path": bool(numbers["path"]), "steps": int(numbers["steps"])}
    return {"family": family, "seed": seed, **{name: (told | numbers)[name] for name in entry}}
