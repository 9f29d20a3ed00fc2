"""Mutants that no test can tell from the source, and why."""

from __future__ import annotations

from typing import NamedTuple

from benchmarks.mutants.operators import Mutant


class Equivalent(NamedTuple):
    """Mutants of `source` whose changed text holds `before` and becomes `after` (anything where empty), and the reason."""

    source: str
    before: str
    after: str
    reason: str


EQUIVALENT: tuple[Equivalent, ...] = ()


def reason_of(source: str, mutant: Mutant) -> str:
    """Why `mutant` changes nothing that can be seen; empty where it is not known to be so."""
    before, after = " ".join(mutant.before.split()), " ".join(mutant.after.split())
    found = (one for one in EQUIVALENT if one.source == source and one.before == before and one.after in ("", after))
    return next((one.reason for one in found), "")
