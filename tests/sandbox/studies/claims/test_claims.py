"""Tests of the verdicts on the claims of the paper.

The verdicts must agree with the documentation and must follow from the computed cases and their error bars. Known
numbers from other sources are also checked.
"""

import importlib
import json
import math
import re
from dataclasses import replace
from functools import partial
from unittest.mock import Mock, patch

import pytest
from softcradle.sandbox.cli.commands import claims
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies import verify
from softcradle.sandbox.studies.claims import catalogue
from softcradle.sandbox.studies.claims.catalogue import CLAIMS, claim_named, measure_claims
from softcradle.sandbox.studies.claims.claim import Case, CaseOutcome, Claim, JudgedClaim, Verdict, grid
from softcradle.sandbox.studies.claims.study_figure import as_json, draw_study, study_table
from softcradle.sandbox.studies.figures.catalogue import FIGURES
from softcradle.sandbox.studies.paper import MEASURING, NotSolvedError
from softcradle.sandbox.studies.plot_style import styled
from softcradle.sandbox.sweeps.run_sweep import map_points

from softcradle import scenes
from tests.helpers.figure_layout import texts_on_texts, unreadable
from tests.helpers.paths import ROOT

PAGE = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
KEPT = ROOT / "docs" / "measured" / "verdicts.md"
QUICK = ("contact-duration", "draft-gears", "kicked-out", "phi-first")
NAMES = [claim.name if claim.name in QUICK else pytest.param(claim.name, marks=pytest.mark.slow) for claim in CLAIMS]
VALUE = re.compile(r"(\S+) ± \S+")
# Pattern of the part of a verdict that contains numbers with many digits.
BAR = re.compile(r"\.? by the bar: .*?(?=\. |$)")


def rows(text: str) -> dict[str, list[str]]:
    cells = [line.strip("| ").split(" | ") for line in text.splitlines()[2:]]
    return {name.strip("`"): rest for name, *rest in cells}


@pytest.mark.usefixtures("one_core")
@pytest.mark.parametrize("name", NAMES)
def test_the_command_finds_the_verdict_of_the_documentation(name, tmp_path):
    """Check that the command prints the verdict of the documentation and that its numbers agree to 1 %.

    Each claim is computed by two methods. The case of the paper itself is also computed by an independent reference
    method.
    """
    assert main(["claims", name, "--json", "--markdown", str(tmp_path / "table.md")]) == 0
    row, kept = rows((tmp_path / "table.md").read_text())[name], rows(KEPT.read_text())[name]
    assert [VALUE.sub("", BAR.sub("", cell)) for cell in row] == [VALUE.sub("", BAR.sub("", cell)) for cell in kept]
    values, expected = ([float(value) for value in VALUE.findall(cells[2])] for cells in (row, kept))
    assert values == pytest.approx(expected, rel=0.01, abs=1e-6)


@pytest.fixture(scope="module")
def some() -> list[JudgedClaim]:
    return measure_claims(["contact-duration", "kicked-out"], workers=1)


def test_cases_that_are_measured_are_not_measured_again(some, tmp_path, monkeypatch):
    # Each case is stored at once, so the interruption leaves some cases, however fast the machine is.
    monkeypatch.setattr(catalogue, "map_points", partial(map_points, chunk_seconds=0.0))
    stop = Mock(side_effect=[None, KeyboardInterrupt])
    names, kept = ["kicked-out"], tmp_path / claims.KEPT
    with pytest.raises(KeyboardInterrupt):
        measure_claims(names, stop, 1, kept)
    with patch.object(Claim, "case", autospec=True, side_effect=Claim.case) as spied:
        (found,) = measure_claims(names, None, 1, kept)
    assert 0 < spied.call_count == len(found.cases) + claim_named("kicked-out").refer - stop.call_args.args[1]
    assert replace(found, seconds=0.0) == replace(some[1], seconds=0.0)
    assert main(["claims", "kicked-out", "-o", str(tmp_path)]) == 0
    assert {path.suffix for path in tmp_path.iterdir()} == {".csv", ".pdf", ".png"}


def test_command_prints_a_table_and_json_and_lists(some, monkeypatch, softcradle):
    monkeypatch.setattr(catalogue, "measure_claims", lambda *_, **__: some)
    shown = " ".join(softcradle("claims").out.split())
    assert "fails beyond: 1" in shown
    assert all(study.seconds > 0.0 for study in some)
    assert f"processor time: {sum(study.seconds for study in some):.0f} s for 2 claims" in shown
    printed = json.loads(softcradle("claims", "--json").out)["claims"]
    assert [one["name"] for one in printed] == ["contact-duration", "kicked-out"]
    assert printed[0]["verdict"] == Verdict.BEYOND
    assert {"range", "how", "limit", "cases", "counter-example", "own case", "reference"} <= set(printed[0])
    assert "contact-duration" in softcradle("claims", "--list").out


