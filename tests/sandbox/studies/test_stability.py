"""The maps of failure, and failure itself: inside its limits a method holds its error, outside it fails as said, and says so."""

from __future__ import annotations

import csv
import math

import numpy as np
import pytest
from softcradle.physics import METHODS, Contact, hertz, one_on, power_law, simulate, stable_step
from softcradle.physics.advice.explicit_limits import TRUSTED_ERROR
from softcradle.physics.analysis.closed_forms import rigid_collision
from softcradle.physics.methods import find_method
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies.figures.figure_style import styled
from softcradle.sandbox.studies.stability import failure_scans as scans
from softcradle.sandbox.studies.stability import rigid_cradle as rigid
from softcradle.sandbox.studies.stability.failure_scans import (
    KEPT,
    SCANS,
    STEPS,
    Spot,
    finenesses,
    methods,
    quietly,
    spot,
    spots,
)
from softcradle.sandbox.studies.stability.stability_chart import draw
from softcradle.sandbox.studies.stability.verdicts import verdicts, write_csv

BY_NAME = {scan.name: scan for scan in SCANS}
EXPLICIT = ("euler", "verlet", "yoshida4")
ADAPTIVE = ("radau", "accurate")


def made(spread, energy=0.0, switches=0, fineness=0.1, **rest):
    given = {"warned": True, "limit": 0.05, "allowed": TRUSTED_ERROR, "value": 1.0, "scan": "alpha", "method": "verlet"}
    return Spot(
        **{**given, **rest}, fineness=fineness, energy=energy, final_energy=energy, spread=spread, switches=switches
    )


@pytest.mark.parametrize(
    ("spot", "failure"),
    [
        (made(1e-3), ""),
        (made(1e-3, switches=1000), ""),  # chatter that does no harm
        (made(0.1, switches=1000), "chatter"),
        (made(0.1), "error"),
        (made(9.0, energy=9.0, switches=1000), "blow-up"),
        (made(math.inf, energy=math.inf), "blow-up"),
        (made(math.nan), "error"),
    ],
)
def test_how_a_run_fails(spot, failure):
    assert spot.failure == failure


def test_verlet_on_five_very_soft_beads_fails_by_chatter_not_by_blow_up_and_says_so():
    """n = 5, alpha = 0.02: no step is stable, what shows is chatter and a spread of velocities."""
    chain, velocity = one_on(5, power_law(1.0, 0.02)), np.eye(1, 6)[0]
    true = quietly(chain, velocity, None, "accurate", tolerance=1e-9)
    limit = stable_step(chain, velocity, TRUSTED_ERROR)
    for step in (3.0 * limit, 10.0 * limit):
        found = quietly(chain, velocity, 2.0 * float(true.time[-1]), "verlet", step=step)
        closings = sum(map(len, found.contact_intervals))
        spread = np.std(found.final_velocity[1:])
        assert np.isfinite(found.final_velocity).all()
        assert np.abs(found.kinetic_energy + found.contact_energy).max() < 2.0 * 0.5  # bounded: the force is
        assert closings > sum(map(len, true.contact_intervals))
        assert spread > 3.0 * np.std(true.final_velocity[1:])
        assert any("past its limit" in str(warning) for warning in found.warnings)
    fine = quietly(chain, velocity, 2.0 * float(true.time[-1]), "verlet", step=limit / 30.0)
    assert sum(map(len, fine.contact_intervals)) > 100  # finer steps chatter as well, and more often
    assert any(warning.code == "chatter" for warning in fine.warnings)
    assert np.abs(fine.final_velocity - true.final_velocity).max() < TRUSTED_ERROR  # but in less


@pytest.mark.parametrize("method", EXPLICIT)
@pytest.mark.parametrize("ratio", [1.0, 10.0])
def test_explicit_methods_fail_on_draft_gears_at_large_steps_and_say_so(method, ratio):
    scan = BY_NAME["preload"]
    found = [spot(scan, ratio, find_method(method), step) for step in STEPS if step > 0.05]
    assert all(one.failure for one in found[-2:])
    assert all(one.warned for one in found if one.failure)


@pytest.mark.parametrize("scan", SCANS, ids=lambda scan: scan.name)
@pytest.mark.parametrize("method", EXPLICIT)
def test_inside_the_estimate_the_error_holds(scan, method):
    """Steps of a third of `stable_step` on every value of a scan: within the error that it was asked for, and some."""
    for value in scan.values:
        chain = scan.chain(value)
        step = stable_step(chain, np.eye(1, chain.contacts + 1)[0], TRUSTED_ERROR) / 3.0
        found = spot(scan, value, find_method(method), step)
        assert found.spread <= 2.0 * TRUSTED_ERROR
        assert found.final_energy < 0.05


@pytest.mark.parametrize("scan", SCANS, ids=lambda scan: scan.name)
@pytest.mark.parametrize("method", [*EXPLICIT, "conserving"])
def test_every_failure_of_a_fixed_step_is_warned_of(scan, method):
    coarse = [step for step in STEPS if step > 0.02]
    found = [one for one in spots(scan, find_method(method), coarse) if one.failure]
    assert found
    assert all(one.warned for one in found)


@pytest.mark.parametrize("scan", SCANS, ids=lambda scan: scan.name)
def test_conserving_keeps_its_energy_at_every_step(scan):
    for found in spots(scan, find_method("conserving"), [0.3, 0.03]):
        assert found.final_energy < 1e-10
        assert found.failure in {"", "error"}  # never chatter, never blow-up


