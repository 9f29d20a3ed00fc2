"""The figures: what their captions say is seen in their tables, and the files are whole."""

from __future__ import annotations

import csv
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from softcradle.sandbox.cli.main import main
from softcradle.sandbox.studies.data_table import rows_where, write_table
from softcradle.sandbox.studies.driven_cluster import FORCE
from softcradle.sandbox.studies.figures import (
    collapse_figure,
    coupling_figure,
    disorder_figure,
    driven_figure,
    hypothesis_figure,
    rigidity_figure,
    scaling_figure,
    train_figure,
    variant_figure,
    wave_figure,
)
from softcradle.sandbox.studies.figures.figure_list import FIGURES, drawn, figures_named, write_figure
from softcradle.sandbox.studies.figures.solved_cases import full_one_on, opening_time
from softcradle.sandbox.studies.picture_files import SUFFIXES
from softcradle.sandbox.studies.plot_style import styled
from softcradle.scenes import load

from tests.helpers.figure_layout import small_texts, texts_beyond, texts_on_curves, texts_on_texts
from tests.helpers.truth import ELASTIC

FRACTIONS = np.linspace(0.01, 0.99, 197)  # the middle 98 % of the contact
NAMES = [figure.name for figure in FIGURES]


@pytest.fixture(scope="module")
def tables():
    return {figure.name: figure.table() for figure in FIGURES}


def columns(table, name, count, kind=""):
    return np.column_stack([table[f"{name}{i}{kind}"] for i in range(count)])


def forces(table, kind, count=4):
    return np.column_stack([table[f"f{i}{i + 1} {kind}"] for i in range(count)])


def test_1b_beads_stay_in_order_and_the_striker_comes_back(tables):
    table = tables["1b"]
    positions = columns(table, "x", 5)
    assert (np.diff(positions, axis=1) > 0.0).all()  # x0 ... x4 from bottom to top
    before = table["t"] <= 0.0
    np.testing.assert_array_equal(positions[before, 1:], positions[:1, 1:].repeat(before.sum(), axis=0))
    assert np.diff(positions[-2:, 0]) < 0.0 < np.diff(positions[-2:, 1])


@pytest.mark.parametrize("name", ["1c", "1d"])
def test_velocities_of_fig_1(tables, name):
    velocity = columns(tables[name], "v", 5)
    assert velocity[0, 0] == 1.0
    assert velocity[-1, 0] < 0.0 < velocity[-1, 1] < velocity[-1, 2] <= velocity[-1, 3] <= velocity[-1, 4]
    ahead = velocity[1:, 1] > velocity[1:, 2]  # v1 is faster than the others at first, then slower for good
    assert ahead[0]
    assert np.count_nonzero(np.diff(ahead)) == 1


def test_the_deviation_of_v1_decreases_with_alpha(tables):
    harder, softer = (columns(tables[name], "v", 5)[-1] for name in ("1c", "1d"))
    assert harder[2:].mean() - harder[1] > 3.0 * (softer[2:].mean() - softer[1]) > 0.1


def test_2a_phi_is_large_and_returns_first(tables):
    table = tables["2a"]
    assert table["Phi"].max() > 5.0 * table["psi"].max() > 0.0
    returned = {name: table["t"][1:][(table[name][1:] <= 0.0)][0] for name in ("Phi", "psi")}
    assert returned["Phi"] < returned["psi"]
    assert returned["Phi"] == pytest.approx(1.802, abs=0.005)
    assert (table["psi"][table["t"] < 2.05][1:] > 0.0).all()
    detached = table["Phi"] < -0.01
    assert (tables["2b"]["f01 model"][detached] == 0.0).all()  # for Phi < 0 the striker has left


def test_2b_forces_from_top_to_bottom(tables):
    table = tables["2b"]
    full, model = forces(table, "full"), forces(table, "model")
    both = (table["t"] > 0.0) & (table["t"] < 1.75)
    assert (np.diff(full[both], axis=1) < 0.0).all()
    np.testing.assert_allclose(model[both], full[both], rtol=0.03)
    np.testing.assert_allclose(model[both][:, :2], full[both][:, :2], rtol=2e-3)
    assert np.argmax(full[:, 0]) < np.argmax(full[:, 1])


