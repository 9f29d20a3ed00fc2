"""What a scan says of each method: how many runs fail and how, at which step or tolerance first, and how many silently."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from softcradle.sandbox.studies.stability.failure_scans import Failure, ScanRun


@dataclass(frozen=True)
class FailureSummary:
    """All runs of one scan by one method.

    Attributes:
        scan, method: which.
        runs: their number.
        failed: how many have a larger error than allowed.
        kinds: how those fail, with counts, the most frequent first.
        finest: the failed run of the smallest step or tolerance, or None.
        below_limit: number of failed runs with a smaller step than `stable_step` gives.
        silent: number of failed runs without a warning.
    """

    scan: str
    method: str
    runs: int
    failed: int
    kinds: tuple[tuple[Failure, int], ...]
    finest: ScanRun | None
    below_limit: int
    silent: int


def summarise_failures(runs: Sequence[ScanRun]) -> list[FailureSummary]:
    """One summary for each scan and method, in order of appearance."""
    groups: dict[tuple[str, str], list[ScanRun]] = {}
    for run in runs:
        groups.setdefault((run.scan, run.method), []).append(run)
    return [_summary(scan, method, group) for (scan, method), group in groups.items()]


def _summary(scan: str, method: str, runs: Sequence[ScanRun]) -> FailureSummary:
    failed = [run for run in runs if run.failure]
    return FailureSummary(
        scan=scan,
        method=method,
        runs=len(runs),
        failed=len(failed),
        kinds=tuple(Counter(run.failure for run in failed if run.failure).most_common()),
        finest=min(failed, key=lambda run: run.fineness, default=None),
        below_limit=sum(run.fineness < run.limit for run in failed),
        silent=sum(not run.warned for run in failed),
    )
