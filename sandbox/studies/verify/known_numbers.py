"""The numbers known from outside: what a row is, the list of all, and their check."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class KnownNumber:
    """A number that is known from outside.

    Attributes:
        name: what it is, with its unit.
        value: the number.
        source: where it is known from.
        find: what computes it by softcradle.
        allowed: largest difference: of the last digit given, or of the tolerance; relative to `value` unless that is 0.
    """

    name: str
    value: float
    source: str
    find: Callable[[], float]
    allowed: float


@dataclass(frozen=True)
class Checked:
    """A known number, what softcradle found, and the difference: relative, or absolute where the number is 0."""

    known: KnownNumber
    found: float
    error: float

    @property
    def agrees(self) -> bool:
        """Whether the difference is within what is allowed."""
        return self.error <= self.known.allowed


def check(known: KnownNumber) -> Checked:
    """Compute the number and compare."""
    found = known.find()
    return Checked(known, found, abs(found - known.value) / (abs(known.value) or 1.0))


def known_numbers() -> list[KnownNumber]:
    """Every row, in the order of the table."""
    from softcradle.sandbox.studies.verify import collision_rows, pulse_rows  # they are made of the class above

    return [
        *collision_rows.closed_form_rows(),
        *collision_rows.three_ball_rows(),
        *pulse_rows.rows(),
        *collision_rows.symmetry_rows(),
    ]


def verified(report: Callable[[Checked], None] = lambda _: None) -> list[Checked]:
    """Every row computed; `report` is called after each."""
    found = []
    for known in known_numbers():
        found.append(check(known))
        report(found[-1])
    return found