def test_2c_a_thousandth_but_for_the_last_part(tables):
    table = tables["2c"]
    assert np.abs(table["f12"]).max() < 1e-3
    early = table["t"] < 0.97 * table["t"][-1]
    assert np.abs(table["f01"][early]).max() < 1e-3
    assert (table["f01"] < 1e-8).all()  # the model's striker pushes longer
    assert (np.diff(table["f01"]) < 1e-8).all()
    assert (np.diff(np.sign(table["f12"])) != 0).sum() == 1  # from - to +
    assert table["f12"][0] < 0.0 < table["f12"][-1]


def test_2d_rises_as_powers(tables):
    table = tables["2d"]
    full, model = forces(table, "full"), forces(table, "model")
    assert (np.diff(full, axis=1) < 0.0).all()
    assert (np.diff(full[table["t"] < 0.5], axis=0) > 0.0).all()
    np.testing.assert_allclose(model[:, 0], full[:, 0], rtol=1e-4)
    np.testing.assert_allclose(model[:, 1], full[:, 1], rtol=3e-3)
    first = slice(0, 41)  # two decades
    for i, power in enumerate((0.1, 0.21)):
        slope = np.polyfit(np.log(table["t"][first]), np.log(full[first, i]), 1)[0]
        assert slope == pytest.approx(power, abs=2e-3)


def test_b_is_the_quadruple_precision_answer():
    case = next(case for case in ELASTIC if case.name == "one on 5, alpha 1/10")
    times = case.time[(case.time > 0.02) & (case.time < 1.8)]
    found = full_one_on(5, 0.1, None, tuple(times.tolist()))
    rows = np.isin(case.time, times)
    np.testing.assert_allclose(found.overlap[:, 1:], case.overlap[rows][:, 1:], rtol=1e-6)


@pytest.mark.parametrize("alpha", hypothesis_figure.ALPHAS)
@pytest.mark.parametrize("n", hypothesis_figure.SIZES)
def test_b_agrees_at_two_tolerances(n, alpha):
    rough, fine = (hypothesis_figure.discrepancy(n, alpha, FRACTIONS, tolerance)[1] for tolerance in (1e-8, 1e-10))
    np.testing.assert_array_equal(np.isnan(rough), np.isnan(fine))
    loaded = np.isfinite(fine)
    np.testing.assert_allclose(1.0 + rough[loaded], 1.0 + fine[loaded], rtol=1e-5)


def test_b_changes_sign_upwards_and_grows_at_both_ends(tables):
    for n in hypothesis_figure.SIZES:
        for alpha in hypothesis_figure.ALPHAS:
            if (n, alpha) in ((3, 1 / 10), (3, 1 / 14)):
                continue  # see the next test
            curve = rows_where(tables["B"], n=n, alpha=alpha, i=2)["discrepancy"]
            assert (np.diff(curve) > 0.0).all()
            assert curve[0] < -np.abs(curve[160:320]).max()
            assert curve[-1] > 0.0


def test_b_sign_change_of_small_clusters_is_real(tables):
    """The sign change near the end at (1/10, 3) is no artefact: the inner contact opens before the striker leaves."""
    curve = rows_where(tables["B"], n=3, alpha=1 / 10, i=2)
    late = curve["fraction of contact"] > 0.97
    assert np.nanmin(curve["discrepancy"][late]) < 0.0
    assert np.isnan(curve["discrepancy"][-1])
    assert opening_time(3, 1 / 10, contact=1) < opening_time(3, 1 / 10, contact=0)


def test_spread_vanishes_with_alpha(tables):
    for n in rigidity_figure.SPREAD_SIZES:
        points = rows_where(tables["spread"], n=n)
        assert points["spread"][-1] > 0.5
        assert points["spread"][0] < 0.05
        assert (points["v striker"][0], points["v last"][0]) == pytest.approx(
            rigidity_figure.rigid_outcome(n), abs=0.01
        )


