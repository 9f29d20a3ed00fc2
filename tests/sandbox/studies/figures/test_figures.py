"""Tests of the figures. The files must be complete and readable in print.

The captions of Fig. 1, Fig. 2, App. B and the figures of trains must agree with the tables.
"""

from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pytest
from PIL import Image
from softcradle.sandbox.cli.commands.figures import KEPT
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.files import filled_folder
from softcradle.sandbox.studies.data_table import rows_where
from softcradle.sandbox.studies.figures import catalogue
from softcradle.sandbox.studies.figures.catalogue import FIGURES, compute_tables, figures_named, write_figure
from softcradle.sandbox.studies.paper import opening_time
from softcradle.sandbox.studies.plot_style import SUFFIXES, styled
from softcradle.sandbox.studies.verify import FINAL

from tests.helpers.figure_layout import keys_on_curves, unnamed_colours, unreadable
from tests.sandbox.studies.figures.conftest import columns, forces

# Names of four figures that are tested by default. The four figures show one curve, a comparison of two methods, a
# vibration mode, and a coupler. Tests of the other figures are slow and run with `make test-all`.
KINDS = ("2a", "1b", "exchange", "stop")
NAMES = [one.name if one.name in KINDS else pytest.param(one.name, marks=pytest.mark.slow) for one in FIGURES]


@pytest.mark.parametrize("name", NAMES)
def test_figure_files_are_complete_and_readable(tables, name, tmp_path):
    """Check that the figure files are complete and that the layout is readable.

    Every curve has a name. No text is smaller than 6 points, outside the figure, or on another text or a curve. No
    legend covers a curve.
    """
    (figure,), table = figures_named([name]), tables(name)
    paths = write_figure(replace(figure, table=lambda: table), tmp_path)
    assert [path.suffix for path in paths] == list(SUFFIXES)
    with Image.open(paths[0]) as image:
        assert min(image.size) > 700
        dark = np.asarray(image.convert("L")) < 128
        assert 0.002 < dark.mean() < 0.3
        assert not dark[[0, -1]].any()  # Dark pixels at an edge would mean that a part of the figure is cut off.
        assert not dark[:, [0, -1]].any()
    assert paths[1].read_bytes().startswith(b"%PDF")
    header, _, rows = paths[2].read_text(encoding="utf-8").partition("\n")
    assert header.split(",") == list(table)
    np.testing.assert_array_equal(np.loadtxt(rows.splitlines(), delimiter=","), np.column_stack(list(table.values())))
    with styled():
        picture = figure.draw(table)
        assert unreadable(picture) == []
        assert unnamed_colours(picture) == set()
        assert keys_on_curves(picture) == []
    assert not [axes for axes in picture.axes if axes.xaxis_inverted() or axes.yaxis_inverted()]
    width, height = picture.get_size_inches() * 25.4
    assert width <= 178.0 + 1e-9
    assert height <= 240.0  # The height of the printed page is 240 mm.


def test_the_figures_command_reuses_stored_tables(tables, tmp_path, monkeypatch, softcradle):
    # Long captions are wrapped, so the lines are joined before the search.
    listed = " ".join(softcradle("figures", "--list").out.split())
    assert all(figure.caption in listed for figure in FIGURES)
    stop = Mock(side_effect=[None, KeyboardInterrupt])
    wanted, folder = figures_named(["2a", "exchange", "2a"]), tmp_path / "new" / "folder"
    # Compute the expected tables first. Later in the test, one of the tables can no longer be computed.
    expected = [[*tables(figure.name).items()] for figure in wanted]
    with filled_folder(folder), pytest.raises(KeyboardInterrupt):
        list(compute_tables(wanted, folder / KEPT, stop, 1))
    again = [replace(wanted[0], table=lambda: pytest.fail("computed again")), wanted[1]]
    monkeypatch.setattr(catalogue, "FIGURES", again)
    np.testing.assert_equal([[*table.items()] for table in compute_tables(again, folder / KEPT, None, 1)], expected)
    assert main(["figures", "2a", "exchange", "-o", str(folder)]) == 0
    written = sorted(path.name for path in folder.iterdir())
    assert written == [f"figure-{name}{suffix}" for name in ("2a", "exchange") for suffix in sorted(SUFFIXES)]


def test_figure_1_shows_ordered_beads_and_a_smaller_deviation_of_v1(tables):
    table = tables("1b")
    positions = columns(table, "x", 5)
    assert (np.diff(positions, axis=1) > 0.0).all()  # The beads are ordered from x0 at the bottom to x4 at the top.
    before = table["t"] <= 0.0
    np.testing.assert_array_equal(positions[before, 1:], positions[:1, 1:].repeat(before.sum(), axis=0))
    behind = []
    for name, alpha in (("1c", 1 / 10), ("1d", 1 / 14)):
        velocity = columns(tables(name), "v", 5)
        assert velocity[0].tolist() == [1.0, 0.0, 0.0, 0.0, 0.0]
        assert velocity[-1, 0] == pytest.approx(FINAL[4, alpha], abs=1e-6)
        behind.append(velocity[-1, 2:].mean() - velocity[-1, 1])
    assert behind[0] > 3.0 * behind[1] > 0.1


