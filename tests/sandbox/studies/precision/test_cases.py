"""The cases of the chart: their chains, and that their truths are true."""

from __future__ import annotations

import numpy as np
import pytest
from softcradle.physics import one_on, power_law, simulate
from softcradle.physics.analysis.critical_speed import critical_speed
from softcradle.sandbox.studies.precision.cases import CASE_DEFINITIONS, TRUTH_TOLERANCE, CaseDefinition, definitions_of
from softcradle.scenes import load

from tests.helpers.truth import ELASTIC


def test_chains_have_unit_masses():
    for definition in CASE_DEFINITIONS:
        assert set(definition.make_chain().mass) == {1.0}


@pytest.mark.parametrize(("name", "speed"), [("gear-below", 0.8), ("gear-above", 3.0)])
def test_draft_gears_meet_below_and_above_their_critical_speed(definitions, name, speed):
    chain = definitions[name].make_chain()
    assert critical_speed(chain.contact[0], chain.mass, 1) == pytest.approx(1.0 / speed, rel=1e-14)


def test_errors_are_distances_from_the_truth(case):
    assert case.uncertainty == 0.0
    assert case.error(case.truth) == 0.0
    assert case.error(case.truth + np.array([0, 0, 1e-3, 0, 0])) == pytest.approx(1e-3)
    assert case.error(np.full(5, np.nan)) == np.inf


def test_known_digits_are_those_in_quadruple_precision(case):
    truth = next(truth for truth in ELASTIC if truth.name == "one on 4, alpha 1/10")
    assert (case.truth == truth.final).all()


def test_without_the_reference_two_ways_to_the_truth_agree(definitions):
    solved = definitions["one-on-10"].solve(by_reference=False)
    assert 0.0 < solved.uncertainty < 1e-10
    assert f"radau at {TRUTH_TOLERANCE:g}" in solved.source


@pytest.mark.slow
@pytest.mark.parametrize("name", ["one-on-10", "hertz-100", "gear-above"])
def test_every_truth_is_from_outside(definitions, name):
    """Half a minute of the reference each, the gears a second; two of our own methods are as near as they say."""
    solved, ours = definitions[name].solve(), definitions[name].solve(by_reference=False)
    assert 0.0 < solved.uncertainty < 1e-10
    assert "reference in extended precision" in solved.source
    assert solved.error(ours.truth) < 3.0 * (ours.uncertainty + solved.uncertainty)


def test_the_truth_is_that_of_the_reference(definitions):
    solved = definitions["one-on-5"].solve()
    assert 0.0 < solved.uncertainty < 1e-11
    assert "reference in extended precision" in solved.source
    found = simulate(solved.chain, solved.velocity, method="radau", tolerance=TRUTH_TOLERANCE)
    assert solved.error(found.final_velocity) < 1e-10


@pytest.mark.parametrize("name", ["gear-below", "step-force"])
def test_closed_forms_are_what_radau_finds(definitions, name):
    solved = definitions[name].solve()
    found = simulate(solved.chain, solved.velocity, method="radau", tolerance=1e-11)
    assert solved.error(found.final_velocity) < 1e-9
    assert "exact" in solved.source


def test_an_earlier_start_ends_the_same(case):
    starts = case.starts([0.0, 0.01, 0.3])
    assert [start.early for start in starts] == [0.0, 0.01, 0.3]
    for start in starts:
        found = simulate(start.chain, start.velocity, method="accurate", tolerance=1e-10)
        assert case.error(found.final_velocity) < 1e-9
        assert found.contact_intervals[0][0][0] == pytest.approx(start.early, abs=1e-12)


def test_a_case_that_cannot_begin_earlier_has_one_start():
    parting = CaseDefinition(
        "parting", "parting", lambda: one_on(2, power_law(1.0, 0.1)), velocity=np.array([1.0, 0.0, 0.1])
    )
    assert len(parting.solve().starts([0.1, 0.2])) == 1


def test_a_scene_is_one_case_for_each_lane():
    scene = load("one-on-four")
    (definition,) = definitions_of(scene)
    assert definition.label == scene.title
    assert definition.make_chain() == scene.lanes[0].chain()
    two = definitions_of(load("galilean"))
    assert len(two) == len(load("galilean").lanes)