def test_rigid_like_behaviour_ends(tables):
    table = tables["softness"]
    cradle = rows_where(table, n=4, alpha=max(rigidity_figure.LOSS_ALPHAS))["v"]
    assert cradle[-1] > 0.99
    assert np.abs(cradle[:-1]).max() < 0.1
    last = [rows_where(table, n=n, alpha=0.1)["v over rigid"][-1] for n in rigidity_figure.LONG_SIZES]
    assert (np.diff(last) > 0.0).all()
    assert last[-1] > 2.0


def test_limits_of_small_alpha(tables):
    for n in scaling_figure.SIZES:
        points = rows_where(tables["scalings"], n=n)
        assert (np.diff(points["max psi"]) < 0.0).all()
        assert points["contact time"][-1] == pytest.approx(scaling_figure.contact_time_limit(n), rel=0.02)
        for column, law in (
            ("max psi", scaling_figure.psi_limit),
            ("response time", scaling_figure.response_time_limit),
        ):
            at_last = points[column][-1] / law(n, 1 / 200)
            assert 0.1 < at_last < 10.0  # over dozens of decades


def test_in_train_forces_grow_with_the_blow_and_fall_along_the_train(tables):
    table, coupling = tables["envelopes"], load(train_figure.SOLID).lanes[0].chain().contact[0]
    for number, (struck, last) in enumerate(((1, 10), (5, 14))):
        blows = rows_where(table, train=number, coupling=struck)
        assert (np.diff(blows["force"]) > 0.0).all()
        assert (blows["travel"] <= 1e3 * coupling.travel).sum() == 5  # up to 2.5 m/s
        for speed in train_figure.SPEEDS:
            behind = rows_where(table, train=number, speed=speed)["force"][struck - 1 : last]
            assert (np.diff(behind) <= 1e-9).all()
    forces = np.maximum(
        coupling.preload, coupling.force(1e-3 * table["travel"])
    )  # below the preload a gear only touches
    np.testing.assert_allclose(np.maximum(table["force"], 1e-3 * coupling.preload), 1e-3 * forces, rtol=5e-3)


def test_driven_cluster_oscillates_about_the_uniform_acceleration(tables):
    table = tables["driven"]
    np.testing.assert_allclose(table["V"], FORCE / driven_figure.SHOWN_BEADS * table["t"], atol=1e-9)
    psi, model = table["psi full"], table["psi model"]
    assert np.abs(psi - model).max() < 0.2 * model.max()
    maxima = (np.diff(np.sign(np.diff(psi))) < 0).sum()
    assert maxima == driven_figure.PERIODS
    first, others = table["v1 - V"], np.column_stack([table[f"v{i} - V"] for i in (2, 3, 4)])
    assert np.corrcoef(first, others.mean(axis=1))[0, 1] < -0.99
    assert np.ptp(others, axis=1).max() < 0.1 * np.ptp(first)


def test_period_and_amplitude_of_the_driven_mode(tables):
    table = tables["driven-scan"]
    np.testing.assert_allclose(table["period full"], table["period model"], rtol=0.06)
    np.testing.assert_allclose(table["amplitude full"], table["amplitude model"], rtol=0.03)
    two = rows_where(table, n=2)
    np.testing.assert_allclose(two["period full"], two["period model"], rtol=1e-3)
    own = rows_where(table, n=4, alpha=0.1)
    assert own["period full"] / own["period model"] == pytest.approx([1.0059], abs=2e-4)
    assert own["psi at the fifth return"] < 2e-5


def test_spreads_collapse_and_the_threshold_falls_with_the_logarithm(tables):
    table = tables["collapse"]
    thresholds = {n: collapse_figure.threshold(table, n, "n alpha") for n in collapse_figure.SIZES}
    assert (np.diff(list(thresholds.values())) < 0.0).all()
    for n, found in thresholds.items():
        assert found == pytest.approx(float(collapse_figure.threshold_law(np.array(n), 1.0 / 0.87)), rel=0.1)
    above = {n: rows_where(table, n=n)["n alpha"] > 1.2 * found for n, found in thresholds.items()}
    for n, rows in above.items():
        assert (rows_where(table, n=n)["spread"][rows] > collapse_figure.THRESHOLD).all()