@pytest.mark.parametrize("scan", SCANS, ids=lambda scan: scan.name)
@pytest.mark.parametrize("method", ADAPTIVE)
@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-7])
def test_adaptive_methods_hold_some_times_their_tolerance(scan, method, tolerance):
    for value in scan.values[::3]:
        found = spot(scan, value, find_method(method), tolerance)
        assert found.failure == ""


def test_dop853_on_the_softest_contacts_fails_and_says_so():
    found = spot(BY_NAME["alpha"], BY_NAME["alpha"].values[0], find_method("dop853"), 1e-8)
    assert found.failure == "chatter"
    assert found.warned


@pytest.mark.parametrize("contact", [power_law(1.0, 0.1), hertz(1.0), Contact(1.0, 1.0, 1.0)])
def test_conserving_says_when_its_step_is_too_long_to_see_a_contact(contact):
    chain = one_on(2, contact)
    with pytest.warns(RuntimeWarning, match="past its limit"):
        found = simulate(chain, [1, 0, 0], 3.0, "conserving", step=1.0)
    assert "energy holds" in str(found.warnings[0])
    assert simulate(chain, [1, 0, 0], 3.0, "conserving", step=0.01).warnings == ()


def test_scipy_is_dear_where_contacts_are_soft():
    """The reference: at alpha = 1/14 it takes many times the evaluations that radau needs for the same error."""
    chain, velocity = one_on(5, power_law(1.0, 1 / 14)), np.eye(1, 6)[0]
    ours = simulate(chain, velocity, method="radau", tolerance=1e-5)
    slow = simulate(chain, velocity, method="scipy", tolerance=1e-3)
    assert slow.seconds > 10.0 * ours.seconds
    truth = simulate(chain, velocity, method="radau", tolerance=1e-11).final_velocity
    errors = [np.abs(found.final_velocity - truth).max() for found in (ours, slow)]
    assert errors[0] < errors[1]


def test_rigid_contacts_of_pymunk_are_no_cradle_of_soft_beads():
    """The cautionary row: its energy depends on the step, and one on four is not the rigid-like outcome at any."""
    coarse, fine = rigid.energy_kept(1 / 60), rigid.energy_kept(1 / 600)
    assert abs(coarse - 1.0) > 0.03
    assert abs(fine - 1.0) < abs(coarse - 1.0)
    soft = rigid_collision(np.ones(5), 1)
    for step in (1 / 60, 1 / 6000):
        assert rigid.blow(step)[-1] > 0.9
        assert np.abs(rigid.blow(step) - soft).max() > 0.5


def test_every_method_is_mapped_but_those_that_are_another_or_the_reference():
    assert {method.name for method in METHODS} - {method.name for method in methods()} == {"pymunk", "scipy"}
    assert list(BY_NAME) == ["alpha", "n", "preload"]


def test_verdicts_count_what_fails_how_and_from_where():
    some = [made(1e-3, fineness=0.01), made(0.1, switches=9, fineness=0.03), made(0.2, fineness=0.1, warned=False)]
    (found,) = verdicts(some)
    assert (found.runs, found.failed, found.unsafe, found.silent) == (3, 2, 1, 1)
    assert found.first is some[1]
    assert dict(found.kinds) == {"chatter": 1, "error": 1}


@pytest.fixture
def few(monkeypatch):
    """A scan of two values and steps, to draw."""
    scan = scans.Scan("alpha", "exponent", (0.05, 1.0), BY_NAME["alpha"].chain)
    monkeypatch.setattr(scans, "STEPS", (0.01, 0.3))
    monkeypatch.setattr(scans, "TOLERANCES", (1e-3, 1e-2))
    monkeypatch.setattr(scans, "SCANS", (scan,))
    return scan


def test_the_picture_has_a_map_a_quantity_and_method_with_the_estimate_on_top(few):
    found = [one for method in methods() for one in spots(few, method)]
    with styled():
        figure = draw(found, [few])
    maps = [axes for axes in figure.axes if axes.collections and axes.get_ylabel() in {"step [s]", "tolerance"}]
    assert len(maps) == 3 * len(methods())
    fixed = [axes for axes in maps if axes.get_ylabel() == "step [s]"]
    assert all(len(axes.lines) == 1 for axes in fixed)
    letters = sorted(text.get_text() for text in fixed[0].texts)
    assert letters == sorted(one.failure[0] for one in found if one.method == "euler" and one.failure)
    assert letters


def test_csv_holds_every_run(tmp_path):
    write_csv([made(0.1, switches=9), made(1e-3)], tmp_path / "x.csv")
    with (tmp_path / "x.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["failure"] for row in rows] == ["chatter", ""]
    assert float(rows[0]["spread"]) == 0.1


def test_the_command(few, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(rigid, "STEPS", (1 / 60,))
    assert main(["stability", "-o", str(tmp_path / "x.png")]) == 0
    said = capsys.readouterr().out
    assert sorted(path.name for path in tmp_path.iterdir()) == ["x.csv", "x.png"]
    assert all(method.name in said for method in methods())
    assert "pymunk's own rigid contacts" in said
    assert f"{KEPT:g} times the tolerance" in " ".join(said.split())


@pytest.mark.parametrize(
    ("arguments", "said"),
    [(["stability", "beta"], "there is no scan 'beta'"), (["stability", "-o", "x.txt"], "stability writes .png")],
)
def test_refusals_are_sentences(arguments, said, capsys):
    assert main(arguments) == 2
    assert said in capsys.readouterr().err


def test_finenesses_are_steps_or_tolerances():
    assert finenesses(find_method("verlet")) is scans.STEPS
    assert finenesses(find_method("radau")) is scans.TOLERANCES
