"""Tests of the scans of random chains. The tests check which chains a scan draws, how the scan classifies runs, and how
an interrupted scan resumes. The reference solver is tested as well.
"""

import json
import math
from dataclasses import replace
from unittest.mock import DEFAULT, Mock

import numpy as np
import pytest
from softcradle.physics import Chain, draft_gear, hertz, hooke, one_on, power_law, simulate
from softcradle.physics.simulation import solve
from softcradle.physics.status import CodedWarning, Status, WarningCode

from benchmarks import __main__ as command
from benchmarks.conserving_scan import FAMILIES as CONSERVING
from benchmarks.conserving_scan import LARGE, error_report, errors, report, run
from benchmarks.json_lines import lines
from benchmarks.scan import chain_points, verdict
from benchmarks.scan import command as scan
from benchmarks.scan.collocation import EPSILON, Extended, tableau
from benchmarks.scan.extended_precision import Event, ReferenceGaveUpError, reference_end
from benchmarks.scan.families import FAMILIES, Motion, motion
from benchmarks.scan.truth import MOST_EVENTS, Path, Truth, truth_of, with_path
from tests.helpers.truth import ELASTIC, GEARS

pytestmark = pytest.mark.slow

PAPER = Motion("power", 0, one_on(4, power_law(1.0, 0.1)), (1.0, 0.0, 0.0, 0.0, 0.0))
VELOCITY = (-0.56758562476, 0.17392146673, 0.45407871484, 0.46978361268, 0.46980183052)
TRUTH = Truth(np.array(VELOCITY), np.full(5, 1e-10), "known")


def test_the_source_of_a_reference_solution():
    found = truth_of(PAPER)
    assert found.source == "reference"
    assert np.abs(found.velocity - VELOCITY).max() < 1e-10
    assert found.doubt.max() < 1e-10
    chosen = motion("own-laws", 1)
    found = truth_of(chosen)
    assert found.source == "scipy"
    assert found.doubt.max() < 1e-9
    ours = simulate(chosen.chain, chosen.velocity, chosen.duration, "conserving", 1e-4 * chosen.duration, samples=2)
    assert ours.final_velocity == pytest.approx(found.velocity, abs=1e-5)


def test_coarser_runs_replace_unfinished_fine_runs():
    # At the tolerance 1e-12, two runs of each method reach their end. At 1e-13, all runs stop early.
    chosen = motion("bounded", 7)
    found = truth_of(chosen)
    assert found.source == "spread of fine runs"
    assert found.doubt.max() < 1e-9
    other = simulate(chosen.chain, chosen.velocity, chosen.duration, "scipy", samples=2, tolerance=1e-9)
    assert other.final_velocity == pytest.approx(found.velocity, abs=1e-9)


def test_a_truth_is_found_again_where_last_digits_differ():
    chosen = motion("own-laws", 2)
    assert replace(chosen, duration=chosen.duration * (1.0 + 1e-14)).key == chosen.key
    assert replace(chosen, duration=chosen.duration * (1.0 + 1e-8)).key != chosen.key


