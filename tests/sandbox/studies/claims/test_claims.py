"""The claims: the command finds the verdicts of the documentation; cases are kept, sent to processes, and keep their reasons."""

import json
import re
from dataclasses import asdict, replace
from unittest.mock import patch

import numpy as np
import pytest
from softcradle.sandbox.cli.commands import claims
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies.claims import catalogue
from softcradle.sandbox.studies.claims.catalogue import CLAIMS, claim_named, measure_claims
from softcradle.sandbox.studies.claims.claim import Claim, JudgedClaim, Verdict
from softcradle.sandbox.studies.paper import NotSolvedError, chain_of, full_motion, start

from tests.helpers.paths import ROOT

KEPT = ROOT / "docs" / "measured" / "verdicts.md"
QUICK = ("contact-duration", "kicked-out", "phi-first", "changes-sign", "hooke-interface")  # of each module one
NAMES = [claim.name if claim.name in QUICK else pytest.param(claim.name, marks=pytest.mark.slow) for claim in CLAIMS]
VALUE = re.compile(r"(\S+) ± \S+")
BAR = re.compile(r"\.? by the bar: .*?(?=\. |$)")  # numbers of many digits


def rows(text: str) -> dict[str, list[str]]:
    """By the name of a claim: statement, verdict, what was found."""
    cells = [line.strip("| ").split(" | ") for line in text.splitlines()[2:]]
    return {name.strip("`"): rest for name, *rest in cells}


@pytest.mark.parametrize("name", NAMES)
def test_the_command_finds_the_verdict_of_the_documentation(name, tmp_path):
    """By two methods and, at the paper's own case, the independent reference; the numbers to a hundredth."""
    assert main(["claims", name, "--json", "--markdown", str(tmp_path / "table.md")]) == 0
    row, kept = rows((tmp_path / "table.md").read_text())[name], rows(KEPT.read_text())[name]
    assert [VALUE.sub("", BAR.sub("", cell)) for cell in row] == [VALUE.sub("", BAR.sub("", cell)) for cell in kept]
    values, expected = ([float(value) for value in VALUE.findall(cells[2])] for cells in (row, kept))
    assert values == pytest.approx(expected, rel=0.01, abs=1e-6)


def test_every_claim_is_in_the_documentation():
    assert list(rows(KEPT.read_text())) == [claim.name for claim in CLAIMS]


def test_the_motions_of_figures_pass_warnings_on():
    chain = chain_of({"n": 4.0, "1/alpha": 10.0})
    with pytest.warns(RuntimeWarning, match="step"):
        full_motion(chain, start(chain), step=0.4)


@pytest.fixture(scope="module")
def some() -> list[JudgedClaim]:
    return measure_claims(["contact-duration", "kicked-out"], workers=1)


def test_cases_of_a_sweep_are_those_of_the_study(some):
    for found in some:
        claim = claim_named(found.name)
        alone = claim.study_of([*map(claim.case, claim.cases)], claim.reference())
        assert found.seconds > 0.0
        np.testing.assert_equal(asdict(replace(found, seconds=0.0)), asdict(alone))


def test_a_case_that_is_not_solved_keeps_its_reason(monkeypatch):
    def unsolved(_, solver):
        raise NotSolvedError(f"{solver.method}: never")

    broken = replace(claim_named("kicked-out"), measure=unsolved)
    monkeypatch.setattr(catalogue, "CLAIMS", (broken,))
    (found,) = measure_claims(workers=1)
    assert {case.reason for case in found.cases} == {f"{broken.first.method}: never"}


def test_cases_that_are_measured_are_not_measured_again(some, tmp_path):
    def stop(_: str, done: int, __: int) -> None:
        measured.append(done)
        if done >= 2:
            raise KeyboardInterrupt

    measured: list[int] = []
    names, kept = ["kicked-out"], tmp_path / claims.KEPT
    with pytest.raises(KeyboardInterrupt):
        measure_claims(names, stop, 1, kept)
    with patch.object(Claim, "case", autospec=True, side_effect=Claim.case) as case:
        (found,) = measure_claims(names, None, 1, kept)
    assert 0 < case.call_count == len(found.cases) + claim_named("kicked-out").refer - measured[-1]
    assert replace(found, seconds=0.0) == replace(some[1], seconds=0.0)
    assert main(["claims", "kicked-out", "-o", str(tmp_path)]) == 0
    assert {path.suffix for path in tmp_path.iterdir()} == {".csv", ".pdf", ".png"}


def test_command_prints_a_table_and_json_and_lists(some, monkeypatch, softcradle):
    monkeypatch.setattr(catalogue, "measure_claims", lambda *_, **__: some)
    shown = " ".join(softcradle("claims").out.split())
    assert "fails beyond: 1" in shown
    assert f"processor time: {sum(study.seconds for study in some):.0f} s for 2 claims" in shown
    printed = json.loads(softcradle("claims", "--json").out)["claims"]
    assert [one["name"] for one in printed] == ["contact-duration", "kicked-out"]
    assert printed[0]["verdict"] == Verdict.BEYOND
    assert {"range", "how", "limit", "cases", "counter-example", "own case", "reference"} <= set(printed[0])
    assert "contact-duration" in softcradle("claims", "--list").out
