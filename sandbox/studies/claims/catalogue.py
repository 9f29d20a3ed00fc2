"""List of all claims in the order of the paper. The claims are measured as a sweep over all their cases."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import process_time
from typing import Any

from softcradle.sandbox.studies.claims import collision, driven, experiment, hypothesis, limit, model, variant
from softcradle.sandbox.studies.claims.claim import Claim, JudgedClaim
from softcradle.sandbox.sweeps import listed
from softcradle.sandbox.sweeps.run_sweep import Progress, map_points
from softcradle.sandbox.sweeps.work import Outcome

CLAIMS: tuple[Claim, ...] = (
    *collision.CLAIMS,
    *model.CLAIMS,
    *limit.CLAIMS,
    *driven.CLAIMS,
    *hypothesis.CLAIMS,
    *variant.CLAIMS,
    *experiment.CLAIMS,
)

# Claims that each take a tenth of the total computing time. They are measured first.
LONGEST = ("waves-diverge", "cradle-perturbed", "rigid-like", "second-mode")
# Case number of the measurement by the independent reference. This measurement takes long and is therefore measured
# first.
REFERENCE_CASE = -1


def claim_named(name: str) -> Claim:
    """Return the claim called `name`; raise KeyError if it does not exist."""
    return {claim.name: claim for claim in CLAIMS}[name]


def measure_claims(
    names: Sequence[str] = (), progress: Progress | None = None, workers: int | None = None, kept: Path | None = None
) -> list[JudgedClaim]:
    """Measure the claims called `names`, or all claims if `names` is empty. The result has the order of the list.

    Each point of the sweep is one case of a claim. Cases that an earlier sweep has stored in `kept` are not measured
    again; see `map_points`.
    """
    wanted = [claim for claim in CLAIMS if not names or claim.name in names]
    rows = [
        (claim.name, case)
        for claim in sorted(wanted, key=lambda claim: claim.name not in LONGEST)
        for case in range(-claim.refer, len(claim.cases))
    ]
    points = listed(dict(zip(("claim", "case"), zip(*rows, strict=True), strict=True)))
    found = map_points(measured_case, points, kept, progress, workers, alike=False)
    return [_study(claim, [found[k] for k, row in enumerate(rows) if row[0] == claim.name]) for claim in wanted]


def measured_case(claim: str, case: int) -> Outcome:
    """Measure one case of a claim, and record the processor time [s] of the measurement."""
    measured, began = claim_named(claim), process_time()
    if case == REFERENCE_CASE:
        return Outcome({"value": measured.reference(), "seconds": process_time() - began})
    found = measured.case(measured.cases[case])
    return Outcome({"value": found.value, "error": found.error, "seconds": process_time() - began}, reason=found.reason)


def _study(claim: Claim, found: Sequence[Mapping[str, Any]]) -> JudgedClaim:
    """Build the study of a claim from the points of all its cases."""
    reference, rows = (float(found[0]["value"]), found[1:]) if claim.refer else (math.nan, found)
    cases = [
        claim.measured(each, float(row["value"]), float(row["error"]), row.get("reason", ""))
        for each, row in zip(claim.cases, rows, strict=True)
    ]
    return claim.study_of(cases, reference, sum(float(row["seconds"]) for row in found))