def case(x, value, error=0.0, allowed=1.0):
    return Case({"x": x}, x, value, error, allowed)


def study(*cases):
    return JudgedClaim("name", "statement", "Sec. I", "quantity", "x", "how", "", {"x": 2.0}, cases)


def test_error_bars_decide_cases():
    assert [case(1.0, *one).side for one in ((0.5, 0.4), (1.0, 0.0))] == [CaseOutcome.HOLDS] * 2
    assert case(1.0, 1.5, 0.4).side is CaseOutcome.FAILS
    undetermined = (0.5, 0.6), (1.5, 0.6), (math.nan, 0.0), (0.5, math.nan)
    assert [case(1.0, *one).side for one in undetermined] == [CaseOutcome.UNDETERMINED] * 4
    assert study(case(1.0, 2.0), case(2.0, 0.5), case(3.0, 2.0), case(9.0, 2.0)).counter_example == case(3.0, 2.0)
    assert study(case(2.0, 0.5)).counter_example is None


@pytest.mark.parametrize(
    ("values", "verdict", "text"),
    [
        ((0.1, 0.2, 0.3, 0.4), Verdict.HOLDS, "holds"),
        ((0.1, 0.2, 0.3, 1.4), Verdict.WITHIN, "holds within x <= 3"),
        ((1.1, 0.2, 0.3, 0.4), Verdict.WITHIN, "holds within x >= 2"),
        ((1.1, 0.2, 0.3, 1.4), Verdict.WITHIN, "holds within x >= 2 and <= 3"),
        ((1.1, 0.2, 1.3, 0.4), Verdict.WITHIN, "holds within 2 of 4 cases"),
        ((0.1, 1.2, 1.3, 1.4), Verdict.BEYOND, "fails beyond x = 1"),
        ((1.1, 1.2, 0.3, 1.4), Verdict.BEYOND, "fails beyond x = 1, the least tried; holds in 1 of 4"),
        ((1.1, 1.2, 1.3, 1.4), Verdict.BEYOND, "fails beyond x = 1, the least tried"),
        ((0.1, math.nan, 0.3, 0.4), Verdict.UNDETERMINED, "not determined"),
        ((0.1, 0.2, math.nan, 0.4), Verdict.HOLDS, "holds; 1 of 4 not determined"),
        ((0.1, 0.2, math.nan, 1.4), Verdict.WITHIN, "holds within x <= 2; 1 of 4 not determined"),
    ],
)
def test_a_verdict_and_its_limit_follow_from_the_cases(values, verdict, text):
    found = study(*(case(x, value) for x, value in enumerate(values, 1)))
    assert found.verdict is verdict
    assert found.verdict_text == text


def made_claim(measure, **options):
    return Claim(
        name="name", statement="statement", place="Sec. I", quantity="quantity", measure=measure, cases=grid(x=(1, 2, 3)),
        own={"x": 2.0}, variable="x", order=lambda case: case["x"], allowed=2.5, how="how", **options,
    )  # fmt: skip


def test_the_error_bar_covers_methods_and_reference(monkeypatch):
    errors = {MEASURING.method: 0.0, "conserving": 0.1, "scipy": 0.3}
    claim = made_claim(lambda case, solver: case["x"] + errors[solver.method])
    monkeypatch.setattr(catalogue, "CLAIMS", (claim,))
    (found,) = measure_claims(workers=1)
    assert [one.error for one in found.cases] == pytest.approx([0.1, 0.3, 0.1])
    assert found.reference == pytest.approx(2.3)
    assert [one.side for one in found.cases] == [CaseOutcome.HOLDS, CaseOutcome.HOLDS, CaseOutcome.FAILS]


def test_an_unsolved_case_is_not_determined(monkeypatch):
    def measure(parameters, solver):
        if parameters["x"] == 2.0:
            raise NotSolvedError("too many steps")
        return parameters["x"]

    monkeypatch.setattr(catalogue, "CLAIMS", (made_claim(measure, refer=False),))
    (found,) = measure_claims(workers=1)
    assert found.verdict is Verdict.UNDETERMINED
    assert [one.reason for one in found.cases] == ["", "too many steps", ""]
    written = as_json(found)
    assert written["own case"]["value"] is None
    assert written["counter-example"]["parameters"] == {"x": 3.0}


