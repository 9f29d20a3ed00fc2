"""Maps of rigid-like behaviour: a point is what `simulate` gives, and gears are rigid below the critical speed."""

from __future__ import annotations

import csv

import numpy as np
import pytest
from softcradle.physics import one_on, power_law, simulate
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies.maps.rigidity_scan import compute_map, rigidity_maps


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
