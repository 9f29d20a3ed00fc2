"""The scans of random chains: what they draw and judge, that one goes on where it stopped; a part of that of `conserving`."""

import json
from dataclasses import replace
from unittest.mock import DEFAULT, Mock

import numpy as np
import pytest
from softcradle.physics import one_on, power_law, simulate
from softcradle.physics.status import CodedWarning, Status, WarningCode

from benchmarks import __main__ as command
from benchmarks.conserving_scan import FAMILIES as CONSERVING
from benchmarks.conserving_scan import LARGE, error_report, errors, report, run
from benchmarks.json_lines import lines
from benchmarks.scan import chain_points, verdict
from benchmarks.scan import command as scan
from benchmarks.scan.families import FAMILIES, Motion, motion
from benchmarks.scan.truth import Truth, truth_of

pytestmark = pytest.mark.slow

PAPER = Motion("power", 0, one_on(4, power_law(1.0, 0.1)), (1.0, 0.0, 0.0, 0.0, 0.0))
VELOCITY = (-0.56758562476, 0.17392146673, 0.45407871484, 0.46978361268, 0.46980183052)
TRUTH = Truth(np.array(VELOCITY), np.full(5, 1e-10), "known")


@pytest.mark.parametrize("family", FAMILIES)
def test_a_seed_is_one_chain(family):
    first, again, other = motion(family, 7), motion(family, 7), motion(family, 8)
    assert first == again
    assert first.key != other.key
    assert len(first.velocity) == first.chain.contacts + 1


def test_the_truth_is_by_the_reference_and_that_of_laws_of_ones_own_by_scipy():
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
    assert judged(monkeypatch, 1e-3, warnings=warned)["verdict"] == "stated"
    assert judged(monkeypatch, 1e-3, status=Status.OUT_OF_STEPS)["verdict"] == "gave up"
    silent = judged(monkeypatch, 1e-3)
    assert silent["verdict"] == ("silent" if np.isnan(silent["stated"]) or silent["stated"] < 1e-3 else "stated")


@pytest.mark.parametrize(("source", "expected"), [("spread", "unknown"), ("spread of fine runs", "silent")])
def test_what_is_not_known_is_no_verdict(monkeypatch, source, expected):
    """Coarse runs that differ tell nothing of an error; fine ones tell that the motion is not determined to what is stated."""
    truth = Truth(TRUTH.velocity, np.full(5, 1e-2), source)
    assert judged(monkeypatch, 1e-3, truth, velocity_error=np.full(5, 1e-7))["verdict"] == expected


def test_a_scan_that_is_stopped_goes_on_and_what_is_judged_is_kept(tmp_path, capsys, monkeypatch):
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
        file.write('\n{"family": "cut o')  # as an interruption leaves it
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
    kept = {entry["key"]: entry for entry in lines(scan.KEPT)}
    for chain in (motion(family, seed) for seed in range(40)):
        truth = Truth.from_json(kept[chain.key])
        assert truth.velocity.size == truth.doubt.size == len(chain.velocity)


COUNT = 30 * len(CONSERVING)


@pytest.fixture(scope="module")
def found():
    return [run(number) for number in range(COUNT)]


def test_every_step_converges_and_conserves(found):
    assert not [one for one in found if one.unconverged or one.gave_up]
    assert max(one.momentum for one in found) < 1e-9
    assert max(one.energy for one in found) < 1e-9
    assert sum(one.steps for one in found) > 100 * COUNT


def test_the_table_names_the_seeds_that_fail(found):
    failed = replace(found[3], unconverged=True)
    table = report([failed, *found[:20]])
    row = next(row for row in table.rows if row[0] == failed.family)
    assert row[3] == "1"
    assert row[-1] == str(failed.seed)
    assert table.rows[-1][:2] == ["all", "21"]


def test_errors_beyond_a_thousandth_are_warned_of():
    """But one in hundreds, at four times the default step."""
    found = [one for number in range(40) for one in errors(number)]
    assert [one for one in found if one.error > LARGE and not one.warned] == []
    assert sum(int(row[2]) for row in error_report(found).rows) == len(found)


def test_the_command_writes_its_table(tmp_path, capsys):
    assert command.main(["conserving", "--count", "10", "--jobs", "1", "--markdown", str(tmp_path / "table.md")]) == 0
    assert "| all | 10 |" in (tmp_path / "table.md").read_text()