def test_inner_contacts_ring_at_the_frequency_of_their_branch(tables):
    table = tables["ringing"]
    rows = np.isfinite(table["period"])
    assert rows.sum() >= 15
    np.testing.assert_allclose(table["period"][rows], table["period of the branch"][rows], rtol=0.06)


def test_the_softer_the_slower_the_gear_that_does_the_same(tables):
    table = tables["equivalence"]
    four = rows_where(table, n=4)
    at_tenth = int(np.argmin(np.abs(four["alpha"] - 0.1)))
    assert four["V over v_c"][at_tenth] == pytest.approx(1.26, abs=0.08)
    assert np.nanmax(table["apart"]) < 0.07
    soft, hard = (four["alpha"] < 0.07, four["alpha"] > 0.5)
    assert four["V over v_c"][soft].max() < 1.15 < four["V over v_c"][hard].min()


def test_spreads_say_by_how_much_finer_runs_disagree(tables):
    table = tables["spread"]
    assert (table["finer runs apart"] >= 0.0).all()
    assert table["finer runs apart"].max() < 1e-3
    steps = np.diff(1.0 / rows_where(table, n=2)["alpha"])
    assert np.abs(steps).max() < 0.11


def test_disorder_breaks_the_cradle_and_clusters_with_weak_contacts(tables):
    table = tables["disorder"]
    load, spreads = disorder_figure.loads_and_spreads(table, disorder_figure.SOFT)
    assert spreads[load < 0.84].max() < 0.01  # contacts that are strong enough: rigid-like
    assert spreads[load > 1.0].min() > 0.1  # and that are not
    assert disorder_figure.loads_and_spreads(table, disorder_figure.CRADLE)[1].min() > 0.5
    homogeneous = rows_where(table, kind=disorder_figure.CRADLE, chain=0)["v"]
    last = [
        rows_where(table, kind=disorder_figure.CRADLE, chain=k)["v"][-1] for k in range(1, disorder_figure.CHAINS + 1)
    ]
    assert homogeneous[-1] > 0.98
    assert np.std(last) > 0.1


def test_both_modes_of_cluster_on_cluster(tables):
    table = tables["clusters"]
    count = variant_figure.STRIKERS + variant_figure.TARGETS - 1
    inside = (table["t"] > 0.1) & (table["t"] < 3.7)
    np.testing.assert_allclose(forces(table, "model", count)[inside], forces(table, "full", count)[inside], rtol=0.01)


def test_exchange_is_a_mirror_image(tables):
    table = tables["exchange"]
    np.testing.assert_allclose(columns(table, "v", 5, " seen"), columns(table, "v", 5), atol=1e-7)


def test_hooke_interface_opens_last_and_leaves_a_rigid_cluster(tables):
    table = tables["interface"]
    assert columns(table, "v", 5)[-1] == pytest.approx([-0.6, 0.4, 0.4, 0.4, 0.4], abs=0.01)
    both = (table["t"] > 0.2) & (table["t"] < 2.2)
    np.testing.assert_allclose(forces(table, "model")[both], forces(table, "full")[both], rtol=0.02)
    assert table["t"][table["f12 full"] > 0.0][-1] < table["t"][table["f01 full"] > 0.0][-1]


def test_evanescent_clusters_have_no_waves_springs_fast_and_prestressed_ones_slow_waves(tables):
    table = tables["roads"]
    turns = {kind: (np.diff(np.sign(np.diff(table[f"f23 {kind}"]))) != 0).sum() for kind in wave_figure.STRUCK_CLUSTERS}
    assert turns["soft"] <= 2
    assert turns["springs"] > 10
    assert turns["prestressed"] > 4
    for kind, prestress in (("springs", wave_figure.SPRING_PRESTRESS), ("prestressed", wave_figure.SOFT_PRESTRESS)):
        assert all((table[f"f{i}{i + 1} {kind}"] > -prestress).all() for i in (1, 2, 3))  # no contact ever opens
    late = table["t springs"] > 2.0
    assert np.column_stack([table[f"v{i} springs"][late].mean() for i in range(1, 5)]) == pytest.approx(0.4, abs=0.02)


