"""Sentences: for each scan and method from which step or tolerance it fails, at which value first, and how."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path

from softcradle.sandbox.studies.stability.failure_scans import Spot


@dataclass(frozen=True)
class Verdict:
    """What a scan says of a method.

    Attributes:
        scan, method: which.
        runs, failed: their number, and how many are off by more than the trusted error.
        kinds: how those failed, the most frequent first, with counts.
        first: the finest run that fails, or None.
        unsafe: failed runs finer than `stable_step` says.
        silent: failed runs that no warning speaks of.
    """

    scan: str
    method: str
    runs: int
    failed: int
    kinds: tuple[tuple[str, int], ...]
    first: Spot | None
    unsafe: int
    silent: int


def verdicts(spots: Sequence[Spot]) -> list[Verdict]:
    """One for each scan and method, in order of appearance."""
    groups: dict[tuple[str, str], list[Spot]] = {}
    for spot in spots:
        groups.setdefault((spot.scan, spot.method), []).append(spot)
    return [_verdict(scan, method, some) for (scan, method), some in groups.items()]


def _verdict(scan: str, method: str, spots: Sequence[Spot]) -> Verdict:
    failed = [spot for spot in spots if spot.failure]
    return Verdict(
        scan, method, len(spots), len(failed), tuple(Counter(spot.failure for spot in failed).most_common()),
        min(failed, key=lambda spot: spot.fineness, default=None),
        sum(spot.fineness < spot.limit for spot in failed), sum(not spot.warned for spot in failed),
    )  # fmt: skip


def write_csv(spots: Sequence[Spot], path: Path) -> None:
    """A row a run, its failure last."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow((*(field.name for field in fields(Spot)), "failure"))
        writer.writerows((*astuple(spot), spot.failure) for spot in spots)
