"""What the paper states, measured: one function a statement, and a verdict that follows from its numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from importlib import import_module


class Verdict(StrEnum):
    """How a statement fares."""

    HOLDS = "holds"
    LIMIT = "holds with a limit"
    FAILS = "does not hold"


@dataclass(frozen=True)
class Claim:
    """A statement of the paper and what comes of it.

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


MODULES = (
    "collision_claims",
    "coupling_claims",
    "limit_claims",
    "hypothesis_claims",
    "variant_claims",
)  # in the order of the paper


def claims() -> list[Claim]:
    """All claims, measured now; some seconds."""
    return [measure() for module in MODULES for measure in _functions(module)]


def _functions(module: str) -> tuple[Callable[[], Claim], ...]:
    found: tuple[Callable[[], Claim], ...] = import_module(f"softcradle.sandbox.studies.claims.{module}").CLAIMS
    return found


def judged(holds: bool, with_limit: bool = False) -> Verdict:
    """The verdict of a statement that `holds` as it stands, or `with_limit` only."""
    return Verdict.HOLDS if holds else Verdict.LIMIT if with_limit else Verdict.FAILS
