"""All known numbers, checked."""

from __future__ import annotations

from collections.abc import Callable

from softcradle.sandbox.studies.verify import closed_form_rows, pulse_rows, symmetry_rows, three_ball_rows
from softcradle.sandbox.studies.verify.known_number import Checked, KnownNumber, check


def known_numbers() -> list[KnownNumber]:
    """Every row, in the order of the table."""
    return [*closed_form_rows.rows(), *three_ball_rows.rows(), *pulse_rows.rows(), *symmetry_rows.rows()]


def verified(report: Callable[[Checked], None] = lambda _: None) -> list[Checked]:
    """Every row computed; `report` is called after each."""
    found = []
    for known in known_numbers():
        found.append(check(known))
        report(found[-1])
    return found
