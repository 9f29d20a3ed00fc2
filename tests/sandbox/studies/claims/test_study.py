"""Verdicts follow from cases and their error bars, and can come out each way."""

import math
from dataclasses import replace

import pytest
from softcradle.sandbox.studies.claims.catalogue import CLAIMS
from softcradle.sandbox.studies.claims.claim import Case, CaseOutcome, Claim, JudgedClaim, Verdict, grid
from softcradle.sandbox.studies.claims.study_figure import as_json, draw_study, study_table
from softcradle.sandbox.studies.paper import MEASURING, NotSolvedError
from softcradle.sandbox.studies.plot_style import styled

from tests.helpers.figure_layout import texts_on_texts, unreadable


def case(x, value, error=0.0, allowed=1.0):
    return Case({"x": x}, x, value, error, allowed)


def study(*cases, own=2.0):
    return JudgedClaim("name", "statement", "Sec. I", "quantity", "x", "how", "", {"x": own}, cases)


def test_a_case_is_decided_only_where_its_error_bar_does_not_cross():
    assert [case(1.0, *one).side for one in ((0.5, 0.4), (1.0, 0.0))] == [CaseOutcome.HOLDS] * 2
    assert case(1.0, 1.5, 0.4).side is CaseOutcome.FAILS
    undetermined = (0.5, 0.6), (1.5, 0.6), (math.nan, 0.0), (0.5, math.nan)
    assert [case(1.0, *one).side for one in undetermined] == [CaseOutcome.UNDETERMINED] * 4


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


def test_the_counter_example_is_the_failing_case_nearest_to_the_papers_own():
    assert study(case(1.0, 2.0), case(2.0, 0.5), case(3.0, 2.0), case(9.0, 2.0)).counter_example == case(3.0, 2.0)
    assert study(case(2.0, 0.5)).counter_example is None


def claim(measure, **options):
    return Claim(
        name="name", statement="statement", place="Sec. I", quantity="quantity", measure=measure, cases=grid(x=(1, 2, 3)),
        own={"x": 2.0}, variable="x", order=lambda case: case["x"], allowed=2.5, how="how", **options,
    )  # fmt: skip


def judged(claim):
    return claim.study_of([claim.case(parameters) for parameters in claim.cases], claim.reference())


def test_the_error_bar_is_the_difference_of_two_methods_and_the_reference_widens_it():
    errors = {MEASURING.method: 0.0, "conserving": 0.1, "scipy": 0.3}
    found = judged(claim(lambda case, solver: case["x"] + errors[solver.method]))
    assert [one.error for one in found.cases] == pytest.approx([0.1, 0.3, 0.1])
    assert found.reference == pytest.approx(2.3)
    assert [one.side for one in found.cases] == [CaseOutcome.HOLDS, CaseOutcome.HOLDS, CaseOutcome.FAILS]


def test_a_run_that_gave_up_is_not_determined():
    def measure(parameters, solver):
        if parameters["x"] == 2.0:
            raise NotSolvedError("too many steps")
        return parameters["x"]

    found = judged(claim(measure, refer=False))
    assert found.verdict is Verdict.UNDETERMINED
    assert found.own_case.reason == "too many steps"
    json = as_json(found)
    assert json["own case"]["value"] is None
    assert json["counter-example"]["parameters"] == {"x": 3.0}


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
    """With cases that are made up; as wide as a column."""
    cases = [case(1.0, 0.5, 0.1), case(2.0, 0.5, 0.1), case(30.0, 200.0, 10.0), case(40.0, 0.9, 0.5)]
    words = {name: getattr(claim, name) for name in ("name", "statement", "quantity", "variable")}
    with styled():
        assert unreadable(draw_study(replace(study(*cases), **words))) == []


def test_a_verdict_says_how_it_moves_with_the_bar():
    """At each bar that is named the study says so itself."""

    def at(allowed):
        return study(case(1.0, 0.4, 0.0, allowed), case(2.0, 0.6, 0.05, allowed), case(3.0, 2.0, 0.5, allowed))

    assert at(0.5).bar_text == "by the bar: fails beyond below 0.55, holds within from 0.65, holds from 1.5"
    verdicts = [Verdict.BEYOND, Verdict.UNDETERMINED, Verdict.WITHIN, Verdict.WITHIN, Verdict.HOLDS]
    assert [at(allowed).verdict for allowed in (0.54, 0.6, 0.66, 1.4, 1.6)] == verdicts
    assert replace(at(0.5), chosen=False).bar_text == ""