def test_pulse_has_the_speed_of_the_solitary_wave(tables):
    table = tables["pulse"]
    velocity = columns(table, "v", wave_figure.PULSE_TARGETS + 1)
    arrival = table["t"][np.argmax(velocity, axis=0)]
    assert 10.0 / (arrival[22] - arrival[12]) == pytest.approx(0.840509, rel=5e-3)
    assert velocity[:, 15:25].max(axis=0) == pytest.approx(0.681631, rel=2e-3)
    assert velocity[-1, -1] > 0.95


@pytest.mark.parametrize("name", NAMES)
def test_files_are_whole(tables, name, tmp_path):
    (figure,) = figures_named([name])
    paths = write_figure(replace(figure, table=lambda: tables[name]), tmp_path)
    assert [path.suffix for path in paths] == list(SUFFIXES)
    with Image.open(paths[0]) as image:
        assert min(image.size) > 700
        dark = np.asarray(image.convert("L")) < 128
        assert 0.002 < dark.mean() < 0.3
        assert not dark[[0, -1]].any()  # nothing is cut off at the edges
        assert not dark[:, [0, -1]].any()
    assert paths[1].read_bytes().startswith(b"%PDF")


@pytest.mark.slow
@pytest.mark.parametrize("one_column", [False, True], ids=["page", "column"])
@pytest.mark.parametrize("name", NAMES)
def test_a_printed_figure_can_be_read(tables, name, one_column):
    """At its own size: no text below 6 points or beyond the edge, none on another one or on a curve."""
    (figure,) = figures_named([name])
    with styled(one_column):
        picture = drawn(figure, tables[name])
        assert small_texts(picture) == []
        assert texts_beyond(picture) == []
        assert texts_on_texts(picture) == []
        assert texts_on_curves(picture) == []
    assert not [axes for axes in picture.axes if axes.xaxis_inverted() or axes.yaxis_inverted()]
    width, height = picture.get_size_inches() * 25.4
    assert width <= (86.0 if one_column else 178.0) + 1e-9
    assert height <= 240.0  # of the page


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_panels_below_each_other_show_the_same(tables, name):
    """Every curve, and an axis label at every panel."""
    (figure,) = figures_named([name])
    shown = []
    for one_column in (False, True):
        with styled(one_column):
            panels = drawn(figure, tables[name]).axes
        shown.append(sorted(len(axes.lines) for axes in panels))
    assert shown[0] == shown[1]
    assert all(axes.get_ylabel() for axes in panels)


def test_the_command_draws_them_as_wide_as_a_column(tmp_path):
    assert main(["figures", "exchange", "--column", "-o", str(tmp_path)]) == 0
    with Image.open(tmp_path / "figure-exchange.png") as image:
        assert image.width == pytest.approx(86.0 / 25.4 * 300.0, abs=1)
        assert image.height > image.width


def test_csv_reads_back_equal(tmp_path):
    table = coupling_figure.modes()
    write_table(table, tmp_path / "modes.csv")
    with open(tmp_path / "modes.csv", newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert header == list(table)
    np.testing.assert_array_equal(np.array(rows, dtype=np.float64), np.column_stack(list(table.values())))


def test_command_writes_the_wanted_figures_and_lists_all(tmp_path, capsys):
    assert main(["figures", "2a", "exchange", "-o", str(tmp_path / "new" / "folder")]) == 0
    written = sorted(path.name for path in (tmp_path / "new" / "folder").iterdir())
    assert written == [f"figure-{name}{suffix}" for name in ("2a", "exchange") for suffix in sorted(SUFFIXES)]
    assert main(["figures", "--list"]) == 0
    listed = capsys.readouterr().out
    assert all(figure.caption in listed for figure in FIGURES)


def test_command_refuses_in_a_sentence(tmp_path, capsys):
    assert main(["figures", "3z"]) == 2
    assert "there is no figure '3z'; there are 1b, 1c" in capsys.readouterr().err
    (tmp_path / "file").write_text("")
    assert main(["figures", "2a", "-o", str(tmp_path / "file")]) == 2
    assert "cannot write to" in capsys.readouterr().err
