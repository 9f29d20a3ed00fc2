"""The claims: verdicts are reproduced by other methods on a sample, and what was generalised from one example is not."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from softcradle.physics.analysis.ringing import turning_points
from softcradle.sandbox.cli.commands import claims
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies.claims import claim_list
from softcradle.sandbox.studies.claims.claim import Case, CaseOutcome, Claim, JudgedClaim, Verdict
from softcradle.sandbox.studies.claims.claim_list import CLAIMS, claim_named, measure_claims
from softcradle.sandbox.studies.claims.driven import driven_returns
from softcradle.sandbox.studies.claims.variant import misplaced
from softcradle.sandbox.studies.paper import (
    FINER_SECOND,
    MEASURING,
    REFERENCE,
    SECOND,
    MethodFineness,
    NotSolvedError,
    chain_of,
    full_motion,
    start,
    while_struck,
)

NAMES = [claim.name for claim in CLAIMS]
FINE = MethodFineness("conserving", 3e-5)

# Verdicts at the parameters of the paper's own case: of (claim, parameters), from either side.
SAMPLE = {
    ("rigid-like", (4, 10)): CaseOutcome.HOLDS,
    ("rigid-like", (3, 10.25)): CaseOutcome.FAILS,
    ("first-target", (4, 10)): CaseOutcome.HOLDS,
    ("first-target", (8, 10)): CaseOutcome.FAILS,
    ("phi-first", (4, 10)): CaseOutcome.HOLDS,
    ("phi-first", (3, 10)): CaseOutcome.FAILS,
    ("no-oscillation", (4, 10)): CaseOutcome.HOLDS,
    ("no-oscillation", (2, 14)): CaseOutcome.FAILS,
    ("below-1/n", (4, 10)): CaseOutcome.FAILS,
    ("below-1/n", (4, 16)): CaseOutcome.HOLDS,
    ("contact-duration", (4, 10)): CaseOutcome.FAILS,
    ("amplitude", (4, 57)): CaseOutcome.FAILS,
    ("time-scales", (4, 10)): CaseOutcome.HOLDS,
    ("changes-sign", (4, 10)): CaseOutcome.HOLDS,
    ("changes-sign", (3, 10)): CaseOutcome.FAILS,
}
MINUTES = {"no-oscillation", "amplitude"}  # claims whose samples take the reference a minute each


def at(claim: Claim, n: float, inverse: float, solver: MethodFineness) -> float:
    return claim.measure({"n": float(n), "1/alpha": float(inverse)}, solver)


@pytest.mark.parametrize(("name", "place"), SAMPLE)
def test_sides_are_those_of_conserving_at_fine_steps(name, place):
    claim = claim_named(name)
    for solver in (claim.first, FINE):
        value = at(claim, *place, solver)
        assert (value <= claim.allowed) is (SAMPLE[name, place] is CaseOutcome.HOLDS), (solver.method, value)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "place"), [key for key in SAMPLE if key[0] not in MINUTES])
def test_sides_are_those_of_the_independent_reference(name, place):
    claim = claim_named(name)
    assert (at(claim, *place, REFERENCE) <= claim.allowed) is (SAMPLE[name, place] is CaseOutcome.HOLDS)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_papers_own_case_and_the_counter_example_at_half_the_step(name):
    claim = claim_named(name)
    found = claim.study()
    half = MethodFineness("conserving", claim.second.step and 0.5 * claim.second.step)
    for case in {found.own_case.variable: found.own_case, **_counter(found)}.values():
        if case.side is not CaseOutcome.UNDETERMINED:
            value, reason = claim.value(case.parameters, half)
            assert not reason
            assert (value <= case.allowed) is (case.side is CaseOutcome.HOLDS)


def _counter(found: JudgedClaim) -> dict[float, object]:
    counter = found.counter_example
    return {} if counter is None else {counter.variable: counter}


def test_the_counter_example_of_random_chains_is_that_of_the_nearest_load():
    for name in ("robust", "inhomogeneous-model"):
        claim = claim_named(name)
        cases = [Case(case, claim.order(case), float(case["load"] > 0.9), 0.0, 0.5) for case in claim.cases]
        found = JudgedClaim(name, "", "", "", claim.variable, "", "", claim.own, tuple(cases))
        assert found.own_case.parameters["seed"] == 0.0
        assert found.counter_example.variable == min(case.variable for case in cases if case.variable > 0.9)


def test_the_driven_mode_is_read_at_its_own_returns():
    """Five periods of the model end before the fifth return: there psi is 2.4 % of its amplitude, at the return nothing."""
    for solver in (MEASURING, FINE):
        times, least, largest = driven_returns({"n": 4.0, "1/alpha": 10.0}, solver)
        assert times[-1] / 5.0 == pytest.approx(4.4184, abs=2e-4)
        assert max(abs(psi) for psi in least) < 2e-12 * largest
    assert times[-1] == pytest.approx(22.0922184, abs=1e-5)


@pytest.mark.parametrize(
    ("name", "n", "inverse"), [("after-detachment", 3, 10), ("after-detachment", 2, 12), ("no-oscillation", 2, 30)]
)
def test_round_off_is_not_counted(name, n, inverse):
    """They had 2684, 2021 and 25 turns by one method, and none or 683 by another."""
    claim = claim_named(name)
    assert at(claim, n, inverse, claim.first) == at(claim, n, inverse, FINER_SECOND) <= 1.0


def test_slopes_are_those_of_the_full_motion_of_all_contacts():
    """Deeper contacts have the powers that follow, at the tolerance of the claims and at that of measures alike."""
    claims = claim_named("slopes"), claim_named("deeper-slopes")
    assert {case["contact"] for claim in claims for case in claim.cases} == {0.0, 1.0, 2.0, 3.0}
    for contact, claim in zip((0, 1, 2, 3), (*claims[:1] * 2, *claims[1:] * 2), strict=True):
        case = {"n": 4.0, "1/alpha": 10.0, "contact": float(contact), "t": 1e-13}
        assert claim.case(case).side is CaseOutcome.HOLDS
        assert claim.measure(case, MEASURING) < 0.05


@pytest.mark.slow
def test_wave_speeds_are_measured_and_their_divergence_can_fail():
    """They diverge for alpha < 1 alone: those of springs do not move, those of Hertz beads vanish."""
    claim = claim_named("waves-diverge")
    soft, spring, hertz = (claim.case({"prestress": 1.0, "1/alpha": k}) for k in (3.0, 1.0, 2.0 / 3.0))
    assert [case.side for case in (soft, spring, hertz)] == [CaseOutcome.HOLDS, CaseOutcome.FAILS, CaseOutcome.FAILS]
    for case, slope in ((soft, -1.0), (spring, 0.0), (hertz, 1.0 / 6.0)):
        assert case.value == pytest.approx(slope * math.log(1.0 / 0.9), abs=1e-4)
        assert 0.0 < case.error < 1e-4  # another method, at other crests: no identity


def test_springs_need_to_pull_for_an_echo_and_time_to_share():
    echo = claim_named("free-end").measure
    found = [echo({"beads": 20.0, "pull": pull}, MethodFineness("conserving", 2e-3)) for pull in (0.0, 0.1, 1.0)]
    assert found[0] == 0.0
    assert found[1] < 0.05
    assert found[2] > 0.5
    vibration = claim_named("stiff-springs").measure
    for k in (100.0, 400.0, 1600.0, 6400.0, 25600.0):  # as the inverse frequency, up and down with its phase
        assert 0.25 < vibration({"n": 4.0, "k": k}, SECOND) * math.sqrt(k) < 1.5


def test_what_disorder_misplaces_is_less_in_soft_chains():
    measure = claim_named("in-contrast").measure
    assert measure({"width": 2.0, "1/alpha": 10.0}, MEASURING) < 0.1
    assert misplaced(2.0, 1.5, MEASURING) > 3.0 * misplaced(1.0, 1.5, MEASURING)


def test_a_hooke_interface_needs_an_inner_force_below_f0():
    measure = claim_named("hooke-interface").measure
    found = [measure({"n": 4.0, "1/alpha": 10.0, "V": 1.0, "k": k}, MEASURING) for k in (0.5, 1.0, 1.5, 3.0, 10.0)]
    assert found[0] < 2e-3  # 0.0008 at a tolerance of 1e-11, and less at looser ones
    assert found[1:] == pytest.approx([0.028, 0.99, 2.0, 2.2], rel=0.05)
    slow = measure({"n": 4.0, "1/alpha": 10.0, "V": 0.5, "k": 3.0}, MEASURING)
    assert slow < 0.1  # it depends on the speed


def test_f12_is_not_within_a_thousandth_over_all_of_its_time():
    measure = claim_named("within-1e-3").measure
    late = measure({"n": 4.0, "1/alpha": 10.0, "contact": 1.0, "until": 0.995}, MEASURING)
    assert late > 0.02


def test_the_forces_deeper_inside_are_off_by_percents_early_and_late():
    """At a hundredth of its time f34 is off by 2.4 %, at the last hundredth by 19 %; in the middle by a thousandth."""
    measure = claim_named("inner-forces").measure
    found = [measure({"n": 4.0, "1/alpha": 10.0, "contact": 3.0, "until": u}, MEASURING) for u in (0.01, 0.5, 0.99)]
    assert found == pytest.approx([0.0241, 0.0015, 0.186], rel=0.02)


def test_the_amplitude_has_a_prefactor_and_at_a_fixed_size_another_rate_than_stated():
    """n/(2(n+1)) is within 1 % at 1/alpha = 200; the rate is n ln(n/(n-1)), which tends to 1 for large n alone."""
    law, rate = claim_named("amplitude-law"), claim_named("amplitude")
    assert law.measure({"n": 4.0, "1/alpha": 200.0}, MEASURING) == pytest.approx(0.0096, rel=0.02)
    for n, inverse in ((2, 20), (4, 57), (10, 100)):
        off = rate.measure({"n": float(n), "1/alpha": float(inverse)}, MEASURING)
        assert off == pytest.approx(n * math.log(n / (n - 1)) - 1.0, abs=0.01)


def test_random_chains_near_the_greatest_load_are_not_rigid_like():
    """The load at which they are lost lies below 1, and no threshold set by hand hides it: all above 0.9 spread."""
    claim = claim_named("robust")
    spreads = {case["load"]: claim.measure(case, claim.first) for case in claim.cases if 0.8 < case["load"] < 1.0}
    assert {load < 0.9 for load in spreads} == {True, False}
    for load, found in spreads.items():
        assert (found <= claim.allowed) is (load < 0.9)
    assert max(found for load, found in spreads.items() if load < 0.97) > 0.4


def test_the_motions_of_figures_pass_warnings_on():
    chain = chain_of({"n": 4.0, "1/alpha": 10.0})
    with pytest.warns(RuntimeWarning, match="step"):
        full_motion(chain, start(chain), step=0.4)


def test_inner_forces_ring_more_often_at_smaller_exponents():
    found = [while_struck({"n": 2.0, "1/alpha": k}, FINER_SECOND, 20001).force[:, 1] for k in (10.0, 14.0, 20.0)]
    assert [turning_points(force).size for force in found] == [1, 3, 7]
    claim = claim_named("no-oscillation")  # counts what may be seen
    assert [at(claim, 2, k, MEASURING) for k in (10, 14, 22)] == [1.0, 3.0, 1.0]
    assert while_struck({"n": 2.0, "1/alpha": 20.0}, MEASURING, 101).force[:, 1].max() < 1.0


@pytest.fixture(scope="module")
def some() -> list[JudgedClaim]:
    return measure_claims(["contact-duration", "kicked-out"], workers=1)


def test_cases_of_a_sweep_are_those_of_the_study(some):
    for found in some:
        alone = claim_named(found.name).study()
        assert found.seconds > 0.0
        assert replace(found, seconds=0.0, reference=0.0) == replace(alone, reference=0.0)
        assert np.array_equal([found.reference], [alone.reference], equal_nan=True)


def test_a_case_that_is_not_solved_keeps_its_reason(monkeypatch):
    def unsolved(_, solver):
        raise NotSolvedError(f"{solver.method}: never")

    broken = replace(claim_named("kicked-out"), measure=unsolved)
    monkeypatch.setattr(claim_list, "CLAIMS", (broken,))
    (found,) = measure_claims(workers=1)
    assert {case.reason for case in found.cases} == {f"{broken.first.method}: never"}
    assert found.verdict is Verdict.UNDETERMINED


def test_cases_that_are_measured_are_not_measured_again(some, monkeypatch, tmp_path, capsys):
    def stop(_: str, done: int, __: int) -> None:
        measured.append(done)
        if done >= 2:
            raise KeyboardInterrupt

    measured: list[int] = []
    names, kept = ["kicked-out"], tmp_path / claims.KEPT
    with pytest.raises(KeyboardInterrupt):
        measure_claims(names, stop, 1, kept)
    again: list[float] = []
    case_of = Claim.case
    monkeypatch.setattr(Claim, "case", lambda claim, each: again.append(each["n"]) or case_of(claim, each))
    (found,) = measure_claims(names, None, 1, kept)
    assert 0 < len(again) == len(found.cases) + claim_named("kicked-out").refer - measured[-1]
    assert replace(found, seconds=0.0) == replace(some[1], seconds=0.0)
    assert main(["claims", "kicked-out", "-o", str(tmp_path)]) == 0
    assert sorted({path.suffix for path in tmp_path.iterdir()}) == [".csv", ".pdf", ".png"]


@pytest.mark.slow
def test_command_prints_a_table_json_one_claim_and_its_picture(some, monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(claim_list, "measure_claims", lambda *_, **__: some)
    assert main(["claims"]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "fails beyond: 1" in shown
    assert f"processor time: {sum(study.seconds for study in some):.0f} s for 2 claims" in shown
    assert main(["claims", "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)["claims"]
    assert [one["name"] for one in printed] == ["contact-duration", "kicked-out"]
    assert printed[0]["verdict"] == Verdict.BEYOND
    assert {"range", "how", "limit", "cases", "counter-example", "own case", "reference"} <= set(printed[0])
    assert main(["claims", "contact-duration", "-o", str(tmp_path)]) == 0
    assert "the striker's" not in capsys.readouterr().err
    assert {path.suffix for path in tmp_path.iterdir()} == {".png", ".pdf", ".csv"}


def test_command_lists_and_refuses_in_a_sentence(capsys):
    assert main(["claims", "--list"]) == 0
    assert "contact-duration" in capsys.readouterr().out
    assert main(["claims", "nonsense"]) == 2
    assert "there is no claim 'nonsense'; there are rigid-like" in capsys.readouterr().err