def test_the_picture_shows_every_case_that_has_a_value():
    found = study(case(1.0, 0.5), case(2.0, 0.5), case(30.0, 200.0), case(40.0, math.nan))
    with styled():
        axes = draw_study(found).axes[0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    assert "holds within x <= 2" in axes.get_title(loc="left")
    assert study_table(found)["holds"].tolist() == [1.0, 1.0, -1.0, 0.0]


@pytest.mark.parametrize("span", [5.0, 12.0, 35.0, 90.0, 300.0, 1e6])
def test_the_labels_of_every_logarithmic_axis_are_apart(span):
    found = study(*(case(0.025 * span**share, 0.004 * span**share) for share in (0.0, 0.3, 0.7, 1.0)))
    with styled():
        picture = draw_study(found)
        assert texts_on_texts(picture) == []
        (axes,) = picture.axes
        assert sum(bool(label.get_text()) for label in axes.get_xticklabels()) >= 3


@pytest.mark.slow
@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: claim.name)
def test_the_words_of_every_claim_have_room_in_its_picture(claim):
    cases = [case(1.0, 0.5, 0.1), case(2.0, 0.5, 0.1), case(30.0, 200.0, 10.0), case(40.0, 0.9, 0.5)]
    words = {name: getattr(claim, name) for name in ("name", "statement", "quantity", "variable")}
    with styled():
        assert unreadable(draw_study(replace(study(*cases), **words))) == []


def verdicts(bars, *values):
    found = [study(*(case(x, *value, allowed=bar) for x, value in enumerate(values, 1))) for bar in bars]
    return found[0].bar_text, [one.verdict for one in found]


def test_a_verdict_says_how_it_moves_with_the_bar():
    """Check that the text of a verdict is right for each acceptance limit that it names.

    A claim holds if no case fails and the case of the paper is determined.
    """
    text, found = verdicts((0.54, 0.6, 0.66, 1.4, 1.6), (0.4,), (0.6, 0.05), (2.0, 0.5))
    assert text == "by the bar: fails beyond below 0.55, holds within from 0.65, holds from 1.5"
    assert found == [Verdict.BEYOND, Verdict.UNDETERMINED, Verdict.WITHIN, Verdict.WITHIN, Verdict.HOLDS]
    text, found = verdicts((0.79, 1.0, 1.21), (0.1,), (1.0, 0.2))
    assert text == "by the bar: fails beyond below 0.8, holds from 1.2"
    assert found == [Verdict.BEYOND, Verdict.UNDETERMINED, Verdict.HOLDS]
    text, found = verdicts((0.65, 0.5, 0.6), (0.49,), (0.3,), (0.7, 0.08), (math.nan,))
    assert text == "by the bar: fails beyond below 0.3, holds within from 0.3, holds from 0.62"
    assert found == [Verdict.HOLDS, Verdict.WITHIN, Verdict.WITHIN]
    chosen = study(case(1.0, 0.5), case(2.0, 0.5))
    assert chosen.bar_text != replace(chosen, chosen=False).bar_text == ""


def test_every_number_is_met(capsys):
    assert main(["verify", "--json"]) == 0, capsys.readouterr().out
    rows = json.loads(capsys.readouterr().out)["numbers"]
    assert len({row["name"] for row in rows}) == len(rows) == len(verify.known_numbers())
    assert all(row["met"] and row["source"] for row in rows)


def test_a_number_that_is_missed_is_said(softcradle, monkeypatch):
    wrong = verify.KnownNumber("two", 2.0, "counting", lambda: 2.1, 0.01)
    monkeypatch.setattr(verify, "known_numbers", lambda: [wrong])
    shown = softcradle("verify", code=1).out
    assert "missed" in shown
    assert "1e-02" in shown  # The acceptance bound is printed in every row of the table.
    row = json.loads(softcradle("verify", "--json", code=1).out)["numbers"][0]
    assert row["allowed"] == 0.01
    assert row["met"] is False
    assert row["error"] == pytest.approx(0.05)


def named(kind: str) -> set[str]:
    """Return the names in backticks that follow the word `kind` or its plural in the documentation."""
    lists = re.findall(rf"\b{kind}s? ((?:`[^`]+`(?:, | and | to )?)+)", PAGE)
    return {name for text in lists for name in re.findall(r"`([^`]+)`", text)}


def test_names_in_the_documentation_exist():
    assert list(rows(KEPT.read_text())) == [claim.name for claim in CLAIMS]
    assert named("claim") == {claim.name for claim in CLAIMS}  # The documentation names all claims.
    assert named("figure") == {figure.name for figure in FIGURES}
    assert named("scene") <= set(scenes.names())
    for path in re.findall(r"`([a-z]+/[\w/]+\.py)`", PAGE):
        # Only test modules are named by their path. Other modules are named as in an import.
        assert path.startswith("tests/")
        assert (ROOT / path).is_file(), path
    for module in re.findall(r"`(softcradle\.[\w.]+)`", PAGE):
        importlib.import_module(module)
