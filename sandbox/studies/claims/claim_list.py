"""The list of all claims, in the order of the paper, and their measurement on all cores."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from time import process_time

from softcradle.physics.chain_ensemble import cores
from softcradle.sandbox.studies.claims import (
    collision_claims,
    driven_claims,
    experiment_claims,
    hypothesis_claims,
    limit_claims,
    model_claims,
    variant_claims,
)
from softcradle.sandbox.studies.claims.claim import Claim
from softcradle.sandbox.studies.claims.study import Study

CLAIMS: tuple[Claim, ...] = (
    *collision_claims.CLAIMS,
    *model_claims.CLAIMS,
    *limit_claims.CLAIMS,
    *driven_claims.CLAIMS,
    *hypothesis_claims.CLAIMS,
    *variant_claims.CLAIMS,
    *experiment_claims.CLAIMS,
)

LONGEST = ("waves-diverge", "cradle-perturbed", "rigid-like", "second-mode")  # a tenth of all each: measured first,
# so that in the end no core waits long for another


def claim_named(name: str) -> Claim:
    """The claim of that name; KeyError where there is none."""
    return {claim.name: claim for claim in CLAIMS}[name]


def measure_claims(
    names: Sequence[str] = (), progress: Callable[[str], None] | None = None, workers: int | None = None
) -> list[Study]:
    """The studies of the claims of those names, all for none, in the order of the list; `progress` gets each name done."""
    wanted = [claim.name for claim in CLAIMS if not names or claim.name in names]
    found: dict[str, Study] = {}
    queue = sorted(wanted, key=lambda name: name not in LONGEST)
    with ProcessPoolExecutor(min(workers or cores(), len(wanted)) or 1) as pool:
        running = {pool.submit(study_of, name): name for name in queue}
        for done in as_completed(running):
            found[running[done]] = done.result()
            if progress is not None:
                progress(running[done])
    return [found[name] for name in wanted]


def study_of(name: str) -> Study:
    """The study of one claim, with the processor time that it took."""
    began = process_time()
    study = claim_named(name).study()
    return replace(study, seconds=process_time() - began)
