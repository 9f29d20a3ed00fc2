"""Tests of the parameter scans that search for failures of the numerical methods.

Inside its limits, a method must keep its error bound. Outside, it must fail in the expected way and give a warning.
"""

import csv
import math

import numpy as np
import pytest
from softcradle.physics import one_on, power_law, stable_step
from softcradle.physics.advice.stability_limits import TRUSTED_ERROR
from softcradle.physics.analysis.closed_forms import rigid_collision
from softcradle.physics.methods import find_method
from softcradle.sandbox.studies.plot_style import styled
from softcradle.sandbox.studies.stability import failure_scans, rigid_cradle
from softcradle.sandbox.studies.stability.failure_scans import SCANS, STEPS, Failure, Scan, ScanRun, scan_run
from softcradle.sandbox.studies.stability.scan_maps import ORDER, draw_details, draw_overview

EXPLICIT = ("euler", "verlet", "yoshida4")
METHODS = failure_scans.scanned_methods()


def scan_runs(scan, method, steps=None):
    steps = steps or failure_scans.finenesses(method)
    return [scan_run(scan, value, method, step) for value in scan.values for step in steps]


def made_run(spread, energy=0.0, switches=0, fineness=0.1, warned=True):
    return ScanRun("alpha", 1.0, "verlet", fineness, energy, energy, spread, switches, warned, 0.05, TRUSTED_ERROR)


@pytest.mark.parametrize(
    ("run", "failure"),
    [
        (made_run(1e-3), None),
        # Chattering contacts with a small error do not count as a failure.
        (made_run(1e-3, switches=1000), None),
        (made_run(0.1, switches=1000), Failure.CHATTER),
        (made_run(0.1), Failure.ERROR),
        (made_run(9.0, energy=9.0, switches=1000), Failure.BLOW_UP),
        (made_run(math.inf, energy=math.inf), Failure.BLOW_UP),
        (made_run(math.nan), Failure.ERROR),
    ],
)
def test_how_a_run_fails(run, failure):
    assert run.failure is failure


def test_verlet_on_five_very_soft_beads_chatters_and_warns():
    """Check the method `verlet` for n = 5 and alpha = 0.02.

    No step is stable. The contacts chatter and the final velocities of the beads differ.
    """
    scan = Scan("soft", "", (5.0,), lambda n: one_on(int(n), power_law(1.0, 0.02)))
    limit = stable_step(scan.chain(5.0), np.eye(1, 6)[0], TRUSTED_ERROR)
    verlet = find_method("verlet")
    coarser, coarse, fine = (scan_run(scan, 5.0, verlet, part * limit) for part in (10.0, 3.0, 1.0 / 30.0))
    for found in (coarser, coarse):
        assert found.failure is Failure.CHATTER
        assert found.energy < 1.0  # The energy error is bounded because the contact force is bounded.
    assert all(found.warned for found in (coarser, coarse, fine))
    assert fine.switches > 200  # With a finer step, the contacts open and close even more often.
    # With a finer step, each opening or closing changes the velocities less. No bead has a large error.
    assert math.sqrt(5.0) * fine.spread < TRUSTED_ERROR


@pytest.mark.parametrize("scan", SCANS, ids=lambda scan: scan.name)
@pytest.mark.parametrize("method", EXPLICIT)
def test_inside_the_estimate_the_error_holds(scan, method):
    """Check the error of each explicit method with a third of the step `stable_step`. The error must be at most twice
    the requested error.

    Each of four contacts can end its chattering at any point of the error range. The mean error over several steps can
    therefore be twice as large.
    """
    for value in scan.values:
        chain = scan.chain(value)
        step = stable_step(chain, np.eye(1, chain.contacts + 1)[0], TRUSTED_ERROR) / 3.0
        found = [scan_run(scan, value, find_method(method), part * step) for part in (0.9, 1.0, 1.1)]
        assert np.sqrt(np.mean([one.spread**2 for one in found])) <= 2.0 * TRUSTED_ERROR
        assert max(one.final_energy for one in found) < 0.05


