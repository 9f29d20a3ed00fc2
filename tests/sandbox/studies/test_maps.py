"""Tests of maps that show for which parameters a cluster behaves like a rigid body.

Single points of a map must agree with `simulate`. Clusters of draft gears must be rigid below the critical speed.
"""

import csv
import itertools
from dataclasses import replace

import numpy as np
import pytest
from softcradle.physics import one_on, power_law, simulate
from softcradle.physics.simulation import solve
from softcradle.physics.status import Status
from softcradle.sandbox.studies import rigidity_maps as rigidity_scan
from softcradle.sandbox.studies.plot_style import styled
from softcradle.sandbox.studies.rigidity_maps import COLUMNS, compute_map, draw_map, rigidity_maps
from softcradle.sandbox.sweeps import measure_table

from tests.helpers.figure_layout import texts_of, unreadable


@pytest.fixture(scope="module")
def tables():
    power, gear = rigidity_maps(7, 3)
    return {"power": (power, compute_map(power)), "gear": (gear, compute_map(gear))}


def test_a_point_is_what_simulate_gives(tables):
    _, table = tables["power"]
    for row in (0, 9, 20):
        n, alpha = int(table["n"][row]), float(table["alpha"][row])
        chain, velocity = one_on(n, power_law(1.0, alpha)), np.eye(1, n + 1)[0]
        end = simulate(chain, velocity, tolerance=1e-8)
        detached = simulate(chain, velocity, end.contact_intervals[0][0][1], tolerance=1e-8)
        for column, run in zip(COLUMNS, (detached, end), strict=True):
            targets = run.final_velocity[1:]
            assert table[column][row] == pytest.approx(np.ptp(targets) / targets.mean(), rel=1e-2, abs=4e-4)
    assert (table["n"] >= 2).all()
    assert not table["warned"].any()


@pytest.mark.parametrize("column", COLUMNS)
def test_gears_are_rigid_below_the_critical_speed_alone(tables, column):
    scanned, table = tables["gear"]
    found, below = table[column].reshape(len(scanned.sizes), -1), scanned.values < 1.0
    assert below.any()
    assert (found[:, below] < 1e-9).all()
    assert (found[:, ~below] > 1e-3).all()


def test_command_writes_picture_and_numbers(tmp_path, softcradle):
    assert str(tmp_path) in softcradle("maps", "draft-gear", "--points", "5x2", "-o", str(tmp_path)).out
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["map-draft-gear.csv", "map-draft-gear.pdf", "map-draft-gear.png"]
    with (tmp_path / "map-draft-gear.csv").open() as file:
        assert sorted(row["n"] for row in csv.DictReader(file)) == ["2"] * 5 + ["3"] * 5


def map_with(changes, monkeypatch, *size):
    """Return the table and the axes of a map whose simulation results are modified by the function `changes`.

    The arguments of `changes` are the number of contacts, and True if the simulation continues to the end of the
    motion.
    """

    def changed(chain, *arguments, **options):
        found = solve(chain, *arguments, **options)
        return replace(found, **changes(chain.contacts, "duration" not in options))

    monkeypatch.setattr(measure_table, "solve", changed)
    scanned, _ = rigidity_maps(*size)
    table = compute_map(scanned, workers=1)
    with styled():
        return table, draw_map(scanned, table).axes[:2]


def test_a_point_that_gives_up_is_hatched(monkeypatch):
    """Check that a map marks failed points with hatches. In this test, the longest chains fail before a contact has
    opened.
    """
    lost = {"status": Status.OUT_OF_STEPS, "contact_intervals": ((),) * 3}
    table, (axes, _) = map_with(lambda contacts, _: lost if contacts == 3 else {}, monkeypatch, 4, 3)
    failed = table["n"] == 3
    for column in COLUMNS:
        np.testing.assert_array_equal(np.isnan(table[column]), failed)
    assert (table["status"][failed] == Status.OUT_OF_STEPS).all()
    assert len(axes.patches) == 4
    assert all(patch.get_hatch() for patch in axes.patches)
    assert "hatched: 4 took too many steps" in axes.get_xlabel()


def test_the_reason_of_a_hatched_cell_is_that_of_the_run_that_gave_up(monkeypatch):
    """Check the reason that a map gives for its hatched points.

    Each point needs two simulations. At n = 2, the simulation to the end fails. At n = 3, the simulation to the
    separation fails. The result of the other simulation is undetermined, which must not be given as the reason.
    """
    lost = {True: {"status": Status.FAILED}, False: {"status": Status.UNDETERMINED}}
    table, both = map_with(lambda contacts, to_the_end: lost[to_the_end is (contacts == 2)], monkeypatch, 3, 2)
    assert (table["status"] == Status.FAILED).all()
    assert all("hatched: 3 could not go on" in axes.get_xlabel() for axes in both)


@pytest.mark.parametrize("name", ["power", "gear"])
def test_only_spreads_below_a_thousandth_are_white(tables, name):
    """Check that only cells with a relative spread of velocities below a thousandth are white.

    Cells with an unknown spread are grey and hatched.
    """
    scanned, table = tables[name]
    unknown = np.arange(len(table["n"])) % 5 == 2
    table = table | {"status": np.where(unknown, int(Status.FAILED), table["status"])}
    table |= {column: np.where(unknown, np.nan, table[column]) for column in COLUMNS}
    with styled():
        figure = draw_map(scanned, table)
    # A spread beyond the end of the scale gets the last colour.
    assert figure.axes[1].collections[0].colorbar.extend == "both"
    for axes, column in zip(figure.axes, COLUMNS, strict=False):
        cells, spreads = axes.collections[0], table[column].reshape(len(scanned.sizes), -1)
        assert (spreads < 1e-3).any()
        colours, unknown = cells.to_rgba(cells.get_array()), np.isnan(spreads)
        np.testing.assert_array_equal((colours == 1.0).all(axis=2), spreads < 1e-3)
        # Cells with an unknown spread are transparent, so their hatches are visible.
        assert (colours[unknown, 3] == 0.0).all()
        columns, rows = np.transpose([patch.get_center() for patch in axes.patches])
        hatched = np.rint(rows) - scanned.sizes[0], np.searchsorted(cells.get_coordinates()[0, :, 0], columns) - 1
        np.testing.assert_array_equal(hatched, np.nonzero(unknown))
        faces = [patch.get_facecolor() for patch in axes.patches]
        assert all(red == green == blue < 0.98 for red, green, blue, _ in faces)


@pytest.mark.slow
@pytest.mark.parametrize("scanned", rigidity_maps(40, 20), ids=["power", "gear"])
def test_a_map_can_be_read(scanned):
    with styled():
        figure = draw_map(scanned, compute_map(scanned))
        assert [text.get_text() for text, _ in texts_of(figure) if "white: below 0.1 %" in text.get_text()]
        assert unreadable(figure) == []


def test_white_cells_are_white_at_a_hundredth_of_the_tolerance():
    scanned, _ = rigidity_maps(12, 20)
    sides = []
    for tolerance in (rigidity_scan.TOLERANCE, 0.01 * rigidity_scan.TOLERANCE):
        cases = itertools.product(scanned.values, (2, 5, 12))
        points = [rigidity_scan.point_numbers("power-law", tolerance, alpha, n) for alpha, n in cases]
        sides.append([point[key] < 1e-3 for point in points for key in point if key.startswith("rigidity")])
    assert sides[0] == sides[1]
    assert 0 < sum(sides[0]) < len(sides[0])
