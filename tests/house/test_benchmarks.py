"""Tests of the benchmarks. Each benchmark must measure the quantities that its table names. The command must write the
tables that it prints.
"""

import importlib
import json
import sys

import numpy as np
import pytest
from softcradle.sandbox.studies.precision.cases import CASE_DEFINITIONS

from benchmarks import __main__ as command
from benchmarks import many_chains, steps, sweeps, two_versions
from benchmarks.auto_choice import Judged, report
from benchmarks.steps import StepCase
from benchmarks.work_precision import case_report
from tests.helpers.paths import ROOT
from tests.helpers.series import SHORT_LIMITS, our_solver

pytestmark = pytest.mark.slow


def test_the_table_of_a_case_has_the_aims_of_accurate():
    case = CASE_DEFINITIONS[0].solve()
    solvers = [our_solver(case, "accurate", 1e-5, 1e-7), our_solver(case, "conserving", 60.0, 120.0)]
    report = case_report(case, solvers, SHORT_LIMITS)
    assert [row[0] for row in report.rows] == ["accurate", "conserving"]
    assert report.rows[0][3] == "- (0.22) missed"
    assert json.loads(json.dumps(report.data))["case"] == case.label
    assert report.data["solvers"][0]["fastest"][1]["error"] <= 1e-6


def test_two_versions_are_timed_on_the_same_chains_by_turns(monkeypatch, capsys):
    """Compare this version of the package with itself. Each case must run in both interpreters, and the reported ratio
    must be the ratio of the two times.
    """
    monkeypatch.setattr(two_versions, "SECONDS", 0.0)
    monkeypatch.setattr(two_versions, "FEWEST", 1)
    assert set(two_versions.AIMS) < set(two_versions.cases())
    here = two_versions.measured()
    assert here.keys() == two_versions.times_of(sys.executable).keys()
    rows = list(two_versions.rows(here, {key: 2.0 * time for key, time in here.items()}))
    assert {row[0] for row in rows} == set(two_versions.cases())
    assert all(row[4] == row[7] == "0.50" for row in rows)
    with pytest.raises(SystemExit, match="2"):
        command.main(["two-versions", "no/such/python"])
    assert "no/such/python is not there" in capsys.readouterr().err


def test_a_chunk_of_a_sweep_is_sent_as_two_numbers():
    found = sweeps.measure_traffic(count=50)
    assert found["task_bytes"] < 100
    assert found["work_bytes"] < 5000  # These bytes are sent once per worker, even if a sweep has ten million points.
    assert 5 * 8 <= found["point_bytes"] < 100  # Each point sends five velocities.


def test_the_cost_of_steps_and_batches_is_measured():
    for method in ("verlet", "conserving"):
        found = steps.measure(StepCase(method, 1e-4, 4, method == "verlet", 20.0), contact_steps=40, rounds=1)
        assert (found["closed"], found["steps"]) == (4, 10)
        assert found["nanoseconds"] > 0.0
    found = many_chains.measure(many_chains.CASES["Hertz"], "verlet", chains=3, alone=3)
    assert found["ratio"] == pytest.approx(found["ensemble"] / found["ends"])
    assert found["ends"] > 0.0


def test_the_command_writes_what_it_shows(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(steps, "CASES", (StepCase("verlet", 1e-4, 4, True, 20.0),))
    assert command.main(["steps", "--json", str(tmp_path / "new" / "bench.json")]) == 0
    assert "Cost of a step" in capsys.readouterr().out
    content = json.loads((tmp_path / "new" / "bench.json").read_text())
    assert [row["method"] for row in content["steps"][0]] == ["verlet"]
    assert content["versions"]["numpy"] == np.__version__
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["bench.json"]
    with pytest.raises(SystemExit, match="2"):
        command.main(["nonsense"])
    assert "nonsense" in capsys.readouterr().err


def test_choices_of_auto_are_reported_for_a_motion_without_evaluations():
    """Check a motion that consists only of free flights. In an earlier version, its cost was divided by the number of
    evaluations of the alternatives, which is zero.
    """
    one = Judged(3, 1e-2, "accurate", 0.0, {"accurate": 0.0, "radau": 0.0}, 0.0)
    (row,) = report([one], "").rows
    assert row[:7] == ["0.01", "accurate", "1", "0", "0", "0", "0"]


@pytest.mark.parametrize("name", command.COMMANDS)
def test_the_help_of_a_command_says_what_it_does(name, capsys):
    with pytest.raises(SystemExit, match="0"):
        command.main([name, "--help"])
    assert f"``python -m benchmarks {name}" in " ".join(capsys.readouterr().out.split())


def benchmarks_over_time():
    for stem in ("first_use", "films", "solves", "steps"):
        module = importlib.import_module(f"benchmarks.over_time.{stem}")
        for name, kind in vars(module).items():
            if isinstance(kind, type) and kind.__module__ == module.__name__:
                yield f"{stem}.{name}", kind


def measurement_of(kind):
    (found,) = [name for name in vars(kind) if name.startswith(("time_", "track_"))]
    return found


@pytest.mark.parametrize("kind", [pytest.param(kind, id=name) for name, kind in benchmarks_over_time()])
def test_benchmarks_over_time_run(kind, monkeypatch):
    """Run each benchmark with the smallest possible amount of work. The benchmark uses the same code as the command."""
    monkeypatch.setattr("benchmarks.render.MOST_FRAMES", 4)
    monkeypatch.setattr("benchmarks.over_time.solves.COLLISIONS", 2)
    monkeypatch.setattr("benchmarks.over_time.steps.measure", lambda case: {"nanoseconds": 1.0})
    monkeypatch.setattr("benchmarks.over_time.first_use.started", lambda *words: (float(words[-1] == "--help"), ""))
    benchmark, first = kind(), [values[0] for values in getattr(kind, "params", ())]
    getattr(benchmark, "setup", lambda *_: None)(*first)
    found = getattr(benchmark, measurement_of(kind))(*first)
    assert found is None or found >= 0.0


RELEASES = ROOT / json.loads((ROOT / "asv.conf.json").read_text(encoding="utf-8"))["results_dir"]
KEPT = sorted(RELEASES.glob("*/*-*.json"))


@pytest.mark.parametrize("path", KEPT, ids=lambda path: path.stem[:8])
def test_every_benchmark_of_a_kept_release_ran(path):
    """Check the stored benchmark results of a release. The results must contain a number for each case, the hardware,
    and the versions of the dependencies.
    """
    found, machine = (json.loads(file.read_text(encoding="utf-8")) for file in (path, path.parent / "machine.json"))
    columns = found["result_columns"]
    results = {name: dict(zip(columns, values, strict=False)) for name, values in found["results"].items()}
    wanted = {f"{name}.{measurement_of(kind)}" for name, kind in benchmarks_over_time()}
    assert set(results) == wanted
    assert [name for name, one in results.items() if not all(isinstance(value, float) for value in one["result"])] == []
    assert machine["cpu"]
    assert set(found["requirements"]) == {"av", "numba", "numpy", "pymunk", "scipy"}