@pytest.mark.parametrize("scan", SCANS, ids=lambda scan: scan.name)
@pytest.mark.parametrize("method", [*EXPLICIT, "conserving"])
def test_every_failure_of_a_fixed_step_has_a_warning(scan, method):
    coarse = [step for step in STEPS if step > 0.02]
    found = [one for one in scan_runs(scan, find_method(method), coarse) if one.failure]
    assert found
    assert all(one.warned for one in found)
    if method == "conserving":  # The method `conserving` must never chatter or become unstable.
        assert all(one.failure is Failure.ERROR and one.final_energy < 1e-10 for one in found)


def test_rigid_contacts_of_pymunk_are_no_cradle_of_soft_beads():
    """Check that the rigid contacts of pymunk cannot replace soft beads.

    The remaining energy of the cradle depends on the step. The rigid-like outcome of the collision of one bead with
    four appears at no step.
    """
    coarse, fine = rigid_cradle.remaining_energy(1 / 60), rigid_cradle.remaining_energy(1 / 600)
    assert abs(coarse - 1.0) > 0.03
    assert abs(fine - 1.0) < abs(coarse - 1.0)
    soft = rigid_collision(np.ones(5), 1)
    for step in (1 / 60, 1 / 6000):
        assert rigid_cradle.strike(step)[-1] > 0.9
        assert np.abs(rigid_cradle.strike(step) - soft).max() > 0.5


def test_summary_counts_failures_and_names_the_finest():
    runs = [made_run(1e-3, fineness=0.01), made_run(0.1, switches=9, fineness=0.03), made_run(0.2, warned=False)]
    (found,) = failure_scans.summarise_failures(runs)
    assert (found.runs, found.failed, found.below_limit, found.silent) == (3, 2, 1, 1)
    assert found.finest is runs[1]
    assert dict(found.kinds) == {Failure.CHATTER: 1, Failure.ERROR: 1}


def test_a_scan_is_written_and_drawn_as_maps(tmp_path, softcradle, monkeypatch):
    scan = Scan("alpha", "exponent", (0.05, 1.0), next(one for one in SCANS if one.name == "alpha").chain)
    monkeypatch.setattr(failure_scans, "STEPS", (0.01, 0.3))
    monkeypatch.setattr(failure_scans, "TOLERANCES", (1e-3, 1e-2))
    monkeypatch.setattr(failure_scans, "SCANS", (scan,))
    monkeypatch.setattr(rigid_cradle, "STEPS", (1 / 60,))
    printed = softcradle("stability", "-o", str(tmp_path / "x.png")).out
    assert sorted(path.name for path in tmp_path.iterdir()) == ["x.csv", "x.png"]
    assert all(method.name in printed for method in METHODS)
    assert "pymunk's own rigid contacts" in printed
    assert f"{failure_scans.ADAPTIVE_ERROR_FACTOR:g} times the tolerance" in " ".join(printed.split())
    found = [one for method in METHODS for one in scan_runs(scan, method)]
    with (tmp_path / "x.csv").open() as file:
        assert [row["failure"] for row in csv.DictReader(file)] == [one.failure or "" for one in found]
    # The results of the parallel sweep are equal to the results of single simulations.
    failure_scans.write_csv(found, tmp_path / "alone.csv")
    assert (tmp_path / "alone.csv").read_text() == (tmp_path / "x.csv").read_text()
    with styled():
        details, overview = draw_details(found, [scan]), draw_overview(found, [scan])
    maps = [axes for axes in details.axes if axes.collections and axes.get_ylabel() in {"step [s]", "tolerance"}]
    assert len(maps) == 3 * len(METHODS)
    fixed = [axes for axes in maps if axes.get_ylabel() == "step [s]"]
    assert all(len(axes.lines) == 1 for axes in fixed)
    euler = [one.failure for one in found if one.method == "euler"]
    letters = sorted(text.get_text() for text in fixed[0].texts)
    assert letters == sorted(failure[0] for failure in euler if failure)
    assert letters
    maps = [axes for axes in overview.axes if axes.collections]
    assert len(maps) == len(METHODS)
    explained = " ".join(text.get_text() for legend in overview.legends for text in legend.get_texts())
    assert all(name in explained for name in (*(failure.value for failure in Failure), "stable_step"))
    shown = np.sort(np.asarray(maps[0].collections[0].get_array()).ravel())
    np.testing.assert_array_equal(shown, np.sort([ORDER.index(failure) for failure in euler]))