def test_chains_that_a_method_refuses_are_left_out(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("benchmarks.scan.command.refusal_of", lambda _, chain: "no" if chain.couplers else "")
    given = ["scan", "--families", "couplers", "hooke-hertz", "--jobs", "1", "--folder", str(tmp_path), "--count", "1"]
    assert command.main(given) == 0
    assert "refuses 1 of the chains" in capsys.readouterr().out
    assert (tmp_path / "accurate-1e-08.jsonl").read_text().count("hooke-hertz") == 1


def judged(monkeypatch, error, truth=TRUTH, **changes):
    run = simulate(PAPER.chain, PAPER.velocity, samples=2, tolerance=1e-9)
    run = replace(run, final_velocity=TRUTH.velocity + error, **changes)
    monkeypatch.setattr(verdict, "solve", lambda *_, **__: run)
    return verdict.judge(PAPER, truth, "accurate", 1e-6)


def test_verdicts(monkeypatch):
    warned = (CodedWarning(WarningCode.SENSITIVE, "x"),)
    assert judged(monkeypatch, 9e-6)["verdict"] == "within"
    assert judged(monkeypatch, 1e-3, warnings=warned)["verdict"] == "reported"
    assert judged(monkeypatch, 1e-3, status=Status.OUT_OF_STEPS)["verdict"] == "gave up"
    for estimate, expected in ((np.nan, "undetected"), (1e-4, "undetected"), (2e-3, "reported")):
        assert judged(monkeypatch, 1e-3, velocity_error=np.full(5, estimate))["verdict"] == expected
    # A difference between coarse runs does not measure the error. A difference between fine runs shows that the
    # estimated error of the motion is too small.
    for source, expected in (("spread", "unknown"), ("spread of fine runs", "undetected")):
        truth = Truth(TRUTH.velocity, np.full(5, 1e-2), source)
        assert judged(monkeypatch, 1e-3, truth, velocity_error=np.full(5, 1e-7))["verdict"] == expected


@pytest.mark.parametrize(
    ("shift", "late", "doubt", "expected"),
    [
        (0.0, 0.0, 1e-10, "within"), (1e-6, 1e-6, 1e-10, "within"), (1e-3, 0.0, 1e-10, "undetected"),
        (0.0, 1e-3, 1e-10, "undetected"), (1e-3, 0.0, 1e-2, "unknown"),
    ],
)  # fmt: skip
def test_positions_and_contact_times_are_judged(monkeypatch, shift, late, doubt, expected):
    run = simulate(PAPER.chain, PAPER.velocity, samples=2, tolerance=1e-9)
    opens = Event(0, False, run.contact_intervals[0][0][1] + late, 0.5)
    truth = replace(TRUTH, path=Path(run.position[-1] + shift, doubt, float(run.time[-1]), (opens,)))
    assert judged(monkeypatch, 0.0, truth)["verdict"] == expected


def test_a_contact_that_does_not_open_in_the_run_is_an_error(monkeypatch):
    run = simulate(PAPER.chain, PAPER.velocity, samples=2, tolerance=1e-9)
    path = Path(run.position[-1], 1e-10, float(run.time[-1]), (Event(0, False, 1.0, 0.5),))
    closed = replace(run, contact_intervals=(((0.0, math.inf),),) * 4)
    monkeypatch.setattr(verdict, "solve", lambda *_, **__: closed)
    assert verdict.judge(PAPER, replace(TRUTH, path=path), "accurate", 1e-6)["verdict"] == "undetected"


def test_the_path_of_fine_runs_is_that_of_the_reference():
    for seed in (1, 2, 3):
        chosen = motion("bed-struck", seed)
        exact = truth_of(chosen)
        assert exact.source == "reference"
        fine = with_path(chosen, replace(exact, source="fine runs", path=None))
        assert fine.path.position == pytest.approx(exact.path.position, abs=1e-9)
        known = {(event.contact, event.closes, round(event.time, 7)) for event in fine.path.events}
        fast = [event for event in exact.path.events[:MOST_EVENTS] if event.speed > 0.01]
        assert fast
        assert {(event.contact, event.closes, round(event.time, 7)) for event in fast} <= known
        again = Truth.from_json(json.loads(json.dumps(exact.as_json())))
        assert again.path.events == exact.path.events


def test_positions_and_contact_times_of_the_reference_on_a_bed():
    """Compare two motions on a friction bed with closed forms. In the first motion a bead slides 0.1 m and hits another
    bead. In the second motion a single bead slides until it rests.
    """
    brake, far = 0.05 * 9.80665, Chain([2.0, 1.0], hertz(1.0), gap=0.1, friction=0.05)
    found = reference_end(far, [1.5, 0.0], 0.5, 1e-12)
    assert found.events[0].time == pytest.approx((1.5 - math.sqrt(1.5**2 - 0.2 * brake)) / brake, rel=1e-12)
    assert found.events[0].speed == pytest.approx(math.sqrt(1.5**2 - 0.2 * brake), rel=1e-12)
    assert found.events[0].closes
    alone = reference_end(replace(far, gap=(50.0,)), [1.5, 0.0], 5.0, 1e-12)
    assert alone.position.tolist() == pytest.approx([1.5**2 / (2.0 * brake), 50.0], abs=1e-11)
    assert alone.events == []


def test_an_interrupted_scan_continues(tmp_path, capsys, monkeypatch):
    given = ["scan", "--families", "hooke-hertz", "--jobs", "1", "--folder", str(tmp_path), "--count", "3", "--require"]
    monkeypatch.setattr("benchmarks.scan.truth.TOLERANCE", 1e-9)
    monkeypatch.setattr(scan, "KEPT", tmp_path / "kept.jsonl.gz")
    judge = Mock(wraps=chain_points.judge)
    judge.side_effect = [DEFAULT, KeyboardInterrupt]
    monkeypatch.setattr(chain_points, "judge", judge)
    with pytest.raises(KeyboardInterrupt):
        command.main(given)
    judge.side_effect = None
    assert command.main(given) == 0
    assert [call.args[0].seed for call in judge.call_args_list] == [0, 1, 1, 2]
    verdicts, truths = tmp_path / "accurate-1e-08.jsonl", (tmp_path / "truths.jsonl").read_text()
    kept = [json.loads(line) for line in verdicts.read_text().splitlines() if line]
    assert [(one["seed"], one["verdict"]) for one in kept] == [(0, "within"), (1, "within"), (2, "within")]
    with verdicts.open("a") as file:
        # An interrupted scan leaves an incomplete last line, which this line imitates.
        file.write('\n{"family": "cut o')
    assert command.main([*given, "--markdown", str(tmp_path / "scan.md")]) == 0
    assert judge.call_count == 4
    assert (tmp_path / "truths.jsonl").read_text() == truths
    table = (tmp_path / "scan.md").read_text()
    assert "| hooke-hertz | 3 | 3 | 0 |" in table
    assert table.startswith("**Random chains, accurate at 1e-08**\n\n| family | chains |")
    assert "* made by `python -m benchmarks scan --count 3 --families hooke-hertz`, softcradle " in table
    assert "hooke-hertz" in capsys.readouterr().out
    assert command.main([*given, "--keep"]) == 0
    monkeypatch.setattr(chain_points, "truth_of", lambda _: pytest.fail("its truth is kept"))
    assert command.main([*given, "--folder", str(tmp_path / "another")]) == 0
    assert not (tmp_path / "another" / "truths.jsonl").exists()


@pytest.mark.parametrize("family", FAMILIES)
def test_truths_of_the_repository_are_of_the_chains_that_are_drawn(family):
    kept, chains = {entry["key"]: entry for entry in lines(scan.KEPT)}, [motion(family, seed) for seed in range(40)]
    assert len({chain.key for chain in chains}) == 40
    for chain in chains:
        truth = Truth.from_json(kept[chain.key])
        assert truth.velocity.size == truth.doubt.size == len(chain.velocity)


COUNT = 30 * len(CONSERVING)


@pytest.fixture(scope="module")
def found():
    return [run(number) for number in range(COUNT)]


def test_every_step_converges_and_conserves(found):
    assert not [one for one in found if one.unconverged or one.gave_up]
    assert max(one.momentum for one in found if one.momentum is not None) < 1e-9
    assert max(one.energy for one in found) < 1e-9
    assert sum(one.steps for one in found) > 100 * COUNT


def test_the_table_names_the_seeds_that_fail(found):
    failed = replace(found[3], unconverged=True)
    table = report([failed, *found[:20]])
    row = next(row for row in table.rows if row[0] == failed.family)
    assert row[3] == "1"
    assert row[-1] == str(failed.seed)
    assert table.rows[-1][:2] == ["all", "21"]
    # Chains of these families exchange momentum with the ground or with a wall.
    assert {row[0] for row in table.rows if row[4] == "-"} == {"friction", "walls"}


def test_errors_beyond_a_thousandth_are_warned_of():
    """Check that every large error comes with a warning. A longer scan found exceptions with four times the default
    step. About one chain in hundreds had a large error without a warning.
    """
    found = [one for number in range(40) for one in errors(number)]
    assert [one for one in found if one.error > LARGE and not one.warned] == []
    assert sum(int(row[2]) for row in error_report(found).rows) == len(found)


def test_the_command_writes_its_table(tmp_path, capsys):
    assert command.main(["conserving", "--count", "10", "--jobs", "1", "--markdown", str(tmp_path / "table.md")]) == 0
    assert "| all | 10 |" in (tmp_path / "table.md").read_text()
    with pytest.raises(SystemExit, match="2"):
        command.main(["conserving", "--lossy"])
    assert "--lossy is for --errors" in capsys.readouterr().err


@pytest.mark.parametrize("stages", [1, 3, 5, 7])
def test_the_last_stage_has_order_of_twice_the_stages_less_one(stages):
    found = tableau(stages)
    apart = [abs(found.once[-1] @ found.node**k - Extended(1) / (k + 1)) for k in range(2 * stages)]
    assert max(apart[:-1]) < 20 * EPSILON
    assert apart[-1] > 1e3 * EPSILON


def test_bernstein_coefficients_enclose_the_polynomial():
    found, draw = tableau(5), np.random.default_rng(3)
    for _ in range(50):
        value = draw.normal(size=5).astype(Extended)
        series = found.legendre @ value
        time = np.linspace(0.0, 1.0, 101)
        curve = np.polynomial.legendre.legval(2.0 * time - 1.0, series.astype(float))
        bound = (found.bernstein_value @ value).astype(float)
        assert bound.min() - 1e-12 <= curve.min()
        assert curve.max() <= bound.max() + 1e-12
        assert bound[[0, -1]] == pytest.approx(curve[[0, -1]], abs=1e-12)


@pytest.mark.parametrize("truth", ELASTIC + GEARS, ids=lambda truth: truth.name)
def test_truths_in_quadruple_precision(truth):
    found = reference_end(truth.chain, truth.start, tolerance=1e-12)
    error = float(np.abs(found.velocity - truth.final).max())
    assert error < 1e-12 * float(np.ptp(truth.start))
    assert error < found.error + 1e-16


def test_a_contact_that_never_closes_changes_nothing():
    ends = [
        reference_end(
            Chain([100.0, 0.01, 1.0, 1.0], [hooke(1e4), hooke(1e4), hooke(k)], [0.05, 0.05, 50.0], friction=0.3),
            [2.0, 2.0, 0.0, 0.0], 0.03, 1e-9,
        ).velocity
        for k in (1e4, 1e-4)
    ]  # fmt: skip
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)


