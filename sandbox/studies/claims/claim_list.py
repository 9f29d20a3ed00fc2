"""The list of all claims, in the order of the paper."""

from __future__ import annotations

from collections.abc import Callable

from softcradle.sandbox.studies.claims import (
    collision_claims,
    coupling_claims,
    hypothesis_claims,
    limit_claims,
    variant_claims,
)
from softcradle.sandbox.studies.claims.claim import Claim

MEASUREMENTS: tuple[Callable[[], Claim], ...] = (
    *collision_claims.MEASUREMENTS,
    *coupling_claims.MEASUREMENTS,
    *limit_claims.MEASUREMENTS,
    *hypothesis_claims.MEASUREMENTS,
    *variant_claims.MEASUREMENTS,
)


def measure_claims() -> list[Claim]:
    """All claims, measured now, which takes some seconds."""
    return [measure() for measure in MEASUREMENTS]