def test_2a_phi_is_large_and_returns_first(tables):
    table = tables("2a")
    assert table["Phi"].max() > 5.0 * table["psi"].max() > 0.0
    phi, psi = (table["t"][1:][table[name][1:] <= 0.0][0] for name in ("Phi", "psi"))
    assert phi == pytest.approx(1.802, abs=0.005)
    assert psi >= 2.05


def test_2b_forces_from_top_to_bottom(tables):
    table = tables("2b")
    full, model = forces(table, "full"), forces(table, "model")
    both = (table["t"] > 0.0) & (table["t"] < 1.75)
    assert (np.diff(full[both], axis=1) < 0.0).all()
    np.testing.assert_allclose(model[both], full[both], rtol=0.03)
    np.testing.assert_allclose(model[both][:, :2], full[both][:, :2], rtol=2e-3)


def test_2c_a_thousandth_but_for_the_last_part(tables):
    table = tables("2c")
    assert np.abs(table["f12"]).max() < 1e-3
    early = table["t"] < 0.97 * table["t"][-1]
    assert np.abs(table["f01"][early]).max() < 1e-3
    # In the approximate model, the striker pushes longer than in the full equations.
    assert (table["f01"] < 1e-8).all()
    # The approximation error changes its sign exactly once, from negative to positive.
    assert (np.diff(np.sign(table["f12"])) != 0).sum() == 1
    assert table["f12"][0] < 0.0 < table["f12"][-1]


def test_2d_rises_as_powers(tables):
    table = tables("2d")
    full, model = forces(table, "full"), forces(table, "model")
    assert (np.diff(full, axis=1) < 0.0).all()
    np.testing.assert_allclose(model[:, 0], full[:, 0], rtol=1e-4)
    np.testing.assert_allclose(model[:, 1], full[:, 1], rtol=3e-3)
    first = slice(0, 41)  # The first 41 samples cover two decades of time.
    for i, power in enumerate((0.1, 0.21)):
        slope = np.polyfit(np.log(table["t"][first]), np.log(full[first, i]), 1)[0]
        assert slope == pytest.approx(power, abs=2e-3)


@pytest.mark.slow
def test_the_discrepancy_of_appendix_b_is_small(tables):
    """Check that the approximation error in App. B is small and changes its sign near the end for alpha = 1/10 and n =
    3.

    The sign change is real, because the inner contact opens before the striker separates.
    """
    assert np.nanmax(np.abs(rows_where(tables("B"), alpha=1 / 14)["discrepancy"])) < 0.13
    curve = rows_where(tables("B"), n=3, alpha=1 / 10, i=2)
    late = curve["fraction of contact"] > 0.97
    assert np.nanmin(curve["discrepancy"][late]) < 0.0
    assert np.isnan(curve["discrepancy"][-1])
    assert opening_time(3, 1 / 10, contact=1) < opening_time(3, 1 / 10, contact=0)


def test_the_solid_stop_multiplies_the_force(tables):
    """Check by how much elastic wagons reduce the force of a collision of trains.

    The reduction is a twentieth below the solid stop and a sixth above it, as stated in the figure and in the
    documentation.
    """
    endless, rigid, elastic = (rows_where(tables("stop"), train=number) for number in range(3))
    # At a speed of 2.54 m/s, the first gear uses its whole travel in the collision of one wagon with ten.
    below = endless["speed"] < 2.54
    np.testing.assert_allclose(rigid["force"][below], endless["force"][below], rtol=1e-6)
    assert rigid["force"][-1] > 2.3 * endless["force"][-1]
    less = 1.0 - elastic["force"] / rigid["force"]
    assert less[below] == pytest.approx(0.05, abs=0.02)
    assert less[~below] == pytest.approx(0.175, abs=0.015)


def test_trains_have_in_train_forces_and_start_in_turn(tables):
    assert tables("train")["five on ten: force 5-6"].max() == pytest.approx(1335.0, rel=0.02)
    assert (tables("train")["one on ten: absorbed by gears"] >= -1e-9).all()
    table = tables("starting")
    wagons = [name for name in table if name not in ("t", "locomotive")]
    starts = [table["t"][np.argmax(table[name] > 0.01)] for name in wagons]
    np.testing.assert_allclose(np.diff(starts), 0.175, atol=0.075)
    # At the end, the locomotive and all wagons have the same velocity.
    assert np.ptp([table[name][-1] for name in table if name != "t"]) < 1e-3
