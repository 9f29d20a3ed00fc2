"""Maps of rigid-like behaviour: a point is what `simulate` gives, and gears are rigid below the critical speed."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from softcradle.physics import ensemble, one_on, power_law, simulate
from softcradle.physics.status import Status
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies.maps import map_progress
from softcradle.sandbox.studies.maps.map_figure import draw_map
from softcradle.sandbox.studies.maps.map_progress import compute_map
from softcradle.sandbox.studies.maps.rigidity_scan import Point, RigidityMap, point_rows, rigidity_maps
from softcradle.sandbox.studies.plot_style import styled

real_ensemble = ensemble  # as it is, for the one that gives up


@pytest.fixture(scope="module")
def tables():
    power, gear = rigidity_maps(7, 3)
    return {"power": (power, compute_map(power)), "gear": (gear, compute_map(gear))}


def grid(tables, name, column):
    scanned, table = tables[name]
    return table[column].reshape(len(scanned.sizes), len(scanned.values))


def test_a_point_is_what_simulate_gives(tables):
    _, table = tables["power"]
    for row in (0, 9, 20):
        n, alpha = int(table["n"][row]), float(table["alpha"][row])
        chain = one_on(n, power_law(1.0, alpha))
        alone = simulate(chain, [1.0] + [0.0] * n, tolerance=1e-8)
        targets = alone.final_velocity[1:]
        spread = (targets.max() - targets.min()) / targets.mean()
        assert table["rigidity at the end"][row] == pytest.approx(spread, rel=1e-2, abs=4e-4)
        leaving = alone.contact_intervals[0][0][1]
        then = simulate(chain, [1.0] + [0.0] * n, leaving, tolerance=1e-8).final_velocity[1:]
        spread = (then.max() - then.min()) / then.mean()
        assert table["rigidity at detachment"][row] == pytest.approx(spread, rel=1e-2, abs=4e-4)
    assert (table["n"] >= 2).all()
    assert not table["warned"].any()


def test_softer_and_smaller_clusters_are_more_rigid(tables):
    ends = grid(tables, "power", "rigidity at the end")
    assert (ends[:, 0] < 1e-3).all()
    assert (ends[:, -1] > 0.5).all()
    assert (np.diff(ends[:, -1]) > 0.0).all()


@pytest.mark.parametrize("column", ["rigidity at detachment", "rigidity at the end"])
def test_gears_are_rigid_below_the_critical_speed_alone(tables, column):
    scanned, _ = tables["gear"]
    found, below = grid(tables, "gear", column), scanned.values < 1.0
    assert below.any()
    assert (found[:, below] < 1e-9).all()
    assert (found[:, ~below] > 1e-3).all()


def test_command_writes_picture_and_numbers(tmp_path, capsys):
    assert main(["maps", "draft-gear", "--points", "5x2", "-o", str(tmp_path)]) == 0
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["map-draft-gear.csv", "map-draft-gear.pdf", "map-draft-gear.png"]
    with (tmp_path / "map-draft-gear.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 10
    assert {row["n"] for row in rows} == {"2", "3"}
    assert str(tmp_path) in capsys.readouterr().out


def giving_up(chains, *arguments, **options):
    """An ensemble in which the longest chains give up before anything has opened."""
    found = real_ensemble(chains, *arguments, **options)
    return [
        replace(one, status=Status.OUT_OF_STEPS, contact_intervals=((),) * one.chain.contacts)
        if one.chain.contacts == 3
        else one
        for one in found
    ]


def test_a_point_that_gives_up_is_hatched_and_the_map_complete(monkeypatch):
    monkeypatch.setattr("softcradle.sandbox.studies.maps.rigidity_scan.ensemble", giving_up)
    scanned, _ = rigidity_maps(4, 3)
    table = compute_map(scanned)
    failed = table["n"] == 3
    for column in ("rigidity at detachment", "rigidity at the end"):
        np.testing.assert_array_equal(np.isnan(table[column]), failed)
    assert (table["status"][failed] == Status.OUT_OF_STEPS).all()
    with styled():
        axes = draw_map(scanned, table).axes[0]
    assert len(axes.patches) == 4
    assert all(patch.get_hatch() for patch in axes.patches)
    assert "hatched: 4 took too many steps" in axes.get_xlabel()


def test_a_map_that_was_stopped_goes_on(tmp_path, monkeypatch):
    scanned, _ = rigidity_maps(6, 3)
    asked: list[Point] = []

    def counted(scanned: RigidityMap, points: Sequence[Point]):
        if len(asked) >= 10:
            raise KeyboardInterrupt
        asked.extend(points)
        return point_rows(scanned, points)

    monkeypatch.setattr(map_progress, "PART", 5)
    monkeypatch.setattr(map_progress, "point_rows", counted)
    kept = tmp_path / "kept"
    with pytest.raises(KeyboardInterrupt):
        compute_map(scanned, kept)
    first = list(asked)
    kept.write_text(kept.read_text() + "0.5,2.0,0.1")  # a line that was cut off
    asked.clear()
    monkeypatch.setattr(
        map_progress, "point_rows", lambda *arguments: asked.extend(arguments[1]) or point_rows(*arguments)
    )
    done: list[int] = []
    table = compute_map(scanned, kept, done.append)
    assert len(first) == 10
    assert not set(first) & set(asked)
    assert sum(done) == 18 == len(first) + len(asked)
    fresh = compute_map(scanned)
    for name, column in fresh.items():
        np.testing.assert_array_equal(table[name], column)


def test_kept_points_of_other_settings_are_not_taken(tmp_path, monkeypatch):
    power, _ = rigidity_maps(3, 2)
    kept = tmp_path / "kept"
    compute_map(power, kept)
    monkeypatch.setattr(map_progress, "TOLERANCE", 1e-3)
    asked: list[Point] = []
    monkeypatch.setattr(
        map_progress, "point_rows", lambda *arguments: asked.extend(arguments[1]) or point_rows(*arguments)
    )
    compute_map(power, kept)
    assert len(asked) == 6


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["gear"], "no map 'gear'; there are power-law, draft-gear"),
        (["--points", "200"], "--points must be two whole numbers from 2 to 2000"),
        (["--points", "1x20"], "--points must be two whole numbers"),
        (["--points", "20x-3"], "--points must be two whole numbers"),
    ],
)
def test_command_refuses_in_a_sentence(arguments, sentence, tmp_path, capsys):
    assert main(["maps", *arguments, "-o", str(tmp_path / "none")]) == 2
    assert sentence in capsys.readouterr().err
    assert not (tmp_path / "none").exists()