def test_forces_that_nothing_determines_do_not_stop_it():
    between_walls = Chain([math.inf, 1.0, math.inf], draft_gear(1.0, 1.0))
    assert reference_end(between_walls, [0, 0, 0], 1.0).velocity.tolist() == [0.0, 0.0, 0.0]
    cluster = Chain([1.0] * 5, draft_gear(100.0, 0.5), friction=0.5)
    assert np.abs(reference_end(cluster, [0.3, 0, 0, 0, 0], tolerance=1e-10).velocity).max() < 1e-11


def test_soft_clusters_to_an_exponent_of_a_fiftieth():
    found = reference_end(one_on(3, power_law(1.0, 0.02)), [1, 0, 0, 0], tolerance=1e-9)
    assert found.error < 1e-7
    assert found.velocity @ found.velocity == pytest.approx(1.0, abs=1e-8)
    assert found.velocity.sum() == pytest.approx(1.0, abs=1e-11)


def test_it_says_that_it_gives_up():
    with pytest.raises(ReferenceGaveUpError, match="after 30 steps"):
        reference_end(one_on(2, hertz(1.0)), [1, 0, 0], most_steps=30)


@pytest.mark.parametrize("family", ["gears", "walls", "driven", "loss", "friction", "timed", "couplers"])
@pytest.mark.parametrize("tolerance", [1e-6, 1e-8])
def test_method_scipy_ends_where_it_does(family, tolerance):
    """Compare the method scipy with the reference. The results must agree within the tolerance. In 140 chains of the
    scan, the largest error was a hundredth of the tolerance.
    """
    compared = 0
    for seed in range(8):
        chosen = motion(family, seed)
        found = solve(chosen.chain, chosen.velocity, chosen.duration, "scipy", None, 2, tolerance, most_steps=3000)
        try:
            truth = reference_end(chosen.chain, chosen.velocity, float(found.time[-1]), 0.01 * tolerance, 400)
        except ReferenceGaveUpError:
            continue
        if not found.status.gave_up:
            compared += 1
            assert np.abs(found.final_velocity - truth.velocity).max() < tolerance * chosen.speed + truth.error, seed
    assert compared >= 4
