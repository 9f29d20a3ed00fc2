"""A claim of the paper with what is measured of it, and the verdict on it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum


class Verdict(StrEnum):
    """Whether a statement holds."""

    HOLDS = "holds"
    LIMIT = "holds with a limit"
    FAILS = "does not hold"


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, and how it compares with the measurement.

    Attributes:
        name: short name, for tests and JSON.
        statement: what the paper says, in a sentence.
        place: where.
        measured: what we find, in a sentence with the numbers.
        how: how it was measured.
        verdict: what follows.
        numbers: the numbers themselves, by name.
    """

    name: str
    statement: str
    place: str
    measured: str
    how: str
    verdict: Verdict
    numbers: Mapping[str, float]


def verdict_of(holds: bool, with_limit: bool = False) -> Verdict:
    """The verdict on a statement that `holds` as it stands, or only `with_limit`."""
    return Verdict.HOLDS if holds else Verdict.LIMIT if with_limit else Verdict.FAILS
